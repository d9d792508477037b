"""A picture: a frame or several, with the words of the map around them, in letters of its own."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal
from xml.etree.ElementTree import Element, tostring

import svgwrite
from svgwrite.base import BaseElement

from geotween.export.elements import px
from geotween.export.furniture.text import LEADING
from geotween.export.keyframes import Keyframes
from geotween.export.pictures.frame import map_at
from geotween.export.pictures.letters import outlined
from geotween.export.pictures.moments import Moment
from geotween.export.words import LABEL, NO_STEP, words, write_words

Shape = Literal["landscape", "square", "vertical"]

# Width to height, and how many times larger words are: square and vertical films are seen small.
SHAPES: dict[str, tuple[tuple[int, int], float]] = {
    "landscape": ((16, 9), 1.0),
    "square": ((1, 1), 1.25),
    "vertical": ((9, 16), 1.6),
}


@dataclass(frozen=True, eq=False)
class Shown:
    """A map as it goes into pictures: its keyframes, and the words that stand around it.

    ``description`` is its text alternative.
    """

    frames: Keyframes
    title: str
    source: str
    description: str = ""


def frame_svg(
    shown: Shown, moment: Moment, width: float | None = None, shape: Shape | None = None
) -> str:
    """A frame with title, step label, legend and source, as the animated SVG has them.

    Parameters
    ----------
    width
        How wide (px) it will be drawn, if not as wide as the map; where that is narrower its words
        are larger than the map they stand by.
    shape
        What it is fitted into; its own size unless given.

    Raises
    ------
    MissingExtraError
        Where what draws letters is not installed.
    """
    page = shown.frames.page
    ratio, larger = SHAPES[shape] if shape else (None, 1.0)
    wide = page.width if ratio is None else max(page.width, page.height * ratio[0] / ratio[1])
    scale = width / wide if width else 1.0
    drawing = new_drawing()
    content = map_at(drawing, shown.frames, moment, scale)
    around = Around(moment.step, larger * max(1.0, 1 / scale), ratio=ratio)
    return whole(drawing, shown, content, (page.width, page.height), around)


@dataclass(frozen=True)
class Around:
    """How words stand around a content: the step they name, and how large they are.

    ``bar`` is the length of the scale bar to that on the map's page, ``ratio`` the picture's width
    and height to each other, None for what the content and its words take.
    """

    step: int = NO_STEP
    larger: float = 1.0
    bar: float = 1.0
    ratio: tuple[int, int] | None = None


def new_drawing() -> svgwrite.Drawing:
    """An SVG to make elements with; its size is set when it is put together."""
    return svgwrite.Drawing(debug=False)


def whole(
    drawing: svgwrite.Drawing,
    shown: Shown,
    content: BaseElement,
    size: tuple[float, float],
    around: Around,
) -> str:
    """The picture of a content (px) with the words of its map, its letters as outlines."""
    (width, height), larger = size, around.larger
    frames = _of_size(shown.frames, width / larger, height / larger, around.bar / larger)
    said = words(frames, shown.title, shown.source)
    above = said.header - (LABEL * LEADING if around.step == NO_STEP else 0)
    needed_height = height + larger * (above + said.footer)
    full, tall = _fitted(width, needed_height, around.ratio)
    left, top = (full - width) / 2, (tall - needed_height) / 2 + larger * above
    drawing.elements.clear()  # svgwrite's empty defs
    drawing.attribs |= {"width": px(full), "height": px(tall), "role": "img"}
    drawing.attribs |= {"viewBox": f"0 0 {px(full)} {px(tall)}", "lang": frames.lang}
    drawing.attribs["aria-label"] = shown.title
    if frames.background != "none":
        drawing.add(drawing.rect((0, 0), ("100%", "100%"), fill=frames.background))
    for element, scale in (
        (content, 1.0),
        (write_words(drawing, frames, said, around.step), larger),
    ):
        place = f"translate({px(left)} {px(top)})"
        placed = drawing.g(transform=place if scale == 1 else f"{place} scale({px(scale)})")
        placed.add(element)
        drawing.add(placed)
    root: Element = drawing.get_xml()
    outlined(root)
    return tostring(root, encoding="unicode")


def _fitted(width: float, height: float, ratio: tuple[int, int] | None) -> tuple[float, float]:
    """The size (px) of the least picture of a ratio that has room for a size."""
    if ratio is None:
        return width, height
    # In whole px: pictures of the usual sizes have no half pixel over.
    unit = math.ceil(max(width / ratio[0], height / ratio[1]))
    return float(unit * ratio[0]), float(unit * ratio[1])


def _of_size(frames: Keyframes, width: float, height: float, bar: float) -> Keyframes:
    """Keyframes for words around a content of another size, with another scale."""
    furniture = frames.furniture
    if furniture.scale_bar is not None:
        drawn = replace(furniture.scale_bar, width=furniture.scale_bar.width * bar)
        furniture = replace(furniture, scale_bar=drawn)
    page = replace(frames.page, width=width, height=height)
    return replace(frames, page=page, furniture=furniture)
