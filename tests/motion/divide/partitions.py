"""What every division promises, and correspondents that are hard to divide among."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest
import shapely
from shapely.geometry import MultiPolygon, Point, Polygon, box

import geotween
from tests.motion.shapes import star

SQUARE = box(0, 0, 8, 8)
COMB = Polygon([(0, 0), (9, 0), (9, 6), (8, 6), (8, 1), (5, 1), (5, 6), (4, 6), (4, 1), (0, 1)])
TECHNIQUES = ("territory", "voronoi", "advancing-front", "quadtree")

Shape = Polygon | MultiPolygon


def assert_partition(polygon: Polygon, pieces: Sequence[Shape], connected: bool = True) -> None:
    """Pieces tile their polygon, none is empty, and both sides of a seam have its vertices."""
    kind = Polygon if connected else (Polygon, MultiPolygon)
    assert all(isinstance(p, kind) and p.is_valid and p.area > 0 for p in pieces)
    assert sum(p.area for p in pieces) == pytest.approx(polygon.area, rel=1e-9)
    assert shapely.union_all(pieces).symmetric_difference(polygon).area <= 1e-9 * polygon.area
    # Of a coverage whose seams match to the bit, GEOS finds no edge that does not.
    parts = shapely.get_parts(np.array(pieces, dtype=object))
    assert shapely.coverage_is_valid(parts)


def areas(pieces: Sequence[Shape]) -> list[float]:
    return [piece.area for piece in pieces]


def wedges(count: int) -> list[Polygon]:
    """Triangles around (4, 4) that all share that vertex."""
    angles = np.linspace(0, 2 * np.pi, count + 1)
    rim = 4 + 10 * np.column_stack([np.cos(angles), np.sin(angles)])
    return [Polygon([(4, 4), rim[i], rim[i + 1]]) for i in range(count)]


def _needle() -> Polygon:
    return Polygon([(0, 0), (10, 1e-4), (10, 0)])


def _ring() -> Polygon:
    return Point(4, 4).buffer(4).difference(Point(4.5, 4).buffer(2))


# A polygon and its correspondents, by what is hard about them.
HARD: dict[str, Callable[[], tuple[Polygon, list[Polygon]]]] = {
    "touching": lambda: (SQUARE, [box(1, 1, 4, 7), box(4, 1, 7, 7)]),
    "coinciding": lambda: (SQUARE, [box(2, 2, 6, 6)] * 5),
    "outside": lambda: (SQUARE, [box(10 + 2 * i, 1, 11 + 2 * i, 2) for i in range(20)]),
    "one vertex in common": lambda: (SQUARE, wedges(12)),
    "one within another": lambda: (SQUARE, [box(1, 1, 7, 7), box(3, 3, 5, 5)]),
    "overlapping": lambda: (SQUARE, [box(0, 0, 5, 8), box(3, 0, 8, 8), box(2, 2, 6, 9)]),
    "a ring": lambda: (_ring(), [box(0, 3, 1, 5), box(7, 3, 8, 5), box(3, 7, 5, 8)]),
    "a comb": lambda: (COMB, [box(0, 4, 9, 7), box(0, -1, 9, 3.5)]),
    "a needle": lambda: (_needle(), [box(0, -1, 3, 1), box(3, -1, 6, 1), box(8, -1, 9, 1)]),
    "outlines that all but coincide": lambda: (
        SQUARE,
        [box(-1e-9, -1e-9, 4, 8), box(4 + 1e-10, 1e-11, 8 + 1e-9, 8)],
    ),
    "the polygon itself": lambda: (COMB, [COMB, COMB, box(0, 0, 1, 1)]),
    "200 of them": lambda: (
        star(300, seed=3, radius=10),
        [
            star(5, i, 0.4, *place)
            for i, place in enumerate(np.random.default_rng(4).uniform(-6, 6, (200, 2)))
        ],
    ),
}


def divided(polygon: Polygon, others: Sequence[Shape], technique: str) -> list[Shape]:
    return geotween.divide(polygon, others, technique)
