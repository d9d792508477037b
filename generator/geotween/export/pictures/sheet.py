"""Sheets: several frames side by side, each under its label; or two steps laid over each other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import svgwrite
from svgwrite.base import BaseElement

from geotween.export.elements import SvgPath, paint_attributes, px
from geotween.export.furniture.language import direction
from geotween.export.furniture.legend import Entry, seen
from geotween.export.furniture.text import FONT, text_width
from geotween.export.keyframes import Keyframes
from geotween.export.paint import PALETTE, Paint
from geotween.export.paths import path_at
from geotween.export.pictures.frame import map_at
from geotween.export.pictures.moments import Moment, at_place
from geotween.export.pictures.picture import Around, Shown, new_drawing, whole
from geotween.export.svg import draw_scenery
from geotween.export.words import MARGIN, ink_on

Layout = Literal["strip", "grid"]

PANEL = 320.0  # px, the width of a map beside others
GAP = 16.0  # px between maps
CAPTION, ROOM = 13.0, 22.0  # px: the size of the words above each, and the height they take

# Two steps over each other: what both cover is the mixture of their colours.
OVER = (PALETTE[0], PALETTE[1])
OVER_OPACITY = 0.6
OVER_WIDTH = 1.5  # px, of their outlines


def sheet_svg(shown: Shown, moments: Sequence[Moment], layout: Layout) -> str:
    """Frames side by side in one row, or in rows of about as many as there are rows.

    Raises
    ------
    MissingExtraError
        Where what draws letters is not installed.
    """
    page = shown.frames.page
    scale = min(1.0, PANEL / page.width)
    width, height = page.width * scale, page.height * scale
    columns = len(moments)
    if layout == "grid":
        square = math.sqrt(len(moments) * (height + ROOM) / width)
        columns = min(len(moments), max(1, math.ceil(square)))
    rows = math.ceil(len(moments) / columns)
    drawing = new_drawing()
    content = drawing.g(class_="sheet")
    for number, moment in enumerate(moments):
        row, column = divmod(number, columns)
        left, top = MARGIN + column * (width + GAP), row * (height + ROOM + GAP)
        content.add(_caption(drawing, shown.frames, moment, (left, top), width))
        panel = drawing.svg((px(left), px(top + ROOM)), (px(width), px(height)))
        panel.attribs["viewBox"] = f"0 0 {px(page.width)} {px(page.height)}"
        panel.add(map_at(drawing, shown.frames, moment, scale))
        content.add(panel)
    size = (
        columns * (width + GAP) - GAP + 2 * MARGIN,
        rows * (height + ROOM + GAP) - GAP,
    )
    return whole(drawing, shown, content, size, Around(bar=scale))


def caption(frames: Keyframes, moment: Moment) -> str:
    """The label of a step; for a frame in between both labels, and t."""
    span = frames.spans[moment.span][0]
    if span.rest:
        return frames.labels[span.step]
    return f"{frames.labels[span.step]} – {frames.labels[span.step + 1]}, t = {moment.t:.3g}"


def _caption(
    drawing: svgwrite.Drawing,
    frames: Keyframes,
    moment: Moment,
    place: tuple[float, float],
    width: float,
) -> BaseElement:
    line = caption(frames, moment)
    size = CAPTION * min(1.0, width / text_width(line, CAPTION))
    way = direction(frames.lang)
    x = place[0] if way == "ltr" else place[0] + width
    text = drawing.text(line, insert=(px(round(x, 2)), px(round(place[1] + CAPTION, 2))))
    text.attribs |= {"font-family": FONT, "font-size": px(round(size, 1)), "direction": way}
    text.attribs |= {"fill": ink_on(frames.background), "class": "step"}
    return text


def superposed_svg(shown: Shown, one: int, other: int) -> str:
    """Two steps, by number, laid over each other in two colours.

    Raises
    ------
    MissingExtraError
        Where what draws letters is not installed.
    """
    frames = shown.frames
    drawing = new_drawing()
    content = drawing.g(class_="map")
    draw_scenery(drawing, content, frames, above=False)
    entries = []
    for step, colour in zip((one, other), OVER, strict=True):
        content.add(_in_one_colour(drawing, frames, at_place(frames, step), colour))
        fill = seen(colour, OVER_OPACITY, frames.background)
        entries.append(Entry(frames.labels[step], fill, colour))
    draw_scenery(drawing, content, frames, above=True)
    named = replace(frames, furniture=replace(frames.furniture, legend=tuple(entries)))
    size = (frames.page.width, frames.page.height)
    return whole(drawing, replace(shown, frames=named), content, size, Around())


def _in_one_colour(
    drawing: svgwrite.Drawing, frames: Keyframes, moment: Moment, colour: str
) -> BaseElement:
    """All regions of a step in one colour: through their area one sees, not through their lines."""
    regions = [
        path_at(shape, moment.t)
        for shape in frames.spans[moment.span][1]
        if shape.slot.kind == "region"
    ]
    group = drawing.g(class_="superposed")
    area, lines = drawing.g(), drawing.g()
    area.attribs["opacity"] = px(OVER_OPACITY)
    for text in regions:
        for into, paint in (
            (area, Paint(colour, "none", 0.0)),
            (lines, Paint("none", colour, OVER_WIDTH)),
        ):
            path = SvgPath("region", text)
            path.attribs.update(paint_attributes(paint))
            into.add(path)
    group.add(area)
    group.add(lines)
    return group
