"""Correspondence: pairs of polygons that have to do with each other.

Pictures: AB are origin polygons on a line, CD target polygons below them.
"""

from __future__ import annotations

import pytest
from shapely.geometry import Polygon, box

from geotween.data.polygons import Feature, PolygonSet, polygon_set
from geotween.motion.correspond import correspond


def unkeyed(*polygons: Polygon) -> PolygonSet:
    return polygon_set(Feature(p) for p in polygons)


def keyed(**polygons: Polygon) -> PolygonSet:
    return polygon_set(Feature(p, key) for key, p in polygons.items())


def pairs(origin: PolygonSet, target: PolygonSet, technique: str = "intersects") -> list[list[int]]:
    return correspond(origin, target, technique).pairs.tolist()


def test_aa_over_cc_overlap_one_to_one() -> None:
    assert pairs(unkeyed(box(0, 0, 2, 1)), unkeyed(box(1, 0, 3, 1))) == [[0, 0]]


def test_ab_over_cd_with_a_over_both_is_a_double_list() -> None:
    origin = unkeyed(box(0, 0, 4, 1), box(5, 0, 9, 1))
    target = unkeyed(box(0, 0, 1, 1), box(3, 0, 6, 1))
    related = correspond(origin, target)
    assert related.pairs.tolist() == [[0, 0], [0, 1], [1, 1]]
    assert [list(c) for c in related.of_origin()] == [[0, 1], [1]]
    assert [list(c) for c in related.of_target()] == [[0], [0, 1]]


def test_neighbours_that_touch_at_an_edge_or_a_corner_correspond() -> None:
    origin = unkeyed(box(0, 0, 1, 1))
    assert pairs(origin, unkeyed(box(1, 0, 2, 1), box(1, 1, 2, 2))) == [[0, 0], [0, 1]]


def test_a_far_from_c_corresponds_to_nothing() -> None:
    related = correspond(unkeyed(box(0, 0, 1, 1)), unkeyed(box(5, 5, 6, 6)))
    assert related.pairs.shape == (0, 2)
    assert [len(c) for c in related.of_origin()] == [0]


def test_c_in_the_hole_of_a_does_not_correspond() -> None:
    ring = Polygon(box(0, 0, 9, 9).exterior, [box(2, 2, 7, 7).exterior])
    assert pairs(unkeyed(ring), unkeyed(box(4, 4, 5, 5))) == []


@pytest.mark.parametrize("technique", ["intersects", "key"])
def test_empty_sets_have_no_pairs(technique: str) -> None:
    empty = unkeyed()
    assert pairs(empty, unkeyed(box(0, 0, 1, 1)), technique) == []
    assert pairs(unkeyed(box(0, 0, 1, 1)), empty, technique) == []


def test_same_key_corresponds_wherever_it_lies() -> None:
    origin = keyed(a=box(0, 0, 1, 1), b=box(1, 0, 2, 1))
    target = keyed(b=box(0, 0, 1, 1), a=box(50, 0, 51, 1))
    assert pairs(origin, target, "key") == [[0, 1], [1, 0]]


def test_parts_of_one_key_correspond_where_they_meet() -> None:
    origin = polygon_set([Feature(box(0, 0, 1, 1), "a"), Feature(box(5, 0, 6, 1), "a")])
    target = polygon_set([Feature(box(5, 0, 6, 2), "a"), Feature(box(0, 0, 1, 2), "a")])
    assert pairs(origin, target, "key") == [[0, 1], [1, 0]]


def test_without_keys_key_means_intersects() -> None:
    origin = unkeyed(box(0, 0, 1, 1), box(5, 0, 6, 1))
    target = unkeyed(box(5, 0, 6, 2), box(0, 0, 1, 2))
    assert pairs(origin, target, "key") == [[0, 1], [1, 0]]
