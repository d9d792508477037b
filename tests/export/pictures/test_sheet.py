"""Several frames side by side, and two steps over each other."""

from __future__ import annotations

from itertools import pairwise
from xml.etree.ElementTree import fromstring

import pytest
from scipy import ndimage

from geotween.export.pictures.moments import at_place, evenly
from geotween.export.pictures.picture import Shown
from geotween.export.pictures.pixels import png
from geotween.export.pictures.sheet import caption, sheet_svg, superposed_svg
from tests.export.pictures.seen import box, pixels, where


def moments(shown: Shown, count: int) -> list:  # type: ignore[type-arg]
    return [at_place(shown.frames, place) for place in evenly(shown.frames, count)]


@pytest.mark.parametrize("layout", ["strip", "grid"])
def test_each_frame_is_seen_once(squares: Shown, layout: str) -> None:
    svg = sheet_svg(squares, moments(squares, 5), layout)  # type: ignore[arg-type]
    width = round(float(fromstring(svg).attrib["width"]))
    seen = where(pixels(png(svg, width)), "#ff0000")
    labels, count = ndimage.label(seen)
    assert count == 5
    assert [int((labels == n + 1).sum()) for n in range(5)] == pytest.approx(
        [72 * 72] * 5, rel=0.06
    )


def test_a_strip_is_one_row_and_the_square_goes_through_it(squares: Shown) -> None:
    svg = sheet_svg(squares, moments(squares, 5), "strip")
    width = round(float(fromstring(svg).attrib["width"]))
    boxes = ndimage.find_objects(ndimage.label(where(pixels(png(svg, width)), "#ff0000"))[0])
    assert len({found[0].start for found in boxes}) == 1
    lefts = sorted(found[1].start for found in boxes)
    steps = [b - a for a, b in pairwise(lefts)]
    assert steps == pytest.approx([216 + 27] * 4, abs=1)  # a panel and its gap, and a quarter's way


def test_captions_name_steps_and_what_lies_between(squares: Shown) -> None:
    assert [caption(squares.frames, moment) for moment in moments(squares, 3)] == [
        "Before", "Before – After, t = 0.5", "After",
    ]  # fmt: skip


def test_two_steps_lie_over_each_other_in_two_colours(squares: Shown) -> None:
    drawn = pixels(png(superposed_svg(squares, 0, 1), 800))
    one, other = where(drawn, "#66aad1"), where(drawn, "#e69e66")  # the palette's first, at 60%
    assert box(one[:700])[0] == pytest.approx(4 * 10, abs=4)
    assert one.sum() == pytest.approx(16 * 72 * 72, rel=0.06)
    assert other.sum() == pytest.approx(16 * 72 * 72, rel=0.06)
    assert not (one & other).any()
