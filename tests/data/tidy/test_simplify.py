"""Simplification: what it promises, on pictures, on random tilings and islands, on real sets."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Callable, Sequence

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from shapely.affinity import scale, translate
from shapely.geometry import MultiPolygon, Polygon, box

from geotween.data.tidy.linework import Shapes
from geotween.data.tidy.simplify import simplify
from tests.data.tidy.test_linework import DIAMOND, DISC, PLATE, RANDOM, a_set, merged
from tests.real_data import files, needs_real_data

Points = NDArray[np.float64]
Change = Callable[[Points], Points]

TURNS: dict[str, Change] = {
    "quarter turn": lambda p: np.stack([-p[:, 1], p[:, 0]], axis=1),
    "half turn": lambda p: -p,
    "reflected": lambda p: p * [-1, 1],
    "turned over": lambda p: p[:, ::-1],
}
SCALES: dict[str, float] = {"large": 1e9, "small": 1e-9}


# What is promised


def check(sets: Sequence[Shapes], tolerance: float) -> list[Shapes]:
    """Simplify and look at every promise."""
    result = simplify(sets, tolerance)
    assert [len(s) for s in result] == [len(s) for s in sets]
    for before, after in zip(sets, result, strict=True):
        assert shapely.is_valid(after).all()
        if shapely.coverage_is_valid(before):
            assert shapely.coverage_is_valid(after)
    before, after = np.concatenate(sets), np.concatenate(result)
    assert (shapely.get_type_id(before) == shapely.get_type_id(after)).all()
    assert shape_of(before) == shape_of(after)
    one, other = shapely.get_rings(parts(before)), shapely.get_rings(parts(after))
    strays = shapely.hausdorff_distance(one, other, densify=0.25)
    assert (strays <= tolerance * (1 + 1e-9)).all()
    shared_stay_shared(before, after)
    return result


def parts(shapes: Shapes) -> Shapes:
    return shapely.get_parts(shapes)


def shape_of(shapes: Shapes) -> list[list[int]]:
    """How many holes the parts of each shape have."""
    return [shapely.get_num_interior_rings(shapely.get_parts(shape)).tolist() for shape in shapes]


def points_of(ring: Polygon) -> list[tuple[float, float]]:
    return [(x, y) for x, y in ring.coords[:-1]]


def edges(shapes: Shapes) -> set[frozenset[tuple[float, float]]]:
    found = set()
    for ring in shapely.get_rings(parts(shapes)):
        path = points_of(ring)
        found |= {frozenset(edge) for edge in zip(path, path[1:] + path[:1], strict=True)}
    return found


def shared_stay_shared(before: Shapes, after: Shapes) -> None:
    """A vertex stays in all its rings or in none, and where borders part or meet it stays."""
    neighbours = defaultdict(set)
    for edge in edges(before):
        for point in edge:
            neighbours[point] |= edge - {point}
    dropped, stayed = set(), set()
    one, other = shapely.get_rings(parts(before)), shapely.get_rings(parts(after))
    for was, became in zip(one, other, strict=True):
        old, new = points_of(was), points_of(became)
        kept = set(new)
        assert sequence(new) == sequence([point for point in old if point in kept])
        stayed |= kept
        dropped |= set(old) - kept
    assert not dropped & stayed
    assert all(len(neighbours[point]) == 2 for point in dropped)


def sequence(ring: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """A ring from its smallest vertex on."""
    first = ring.index(min(ring))
    return ring[first:] + ring[:first]


def same(one: Sequence[Shapes], other: Sequence[Shapes]) -> bool:
    return all(
        shapely.equals_identical(shapely.normalize(a), shapely.normalize(b)).all()
        for a, b in zip(one, other, strict=True)
    )


# Pictures


def wavy(n: int, height: float, first: tuple[float, float], last: tuple[float, float]) -> Points:
    """A line that swings to both sides of the straight one, none of its heights the same."""
    share = np.linspace(0, 1, n)
    along = np.subtract(last, first)
    swing = np.sin(share * np.pi) * height * np.cos(np.arange(n) * 2.1)
    across = np.array([-along[1], along[0]]) / np.hypot(*along)
    return np.asarray(first) + share[:, None] * along + swing[:, None] * across


BORDER = wavy(21, 0.1, (5, 0), (5, 10))
WEST = Polygon([(0, 10), (0, 0), *BORDER])
EAST = Polygon([*BORDER, (10, 10), (10, 0)])


def test_tolerance_zero_gives_the_sets_back() -> None:
    assert same(simplify([a_set(PLATE, DISC)], 0), [a_set(PLATE, DISC)])


@pytest.mark.parametrize("tolerance", [-1, np.nan, np.inf])
def test_tolerance_that_is_none_is_refused(tolerance: float) -> None:
    with pytest.raises(ValueError, match="tolerance must be finite"):
        simplify([a_set(DISC)], tolerance)


@pytest.mark.parametrize("sets", [[], [a_set()], [a_set(MultiPolygon()), a_set(), a_set(DISC)]])
def test_empty_sets_stay_empty(sets: list[Shapes]) -> None:
    result = simplify(sets, 0.2)
    assert [len(s) for s in result] == [len(s) for s in sets]
    assert [g.is_empty for s in result for g in s] == [g.is_empty for s in sets for g in s]


def test_a_wavy_border_becomes_straight_on_both_sides_and_in_both_steps() -> None:
    (west, east), (again,) = check([a_set(WEST, EAST), a_set(WEST)], 0.11)
    assert len(west.exterior.coords) == len(east.exterior.coords) == 5
    assert again == west


def test_a_border_that_wavers_more_than_the_tolerance_keeps_vertices() -> None:
    ((west, _),) = check([a_set(WEST, EAST)], 0.05)
    assert 5 < len(west.exterior.coords) < len(WEST.exterior.coords)


def test_what_does_not_change_is_the_very_same() -> None:
    square = box(0, 0, 1, 1)
    ((result, _),) = check([a_set(square, WEST)], 0.2)
    assert list(result.exterior.coords) == list(square.exterior.coords)


def test_islands_smaller_than_the_tolerance_survive() -> None:
    specks = [translate(scale(DISC, 0.01, 0.01), k) for k in range(4)]
    (result,) = check([a_set(*specks[:2], MultiPolygon(specks[2:]))], 3)
    assert shapely.get_num_coordinates(parts(result)).max() < 9


def test_holes_smaller_than_the_tolerance_survive() -> None:
    ((plate,),) = check([a_set(PLATE)], 3)
    assert len(plate.interiors) == 1


def test_an_enclave_stays_in_its_hole() -> None:
    ((plate, disc),) = check([a_set(PLATE, DISC)], 0.5)
    assert 3 < len(disc.exterior.coords) < len(DISC.exterior.coords)
    assert disc.equals(Polygon(plate.interiors[0]))


def test_a_lens_between_two_nodes_does_not_collapse() -> None:
    line, apart = wavy(9, 0.01, (0, 0), (9, 0)), np.array([0, 0.02])
    low, high = line - apart, line + apart
    low[[0, -1]] = high[[0, -1]] = [(0, 0), (9, 0)]
    south = Polygon([*low, (9, -5), (0, -5)])
    north = Polygon([*high, (9, 5), (0, 5)])
    lens = Polygon([*low, *high[-2:0:-1]])
    ((_, _, thin),) = check([a_set(south, north, lens)], 1)
    assert thin.area > 0
    check([a_set(MultiPolygon([south, north]))], 1)  # the gap between two parts of one


def test_a_coast_does_not_sweep_over_the_island_in_its_bay() -> None:
    coast = Polygon([(0, 0), (10, 0), (10, 5), (6, 5), (5, 3), (4, 5), (0, 5)])
    island = Polygon([(4.9, 4.2), (5.1, 4.2), (5, 4.4)])
    for sets in ([a_set(coast, island)], [a_set(MultiPolygon([coast, island]))]):
        check(sets, 2.5)
    ((alone,), _) = check([a_set(coast), a_set(island)], 2.5)
    assert len(alone.exterior.coords) == 5  # another set's island is no obstacle


def test_a_coast_does_not_cut_into_an_island_that_does_not_change() -> None:
    coast = Polygon([(0, 0), (20, 0), (20, 5), (14, 5), (10, 3), (6, 5), (0, 5)])
    island = Polygon([(10, 3.5), (16, 12), (4, 12)])
    ((_, result),) = check([a_set(coast, island)], 2.2)
    assert result == island


@pytest.mark.parametrize("joined", [False, True])
def test_only_what_lies_near_an_obstacle_becomes_finer(joined: bool) -> None:
    bay = [(10, 10), (10, 6), (9, 5), (10, 4)]
    country = Polygon([*BORDER[:-1], (5, 10), *bay, (10, 0)])
    island = Polygon([(9.6, 4.9), (9.8, 4.9), (9.7, 5.1)])
    sets = [a_set(MultiPolygon([country, island])) if joined else a_set(country, island)]
    (result,) = check(sets, 1.05)
    assert set(points_of(parts(result)[0].exterior)) >= set(bay)
    assert len(parts(result)[0].exterior.coords) < 10  # the wavy border stays straight


def test_a_coast_does_not_sweep_over_its_own_lake() -> None:
    lake = [(4.9, 4.2), (5.1, 4.2), (5, 4.4)]
    check([a_set(Polygon([(0, 0), (10, 0), (10, 4), (6, 4), (5, 5), (4, 4), (0, 4)], [lake]))], 2)


def test_diamonds_that_touch_at_a_point_still_do() -> None:
    other = translate(DIAMOND, 2)
    ((left, right),) = check([a_set(DIAMOND, other)], 0.9)
    assert (2, 0) in left.exterior.coords
    assert (2, 0) in right.exterior.coords
    check([a_set(MultiPolygon([DIAMOND, other]))], 0.9)


def test_a_hole_that_touches_its_outer_ring_still_does() -> None:
    hole = [(0, 5), (4, 4), (4.1, 5), (4, 6)]
    outer = [(0, 0), (9, 0), (9, 9), (0, 9), (0, 5)]
    ((result,),) = check([a_set(Polygon(outer, [hole]))], 0.5)
    assert (0, 5) in result.interiors[0].coords


def test_a_set_that_overlaps_itself_is_simplified_elsewhere() -> None:
    over = Polygon([(9, 4), (12, 4), (12, 6), (9, 6)])
    ((west, east, _),) = check([a_set(WEST, EAST, over)], 0.11)
    assert len(west.exterior.coords) == 5
    assert len(east.exterior.coords) == 5


# Random sets


# Vertices that lie equally far from a chord: which stays depends on the direction of the arc.
@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.1, 3))
def test_promises_hold_on_square_cells(seed: int, tolerance: float) -> None:
    rng = np.random.default_rng(seed)
    cells = shapely.box(*np.mgrid[:9, :9], *np.mgrid[1:10, 1:10])
    sets = [merged(cells, rng.integers(0, 3, (9, 9))) for _ in range(2)]
    assume(all(shapely.is_valid(s).all() for s in sets))
    assert same(check(sets[::-1], tolerance)[::-1], check(sets, tolerance))


TOLERANCES = st.floats(0.02, 4)


@settings(max_examples=150, deadline=None)
@given(RANDOM, TOLERANCES)
def test_promises_hold(sets: list[Shapes], tolerance: float) -> None:
    check(sets, tolerance)


@settings(max_examples=40, deadline=None)
@given(RANDOM, TOLERANCES, st.randoms(use_true_random=False))
def test_order_of_sets_and_polygons_and_rings_does_not_matter(
    sets: list[Shapes], tolerance: float, chance: np.random.Generator
) -> None:
    expected = simplify(sets, tolerance)
    assert same(simplify(sets[::-1], tolerance)[::-1], expected)
    orders = [chance.sample(range(len(s)), len(s)) for s in sets]
    mixed = [s[order] for s, order in zip(sets, orders, strict=True)]
    assert same(
        simplify(mixed, tolerance), [s[order] for s, order in zip(expected, orders, strict=True)]
    )
    assert same(simplify([shapely.reverse(s) for s in sets], tolerance), expected)
    assert same(simplify([shapely.normalize(s) for s in sets], tolerance), expected)


@pytest.mark.parametrize("change", TURNS.values(), ids=list(TURNS))
@settings(max_examples=15, deadline=None)
@given(sets=RANDOM, tolerance=TOLERANCES)
def test_a_turned_map_is_simplified_alike(
    change: Change, sets: list[Shapes], tolerance: float
) -> None:
    turned = [shapely.transform(s, change) for s in sets]
    expected = [shapely.transform(s, change) for s in simplify(sets, tolerance)]
    assert same(simplify(turned, tolerance), expected)


@pytest.mark.parametrize("factor", SCALES.values(), ids=list(SCALES))
@settings(max_examples=15, deadline=None)
@given(sets=RANDOM, tolerance=TOLERANCES)
def test_the_unit_does_not_matter(factor: float, sets: list[Shapes], tolerance: float) -> None:
    scaled = [shapely.transform(s, lambda p: p * factor) for s in sets]
    assume(all(shapely.is_valid(s).all() for s in scaled))
    expected = [shapely.transform(s, lambda p: p * factor) for s in simplify(sets, tolerance)]
    assert same(simplify(scaled, tolerance * factor), expected)


# Real sets


def real(name: str) -> list[Shapes]:
    steps = []
    for file in files(name):
        listed = json.loads(file.read_text(encoding="utf-8"))["features"]
        step = a_set(*(shapely.from_geojson(json.dumps(f["geometry"])) for f in listed))
        valid = shapely.make_valid(step, method="structure", keep_collapsed=False)
        step = np.where(shapely.is_valid(step), step, valid)
        steps.append(shapely.remove_repeated_points(step[~shapely.is_empty(step)]))
    return steps


def pixel(sets: Sequence[Shapes]) -> float:
    """One of 960 pixels across the map."""
    box = shapely.total_bounds(np.concatenate(sets))
    return float(box[2] - box[0]) / 960


@needs_real_data
@pytest.mark.parametrize("pixels", [0.25, 1, 5, 20])
@pytest.mark.parametrize("name", ["us_regions", "wildfire_creek2020", "scale_us_counties"])
def test_real_sets_keep_what_is_promised(name: str, pixels: float) -> None:
    sets = real(name)
    check(sets, pixels * pixel(sets))


@needs_real_data
@pytest.mark.parametrize("pixels", [0.25, 1, 5, 20])
def test_coarser_borders_stay_borders_of_the_finer_regions(pixels: float) -> None:
    sets = real("us_regions")
    before = [edges(s) for s in sets]
    after = [edges(s) for s in simplify(sets, pixels * pixel(sets))]
    for coarse, fine in zip(range(3), range(1, 4), strict=True):
        assert before[coarse] <= before[fine]
        assert after[coarse] <= after[fine]


@needs_real_data
@pytest.mark.parametrize("change", TURNS.values(), ids=list(TURNS))
def test_a_turned_country_is_simplified_alike(change: Change) -> None:
    sets = real("us_regions")
    turned = [shapely.transform(s, change) for s in sets]
    expected = [shapely.transform(s, change) for s in simplify(sets, 5 * pixel(sets))]
    assert same(simplify(turned, 5 * pixel(sets)), expected)
