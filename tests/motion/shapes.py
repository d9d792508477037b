"""Seeded polygons and polygon sets for the motion's tests."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from hypothesis import strategies as st
from shapely.geometry import MultiPoint, Polygon, box

import geotween
from geotween.motion.morph import Shapes


def star(count: int, seed: int, radius: float = 1.0, x: float = 0.0, y: float = 0.0) -> Polygon:
    """A star-shaped outline with ``count`` vertices and a rough radius."""
    rng = np.random.default_rng(seed)
    angles = 2 * np.pi * (np.arange(count) + rng.uniform(0, 0.9, count)) / count
    reach = radius * rng.uniform(0.4, 1.0, count)
    return Polygon(np.column_stack([x + reach * np.cos(angles), y + reach * np.sin(angles)]))


def blobs(count: int, seed: int, holes: int = 2) -> list[Polygon]:
    """Disjoint polygons, some with holes: stars united, smaller ones taken out."""
    rng = np.random.default_rng(seed)
    places, sizes = rng.uniform(0, 10, (count + holes, 2)), rng.uniform(0.5, 3.5, count)
    area = shapely.union_all(
        [star(int(rng.integers(3, 25)), seed * 100 + i, sizes[i], *places[i]) for i in range(count)]
    )
    taken = [star(8, seed * 100 + 50 + i, 0.8, *places[count + i]) for i in range(holes)]
    left = shapely.get_parts(area.difference(shapely.union_all(taken)))
    return [p for p in left if p.area > 1e-6]


def tiles(count: int, seed: int) -> list[Polygon]:
    """A tiling of the square from 0 to 10 by Voronoi cells."""
    points = np.random.default_rng(seed).uniform(0, 10, (count, 2))
    square = box(0, 0, 10, 10)
    cells = shapely.get_parts(shapely.voronoi_polygons(MultiPoint(points), extend_to=square))
    return [p for p in shapely.intersection(cells, square) if p.area > 0]


def hulls(count: int, seed: int) -> list[Polygon]:
    """Disjoint polygons with whole coordinates: many are collinear, touch or coincide."""
    rng = np.random.default_rng(seed)
    taken, found = Polygon(), []
    for _ in range(count):
        hull = MultiPoint(rng.integers(0, 6, (5, 2)).astype(float)).convex_hull
        parts = shapely.get_parts(hull.difference(taken))
        found += [p for p in parts if isinstance(p, Polygon) and p.area > 1e-9]
        taken = taken.union(hull)
    return found


seeds = st.integers(0, 10_000)
polygon_sets = st.one_of(
    st.builds(blobs, st.integers(1, 7), seeds, st.integers(0, 4)),
    st.builds(tiles, st.integers(1, 8), seeds),
    st.builds(hulls, st.integers(1, 6), seeds),
)


def travelled(origin: Shapes, target: Shapes, **options: Any) -> geotween.Morph:
    """The motion by rotation and straight lines, with no other way tried; options go first."""
    return geotween.morph(origin, target, "morph", **{"matching": "rotation", **options})
