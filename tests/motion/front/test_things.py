"""Who is who at both ends: by key, by class or by place."""

from __future__ import annotations

import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely.geometry import Polygon, box

from geotween.data.polygons import Feature, PolygonSet, polygon_set
from geotween.motion.front.changes import changes
from geotween.motion.front.plane import SINK
from tests.motion.front.test_changes import (
    Step,
    assert_reached,
    keyed,
    names,
    sides,
    story,
    strip,
    unkeyed,
)
from tests.motion.shapes import tiles


def test_slivers_between_borders_drawn_twice_are_swept_and_no_things() -> None:
    counties = [(f"{x}{y}", box(x, y, x + 1, y + 1)) for x in range(4) for y in range(3)]
    wave = [(2 + (-1) ** k * 4e-3, k / 4) for k in range(13)]
    west = Polygon([(0, 3), (0, 0), *wave])
    east = Polygon([(4, 0), (4, 3), *wave[::-1]])
    change = changes(keyed(counties), keyed([("west", west), ("east", east)]))
    assert len(change.things) == 12
    assert all((x < "2") == (side == "west") for (x, *_), side in names(change))
    assert change.region.max() > 10
    assert_reached(change)


def test_an_unkeyed_fire_that_splits_stays_one_thing() -> None:
    change = changes(unkeyed(box(0, 0, 9, 3)), unkeyed(box(0, 0, 3, 3), box(5, 0, 9, 3)))
    assert len(change.things) == 1
    assert change.region.max() == 0
    assert len(sides(change, SINK)) == 2


def test_unkeyed_spots_that_do_not_meet_are_things_of_their_own() -> None:
    origin = unkeyed(box(0, 0, 1, 1), box(5, 5, 6, 6), box(9, 9, 10, 10))
    change = changes(origin, unkeyed(box(5, 5, 7, 7), box(0, 0, 2, 2)))
    assert sorted(names(change), key=str) == [(0, 1), (1, 0), (2, None)]


def test_unkeyed_tiles_keep_their_borders() -> None:
    origin, target = (
        unkeyed(box(0, 0, x, 2), box(x, 0, 4, 2), box(4, 0, 6, 2)) for x in (2.0, 2.5)
    )
    change = changes(origin, target)
    assert names(change) == [(0, 0), (1, 1), (2, 2)]
    assert story(change)[(1, 1), (0, 0)] == 1


def test_without_keys_a_class_is_what_places_change() -> None:
    def classes(step: Step) -> PolygonSet:
        return polygon_set(Feature(polygon, class_=class_) for class_, polygon in step)

    change = changes(classes(strip("aab")), classes(strip("abb")))
    assert [(t.origin and t.origin.class_) for t in change.things] == ["a", "b"]
    assert change.region.max() == 0


def test_a_thing_is_known_by_its_largest_polygon() -> None:
    parts = [Feature(box(0, 0, 1, 1), name="isle"), Feature(box(2, 0, 9, 1), name="main")]
    change = changes(polygon_set(parts), unkeyed(box(0, 0, 9, 1)))
    assert [thing.origin.name for thing in change.things if thing.origin] == ["main"]


def test_a_share_of_a_hundredth_makes_a_thing_and_less_does_not() -> None:
    #  a a b b  ->  c c d d    where c reaches into b's cells by more and more
    for reach, wanted in ((0.03, True), (0.01, False)):
        target = [("c", box(0, 0, 2 + reach, 1)), ("d", box(2 + reach, 0, 4, 1))]
        found = names(changes(keyed(strip("aabb")), keyed(target)))
        assert (("b", "c") in found) == wanted
        assert {("a", "c"), ("b", "d")} <= set(found)


def test_what_overlaps_only_a_little_and_only_once_is_still_that() -> None:
    origin, target = [("a", box(0, 0, 1, 1))], [("b", box(0.995, 0, 2, 1))]
    assert names(changes(keyed(origin), keyed(target))) == [("a", "b")]
    far = [("b", box(0.9995, 0, 2, 1))]
    found = changes(keyed(origin), keyed(far))
    assert {(None, "b"), ("a", None)} <= set(names(found))


def test_keys_and_polygons_without_keys_in_one_set_do_not_mix() -> None:
    origin = polygon_set([Feature(box(0, 0, 1, 1), key="a"), Feature(box(2, 0, 3, 1))])
    target = polygon_set([Feature(box(2, 0, 4, 1)), Feature(box(0, 0, 1, 1), key="a")])
    assert names(changes(origin, target)) == [("a", "a"), (1, 0)]


@given(st.integers(0, 10_000), st.integers(1, 9))
def test_unkeyed_tiles_that_rest_are_the_same_whatever_their_order(seed: int, count: int) -> None:
    polygons = tiles(count, seed)
    change = changes(unkeyed(*polygons), unkeyed(*polygons[::-1]))
    assert set(names(change)) == {(k, count - 1 - k) for k in range(count)}
    assert change.region.max() == -1


@given(st.integers(0, 10_000), st.integers(0, 10_000))
def test_unkeyed_tilings_are_drawn_whole_at_both_ends(one: int, other: int) -> None:
    origin, target = tiles(7, one), tiles(5, other)
    change = changes(unkeyed(*origin), unkeyed(*target))
    for end, polygons in enumerate((origin, target)):
        found = dict.fromkeys(range(len(polygons)), 0.0)
        for pair, area in story(change).items():
            thing = pair[end]
            if thing is not None:
                found[int(str(thing[end]))] += area
        assert shapely.area(polygons).tolist() == [pytest.approx(a) for a in found.values()]
