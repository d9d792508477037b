"""What fronts promise, in frames: from polygon sets to tracks, whatever lies in between."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import Polygon, box

from geotween.data.polygons import Feature, PolygonSet, bounds_of, extent, polygon_set
from geotween.export.page_grid import fit_page, on_grid
from geotween.motion.areas import area_over_time
from geotween.motion.front.fronts import front
from geotween.motion.looks import rebuilt
from geotween.motion.measure import measure
from geotween.motion.tracks import Track
from geotween.scene.model import Map
from tests.motion.front.fires import pair
from tests.motion.front.tilings import (
    KINDS,
    SQUARE,
    Floats,
    Geometry,
    Transition,
    beyond,
    islands,
    keyed,
    moving,
    polygons_at,
    regions_at,
    retreat,
    twice_and_bare,
    unlikeness,
)
from tests.motion.shapes import polygon_sets

# Shares of the area that are rounding, of coordinates and of a page's tenths of pixels.
ROUNDING, ROUNDED = 1e-9, 1e-6

# The small sample is for every day, the large one for make prove.
PROVING = os.environ.get("HYPOTHESIS_PROFILE") == "prove"
EXAMPLES = settings.default.max_examples if PROVING and settings.default else 12

TIMES = np.linspace(0, 1, 21)
DISC = shapely.Point(0, 0).buffer(3)
NOTHING = Polygon()


def swept(origin: PolygonSet, target: PolygonSet) -> tuple[Track, ...]:
    """The tracks of a front; half a pixel is what a page of a thousand has."""
    resolution = extent(bounds_of([origin, target])) / 2000
    found = front(origin, target, "regions", resolution)
    assert not found.problems
    return found.tracks


def burnt(shape: shapely.Geometry) -> PolygonSet:
    """A fire, whose parts have one key."""
    return polygon_set(Feature(part, key="fire") for part in shapely.get_parts(shape))


def unnamed(*shapes: Polygon) -> PolygonSet:
    return polygon_set(Feature(shape) for shape in shapes)


def covered(tracks: Sequence[Track], t: float) -> Geometry:
    return shapely.union_all(polygons_at(tracks, t)[0])


# Tilings stay tilings.


TILINGS = [(make, seed) for make in (moving, keyed) for seed in range(2)]


@cache
def tiled(
    make: Callable[[int, int], Transition], seed: int
) -> tuple[Transition, tuple[Track, ...]]:
    """A tiling of 14 cells, and its tracks."""
    transition = make(seed, 14)
    return transition, swept(*transition)


@pytest.mark.parametrize(("make", "seed"), TILINGS)
def test_a_tiling_stays_a_tiling(make: Callable[[int, int], Transition], seed: int) -> None:
    transition, tracks = tiled(make, seed)
    for t in TIMES:
        assert max(twice_and_bare(polygons_at(tracks, t)[0], SQUARE.area)) < ROUNDING
    found = measure(tracks, *transition, 11)
    assert found.invalid_time == 0
    assert max(found.inexact_ends, found.lost, found.boundary_moved) < ROUNDING


@pytest.mark.parametrize(("make", "seed"), TILINGS)
def test_a_tiling_stays_one_on_the_pages_grid(
    make: Callable[[int, int], Transition], seed: int
) -> None:
    transition, tracks = tiled(make, seed)
    page = fit_page(Map(width=960), transition)
    square = Polygon(page.grid(shapely.get_coordinates(SQUARE)))
    rounded = on_grid(tracks, page)
    for t in TIMES[:-1]:
        there = [k for k in rounded if k.life[0] <= t < k.life[1] and k.vertices.shape[1]]
        drawn = [
            Polygon(rings[0], rings[1:])
            for k in there
            for rings in [np.split(k.at(t), k.offsets[1:-1])]
        ]
        mended = rebuilt(np.array(drawn, dtype=object))
        assert max(twice_and_bare(mended, square.area)) < ROUNDED


@pytest.mark.parametrize("kind", KINDS)
def test_what_one_tile_has_goes_over_and_comes_never_back(kind: str) -> None:
    tracks = swept(*keyed(3, 10, [kind]))
    ends = regions_at(tracks, 1)
    before = regions_at(tracks, 0)
    for t in TIMES[1:]:
        after = regions_at(tracks, t)
        for name, end in ends.items():
            back = retreat(before.get(name, NOTHING), after.get(name, NOTHING), end)
            assert back < ROUNDING * SQUARE.area
        before = after


@pytest.mark.parametrize("kind", ["breaks up", "joins", "parts", "swaps"])
def test_what_changes_in_place_does_not_move(kind: str) -> None:
    tracks = swept(*keyed(3, 10, [kind], share=0.0))
    assert all(track.life == (0, 1) for track in tracks)
    assert all(np.array_equal(*track.vertices) for track in tracks)


@pytest.mark.parametrize("seed", range(2))
def test_tiles_change_without_a_flash(seed: int) -> None:
    tracks = swept(*moving(seed, 6, step=0.15))
    shapes = [regions_at(tracks, t) for t in np.linspace(0, 1, 101)]
    for name in shapes[0]:
        mine = [there[name] for there in shapes]
        steps = shapely.area(shapely.symmetric_difference(mine[1:], mine[:-1]))
        assert steps.max() <= 4 * steps.mean()


# Fires.


@pytest.fixture(scope="module", params=range(2))
def fire(request: pytest.FixtureRequest) -> list[Geometry]:
    """The frames of a fire."""
    one, other, _ = pair(request.param, 100)
    tracks = swept(burnt(one), burnt(other))
    return [covered(tracks, t) for t in np.linspace(0, 1, 101)]


def test_a_fire_never_retreats_nor_goes_where_it_does_not_burn(fire: list[Geometry]) -> None:
    for now, then in pairwise(fire):
        assert retreat(now, then, fire[-1]) < ROUNDING * fire[-1].area


def test_no_spot_burns_before_the_fire_is_there_nor_is_left_behind(fire: list[Geometry]) -> None:
    around = box(*fire[-1].bounds).buffer(10)
    unburnt = [around - shape for shape in fire]
    found = [islands(now, fire[0], fire[-1]) for now in fire]
    found += [islands(left, unburnt[-1], unburnt[0]) for left in unburnt]
    assert max((area for areas in found for area in areas), default=0) < ROUNDING * fire[-1].area


def test_a_fire_grows_evenly_and_without_a_flash(fire: list[Geometry]) -> None:
    areas = shapely.area(fire)
    straight = np.linspace(areas[0], areas[-1], len(areas))
    assert np.abs(areas - straight).max() <= 0.005 * areas[-1]
    steps = shapely.area(shapely.symmetric_difference(fire[1:], fire[:-1]))
    assert steps.max() <= 3 * steps.mean()


@pytest.mark.parametrize("seed", range(4))
def test_area_is_linear_at_any_time(seed: int) -> None:
    one, other, _ = pair(seed, 80)
    area = area_over_time(swept(burnt(one), burnt(other)))
    assert max(map(abs, area.extremes(linear=True))) <= 0.005 * max(area.ends)


# The five kinds of Kim and Cova (2007): how polygons at two times may be each other.

KIM_AND_COVA: dict[str, tuple[list[Polygon], list[Polygon]]] = {
    "one to one": ([box(0, 0, 4, 4)], [Polygon([(0, 0), (9, 0), (9, 2), (4, 4), (0, 4)])]),
    "one to many": ([box(0, 0, 9, 3)], [box(0, 0, 4, 3), box(5, 0, 9, 3)]),
    "many to one": ([box(0, 0, 4, 3), box(5, 0, 9, 3)], [box(0, 0, 9, 3)]),
    "none to one": ([], [DISC]),
    "one to none": ([DISC], []),
}


@pytest.mark.parametrize("kind", KIM_AND_COVA)
def test_the_five_kinds_of_change(kind: str) -> None:
    origin, target = (unnamed(*shapes) for shapes in KIM_AND_COVA[kind])
    tracks = swept(origin, target)
    start, end = (shapely.union_all(shapes.polygons) for shapes in (origin, target))
    numbers = sorted([len(origin), len(target)])
    now = covered(tracks, 0)
    assert (now ^ start).area < ROUNDING
    for t in TIMES[1:-1]:
        then = covered(tracks, t)
        straight = start.area * (1 - t) + end.area * t
        assert then.area == pytest.approx(straight, abs=0.005 * max(start.area, end.area))
        assert retreat(now, then, end) < ROUNDING
        assert islands(then, start, end) == []
        assert islands(then, end, start) == []
        assert max(numbers[0], 1) <= shapely.get_num_geometries(then) <= numbers[1]
        now = then
    assert (covered(tracks, 1) ^ end).area < ROUNDING


# The same from every side.

FIRE, LATER = map(burnt, pair(4, 80)[:2])
SITUATIONS: dict[str, Transition] = {
    "fire": (FIRE, LATER),
    "moving": moving(2, 6, step=0.2),
    "keyed": keyed(5, 9),
}


@cache
def plain(situation: str) -> tuple[Track, ...]:
    return swept(*SITUATIONS[situation])


def turned(angle: float) -> Floats:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, s], [-s, c]])


def mapped(shapes: PolygonSet, matrix: Floats) -> PolygonSet:
    there = shapely.transform(shapes.polygons, lambda points: points @ matrix)
    return PolygonSet(shapely.orient_polygons(there), shapes.identities)


def assert_like(found: tuple[float, float], elsewhere: float, area: float) -> None:
    assert found[0] <= elsewhere
    assert found[1] <= area


SAME_TIMES = [(t, t) for t in (0.0, 0.15, 0.5, 0.8, 1.0)]


@pytest.mark.parametrize("situation", SITUATIONS)
@pytest.mark.parametrize(
    "matrix",
    [turned(np.pi / 2), turned(0.4), np.diag([-1.0, 1.0])],
    ids=["quarter turn", "turn", "mirror"],
)
def test_fronts_turn_with_the_map(situation: str, matrix: Floats) -> None:
    """But for the mesh, which does not turn: a percent of the area may be elsewhere."""
    origin, target = SITUATIONS[situation]
    there = swept(mapped(origin, matrix), mapped(target, matrix))
    back = np.asarray(np.linalg.inv(matrix))
    found = unlikeness(plain(situation), there, SAME_TIMES, back)
    assert_like(found, 0.01, 0.002)


@pytest.mark.parametrize("situation", SITUATIONS)
@pytest.mark.parametrize("scale", [1e9, 1e-9])
def test_fronts_grow_with_the_map(situation: str, scale: float) -> None:
    origin, target = SITUATIONS[situation]
    there = swept(mapped(origin, scale * np.eye(2)), mapped(target, scale * np.eye(2)))
    found = unlikeness(plain(situation), there, SAME_TIMES, np.eye(2) / scale)
    assert_like(found, 1e-3, 1e-3)


@pytest.mark.parametrize("situation", SITUATIONS)
def test_the_order_of_polygons_does_not_matter(situation: str) -> None:
    origin, target = (
        PolygonSet(end.polygons[::-1], end.identities[::-1]) for end in SITUATIONS[situation]
    )
    found = unlikeness(plain(situation), swept(origin, target), SAME_TIMES)
    assert_like(found, 1e-3, 1e-3)


@pytest.mark.parametrize("situation", ["fire", "moving"])
def test_time_runs_back_the_way_it_came(situation: str) -> None:
    origin, target = SITUATIONS[situation]
    back_in_time = [(t, 1 - t) for t, _ in SAME_TIMES]
    found = unlikeness(plain(situation), swept(target, origin), back_in_time)
    assert_like(found, 1e-3, 1e-3)


# Anything.


def assert_sound(
    tracks: Sequence[Track], origin: PolygonSet, target: PolygonSet, times: Sequence[float]
) -> None:
    """No overlap, nothing bare that is common, nothing beyond the ends; the ends exact."""
    ends = [shapely.union_all(end.polygons) for end in (origin, target)]
    both, either = shapely.intersection_all(ends), shapely.union_all(ends)
    little = ROUNDING * either.area
    for t in times:
        drawn, _ = polygons_at(tracks, t)
        there = shapely.union_all(drawn)
        assert shapely.area(drawn).sum() - there.area < little
        assert beyond(both, there) < little
        assert beyond(there, either) < little
    for t, end in enumerate(ends):
        assert (covered(tracks, t) ^ end).area < little


moments = st.lists(st.floats(0, 1), min_size=3, max_size=3)


@settings(max_examples=EXAMPLES)
@given(
    st.integers(0, 2**32 - 1),
    st.integers(4, 12),
    st.sets(st.sampled_from(list(KINDS))),
    st.sampled_from([0.0, 0.02, 0.3, 1.0]),
    moments,
)
def test_any_tiling_is_sound_at_any_time(
    seed: int, number: int, kinds: set[str], step: float, times: list[float]
) -> None:
    transition = keyed(seed, number, sorted(kinds), step=step, share=0.5)
    tracks = swept(*transition)
    assert_sound(tracks, *transition, times)
    for t in times:
        assert max(twice_and_bare(polygons_at(tracks, t)[0], SQUARE.area)) < ROUNDING


@settings(max_examples=EXAMPLES)
@given(polygon_sets, polygon_sets, st.sampled_from([0, 1, 2, 5]), moments)
def test_any_polygons_are_sound_at_any_time(
    before: list[Polygon], after: list[Polygon], keys: int, times: list[float]
) -> None:
    origin, target = (
        polygon_set(
            Feature(polygon, key=f"k{place % keys}" if keys else None)
            for place, polygon in enumerate(polygons)
        )
        for polygons in (before, after)
    )
    assert_sound(swept(origin, target), origin, target, times)
