"""What is too small to matter: dropped, filled, and never at the price of a gap."""

from __future__ import annotations

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import MultiPolygon, Polygon, box

from geotween.data.tidy.linework import Shapes
from geotween.data.tidy.small import drop_small
from tests.data.tidy.test_linework import DISC, PLATE, RANDOM, a_set
from tests.data.tidy.test_simplify import parts, same


def test_a_small_island_is_dropped_and_counted() -> None:
    specks = MultiPolygon([box(20, 0, 21, 1), box(30, 0, 32, 1)])
    (result,), counts, areas = drop_small([a_set(specks, PLATE)], 1.5)
    assert result[0].equals(box(30, 0, 32, 1))
    assert result[0].geom_type == "MultiPolygon"
    assert result[1] is PLATE
    assert (counts, areas) == ([1], [1.0])


def test_a_whole_small_polygon_becomes_empty() -> None:
    (result,), counts, areas = drop_small([a_set(box(20, 0, 21, 1), PLATE)], 1.5)
    assert result[0].equals(MultiPolygon())
    assert (counts, areas) == ([1], [1.0])


@pytest.mark.parametrize(
    "other",
    [box(1, 0, 9, 9), Polygon([(1, -3), (9, 0), (1, 3)])],
    ids=["vertex for vertex", "along a longer edge"],
)
def test_a_small_polygon_that_borders_on_another_stays(other: Polygon) -> None:
    sets = [a_set(box(0, 0, 1, 1), other)]
    result, counts, areas = drop_small(sets, 2)
    assert same(result, sets)
    assert (counts, areas) == ([0], [0.0])


def test_a_small_polygon_that_touches_another_at_a_point_is_dropped() -> None:
    (result,), counts, _ = drop_small([a_set(box(0, 0, 1, 1), box(1, 1, 9, 9))], 2)
    assert result[0].is_empty
    assert counts == [1]


def test_a_neighbour_in_another_set_does_not_hold_it() -> None:
    _, counts, _ = drop_small([a_set(box(0, 0, 1, 1)), a_set(box(1, 0, 9, 9))], 2)
    assert counts == [1, 0]


def test_a_small_hole_is_filled() -> None:
    ((plate,),), counts, areas = drop_small([a_set(PLATE)], 4)
    assert plate.equals(box(0, 0, 10, 10))
    assert (counts, areas) == ([0], [0.0])


def test_of_two_holes_the_large_one_stays() -> None:
    both = Polygon(PLATE.exterior, [DISC.exterior, box(1, 1, 3, 9).exterior])
    ((plate,),), _, _ = drop_small([a_set(MultiPolygon([both]))], 4)
    assert plate.equals(box(0, 0, 10, 10) - box(1, 1, 3, 9))


def test_a_small_hole_with_an_enclave_stays() -> None:
    sets = [a_set(PLATE, DISC)]
    assert same(drop_small(sets, 4)[0], sets)


def test_a_small_hole_goes_with_the_island_in_it() -> None:
    ((plate, island),), counts, _ = drop_small([a_set(PLATE, box(4.9, 4.9, 5.1, 5.1))], 4)
    assert plate.equals(box(0, 0, 10, 10))
    assert island.is_empty
    assert counts == [1]


@pytest.mark.parametrize("sets", [[], [a_set()], [a_set(MultiPolygon())]])
def test_nothing_to_drop(sets: list[Shapes]) -> None:
    result, counts, areas = drop_small(sets, 4)
    assert same(result, sets)
    assert (counts, areas) == ([0] * len(sets), [0.0] * len(sets))


@settings(max_examples=60, deadline=None)
@given(RANDOM, st.floats(0, 3))
def test_dropping_is_final_and_tears_no_gap(sets: list[Shapes], area: float) -> None:
    once, counts, areas = drop_small(sets, area)
    for before, after, count, lost in zip(sets, once, counts, areas, strict=True):
        assert shapely.is_valid(after).all()
        assert shapely.coverage_is_valid(after[~shapely.is_empty(after)])
        assert len(parts(before)) - len(parts(after)) == count
        filled = shapely.area(after).sum() - shapely.area(before).sum() + lost
        assert filled > -1e-9
        covered = shapely.union_all(after)
        missing = shapely.get_parts(shapely.union_all(before) - covered)
        assert (shapely.area(missing) <= area).all()
    again, more, _ = drop_small(once, area)
    assert same(again, once)
    assert not any(more)
