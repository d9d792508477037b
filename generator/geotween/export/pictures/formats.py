"""The formats of pictures: what a map is written as beside page and SVG, and how large."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from typing import Literal
from xml.etree.ElementTree import fromstring

from geotween.data.problems import Problem
from geotween.export.pictures.extras import needed
from geotween.export.pictures.film import Film
from geotween.export.pictures.moments import at_place, film
from geotween.export.pictures.pdf import pdf
from geotween.export.pictures.picture import Shape, Shown, frame_svg
from geotween.export.pictures.pixels import png
from geotween.export.pictures.sheet import Layout, sheet_svg, superposed_svg
from geotween.export.pictures.video import apng, gif, mp4, webp

Still = Literal["svg", "png", "pdf"]

STILL_FORMATS = ("png", "pdf", "svg-still")
MOVING_FORMATS = ("gif", "webp", "apng", "mp4")
PICTURE_FORMATS = (*STILL_FORMATS, *MOVING_FORMATS)

# The name of each file: still and moving pictures of a map lie side by side.
_ENDINGS = {name: f".{name}" for name in PICTURE_FORMATS} | {"svg-still": "-still.svg"}
_LIBRARIES = {
    "svg-still": ("uharfbuzz", "fontpkg_noto_sans"),
    "png": ("resvg_py",),
    "pdf": ("typst",),
    "mp4": ("imageio_ffmpeg",),
}

SCALE = 2.0  # pixels of a PNG to a px of the map: sharp on most screens, and on paper 192 dpi
_RATES = {"gif": 10.0, "webp": 15.0, "apng": 10.0, "mp4": 30.0}  # frames a second
_WIDTHS = {"gif": 600, "webp": 600, "apng": 600, "mp4": 1080}  # pixels
_WIDEST = {"landscape": 1920}  # of an MP4: its height is 1080 pixels then
MEGABYTE = 1_000_000

Done = Callable[[int], object]
Watch = Callable[[str, int], AbstractContextManager[Done]]


def unwatched(_name: str, _count: int) -> AbstractContextManager[Done]:
    """Tells no one how far a film is."""
    return nullcontext(lambda _: None)


@dataclass(frozen=True)
class Pictures:
    """How pictures are made: what is not said is as is usual for the format.

    ``rate`` is in frames a second, ``width`` in pixels; ``limit`` the most megabytes of a GIF.
    ``jobs`` is the number of processes that draw films; ``watch`` is told of each film by name,
    with the number of its frames, and gives what is called as they are done.
    """

    rate: float | None = None
    width: int | None = None
    shape: Shape | None = None
    limit: float | None = None
    jobs: int = 1
    watch: Watch = unwatched


def require(formats: Iterable[str]) -> None:
    """Make sure that what some formats need is there, before anything is planned or drawn.

    Raises
    ------
    MissingExtraError
        Where it is not.
    """
    for name in (name for name in PICTURE_FORMATS if name in {*formats}):
        moving = ("PIL.Image", "resvg_py") if name in MOVING_FORMATS else ()
        for module in (*_LIBRARIES.get(name, ()), *moving, *_LIBRARIES["svg-still"]):
            needed(module, f"format {name}")


def picture_files(
    name: str, shown: Shown, formats: Sequence[str], how: Pictures, step: int
) -> tuple[dict[str, bytes], list[Problem]]:
    """The files of a map by name, those of PICTURE_FORMATS that are among the formats.

    Stills show a step. With the files come the problems that were met.

    Raises
    ------
    MissingExtraError
        Where what a format needs is not installed.
    """
    require(formats)
    files: dict[str, bytes] = {}
    problems: list[Problem] = []
    stills = [form for form in STILL_FORMATS if form in formats]
    if stills:
        svg = frame_svg(shown, at_place(shown.frames, step), how.width, how.shape)
        if "<text" in svg:
            problems.append(_LETTERS)
        for form in stills:
            still: Still = "png" if form == "png" else "pdf" if form == "pdf" else "svg"
            files[name + _ENDINGS[form]] = still_file(svg, shown, still, width=how.width)
    for form in (form for form in MOVING_FORMATS if form in formats):
        file = name + _ENDINGS[form]
        files[file] = _film_file(file, shown, form, how)
        if form == "gif" and how.limit and len(files[file]) > how.limit * MEGABYTE:
            problems.append(_too_large(len(files[file])))
    return files, problems


def still_file(
    svg: str, shown: Shown, form: Still, *, scale: float = SCALE, width: int | None = None
) -> bytes:
    """A still in a format; as PNG so many pixels wide, or at a scale.

    Raises
    ------
    MissingExtraError
        Where what the format needs is not installed.
    """
    if form == "pdf":
        return pdf(svg, shown.title, shown.description, shown.frames.lang)
    if form == "png":
        return png(svg, width or round(scale * float(fromstring(svg).attrib["width"])))
    return svg.encode()


def frame_files(
    name: str,
    shown: Shown,
    places: Sequence[float],
    form: Still,
    layout: Layout | Literal["frames"] = "frames",
    scale: float = SCALE,
) -> dict[str, bytes]:
    """Frames at places between steps, each as a file or all on one sheet.

    Raises
    ------
    MissingExtraError
        Where what the format needs is not installed.
    ValueError
        For a place before the first step, or after the last one.
    """
    moments = [at_place(shown.frames, place) for place in places]
    if layout != "frames":
        sheet = sheet_svg(shown, moments, layout)
        return {f"{name}-{layout}.{form}": still_file(sheet, shown, form, scale=scale)}
    digits = len(str(len(moments)))
    return {
        f"{name}-{number:0{digits}}.{form}": still_file(
            frame_svg(shown, moment), shown, form, scale=scale
        )
        for number, moment in enumerate(moments, 1)
    }


def superposed_files(
    name: str, shown: Shown, steps: tuple[int, int], form: Still, scale: float = SCALE
) -> dict[str, bytes]:
    """Two steps, by number, laid over each other, as a file.

    Raises
    ------
    MissingExtraError
        Where what the format needs is not installed.
    """
    svg = superposed_svg(shown, *steps)
    return {f"{name}-superposed.{form}": still_file(svg, shown, form, scale=scale)}


def _film_file(file: str, shown: Shown, form: str, how: Pictures) -> bytes:
    rate = how.rate or _RATES[form]
    usual = _WIDEST.get(how.shape or "", _WIDTHS[form]) if form == "mp4" else _WIDTHS[form]
    width = how.width or usual
    filmed = Film(shown, film(shown.frames, rate), rate, width, how.shape)
    with how.watch(file, filmed.count) as done:
        if form == "gif":
            limit = round(how.limit * MEGABYTE) if how.limit else None
            return gif(filmed, how.jobs, done, limit)
        make = {"webp": webp, "apng": apng, "mp4": mp4}[form]
        return make(filmed, how.jobs, done)


_LETTERS = Problem(
    "letters", "note", "words in letters that Noto Sans has not are drawn in a font of the reader's"
)


def _too_large(size: int) -> Problem:
    hint = "give it less width (--width), or fewer frames a second (--fps)"
    megabytes = size / MEGABYTE
    return Problem("too large", "warning", "GIF", (), "", megabytes, "MB", hint)
