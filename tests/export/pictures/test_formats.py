"""Each format, opened by a reader that had no part in writing it."""

from __future__ import annotations

import re
import subprocess
import sys
from io import BytesIO
from pathlib import Path
from typing import Any

import imageio_ffmpeg
import numpy as np
import pypdfium2
import pytest
from numpy.typing import NDArray
from PIL import Image, ImageSequence

from geotween.export.pictures.extras import MissingExtraError
from geotween.export.pictures.film import Film, images
from geotween.export.pictures.formats import (
    MOVING_FORMATS,
    PICTURE_FORMATS,
    Pictures,
    picture_files,
    require,
)
from geotween.export.pictures.moments import at_place, film
from geotween.export.pictures.pdf import pdf
from geotween.export.pictures.picture import Shown, frame_svg
from geotween.export.pictures.pixels import png
from geotween.export.pictures.video import durations, gif, mp4
from tests.export.pictures.conftest import GALLERY, gallery_scene
from tests.export.pictures.seen import box, overlap, pixels, where

Pixels = NDArray[np.uint8]
RATE, WIDTH = 5.0, 160


def as_film(shown: Shown, rate: float = RATE, width: int = WIDTH) -> Film:
    return Film(shown, film(shown.frames, rate), rate, width)


def lengths(moving: Image.Image) -> list[int]:
    """How long (ms) each picture is seen."""
    return [frame.load() and frame.info["duration"] for frame in ImageSequence.Iterator(moving)]


def frames_of_mp4(content: bytes, folder: Path) -> tuple[dict[str, Any], Pixels]:
    """What FFmpeg says of a film, and its frames (n, h, w, 3)."""
    path = folder / "film.mp4"
    path.write_bytes(content)
    raw = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-i", str(path), *raw]
    read = subprocess.run(command, capture_output=True, check=True)
    said = read.stderr.decode()
    stream = re.search(r"Video: (\w+).*?, (\d+)x(\d+).*?, ([\d.]+) fps", said)
    length = re.search(r"Duration: 00:00:([\d.]+)", said)
    assert stream
    assert length
    codec, width, height, fps = stream.groups()
    size = int(width), int(height)
    told = {"codec": codec, "size": size, "fps": float(fps), "duration": float(length[1])}
    return told, np.frombuffer(read.stdout, np.uint8).reshape(-1, size[1], size[0], 3)


@pytest.mark.parametrize("name", GALLERY)
def test_every_format_of_the_gallery_opens(name: str, tmp_path: Path) -> None:
    shown = gallery_scene(name)
    seconds = shown.frames.duration / 1000
    rate = 1.0
    files, problems = picture_files(
        name,
        shown,
        PICTURE_FORMATS,
        Pictures(rate=rate, width=WIDTH),
        len(shown.frames.labels) // 2,
    )
    assert problems == []
    assert len(files) == len(PICTURE_FORMATS)
    still = Image.open(BytesIO(files[f"{name}.png"]))
    assert (still.format, still.width) == ("PNG", WIDTH)
    page = pypdfium2.PdfDocument(files[f"{name}.pdf"])[0]
    assert page.get_width() / page.get_height() == pytest.approx(
        still.width / still.height, rel=0.01
    )
    assert b"<svg" in files[f"{name}-still.svg"]
    for ending in ("gif", "webp", "apng"):
        moving = Image.open(BytesIO(files[f"{name}.{ending}"]))
        assert moving.size == still.size
        lasts = sum(lengths(moving)) / 1000
        assert lasts == pytest.approx(round(seconds * rate) / rate)
        assert moving.info["loop"] == 0
    meta, frames = frames_of_mp4(files[f"{name}.mp4"], tmp_path)
    assert (meta["codec"], meta["fps"]) == ("h264", rate)
    assert len(frames) == round(seconds * rate)
    assert meta["size"] == (WIDTH, still.height - still.height % 2)


def test_a_png_is_twice_as_wide_as_the_map_unless_told(squares: Shown) -> None:
    files, _ = picture_files("map", squares, ["png"], Pictures(), 1)
    drawn = where(pixels(files["map.png"]), "#ff0000")
    assert drawn.shape[1] == 400
    assert box(drawn)[::2] == (236, 380)


def test_a_pdf_is_vectors_without_fonts_in_the_colours_and_places_of_the_png() -> None:
    shown = gallery_scene("territory")
    svg = frame_svg(shown, at_place(shown.frames, 0.5))
    made = pdf(svg, shown.title)
    page = pypdfium2.PdfDocument(made)[0]
    kinds = {found.type for found in page.get_objects(max_depth=15)}
    raw = pypdfium2.raw
    assert raw.FPDF_PAGEOBJ_PATH in kinds
    assert not kinds & {raw.FPDF_PAGEOBJ_IMAGE, raw.FPDF_PAGEOBJ_TEXT}
    assert b"/Font" not in made
    # Nearly: the red of the Crown, the blue of Lithuania.
    width = round(float(page.get_width() / 0.75))
    one = np.asarray(page.render(scale=width / page.get_width()).to_pil().convert("RGB"))
    other = pixels(png(svg, width))
    for fill in ("#b84c41", "#4874a3"):
        a, b = where(one, fill, 12), where(other, fill, 12)
        assert b.sum() > 10_000
        assert overlap(a[: len(b)], b[: len(a)]) > 0.98


def test_a_pdf_tells_title_and_language_and_is_the_same_each_time(squares: Shown) -> None:
    svg = frame_svg(squares, at_place(squares.frames, 0))
    made = pdf(svg, 'A "map" #import', lang="de")
    document = pypdfium2.PdfDocument(made)
    assert document.get_metadata_value("Title") == 'A "map" #import'
    assert b"/Lang(de)" in made
    assert made == pdf(svg, 'A "map" #import', lang="de")


def test_the_pdf_of_a_scene_tells_what_it_shows() -> None:
    files, _ = picture_files("map", gallery_scene("territory"), ["pdf"], Pictures(), 0)
    assert b"/Alt(The Crown of Poland, the Grand Duchy of Lithuania" in files["map.pdf"]


def test_a_film_shows_the_square_where_it_is(squares: Shown, tmp_path: Path) -> None:
    meta, frames = frames_of_mp4(mp4(as_film(squares, 10, 400)), tmp_path)
    assert meta["duration"] == pytest.approx(4.0)
    assert len(frames) == 40
    lefts = [box(where(frame, "#ff0000", 60))[0] for frame in frames]
    expected = [2 * (10 + 108 * min(max(n / 10 - 1, 0), 2) / 2) for n in range(40)]
    assert lefts == pytest.approx(expected, abs=2.5)


def test_colours_of_a_film_are_those_of_the_map(squares: Shown, tmp_path: Path) -> None:
    """A matrix of another standard would turn this red by 20 levels."""
    _, frames = frames_of_mp4(mp4(as_film(squares, 5, 400)), tmp_path)
    assert where(frames[0], "#ff0000", 8).sum() > 0.9 * 144 * 144


@pytest.mark.parametrize("kind", ["gif", "webp", "apng"])
def test_moving_pictures_show_the_square_where_it_is(squares: Shown, kind: str) -> None:
    files, _ = picture_files("map", squares, [kind], Pictures(rate=5, width=200), 0)
    moving = Image.open(BytesIO(files[f"map.{kind}"]))
    now, lefts = 0, {}
    for frame in ImageSequence.Iterator(moving):
        seen = np.asarray(frame.convert("RGB"), dtype=np.int16)
        lefts[now] = box(where(seen, "#ff0000", 40))[0]
        now += frame.info["duration"]
    assert now == 4000
    expected = {t: 10 + 108 * min(max(t / 1000 - 1, 0), 2) / 2 for t in lefts}
    assert lefts == pytest.approx(expected, abs=1.5)


def test_a_film_is_the_same_however_many_processes_draw_it(squares: Shown) -> None:
    told: list[int] = []
    alone = [(one.tobytes(), count) for one, count in images(as_film(squares))]
    shared = [(one.tobytes(), count) for one, count in images(as_film(squares), 2, told.append)]
    assert alone == shared
    assert sum(told) == as_film(squares).count == 20


def test_a_gif_gives_up_colours_and_frames_for_its_size() -> None:
    filmed = as_film(gallery_scene("archipelago"), 3, 200)
    whole = gif(filmed)
    smaller = gif(filmed, limit=len(whole) * 2 // 3)
    assert len(smaller) <= len(whole) * 2 // 3
    lasts = [sum(lengths(Image.open(BytesIO(made)))) for made in (whole, smaller)]
    assert lasts[0] == lasts[1]


def test_a_gif_that_cannot_be_that_small_is_told_of(squares: Shown) -> None:
    files, problems = picture_files("map", squares, ["gif"], Pictures(2, 100, limit=0.0001), 0)
    (problem,) = problems
    assert (problem.severity, problem.unit) == ("warning", "MB")
    assert problem.measure == pytest.approx(len(files["map.gif"]) / 1e6)


@pytest.mark.parametrize("rate", [3, 7, 12.5, 24])
@pytest.mark.parametrize("unit", [1, 10])
def test_durations_are_right_in_sum(rate: float, unit: int) -> None:
    found = durations([1] * 100, rate, unit)
    assert sum(found) == pytest.approx(100_000 / rate, abs=unit)
    assert {part % unit for part in found} == {0}
    assert max(found) - min(found) <= unit


@pytest.mark.parametrize(
    ("form", "module", "extra"),
    [
        ("png", "resvg_py", "geotween[stills]"),
        ("pdf", "typst", "geotween[stills]"),
        ("svg-still", "uharfbuzz", "geotween[stills]"),
        ("svg-still", "fontpkg_noto_sans", "geotween[stills]"),
        ("gif", "PIL.Image", "geotween[video]"),
        ("mp4", "imageio_ffmpeg", "geotween[video]"),
    ],
)
def test_without_a_library_one_is_told_what_to_install(
    monkeypatch: pytest.MonkeyPatch, form: str, module: str, extra: str
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(MissingExtraError, match=r"pip install '" + extra.replace("[", r"\[")):
        require([form])
    with pytest.raises(MissingExtraError):
        picture_files("map", gallery_scene("fire"), [form], Pictures(), 0)


@pytest.mark.parametrize("form", MOVING_FORMATS)
def test_watching_counts_every_frame(squares: Shown, form: str) -> None:
    from contextlib import nullcontext

    told: list[tuple[str, int]] = []
    done: list[int] = []

    def watch(name: str, count: int) -> Any:
        told.append((name, count))
        return nullcontext(done.append)

    picture_files("map", squares, [form], Pictures(rate=2, width=64, watch=watch), 0)
    assert told == [(f"map.{form}", 8)]
    assert sum(done) == 8
