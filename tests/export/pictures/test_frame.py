"""A frame shows what the map shows at that moment, with its words as outlines."""

from __future__ import annotations

from dataclasses import replace
from xml.etree.ElementTree import fromstring

import pytest

from geotween.export.paint import Paint
from geotween.export.pictures.frame import mixed, seam_opacity
from geotween.export.pictures.letters import outlined
from geotween.export.pictures.moments import at_place
from geotween.export.pictures.picture import SHAPES, Shown, frame_svg
from geotween.export.pictures.pixels import png
from tests.export.pictures.conftest import GALLERY, gallery_scene
from tests.export.pictures.seen import box, pixels, where


def test_the_square_is_half_way(squares: Shown) -> None:
    seen = where(pixels(png(frame_svg(squares, at_place(squares.frames, 0.5)), 200)), "#ff0000")
    left, top, right, bottom = box(seen)
    assert (left, right, bottom - top) == (64, 136, 72)
    assert seen.sum() == 72 * 72


@pytest.mark.parametrize(("place", "left"), [(0, 10), (0.25, 37), (0.75, 91), (1, 118)])
def test_the_square_is_on_its_way(squares: Shown, place: float, left: int) -> None:
    seen = where(pixels(png(frame_svg(squares, at_place(squares.frames, place)), 200)), "#ff0000")
    assert box(seen)[::2] == (left, left + 72)


@pytest.mark.parametrize("shape", SHAPES)
def test_a_frame_has_the_shape_asked_for(squares: Shown, shape: str) -> None:
    wide, high = SHAPES[shape][0]
    svg = frame_svg(squares, at_place(squares.frames, 0.5), 144 * wide, shape)  # type: ignore[arg-type]
    drawn = pixels(png(svg, 144 * wide))
    assert drawn.shape[:2] == (144 * high, 144 * wide)
    left, top, right, bottom = box(where(drawn, "#ff0000"))
    assert right - left == pytest.approx(bottom - top, abs=2)  # a square stays one
    assert (left + right) / 2 == pytest.approx(72 * wide, abs=1)


def test_words_are_larger_beside_a_map_that_is_drawn_small() -> None:
    fire = gallery_scene("fire")
    moment = at_place(fire.frames, 1)
    whole, small = (fromstring(frame_svg(fire, moment, width)) for width in (None, 300))
    ratio = [float(svg.attrib["height"]) / float(svg.attrib["width"]) for svg in (whole, small)]
    assert ratio[1] > ratio[0]


@pytest.mark.parametrize("name", GALLERY)
@pytest.mark.parametrize("place", [0, 0.37, 1])
def test_no_font_is_asked_for(name: str, place: float) -> None:
    shown = gallery_scene(name)
    svg = frame_svg(shown, at_place(shown.frames, place))
    assert "<text" not in svg
    assert fromstring(svg).attrib["aria-label"] == shown.title


def test_the_same_frame_is_the_same_bytes() -> None:
    shown = gallery_scene("territory")
    once, again = (frame_svg(shown, at_place(shown.frames, 1.3)) for _ in range(2))
    assert once == again
    assert png(once, 300) == png(again, 300)


@pytest.mark.parametrize("title", ["日本の地図", "Squares ★"])
def test_letters_that_the_font_has_not_stay_text(squares: Shown, title: str) -> None:
    svg = frame_svg(replace(squares, title=title), at_place(squares.frames, 0))
    assert svg.count("<text") == 1
    assert title in svg


@pytest.mark.parametrize("anchor", ["start", "middle", "end"])
def test_outlines_stand_where_the_words_stood(anchor: str) -> None:
    svg = f"""<svg xmlns="http://www.w3.org/2000/svg" width="300" height="60" viewBox="0 0 300 60">
      <text x="150" y="40" font-size="30" text-anchor="{anchor}">HHHHH</text></svg>"""
    root = fromstring(svg.replace(' xmlns="http://www.w3.org/2000/svg"', ""))
    assert outlined(root) == 0
    path = root.find("g/path")
    assert path is not None
    drawn = f'<path d="{path.get("d")}" transform="{path.get("transform")}"/>'
    head = svg[: svg.index("<text")]
    seen = pixels(png(f"{head}{drawn}</svg>", 300, "white"))
    left, top, right, bottom = box(where(seen, "#000000", 128))
    assert (bottom, bottom - top) == (40, pytest.approx(30 * 0.714, abs=1))
    held = {"start": left, "middle": (left + right) / 2, "end": right}[anchor]
    assert held == pytest.approx(150, abs=4)


def test_paints_mix_and_none_turns_half_way() -> None:
    one, other = Paint("#ff0000", "none", 1.0, "4 3"), Paint("#0000ff", "#ffffff", 2.0)
    assert mixed(one, other, 0.0) == one
    assert mixed(one, other, 1.0) == other
    assert mixed(one, other, 0.25) == Paint("#bf0040", "none", 1.25, "4 3")
    assert mixed(one, other, 0.75) == Paint("#4000bf", "#ffffff", 1.75, "")


@pytest.mark.parametrize(
    ("code", "at"), [(0, [1, 1, 1, 1]), (1, [0, 0.5, 1, 1]), (2, [1, 1, 1, 0]), (3, [0, 0.5, 1, 0])]
)
def test_seams_fade_in_and_out_over_a_twentieth(code: int, at: list[float]) -> None:
    shares = (0.0, 0.025, 0.5, 1.0)
    assert [seam_opacity(code, share) for share in shares] == pytest.approx(at)
