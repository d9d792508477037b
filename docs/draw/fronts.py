"""Figures of the front motion: one small border war, step by step."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache

import numpy as np
import shapely
from shapely.geometry import MultiPolygon, Polygon

from docs.draw.canvas import FAINT, INK, Box, Canvas, Floats, mixed
from geotween.data.polygons import Feature, Identity, PolygonSet, polygon_set
from geotween.motion.front.changes import changes
from geotween.motion.front.field import TECHNIQUES, Field, arrival
from geotween.motion.front.fronts import Fronts, front
from geotween.motion.front.plane import NEUTRAL, NOTHING, SINK, SOURCE, Change
from geotween.motion.tracks import Track

Step = dict[str, Polygon | MultiPolygon]

# The coast, the borders between the three countries, and what A, C and D get.
COAST_A = [(44, 63), (34, 62), (12, 54), (4, 34), (5, 26)]
COAST_B = [(60, 64), (80, 56), (86, 40), (85, 24)]
COAST_C = [(5, 26), (6, 14), (20, 6), (48, 4), (74, 8), (84, 18), (85, 24)]
MIDDLE = (44, 26)
A_TO_C, B_TO_C = [(20, 25), (32, 22)], [(70, 25), (58, 22)]
OLD, NEW = [(42, 34), (46, 42), (41, 52)], [(54, 35), (62, 44), (58, 54)]
ENCLAVE = [(68, 40), (72, 47), (78, 46), (79, 39), (73, 36)]
SPOT = [(88, 10), (93, 6), (97, 11), (94, 16), (89, 15)]

COLOURS = {"A": "#7fb3d5", "B": "#f2c57c", "C": "#a9cf9b", "D": "#d7a3c4"}
SEA = "#eef3f6"
GREEN, RED, GREY = "#0b8a4b", "#c0392b", "#8a8a8a"
ALL: Box = (0, 0, 100, 68)
NEAR: Box = (36, 22, 68, 67)
RESOLUTION = 0.15  # half a pixel at the size of these figures


@cache
def steps() -> tuple[PolygonSet, PolygonSet]:
    """A, B and C before and after: A takes a strip of B, C an enclave, and D appears."""
    c = Polygon([*COAST_C, *B_TO_C, MIDDLE, *A_TO_C[::-1]])
    before: Step = {
        "A": Polygon([*COAST_A, *A_TO_C, MIDDLE, *OLD]),
        "B": Polygon([COAST_A[0], *COAST_B, *B_TO_C, MIDDLE, *OLD]),
        "C": c,
    }
    after: Step = {
        "A": Polygon([COAST_B[0], *COAST_A, *A_TO_C, MIDDLE, *NEW]),
        "B": Polygon([*COAST_B, *B_TO_C, MIDDLE, *NEW], [ENCLAVE]),
        "C": MultiPolygon([c, Polygon(ENCLAVE)]),
        "D": Polygon(SPOT),
    }
    origin, target = (
        polygon_set([Feature(shape, key) for key, shape in step.items()])
        for step in (before, after)
    )
    return origin, target


@cache
def change() -> Change:
    return changes(*steps())


@cache
def fronts() -> Fronts:
    return front(*steps(), "regions", RESOLUTION)


def two_steps() -> str:
    canvas = Canvas(ALL, ("before: t = 0", "after: t = 1"), 300, label="Both steps", ground=SEA)
    for panel, step in enumerate(steps()):
        for identity, polygon in zip(step.identities, step.polygons, strict=True):
            canvas.area(panel, polygon, COLOURS[_key(identity)], stroke="#ffffff")
            canvas.words(panel, _key(identity), _middle(polygon))
    return canvas.svg()


def cells() -> str:
    canvas = Canvas(ALL, ("cells: the owner before, the owner after",), 460, label="Cells")
    things = change().things
    for face, before, after in zip(
        change().plane.faces, change().before.tolist(), change().after.tolist(), strict=True
    ):
        ends = (
            "" if before == NOTHING else _key(things[before].origin),
            "" if after == NOTHING else _key(things[after].target),
        )
        colours = [COLOURS.get(key, SEA) for key in ends]
        canvas.area(0, face, mixed(colours[0], colours[1], 0.5), stroke=INK)
        canvas.words(0, " ".join(key or "–" for key in ends), _middle(face))
    return canvas.svg()


def regions() -> str:
    legend = ((GREEN, "source"), (RED, "sink"), (GREY, "neutral"))
    title = ("regions of change, and their sides",)
    canvas = Canvas(ALL, title, 460, legend, "Regions of change", SEA)
    _land(canvas, 0)
    plane = change().plane
    for face in plane.faces[change().region != NOTHING]:
        canvas.area(0, face, "#ffe9a8")
    for role, colour in ((NEUTRAL, GREY), (SOURCE, GREEN), (SINK, RED)):
        edges = plane.edges[(change().roles == role).any(axis=1)]
        canvas.lines(0, plane.points[edges], colour, 3)
    return canvas.svg()


def field() -> str:
    found = arrival(change())
    titles = ("the mesh of the region", "level sets, each a tenth later")
    canvas = Canvas(NEAR, titles, 240, ((GREEN, "source"), (RED, "sink")), "The field", SEA)
    for panel in range(2):
        _land(canvas, panel)
    corners = found.points[found.triangles]
    canvas.lines(0, _near(np.concatenate([corners, corners[:, :1]], axis=1)), FAINT, 0.5)
    _level_sets(canvas, 1, found)
    for panel in range(2):
        _sides(canvas, panel)
    return canvas.svg()


def techniques() -> str:
    titles = ("ratio of distances", "harmonic")
    canvas = Canvas(NEAR, titles, 240, label="Level sets of both techniques", ground=SEA)
    for panel, technique in enumerate(TECHNIQUES):
        _land(canvas, panel)
        _level_sets(canvas, panel, arrival(change(), technique=technique))
        _sides(canvas, panel)
    return canvas.svg()


def bands() -> str:
    arrivals = fronts().arrivals
    titles = ("bands, the later the paler", "the ways of the vertices")
    canvas = Canvas(NEAR, titles, 240, label="Bands and the ways of vertices", ground=SEA)
    corners = arrivals.points[arrivals.triangles]
    for panel in range(2):
        _land(canvas, panel)
    for places, times in zip(corners, arrivals.times, strict=True):
        colour = mixed(COLOURS["A"], "#ffffff", float(times.mean()))
        canvas.area(0, Polygon(places), colour, stroke="#ffffff", stroke_width=0.3)
    for track in fronts().tracks:
        if _key(track.identity) == "A":
            moving = (track.vertices[0] != track.vertices[-1]).any(axis=1)
            ways = track.vertices[[0, -1]][:, moving].transpose(1, 0, 2)
            canvas.lines(1, ways, INK, 0.6)
            canvas.dots(1, ways[:, 0], INK, 1)
    for panel in range(2):
        _sides(canvas, panel)
    return canvas.svg()


def moments() -> str:
    times = (0.25, 0.5, 0.75)
    canvas = Canvas(
        ALL, [f"t = {t}" for t in times], 220, label="The map at three moments", ground=SEA
    )
    for panel, t in enumerate(times):
        for track in fronts().tracks:
            if track.is_there(t):
                one, other = (COLOURS[_key(identity)] for identity in track.ends)
                canvas.area(panel, _polygon(track, t), mixed(one, other, t), stroke="#ffffff")
    return canvas.svg()


FIGURES: dict[str, Callable[[], str]] = {
    "front-steps": two_steps,
    "front-cells": cells,
    "front-regions": regions,
    "front-field": field,
    "front-techniques": techniques,
    "front-bands": bands,
    "front-moments": moments,
}


def _key(identity: Identity | None) -> str:
    return "" if identity is None else str(identity.key)


def _middle(polygon: Polygon) -> tuple[float, float]:
    place = shapely.point_on_surface(polygon)
    return place.x, place.y


def _polygon(track: Track, t: float) -> Polygon:
    rings = np.split(track.at(t), track.offsets[1:-1])
    return Polygon(rings[0], rings[1:])


def _land(canvas: Canvas, panel: int) -> None:
    """What does not change, paler."""
    still = change().region == NOTHING
    for face, thing in zip(change().plane.faces[still], change().before[still], strict=True):
        colour = COLOURS[_key(change().things[thing].origin)]
        canvas.area(panel, face, mixed(colour, "#ffffff", 0.6), stroke="#ffffff")


def _near(lines: Floats) -> Floats:
    """The lines (k, n, 2) that lie in the part of the map that is drawn larger."""
    low, high = np.array(NEAR[:2]), np.array(NEAR[2:])
    return lines[((lines >= low) & (lines <= high)).all(axis=(1, 2))]


def _sides(canvas: Canvas, panel: int) -> None:
    plane = change().plane
    for role, colour in ((SOURCE, GREEN), (SINK, RED)):
        edges = plane.edges[(change().roles == role).any(axis=1)]
        canvas.lines(panel, _near(plane.points[edges]), colour, 2.5)


def _level_sets(canvas: Canvas, panel: int, found: Field) -> None:
    canvas.lines(panel, _near(np.concatenate(list(_sections(found)))), INK, 0.8)


def _sections(found: Field) -> Iterator[Floats]:
    """The sections (k, 2, 2) of triangles with levels; at a pivot every level ends."""
    corners = found.points[found.triangles]
    for level in np.arange(1, 10) / 10:
        ends = []
        for k in range(3):
            here, there = found.times[:, k], found.times[:, (k + 1) % 3]
            share = (level - here) / np.where(there == here, np.nan, there - here)
            place = corners[:, k] + share[:, None] * (corners[:, (k + 1) % 3] - corners[:, k])
            place[~((share > 0) & (share <= 1))] = np.nan
            ends.append(place)
            pivot = corners[:, k].copy()
            pivot[~np.isnan(here)] = np.nan
            ends.append(pivot)
        places = np.stack(ends, axis=1)
        there = ~np.isnan(places[..., 0])
        crossed = there.sum(axis=1) == 2
        yield places[crossed][there[crossed]].reshape(-1, 2, 2)
