"""One frame: the map as page and animated SVG show it at a moment."""

from __future__ import annotations

from itertools import groupby

import numpy as np
import svgwrite
from svgwrite.base import BaseElement

from geotween.export.elements import path_element, px
from geotween.export.furniture.annotations import SIZE as NOTE_SIZE
from geotween.export.furniture.draw import draw_callout, draw_graticule, draw_labels
from geotween.export.furniture.labels import SIZE as LABEL_SIZE
from geotween.export.furniture.labels import Label, places_on
from geotween.export.keyframes import Keyframes
from geotween.export.paint import Paint
from geotween.export.paths import path_at
from geotween.export.pictures.moments import Moment
from geotween.export.shapes import SEAM_FADE, Group, Shape
from geotween.export.svg import draw_scenery

LEGIBLE = 8.0  # px of the picture: labels that have no room for it are left out, notes grow to it


def map_at(
    drawing: svgwrite.Drawing, frames: Keyframes, moment: Moment, scale: float
) -> BaseElement:
    """The map at a moment, with what lies on it, as a group in px of its page.

    ``scale`` says how large the page is drawn: where it is small words are larger, or left out.
    """
    found = drawing.g(class_="map")
    draw_scenery(drawing, found, frames, above=False)
    furniture = frames.furniture
    if furniture.graticule:
        found.add(draw_graticule(furniture.graticule))
    for element in _layers(drawing, frames, moment):
        found.add(element)
    draw_scenery(drawing, found, frames, above=True)
    if furniture.labels:

        def placed(text: BaseElement, label: Label) -> bool:
            return _place(text, label, moment, scale)

        found.add(draw_labels(drawing, furniture.labels, placed))
    for callout in furniture.callouts:
        if moment.step in callout.steps:
            size = max(NOTE_SIZE, LEGIBLE / scale)
            found.add(draw_callout(drawing, callout, frames.lang, size))
    return found


def _layers(drawing: svgwrite.Drawing, frames: Keyframes, moment: Moment) -> list[BaseElement]:
    """The regions at a moment in groups, each with the opacity it has then."""
    order = {slot: place for place, slot in enumerate(frames.slots())}
    shown = [s for s in frames.spans[moment.span][1] if _is_shown(s, moment)]
    shown.sort(key=lambda shape: order[shape.slot])
    found = []
    for group, shapes in groupby(shown, key=lambda shape: shape.slot.group):
        element = drawing.g(class_="layer")
        element.attribs["data-layer"] = group.layer
        opacity = _opacity(group, moment.t)
        if opacity < 1:
            element.attribs["opacity"] = px(opacity)
        for shape in shapes:
            path = _path(shape, moment)
            if path is not None:
                element.add(path)
        found.append(element)
    return found


def _is_shown(shape: Shape, moment: Moment) -> bool:
    first, last = shape.show or (0.0, 1.0)
    return first <= moment.share <= last


def _opacity(group: Group, t: float) -> float:
    one, other = group.opacity
    return one + (other - one) * t


def _path(shape: Shape, moment: Moment) -> BaseElement | None:
    text = path_at(shape, moment.t)
    if not text:
        return None
    element = path_element(shape.slot, mixed(*shape.paints, moment.t), text)
    opacity = seam_opacity(shape.slot.code, moment.share)
    if opacity < 1:
        element.attribs["stroke-opacity"] = px(opacity)
    return element


def mixed(one: Paint, other: Paint, t: float) -> Paint:
    """The paint on the way from one to another; between a colour and none it turns half-way."""
    width = one.width + (other.width - one.width) * t
    dash = one.dash if t < 0.5 else other.dash
    return Paint(
        _colour(one.fill, other.fill, t), _colour(one.stroke, other.stroke, t), width, dash
    )


def _colour(one: str, other: str, t: float) -> str:
    if one == other or "none" in (one, other):
        return one if t < 0.5 else other
    pairs = [(int(one[i : i + 2], 16), int(other[i : i + 2], 16)) for i in (1, 3, 5)]
    return "#" + "".join(f"{round(a + (b - a) * t):02x}" for a, b in pairs)


def seam_opacity(code: int, share: float) -> float:
    """How far the stroke of a seam has come, or has not yet gone, at a share of a transition."""
    opening = share / SEAM_FADE if code & 1 else 1.0
    closing = (1 - share) / SEAM_FADE if code & 2 else 1.0
    return min(opening, closing, 1.0)


def _place(text: BaseElement, label: Label, moment: Moment, scale: float) -> bool:
    """Put a label where it is at a moment, as large as it has room for; False if it is not seen."""
    way = label.spans.get(moment.span, ())
    size = LABEL_SIZE * min(max(1 / scale, 1.0), max(label.room, 1.0))
    if not way or size * scale < LEGIBLE:
        return False
    ((x, y),) = places_on(way, np.array([moment.t]))
    text.attribs |= {"x": px(round(float(x), 2)), "y": px(round(float(y), 2))}
    text.attribs["font-size"] = px(round(size, 2))
    return True
