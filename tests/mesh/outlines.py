"""Outlines of many kinds, made and real, that meshes are tried on."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import shapely
from shapely.geometry import Polygon, box, shape

from benchmarks.shapes import rough_star
from tests.real_data import files

STATES = ("Florida", "Maine", "Michigan", "California", "Idaho", "Kentucky", "Maryland")
FIRE_DAYS = (0, 10)


def blob(edges: int, bays: float, lobes: int) -> Polygon:
    """A disc with as many bays as lobes, so deep a share of its radius."""
    angle = np.arange(edges) * 2 * np.pi / edges
    radius = 1 + bays * np.cos(lobes * angle)
    return Polygon(np.column_stack([np.cos(angle), np.sin(angle)]) * radius[:, None])


def star(tips: int, waist: float, edge: float) -> Polygon:
    """A star whose inner corners are so far out, its sides in edges of some length."""
    angle = np.arange(2 * tips) * np.pi / tips
    radius = np.where(np.arange(2 * tips) % 2, waist, 1)
    corners = np.column_stack([np.cos(angle), np.sin(angle)]) * radius[:, None]
    return shapely.segmentize(Polygon(corners), edge)


def comb(teeth: int, edge: float) -> Polygon:
    """A back with teeth, four times as long as they are wide."""
    back = box(0, 0, 2 * teeth - 1, 1)
    fingers = [box(2 * k, 0.5, 2 * k + 1, 5) for k in range(teeth)]
    return shapely.segmentize(shapely.union_all([back, *fingers]), edge)


def pierced() -> Polygon:
    """A plate with holes, some near each other and near the rim, finely and coarsely drawn."""
    holes = [
        shapely.Point(2, 2).buffer(1),
        shapely.Point(6, 3).buffer(1.5, quad_segs=4),
        shapely.Point(8.7, 1).buffer(0.3),
    ]
    return shapely.segmentize(box(0, 0, 10, 6), 0.5).difference(shapely.union_all(holes))


def rough(edges: int) -> Polygon:
    """A rough outline with edges of uneven lengths."""
    return Polygon(rough_star(edges, np.random.default_rng(edges)))


def made() -> dict[str, Polygon]:
    """Ten made outlines."""
    return {
        "blob, 3 lobes": blob(90, 0.4, 3),
        "blob, 7 lobes": blob(200, 0.35, 7),
        "large blob": blob(800, 0.3, 5),
        "comb": comb(5, 0.5),
        "fine comb": comb(7, 0.2),
        "star, 5 tips": star(5, 0.4, 0.1),
        "star, 9 tips": star(9, 0.6, 0.08),
        "plate with holes": pierced(),
        "rough outline": rough(150),
        "rough ring": rough(300).difference(shapely.Point(0, 0).buffer(30)),
    }


def real() -> dict[str, Polygon]:
    """Ten real outlines: states, a region, and a fire; none where they are not at hand."""
    if not files("us_regions"):
        return {}
    states, regions = (_largest(files("us_regions")[k], "name") for k in (3, 1))
    found = {name: states[name] for name in STATES} | {"Northeast": regions["Northeast"]}
    for day in FIRE_DAYS:
        found[f"fire, day {day + 1}"] = _largest(files("wildfire_creek2020")[day], "name")[
            "Creek Fire"
        ]
    return found


def _largest(path: Path, column: str) -> dict[object, Polygon]:
    """The largest part of each feature, by a column."""
    features = json.loads(path.read_text(encoding="utf-8"))["features"]
    return {
        feature["properties"][column]: max(
            shapely.get_parts([shape(feature["geometry"])]), key=shapely.area
        )
        for feature in features
    }
