"""Small multiples: the map at each step, drawn small and as coarsely as it is seen then."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
import svgwrite
from numpy.typing import NDArray

from geotween.export.elements import SvgPath, paint_attributes, px
from geotween.export.furniture.room import drawn_at
from geotween.export.keyframes import Keyframes
from geotween.export.page_grid import GridTrack
from geotween.export.paint import Paint
from geotween.export.shapes import Shape

WIDTH = 300.0  # px: all places are rounded to whole ones of these
THINNEST = 0.4  # px, of a stroke
DETAIL = 0.8  # px: corners go that make a triangle less than this squared


def multiples(frames: Keyframes, title: str) -> list[str]:
    """An SVG for each step."""
    return [_still(frames, step, f"{title}: {label}") for step, label in enumerate(frames.labels)]


def _still(frames: Keyframes, step: int, title: str) -> str:
    scale = min(1.0, WIDTH / frames.page.width)
    width, height = (round(size * scale) for size in (frames.page.width, frames.page.height))
    drawing = svgwrite.Drawing(size=(px(width), px(height)), debug=False)
    drawing.attribs |= {"viewBox": f"0 0 {width} {height}", "class": "still", "role": "img"}
    drawing.attribs["aria-label"] = title
    drawing.elements.clear()  # svgwrite's empty defs
    if frames.background != "none":
        drawing.add(drawing.rect((0, 0), ("100%", "100%"), fill=frames.background))
    _scenery(drawing, frames, scale, above=False)
    shapes = next(shapes for span, shapes in frames.spans if span.rest and span.step == step)
    drawn = _coarse_by_layer(shapes, scale)
    order = {slot: place for place, slot in enumerate(frames.slots())}
    for shape in sorted(shapes, key=lambda shape: order[shape.slot]):
        text = "".join(drawn[track] for track in shape.tracks)
        _add(drawing, shape.paints[0], shape.slot.group.opacity[0], text, scale)
    _scenery(drawing, frames, scale, above=True)
    return str(drawing.tostring())


def _scenery(drawing: svgwrite.Drawing, frames: Keyframes, scale: float, *, above: bool) -> None:
    for layer in frames.scenery:
        if layer.above == above:
            text = "".join(coarse(layer.tracks, scale))
            _add(drawing, layer.paint, layer.opacity, text, scale)


def _coarse_by_layer(shapes: Sequence[Shape], scale: float) -> dict[GridTrack, str]:
    """The path data of each track, those of a layer made simpler together."""
    layers: dict[str, dict[GridTrack, None]] = {}
    for shape in shapes:
        layers.setdefault(shape.slot.group.layer, {}).update(dict.fromkeys(shape.tracks))
    return {
        track: text
        for tracks in layers.values()
        for track, text in zip(tracks, coarse([*tracks], scale), strict=True)
    }


def _add(drawing: svgwrite.Drawing, paint: Paint, opacity: float, text: str, scale: float) -> None:
    if not text:
        return
    path = SvgPath("", text)
    del path.attribs["class"]
    attributes = paint_attributes(paint)
    if "stroke-width" in attributes:
        attributes["stroke-width"] = px(round(max(paint.width * scale, THINNEST), 2))
    path.attribs |= attributes
    if opacity < 1:
        path.attribs["opacity"] = px(opacity)
    drawing.add(path)


def coarse(tracks: Sequence[GridTrack], scale: float) -> list[str]:
    """The rings of each track at rest as path data in whole px, without what is not seen then.

    Lines that two of them share stay shared.
    """
    together, owner = drawn_at(tracks, 0.0)
    small = shapely.transform(together, lambda points: points * scale)
    plain = shapely.coverage_simplify(small, DETAIL) if len(small) else small
    texts = [""] * len(tracks)
    for number, polygon in zip(owner.tolist(), plain, strict=True):
        texts[number] = "".join(map(_ring, shapely.get_rings(polygon)))
    return texts


def _ring(ring: shapely.LinearRing) -> str:
    points = _needed(np.rint(shapely.get_coordinates(ring)[:-1]).astype(np.int64))
    if len(points) < 3:
        return ""
    way = " ".join(f"{x} {y}" for x, y in np.diff(points, axis=0).tolist()).replace(" -", "-")
    return f"M{points[0, 0]} {points[0, 1]}l{way}z"


def _needed(ring: NDArray[np.int64]) -> NDArray[np.int64]:
    """A ring without points that are the same as the next one, or lie on a line through."""
    ring = ring[(ring != np.roll(ring, -1, axis=0)).any(axis=1)]
    before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    turns: NDArray[np.bool_] = before[:, 0] * after[:, 1] != before[:, 1] * after[:, 0]
    return ring[turns]
