"""Properties of the techniques beyond the paper's, and what they find in real sets."""

from __future__ import annotations

import json
from collections.abc import Callable
from itertools import pairwise, permutations
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from shapely.affinity import rotate, scale
from shapely.geometry import Point, Polygon, shape

from geotween.data.polygons import Feature, PolygonSet, polygon_set
from geotween.motion.correspond import LEAST_SHARE, SHARE, TECHNIQUES, correspond
from tests.motion.shapes import blobs, polygon_sets, seeds
from tests.real_data import files, needs_real_data

RADIUS = 1.5  # of polygons that lie in a square of 10
techniques = st.sampled_from(sorted(TECHNIQUES))


def some_keyed(polygons: list[Polygon]) -> PolygonSet:
    """Every third polygon has a key, which another set made so has too; every third its own."""
    keys = (lambda i: f"k{i}", lambda i: f"{len(polygons)} {i}", lambda i: None)
    return polygon_set(Feature(p, keys[i % 3](i)) for i, p in enumerate(polygons))


def related(
    origin: PolygonSet, target: PolygonSet, technique: str, unit: float = 1.0
) -> set[tuple[int, int]]:
    radius = RADIUS * unit if technique == "within" else None
    found = correspond(origin, target, technique, radius).pairs.tolist()
    assert found == sorted(found)
    assert len(found) == len(set(map(tuple, found)))
    return {(i, j) for i, j in found}


def reordered(polygons: PolygonSet, order: list[int]) -> PolygonSet:
    return PolygonSet(polygons.polygons[order], tuple(polygons.identities[i] for i in order))


def changed(polygons: PolygonSet, change: Callable[[Polygon], Polygon]) -> PolygonSet:
    shapes = np.empty(len(polygons), dtype=object)
    shapes[:] = [change(p) for p in polygons.polygons]
    return PolygonSet(shapely.orient_polygons(shapes), polygons.identities)


@given(polygon_sets, polygon_sets, techniques)
def test_time_run_backwards_turns_the_pairs_round(
    one: list[Polygon], other: list[Polygon], technique: str
) -> None:
    origin, target = some_keyed(one), some_keyed(other)
    back = related(target, origin, technique)
    assert related(origin, target, technique) == {(i, j) for j, i in back}


@given(polygon_sets, polygon_sets, techniques, st.data())
def test_the_order_of_polygons_does_not_matter(
    one: list[Polygon], other: list[Polygon], technique: str, data: st.DataObject
) -> None:
    origin, target = some_keyed(one), some_keyed(other)
    order = data.draw(st.permutations(range(len(origin))))
    other_order = data.draw(st.permutations(range(len(target))))
    found = related(reordered(origin, order), reordered(target, other_order), technique)
    assert related(origin, target, technique) == {(order[i], other_order[j]) for i, j in found}


# A touch is exact, and does not always outlive a change of units.
@given(
    polygon_sets,
    polygon_sets,
    st.sampled_from(["overlap", "auto", "within"]),
    st.sampled_from([1e-9, 1e9]),
)
def test_units_do_not_matter(
    one: list[Polygon], other: list[Polygon], technique: str, unit: float
) -> None:
    origin, target = some_keyed(one), some_keyed(other)
    here, there = (
        changed(s, lambda p: scale(p, unit, unit, origin=(0, 0))) for s in (origin, target)
    )
    assert related(origin, target, technique) == related(here, there, technique, unit)


@given(seeds, seeds, techniques, st.sampled_from([90, 180, 270, "reflected"]))
def test_quarter_turns_and_a_mirror_do_not_matter(
    seed: int, other: int, technique: str, turn: int | str
) -> None:
    def turned(polygon: Polygon) -> Polygon:
        if turn == "reflected":
            return scale(polygon, -1, 1, origin=(0, 0))
        return rotate(polygon, turn, origin=(0, 0))

    origin, target = some_keyed(blobs(6, seed)), some_keyed(blobs(6, other))
    here, there = changed(origin, turned), changed(target, turned)
    assert related(origin, target, technique) == related(here, there, technique)


@given(polygon_sets, polygon_sets)
def test_overlap_keeps_every_large_share_and_leaves_nobody_alone_who_has_one(
    one: list[Polygon], other: list[Polygon]
) -> None:
    origin, target = some_keyed(one), some_keyed(other)
    ones, others = origin.polygons[:, None], target.polygons[None, :]
    smaller = np.minimum(shapely.area(ones), shapely.area(others))
    shares = shapely.area(shapely.intersection(ones, others)) / smaller
    large, enough = shares >= SHARE, shares >= LEAST_SHARE
    found = np.zeros(shares.shape, dtype=bool)
    found[tuple(correspond(origin, target, "overlap").pairs.T)] = True
    lonely = ~large.any(axis=1, keepdims=True) | ~large.any(axis=0, keepdims=True)
    assert (found >= large).all()
    assert (found <= (large | (enough & lonely))).all()
    for axis in (0, 1):
        assert (found.any(axis) == enough.any(axis)).all()


@given(polygon_sets)
def test_a_set_that_does_not_change_corresponds_to_itself(polygons: list[Polygon]) -> None:
    same = some_keyed(polygons)
    for technique in ("overlap", "auto", "within"):
        assert related(same, same, technique) == {(i, i) for i in range(len(same))}


@given(st.integers(1, 6), seeds)
def test_storms_alike_go_the_ways_whose_squares_sum_to_the_least(count: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    here, there = rng.uniform(0, 10, (2, count, 2))
    found = correspond(storms(here), storms(there), "within", 20.0).pairs
    assert found[:, 0].tolist() == sorted(found[:, 1].tolist()) == list(range(count))

    def cost(order: tuple[int, ...]) -> float:
        return float(((here - there[list(order)]) ** 2).sum())

    best = min(permutations(range(count)), key=cost)
    assert cost(tuple(found[:, 1])) == pytest.approx(cost(best))


@given(st.integers(1, 40), st.integers(1, 40), seeds, st.floats(0.1, 5.0))
def test_as_many_storms_as_can_have_one_have_a_storm_of_their_own(
    count: int, others: int, seed: int, radius: float
) -> None:
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import maximum_bipartite_matching

    rng = np.random.default_rng(seed)
    here, there = rng.uniform(0, 20, (count, 2)), rng.uniform(0, 20, (others, 2))
    origin, target = storms(here, 1e-3), storms(there, 1e-3)  # so small that none meet
    found = correspond(origin, target, "within", radius).pairs
    assert len(set(found[:, 0])) == len(set(found[:, 1])) == len(found)
    reach = shapely.distance(origin.polygons[:, None], target.polygons[None, :]) <= radius
    assert reach[found[:, 0], found[:, 1]].all()
    assert len(found) == (maximum_bipartite_matching(csr_array(reach)) >= 0).sum()


lattice = st.permutations([(x, y) for x in range(3) for y in range(3)])


@given(lattice, lattice, st.integers(1, 9), st.integers(1, 9), st.data())
def test_ways_of_equal_cost_fall_by_place_not_by_order_or_direction(
    here: list[tuple[int, int]],
    there: list[tuple[int, int]],
    count: int,
    others: int,
    data: st.DataObject,
) -> None:
    def ways(
        places: list[tuple[int, int]], ends: list[tuple[int, int]]
    ) -> set[tuple[tuple[int, int], tuple[int, int]]]:
        related = correspond(storms(np.array(places)), storms(np.array(ends)), "within", 1.0)
        return {(places[i], ends[j]) for i, j in related.pairs}

    places, ends = here[:count], there[:others]
    found = ways(places, ends)
    order = data.draw(st.permutations(places)), data.draw(st.permutations(ends))
    assert ways(*order) == found
    assert {(one, other) for other, one in ways(ends, places)} == found


def storms(places: NDArray[np.float64], radius: float = 0.1) -> PolygonSet:
    return polygon_set(Feature(Point(p).buffer(radius)) for p in places)


def read(path: Path) -> PolygonSet:
    features = json.loads(path.read_text())["features"]
    return polygon_set(
        Feature(shape(f["geometry"]), name=f["properties"]["name"], attributes=f["properties"])
        for f in features
    )


@needs_real_data
@pytest.mark.parametrize(("step", "column"), [(0, None), (1, "region"), (2, "division")])
def test_states_correspond_to_the_divisions_that_the_census_puts_them_in(
    step: int, column: str | None
) -> None:
    steps = [read(path) for path in files("us_regions")]
    whole, parts = steps[step], steps[step + 1]
    for technique in ("overlap", "auto"):
        found = correspond(whole, parts, technique)
        assert [len(owners) for owners in found.of_target()] == [1] * len(parts)
        for i, j in found.pairs:
            said = parts.identities[j].attributes
            assert column is None or whole.identities[i].name == said[column]
    assert len(correspond(whole, parts, "intersects").pairs) >= len(parts)


@needs_real_data
def test_a_fire_that_changes_in_place_keeps_all_that_meets() -> None:
    steps = [read(path) for path in files("wildfire_creek2020")]
    for before, after in pairwise(steps):
        overlap = correspond(before, after, "overlap").pairs
        assert overlap.tolist() == correspond(before, after, "intersects").pairs.tolist()


@needs_real_data
def test_hawaii_s_islands_become_parts_of_michigan_one_to_one() -> None:
    hawaii, michigan = (read(path) for path in files("us_fig9_split")[1:])
    assert not len(correspond(hawaii, michigan, "overlap").pairs)
    found = correspond(hawaii, michigan, "within", 360.0).pairs
    assert found[:, 0].tolist() == list(range(len(hawaii)))
    assert len(set(found[:, 1])) == len(hawaii) < len(michigan)


@needs_real_data
def test_nested_wind_fields_of_a_hurricane_go_one_to_one_and_by_their_size() -> None:
    steps = [read(path) for path in files("hurricane_sandy_winds")]
    kept = []
    for before, after in pairwise(steps):
        found = correspond(before, after, "within", 1.0).pairs
        if len(before) == len(after):
            assert found[:, 0].tolist() == sorted(found[:, 1]) == list(range(len(before)))
            names = [(before.identities[i].name, after.identities[j].name) for i, j in found]
            kept.append(all(here == there for here, there in names))
    # Once two of three quadrants change so much that the fields of 50 and 64 kt look exchanged.
    assert len(kept) >= 20
    assert kept.count(False) <= 1
