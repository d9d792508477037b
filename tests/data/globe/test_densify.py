from __future__ import annotations

import numpy as np
import pytest
import shapely
from shapely.geometry import Polygon, box

from geotween.data.globe.densify import BEND, placed


def drawn(polygon, place):
    (found,) = placed(np.array([polygon]), place, from_globe=False)
    return found


def parabola(points):
    return np.column_stack([points[:, 0], points[:, 1] + points[:, 0] ** 2])


def cubic(points):
    return np.column_stack([points[:, 0], points[:, 1] + points[:, 0] ** 3])


def test_straight_edges_gain_no_points():
    square = box(0, 0, 1, 1)
    found = drawn(square, lambda points: points @ [[2.0, 1.0], [0.0, 3.0]] + 5)
    assert shapely.get_num_coordinates(found) == 5


@pytest.mark.parametrize(("bend", "low"), [(parabola, 0.0), (cubic, -1.0)], ids=["C", "S"])
def test_a_bent_edge_is_followed_to_within_the_tolerance(bend, low):
    found = drawn(Polygon([(-1, 0), (1, 0), (1, 3), (-1, 3)]), bend)
    x = np.linspace(-1, 1, 2001)
    curve = bend(np.column_stack([x, np.zeros(2001)]))
    distances = shapely.distance(found.exterior, shapely.points(curve))
    size = np.ptp(shapely.get_coordinates(found), axis=0).max()
    assert found.bounds[1] == pytest.approx(low)
    assert distances.max() < 1.5 * BEND * size
    assert shapely.get_num_coordinates(found) < 400


def test_an_edge_around_a_circle_that_ends_where_it_began_is_seen_to_bend():
    def around(points):
        angle = np.radians(points[:, 0])
        return np.column_stack([np.cos(angle), np.sin(angle)]) * points[:, 1:]

    found = drawn(Polygon([(0, 1), (360, 1), (360, 2), (0, 2)]), around)
    assert Polygon(found.exterior).bounds == pytest.approx((-2, -2, 2, 2), abs=1e-3)


def test_both_sides_of_a_shared_edge_get_the_same_points():
    rng = np.random.default_rng(5)
    lefts = [Polygon([(0.1, 0), (1.2, 1), *rng.random((1, 2)) - [2, 0]]) for _ in range(5)]
    right = Polygon([(1.2, 1), (0.1, 0), (2.3, -0.4)])
    for left in lefts:
        pair = placed(np.array([left, right]), cubic, from_globe=False)
        a, b = ({tuple(p) for p in shapely.get_coordinates(polygon)} for polygon in pair)
        assert len(a & b) > 2
        assert shapely.coverage_is_valid(pair)


@pytest.mark.parametrize("scale", [1e9, 1e-9])
def test_the_unit_of_the_map_does_not_matter(scale):
    square = box(-1, 0, 1, 1)
    found = drawn(square, lambda points: cubic(points) * scale)
    assert shapely.get_num_coordinates(found) == shapely.get_num_coordinates(drawn(square, cubic))


def test_holes_stay_holes():
    frame = box(0, 0, 3, 3).difference(box(1, 1, 2, 2))
    found = drawn(frame, parabola)
    assert len(found.interiors) == 1
    assert found.area == pytest.approx(8, rel=1e-3)


def test_edges_to_nowhere_do_not_keep_it_busy():
    def half(points):
        return np.where(points[:, :1] > 0.3, np.inf, points)

    found = drawn(box(0, 0, 1, 1), half)
    assert shapely.get_num_coordinates(found) < 100


def test_no_polygons():
    assert len(placed(np.empty(0, dtype=object), parabola, from_globe=False)) == 0
