"""The innermost point: the deepest, of several the one nearest to the centroid; it turns along."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from shapely.affinity import affine_transform
from shapely.geometry import Point, Polygon, box

from geotween.motion.innermost import innermost
from tests.motion.shapes import blobs, hulls, seeds, star

DISC = Point(0, 0).buffer(1)
MOON = DISC.difference(Point(0.4, 0).buffer(0.9))
ELL = Polygon([(0, 0), (9, 0), (9, 2), (2, 2), (2, 7), (0, 7)])
EM = Polygon([(0, 0), (6, 0), (6, 8), (3, 4), (0, 8)])
AITCH = Polygon(
    [(0, 0), (2, 0), (2, 3), (5, 3), (5, 0), (7, 0), (7, 8), (5, 8), (5, 5), (2, 5), (2, 8), (0, 8)]
)
FRAME = Polygon(box(0, 0, 8, 8).exterior, [box(2, 2, 6, 6).exterior])
PANE = Polygon(box(0, 0, 8, 8).exterior, [box(1, 1, 3, 3).exterior])

SHAPES = {
    "rectangle": box(0, 0, 10, 3), "trapezium": Polygon([(0, 0), (10, 0), (8, 3), (1, 3)]),
    "strip": box(0, 0, 1000, 1), "triangle": Polygon([(0, 0), (4, 0), (0, 3)]), "disc": DISC,
    "moon": MOON, "L": ELL, "M": EM, "H": AITCH, "frame": FRAME, "pane": PANE, "star": star(100, 1),
}  # fmt: skip

# Rows of x' = a x + b y + c, y' = d x + e y + f, in shapely's order a, b, d, e, c, f.
TURN = np.radians(33)
CHANGES = {
    "turned": [np.cos(TURN), -np.sin(TURN), np.sin(TURN), np.cos(TURN), 0, 0],
    "turned by 90 degrees": [0, -1, 1, 0, 0, 0],
    "reflected": [-1, 0, 0, 1, 0, 0],
    "a billion times as large": [1e9, 0, 0, 1e9, 0, 0],
    "a billionth as large": [1e-9, 0, 0, 1e-9, 0, 0],
    "moved": [1, 0, 0, 1, 3e4, -1e5],
}


def point_of(polygon: Polygon) -> NDArray[np.float64]:
    return np.asarray(innermost(np.array([polygon]))[0])


def depth_of(polygon: Polygon) -> float:
    point = Point(point_of(polygon))
    assert polygon.contains(point)
    return float(polygon.boundary.distance(point))


def test_of_a_rectangle_a_disc_and_a_hexagon_it_is_the_centre() -> None:
    hexagon = Point(3, 4).buffer(2, quad_segs=6)
    for polygon in (box(0, 0, 10, 3), DISC, hexagon):
        assert point_of(polygon) == pytest.approx(polygon.centroid.coords[0], abs=1e-12)


def test_of_a_triangle_it_is_the_centre_of_the_inscribed_circle() -> None:
    assert point_of(Polygon([(0, 0), (4, 0), (0, 3)])) == pytest.approx([1, 1])


def test_of_points_equally_deep_the_one_nearest_to_the_centroid() -> None:
    # All from (1.5, 1.5) to (8.5, 1.5) are as deep; the spike draws the centroid to the right.
    spiked = Polygon([(0, 0), (10, 0), (12, 0.2), (10, 0.4), (10, 3), (0, 3)])
    x, y = point_of(spiked)
    assert y == pytest.approx(1.5)
    assert x == pytest.approx(spiked.centroid.x)


def test_of_rooms_equally_wide_the_one_nearest_to_the_centroid() -> None:
    # Three squares in a row, joined by narrow doors; the last is larger by a tail.
    doors = [box(2, 0.9, 4, 1.1), box(6, 0.9, 8, 1.1), box(10, 0.9, 13, 1.1)]
    rooms = shapely.union_all([box(0, 0, 2, 2), box(4, 0, 6, 2), box(8, 0, 10, 2), *doors])
    assert isinstance(rooms, Polygon)
    x, _ = point_of(rooms)
    assert 4 < x < 6


def test_of_a_moon_it_lies_in_the_thick_of_it() -> None:
    assert not MOON.contains(MOON.centroid)
    assert point_of(MOON) == pytest.approx([-0.75, 0], abs=1e-2)


def test_of_an_l_it_lies_on_the_diagonal_of_the_corner() -> None:
    # Equally far from both outer edges and from the inner corner: r = (2 - r) √2.
    r = 2 * np.sqrt(2) / (1 + np.sqrt(2))
    assert point_of(ELL) == pytest.approx([r, r])


def test_of_a_ring_it_lies_half_way_across_the_band() -> None:
    ring = DISC.difference(Point(0, 0).buffer(0.5))
    assert np.hypot(*point_of(ring)) == pytest.approx(0.75, abs=0.01)


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
@pytest.mark.parametrize("polygon", SHAPES.values(), ids=SHAPES)
def test_what_is_done_to_the_polygon_is_done_to_the_point(
    polygon: Polygon, change: list[float]
) -> None:
    changed = shapely.orient_polygons(affine_transform(polygon, change))
    size = np.ptp(shapely.get_coordinates(changed), axis=0).max()
    there = affine_transform(Point(point_of(polygon)), change).coords[0]
    assert np.abs(point_of(changed) - there).max() <= 1e-9 * size


@pytest.mark.parametrize("make", [blobs, hulls])
@given(count=st.integers(1, 6), seed=seeds)
def test_no_point_that_geos_finds_is_deeper(
    make: Callable[[int, int], list[Polygon]], count: int, seed: int
) -> None:
    for polygon in make(count, seed):
        size = np.sqrt(polygon.area)
        circle = shapely.maximum_inscribed_circle(polygon, tolerance=1e-6 * size)
        assert depth_of(polygon) >= circle.length * (1 - 1e-3)


@given(st.integers(3, 40), seeds)
def test_a_rough_outline_turns_with_its_point(count: int, seed: int) -> None:
    polygon = star(count, seed)
    turned = affine_transform(polygon, CHANGES["turned"])
    there = affine_transform(Point(point_of(polygon)), CHANGES["turned"]).coords[0]
    assert np.abs(point_of(turned) - there).max() <= 1e-6


@given(seeds)
def test_many_at_once_are_as_one_by_one(seed: int) -> None:
    polygons = [*blobs(5, seed), box(0, 0, 3, 1), MOON]
    together = innermost(np.array(polygons))
    alone = np.array([point_of(polygon) for polygon in polygons])
    assert np.allclose(together, alone, atol=1e-12)


def test_of_none_there_is_none() -> None:
    assert innermost(np.empty(0, dtype=object)).shape == (0, 2)
