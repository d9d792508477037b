"""Figures of the morph: a cloud that drifts and parts, and a point inside."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import shapely
from shapely.geometry import Polygon

from docs.draw.canvas import FAINT, INK, Box, Canvas, Floats
from geotween.data.polygons import Feature, PolygonSet, polygon_set
from geotween.motion.correspond import correspond
from geotween.motion.divide import divide
from geotween.motion.innermost import innermost
from geotween.motion.match import match
from geotween.motion.plan import plan_layers
from geotween.motion.techniques import resolve
from geotween.motion.tracks import frame

BEFORE, AFTER, ACCENT = "#7fb3d5", "#f2c57c", "#c0392b"
ALL: Box = (-2, -1, 41, 27)
CLOUD = [(0, 9), (3, 3), (10, 0), (18, 4), (21, 11), (17, 19), (9, 21), (2, 17)]
PARTS = (
    [(11, 16), (19, 13), (30, 16), (34, 22), (25, 26), (14, 25)],
    [(12, 3), (22, 0), (34, 1), (39, 6), (33, 10), (20, 9)],
)
BAY = [(0, 0), (20, 0), (20, 4), (6, 6), (6, 14), (22, 16), (22, 22), (2, 22)]


def cloud() -> str:
    """Who becomes whom, the cut, the ways, the frame half-way."""
    origin, target = _set(CLOUD), _set(*PARTS)
    titles = ("correspondence", "division", "matching", "t = 0.5")
    canvas = Canvas(ALL, titles, 210, ((BEFORE, "before"), (AFTER, "after")), "A morph in stages")
    for panel in range(3):
        for polygon in target.polygons:
            canvas.area(panel, polygon, AFTER, fill_opacity=0.7)
    related = correspond(origin, target, "auto")
    divided = divide(related)
    for polygon in origin.polygons:
        canvas.area(0, polygon, BEFORE, fill_opacity=0.7)
    for one, other in related.pairs.tolist():
        ends = [_inside(origin.polygons[one]), _inside(target.polygons[other])]
        canvas.lines(0, [np.array(ends)], INK, 1.2)
        canvas.dots(0, np.array(ends))
    for panel in (1, 2):
        for piece in divided.origin_pieces:
            canvas.area(panel, piece, BEFORE, fill_opacity=0.7, stroke=ACCENT, stroke_width=1)
    for piece in match(divided, resolve("morph").matching).pieces:
        canvas.lines(2, piece.vertices.transpose(1, 0, 2), FAINT, 0.7)
        canvas.dots(2, piece.vertices[0], radius=1.3)
    for track in plan_layers(origin, target, resolve("morph"))[0].tracks:
        canvas.area(3, frame([track], 0.5).polygons[0], BEFORE, stroke="#ffffff")
    return canvas.svg()


def inside() -> str:
    """The innermost point and how a polygon grows from it."""
    polygon = Polygon(BAY)
    titles = ("the centroid, and the innermost point", "born there: t = 0.3", "t = 0.6")
    canvas = Canvas((-2, -2, 26, 24), titles, 230, label="The innermost point of a polygon")
    canvas.area(0, polygon, BEFORE)
    place = innermost(np.array([polygon], dtype=object))[0]
    canvas.dots(0, shapely.get_coordinates(polygon.centroid), ACCENT, 3)
    canvas.dots(0, place[None], INK, 3)
    canvas.circle(0, place, polygon.exterior.distance(shapely.Point(place)), INK)
    tracks = plan_layers(_set(), _set(BAY), resolve("morph"))[0].tracks
    for panel, t in ((1, 0.3), (2, 0.6)):
        canvas.lines(panel, [polygon.exterior], FAINT, 0.8)
        canvas.area(panel, frame(tracks, t).polygons, BEFORE)
    return canvas.svg()


FIGURES: dict[str, Callable[[], str]] = {"morph": cloud, "innermost": inside}


def _set(*rings: list[tuple[int, int]]) -> PolygonSet:
    return polygon_set([Feature(Polygon(ring)) for ring in rings])


def _inside(polygon: Polygon) -> Floats:
    return np.asarray(shapely.get_coordinates(shapely.point_on_surface(polygon))[0])
