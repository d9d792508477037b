"""Polygons for the tests of what comes in, and the ways to write them down."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any

from hypothesis import assume
from hypothesis import strategies as st
from shapely.affinity import scale
from shapely.geometry import MultiPoint, MultiPolygon, Polygon, mapping

from geotween.data.polygons import Feature
from geotween.data.read.parse import Parser
from geotween.scene.document import Location

Told = list[tuple[Location, str, str]]

PLACES = st.tuples(st.integers(-50, 50), st.integers(-50, 50))


@st.composite
def polygons(draw: st.DrawFn) -> Polygon:
    """A convex polygon with whole coordinates; now and then with a hole, half its size."""
    hull = MultiPoint(draw(st.lists(PLACES, min_size=3, max_size=8))).convex_hull
    assume(isinstance(hull, Polygon))
    hole = scale(hull, 0.5, 0.5).exterior
    return Polygon(hull.exterior, [hole.coords] if draw(st.booleans()) else [])


def as_rings(polygon: Polygon) -> list[Any]:
    """A list of rings, open as people write them, every number a text as YAML gives it."""
    rings = (polygon.exterior, *polygon.interiors)
    return [[[repr(x), repr(y)] for x, y in ring.coords[:-1]] for ring in rings]


def as_geojson(polygon: Polygon | MultiPolygon) -> dict[str, Any]:
    geometry: dict[str, Any] = json.loads(json.dumps(mapping(polygon)))
    return geometry


def parsed(value: Any) -> list[Feature]:
    """The features in a value that has no fault."""
    features, told, _ = parse(value)
    assert told == []
    return features


def parse(value: Any) -> tuple[list[Feature], Told, int]:
    """The features in a value, what is told of it, and how many have no area."""
    told: Told = []
    parser = Parser(lambda at, message, hint: told.append((at, message, hint)))
    return parser.features(value), told, parser.skipped


def rings(features: Iterable[Feature]) -> list[list[list[tuple[float, ...]]]]:
    """The coordinates of each polygon's rings, open."""
    found = []
    for feature in features:
        geometry = feature.geometry
        parts = geometry.geoms if isinstance(geometry, MultiPolygon) else [geometry]
        found += [[ring.coords[:-1] for ring in (part.exterior, *part.interiors)] for part in parts]
    return found
