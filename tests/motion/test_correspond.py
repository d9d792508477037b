"""Correspondence: pairs of polygons that have to do with each other.

Pictures: AB are origin polygons on a line, CD target polygons below them. Techniques that go
beyond the paper's have their properties, and real sets, in test_correspond_beyond.py.
"""

from __future__ import annotations

import pytest
from shapely.geometry import Point, Polygon, box

from geotween.data.polygons import Feature, PolygonSet, polygon_set
from geotween.motion.correspond import LEAST_SHARE, SHARE, TECHNIQUES, correspond


def unkeyed(*polygons: Polygon) -> PolygonSet:
    return polygon_set(Feature(p) for p in polygons)


def keyed(**polygons: Polygon) -> PolygonSet:
    return polygon_set(Feature(p, key) for key, p in polygons.items())


def pairs(
    origin: PolygonSet,
    target: PolygonSet,
    technique: str = "intersects",
    radius: float | None = None,
) -> list[list[int]]:
    return correspond(origin, target, technique, radius).pairs.tolist()


def storm(x: float, y: float = 0.0, radius: float = 1.0) -> Polygon:
    return Point(x, y).buffer(radius)


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


@pytest.mark.parametrize("technique", TECHNIQUES)
def test_empty_sets_have_no_pairs(technique: str) -> None:
    empty, radius = unkeyed(), 1.0 if technique == "within" else None
    assert pairs(empty, empty, technique, radius) == []
    assert pairs(empty, unkeyed(box(0, 0, 1, 1)), technique, radius) == []
    assert pairs(unkeyed(box(0, 0, 1, 1)), empty, technique, radius) == []


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


def test_overlap_neighbours_that_only_touch_do_not_correspond() -> None:
    origin = unkeyed(box(0, 0, 1, 1))
    assert pairs(origin, unkeyed(box(1, 0, 2, 1), box(1, 1, 2, 2)), "overlap") == []


def test_overlap_a_nested_pair_corresponds_but_not_through_a_hole() -> None:
    large, small = box(0, 0, 99, 99), box(4, 4, 5, 5)
    ring = Polygon(large.exterior, [box(2, 2, 7, 7).exterior])
    assert pairs(unkeyed(large), unkeyed(small), "overlap") == [[0, 0]]
    assert pairs(unkeyed(ring), unkeyed(small), "overlap") == []


@pytest.mark.parametrize("technique", ["overlap", "auto"])
@pytest.mark.parametrize(
    ("share", "expected"),
    [(1.01 * SHARE, [[0, 0], [0, 1], [1, 1]]), (0.99 * SHARE, [[0, 0], [1, 1]])],
)
def test_overlap_ab_over_cd_with_a_reaching_into_d_by_a_share(
    technique: str, share: float, expected: list[list[int]]
) -> None:
    """A is long, D small: the share counts in the smaller one."""
    origin = unkeyed(box(0, 0, 9 + share, 1), box(9 + share, 0, 10, 1))
    target = unkeyed(box(0, 0, 9, 1), box(9, 0, 10, 1))
    assert pairs(origin, target, technique) == expected


@pytest.mark.parametrize(
    ("share", "expected"), [(1.01 * LEAST_SHARE, [[0, 0]]), (0.99 * LEAST_SHARE, [])]
)
def test_overlap_a_lonely_pair_keeps_a_small_overlap_but_not_a_sliver(
    share: float, expected: list[list[int]]
) -> None:
    origin, target = unkeyed(box(0, 0, 1, 1)), unkeyed(box(1 - share, 0, 2 - share, 1))
    assert pairs(origin, target, "overlap") == expected
    assert pairs(target, origin, "overlap") == expected


def test_overlap_a_lonely_b_keeps_the_best_of_two_small_overlaps() -> None:
    b, left, right = box(0, 0, 10, 1), box(-10, 0, 0.02, 1), box(9.95, 0, 20, 1)
    assert pairs(unkeyed(left, b, right), unkeyed(left, right), "overlap") == [
        [0, 0],
        [1, 1],
        [2, 1],
    ]


def test_overlap_c_and_d_that_only_overlap_b_a_little_both_keep_it() -> None:
    b, left, right = box(0, 0, 10, 1), box(-10, 0, 0.02, 1), box(9.95, 0, 20, 1)
    assert pairs(unkeyed(b), unkeyed(left, right), "overlap") == [[0, 0], [0, 1]]


def test_auto_goes_by_keys_that_live_on_wherever_they_lie() -> None:
    origin = keyed(a=box(0, 0, 1, 1), b=box(1, 0, 2, 1))
    target = keyed(b=box(0, 0, 1, 1), a=box(50, 0, 51, 1))
    assert pairs(origin, target, "auto") == [[0, 1], [1, 0]]


def test_auto_goes_by_overlap_where_no_key_lives_on() -> None:
    origin = keyed(nation=box(0, 0, 2, 1))
    target = keyed(west=box(0, 0, 1, 1), east=box(1, 0, 2, 1), island=box(2, 0, 3, 1))
    assert pairs(origin, target, "auto") == [[0, 0], [0, 1]]
    assert pairs(origin, target, "key") == []


def test_auto_a_country_that_leaves_another_comes_from_it() -> None:
    origin = keyed(sudan=box(0, 0, 2, 2), chad=box(-2, 0, 0, 2))
    target = keyed(chad=box(-2, 0, 0.5, 2), sudan=box(0.5, 1, 2, 2), south=box(0.5, 0, 2, 1))
    assert pairs(origin, target, "auto") == [[0, 1], [0, 2], [1, 0]]
    assert pairs(origin, target, "overlap") == [[0, 0], [0, 1], [0, 2], [1, 0]]


def test_auto_parts_of_one_key_correspond_by_overlap_not_by_touch() -> None:
    origin = polygon_set([Feature(box(0, 0, 1, 1), "a"), Feature(box(1, 0, 2, 1), "a")])
    assert pairs(origin, origin, "key") == [[0, 0], [0, 1], [1, 0], [1, 1]]
    assert pairs(origin, origin, "auto") == [[0, 0], [1, 1]]


def test_auto_what_has_no_key_goes_by_overlap_beside_what_has() -> None:
    origin = polygon_set([Feature(box(0, 0, 1, 1), "a"), Feature(box(5, 0, 6, 1))])
    target = polygon_set([Feature(box(5, 0, 6, 2)), Feature(box(9, 0, 10, 1), "a")])
    assert pairs(origin, target, "auto") == [[0, 1], [1, 0]]


def test_within_three_storms_that_move_one_radius() -> None:
    origin = unkeyed(storm(0), storm(10), storm(20))
    target = unkeyed(storm(14, 3), storm(24, 3), storm(4, 3))
    assert pairs(origin, target, "within", 4.0) == [[0, 2], [1, 0], [2, 1]]
    assert pairs(origin, target, "within", 2.0) == []


def test_within_three_storms_on_a_line_all_move_by_one_place() -> None:
    """The first could end where the last does, and the others stay: as long a way in sum."""
    origin, target = (
        unkeyed(storm(0), storm(10), storm(20)),
        unkeyed(storm(30), storm(20), storm(10)),
    )
    assert pairs(origin, target, "within", 99.0) == [[0, 2], [1, 1], [2, 0]]


def test_within_one_goes_to_one_although_two_are_in_reach() -> None:
    origin, target = unkeyed(storm(0), storm(5)), unkeyed(storm(1), storm(4))
    assert pairs(origin, target, "within", 5.0) == [[0, 0], [1, 1]]
    assert pairs(origin, target, "intersects") == [[0, 0], [1, 1]]


def test_within_a_takes_the_farther_one_so_that_b_has_any() -> None:
    """B reaches C only; A is nearer to C, but D is in its reach too."""
    origin, target = unkeyed(storm(0), storm(6)), unkeyed(storm(2.5), storm(-5))
    assert pairs(origin, target, "within", 3.5) == [[0, 1], [1, 0]]


def test_within_paths_cross_where_a_large_and_a_small_one_change_sides() -> None:
    origin = unkeyed(storm(0, 0, 3.0), storm(7, 0, 1.0))
    target = unkeyed(storm(2.5, 4, 1.0), storm(4.5, 4, 3.0))
    assert pairs(origin, target, "within", 9.0) == [[0, 1], [1, 0]]
    alike = unkeyed(storm(2.5, 4), storm(4.5, 4))
    assert pairs(unkeyed(storm(0), storm(7)), alike, "within", 9.0) == [[0, 0], [1, 1]]


def test_within_what_is_left_over_joins_what_it_overlaps_else_is_born() -> None:
    origin = unkeyed(storm(0))
    target = unkeyed(storm(0.2), storm(1.5), storm(4))
    assert pairs(origin, target, "within", 9.0) == [[0, 0], [0, 1]]
    assert pairs(target, origin, "within", 9.0) == [[0, 0], [1, 0]]


@pytest.mark.parametrize("distance", [2.0, 2.0 + 1e-12])
def test_within_a_radius_counts_between_outlines_and_to_rounding(distance: float) -> None:
    origin, target = unkeyed(box(0, 0, 9, 1)), unkeyed(box(9 + distance, 0, 20, 1))
    assert pairs(origin, target, "within", 2.0) == [[0, 0]]
    assert pairs(origin, target, "within", 1.99) == []


@pytest.mark.parametrize(
    ("technique", "radius", "words"),
    [
        ("near", None, "unknown correspondence 'near'; expected one of auto, intersects"),
        ("within", None, "within needs a radius"),
        ("overlap", 1.0, "overlap takes no radius"),
        ("within", -1.0, "not -1"),
        ("within", float("nan"), "not nan"),
        ("within", float("inf"), "not inf"),
    ],
)
def test_what_does_not_go_together_is_refused(
    technique: str, radius: float | None, words: str
) -> None:
    with pytest.raises(ValueError, match=words):
        correspond(unkeyed(), unkeyed(), technique, radius)
