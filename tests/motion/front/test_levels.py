"""Coarse arrivals: they tile what changes, are near the field, and nothing in them flashes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from shapely import Geometry
from shapely.geometry import MultiPolygon, Point, Polygon, box

import geotween
from geotween.data.polygons import Feature, PolygonSet, bounds_of, extent, polygon_set
from geotween.motion.front.changes import changes
from geotween.motion.front.field import Field, arrival
from geotween.motion.front.knots import below
from geotween.motion.front.levels import Arrivals, flaws, levels
from geotween.motion.front.plane import NOTHING, Change
from tests.motion.front import fires
from tests.motion.shapes import tiles
from tests.real_data import needs_real_data, write_scene

Floats = NDArray[np.float64]
Step = Mapping[str, Geometry]

HALF_A_PIXEL = 1 / 2000  # of a map of a thousand pixels, as a share of its extent


def disc(x: float, y: float, radius: float) -> Polygon:
    return Point(x, y).buffer(radius)


PICTURES: dict[str, tuple[Step, Step]] = {
    "a disc grows on all sides": ({"a": disc(0, 0, 1)}, {"a": disc(0, 0, 2)}),
    "a disc moves on": ({"a": disc(0, 0, 1)}, {"a": disc(0.4, 0, 1)}),
    "a square grows at a corner": ({"a": box(0, 0, 1, 1)}, {"a": box(0, 0, 2, 2)}),
    "a square grows on one side": ({"a": box(0, 0, 1, 1)}, {"a": box(0, 0, 3, 1)}),
    "a disc begins": ({}, {"a": disc(0, 0, 1)}),
    "a disc ends": ({"a": disc(0, 0, 1)}, {}),
    "a hole closes": ({"a": disc(0, 0, 3) - disc(0.5, 0, 1)}, {"a": disc(0, 0, 3)}),
    "two spots apart": (
        {"a": disc(0, 0, 1)},
        {"a": MultiPolygon([disc(0, 0, 1.2), disc(5, 0, 1), disc(2, 3, 0.5)])},
    ),
    "a border moves beside a border that moves back": (
        {
            "a": box(0, 0, 1, 1),
            "b": box(1, 0, 4, 1),
            "c": box(0, 1, 2, 2),
            "d": box(2, 1, 4, 2),
        },
        {
            "a": box(0, 0, 3, 1),
            "b": box(3, 0, 4, 1),
            "c": box(0, 1, 1, 2),
            "d": box(1, 1, 4, 2),
        },
    ),
    "a triple point moves": (
        {"a": box(0, 0, 3, 1), "b": box(0, 1, 1, 3), "c": box(1, 1, 3, 3)},
        {"a": box(0, 0, 3, 1.3), "b": box(0, 1.3, 1.4, 3), "c": box(1.4, 1.3, 3, 3)},
    ),
    "a region with four pivots": (
        {"a": box(0, 0, 3, 3) - box(1, 1, 2, 2), "b": box(4, 0, 5, 1)},
        {"a": box(0, 0, 3, 3) - box(1, 0, 2, 3), "b": box(4, 0, 5, 1)},
    ),
    "nothing changes": ({"a": box(0, 0, 1, 1)}, {"a": box(0, 0, 1, 1)}),
}


def set_of(step: Step) -> PolygonSet:
    return polygon_set(Feature(shape, key=key) for key, shape in step.items())


def coarse(origin: PolygonSet, target: PolygonSet) -> tuple[Change, Field, Arrivals]:
    change = changes(origin, target)
    field = arrival(change)
    tolerance = HALF_A_PIXEL * extent(bounds_of([origin, target]))
    return change, field, levels(change, field, tolerance)


def areas(arrivals: Arrivals) -> Floats:
    return np.asarray(shapely.area(shapely.polygons(arrivals.points[arrivals.triangles])))


def assert_no_flash(arrivals: Arrivals) -> None:
    at_once = (arrivals.times == arrivals.times[:, :1]).all(axis=1)
    area = areas(arrivals)
    assert (area[at_once] <= 1e-9 * area.sum()).all()


def swept(arrivals: Arrivals, time: float) -> float:
    share = below(arrivals.times, np.full(len(arrivals.times), time))
    return float((share * areas(arrivals)).sum())


def times_at(arrivals: Arrivals, places: Floats) -> Floats:
    """The arrivals' times at places (k, 2), NaN outside."""
    corners = arrivals.points[arrivals.triangles]
    tree = shapely.STRtree(shapely.polygons(corners))
    place, triangle = tree.query(shapely.points(places), predicate="intersects")
    a, b, c = corners[triangle].transpose(1, 0, 2)
    weights = np.linalg.solve(
        np.stack([b - a, c - a], axis=2), (places[place] - a)[:, :, None]
    ).squeeze(2)
    first, second, third = arrivals.times[triangle].T
    found = np.full(len(places), np.nan)
    found[place] = first + weights[:, 0] * (second - first) + weights[:, 1] * (third - first)
    return found


@pytest.mark.parametrize("picture", PICTURES)
def test_arrivals_of_a_picture_have_no_flaws(picture: str) -> None:
    change, _, arrivals = coarse(*map(set_of, PICTURES[picture]))
    assert flaws(arrivals, change) == []
    assert_no_flash(arrivals)


@pytest.mark.parametrize("scale", [1e9, 1e-9])
@pytest.mark.parametrize("picture", PICTURES)
def test_arrivals_have_no_flaws_turned_reflected_and_rescaled(picture: str, scale: float) -> None:
    matrix = scale * np.array([[np.cos(1), np.sin(1)], [np.sin(1), -np.cos(1)]])
    steps = [
        set_of({key: shapely.transform(shape, lambda p: p @ matrix) for key, shape in step.items()})
        for step in PICTURES[picture]
    ]
    change, _, arrivals = coarse(*steps)
    assert flaws(arrivals, change) == []
    assert_no_flash(arrivals)


def test_the_same_input_has_the_same_arrivals() -> None:
    one, other = (coarse(*map(set_of, PICTURES["a triple point moves"]))[2] for _ in range(2))
    assert all(
        np.array_equal(getattr(one, field.name), getattr(other, field.name))
        for field in fields(one)
    )


def timed(change: Change, when: Callable[[Floats], Floats]) -> Field:
    """A field with times of our own."""
    field = arrival(change)
    return replace(field, times=when(field.points)[field.triangles])


def faster(places: Floats) -> Floats:
    return np.asarray(np.sqrt(np.clip((places[:, 0] - 1) / 2, 0, 1)))


MOVING = (
    {"a": box(0, 0, 1, 1), "b": box(1, 0, 4, 1), "c": box(0, 1, 1, 2), "d": box(1, 1, 4, 2)},
    {"a": box(0, 0, 3, 1), "b": box(3, 0, 4, 1), "c": box(0, 1, 3, 2), "d": box(3, 1, 4, 2)},
)


def test_two_strips_swept_evenly_are_four_triangles_and_no_new_points() -> None:
    change = changes(*map(set_of, MOVING))
    arrivals = levels(change, timed(change, lambda p: (p[:, 0] - 1) / 2), 4 * HALF_A_PIXEL)
    assert flaws(arrivals, change) == []
    assert len(arrivals.triangles) == 4
    assert np.array_equal(arrivals.points, change.plane.points)
    assert np.unique(arrivals.times).tolist() == [0, 1]


def test_two_strips_swept_ever_faster_share_the_ends_of_levels() -> None:
    change = changes(*map(set_of, MOVING))
    arrivals = levels(change, timed(change, faster), 4 * HALF_A_PIXEL)
    assert flaws(arrivals, change) == []
    between = (arrivals.points[arrivals.edges][:, :, 1] == 1).all(axis=1)
    both = (arrivals.sides[between] != NOTHING).all(axis=1)
    assert both.sum() >= 8
    for edge in np.flatnonzero(between)[both]:
        times = [
            arrivals.times[side][arrivals.triangles[side] == end]
            for end in arrivals.edges[edge]
            for side in arrivals.sides[edge]
        ]
        assert times[0] == times[1]
        assert times[2] == times[3]


def test_levels_end_on_the_outline_of_what_does_not_change() -> None:
    still = {"s": box(1.2, -1, 2.8, 0)}
    change = changes(*(set_of({**step, **still}) for step in MOVING))
    arrivals = levels(change, timed(change, faster), 4 * HALF_A_PIXEL)
    assert flaws(arrivals, change) == []
    ends = arrivals.points[len(change.plane.points) :]
    on_top = ends[(ends[:, 1] == 0) & (ends[:, 0] > 1.2) & (ends[:, 0] < 2.8)]
    assert len(on_top) >= 4
    lower = (arrivals.points[arrivals.edges][:, :, 1] < 0).any(axis=1)
    assert lower.sum() == 3  # its other sides are whole


def test_what_does_not_change_keeps_its_own_vertices() -> None:
    apart = disc(10, 0, 1)
    origin, target = ({**step, "z": apart} for step in PICTURES["a disc grows on all sides"])
    change, _, arrivals = coarse(set_of(origin), set_of(target))
    number = next(i for i, thing in enumerate(change.things) if thing.origin.key == "z")  # type: ignore[union-attr]
    own = (arrivals.still == number).any(axis=1)
    assert own.sum() == len(apart.exterior.coords) - 1
    assert (arrivals.edges[own] < len(change.plane.points)).all()


def test_a_disc_that_begins_does_so_at_one_point_inside() -> None:
    _, _, arrivals = coarse(*map(set_of, PICTURES["a disc begins"]))
    first = np.unique(arrivals.triangles[arrivals.times == 0])
    assert len(first) == 1
    assert np.hypot(*arrivals.points[first[0]]) < 0.1


@pytest.mark.parametrize("picture", ["a disc grows on all sides", "a hole closes", "a disc ends"])
def test_area_is_swept_evenly(picture: str) -> None:
    _, _, arrivals = coarse(*map(set_of, PICTURES[picture]))
    whole = areas(arrivals).sum()
    off = [swept(arrivals, t) / whole - t for t in np.linspace(0, 1, 41)]
    assert np.abs(off).max() < 0.006


def test_levels_of_a_ring_are_circles_to_within_a_pixel() -> None:
    change = changes(*map(set_of, PICTURES["a disc grows on all sides"]))
    field = timed(change, lambda p: (np.clip(np.hypot(*p.T), 1, 2) ** 2 - 1) / 3)
    arrivals = levels(change, field, 4 * HALF_A_PIXEL)
    found = times_at(arrivals, field.points[field.triangles].mean(axis=1))
    off = np.sqrt(1 + 3 * found) - np.sqrt(1 + 3 * field.times.mean(axis=1))
    assert np.quantile(np.abs(off), 0.95) < 2 * 4 * HALF_A_PIXEL


@pytest.mark.parametrize("seed", [0, 1])
def test_a_fire_is_swept_as_its_field_says(seed: int) -> None:
    origin, target, _ = fires.pair(seed, size=80)
    sets = polygon_set([Feature(origin)]), polygon_set([Feature(target)])
    change, field, arrivals = coarse(*sets)
    assert flaws(arrivals, change) == []
    assert_no_flash(arrivals)
    whole = areas(arrivals).sum()
    for time in (0.25, 0.5, 0.75):
        assert swept(arrivals, time) / whole == pytest.approx(time, abs=0.01)
    middle = field.points[field.triangles].mean(axis=1)
    off = np.abs(times_at(arrivals, middle) - field.times.mean(axis=1))
    assert np.nanquantile(off, 0.9) < 0.05


@settings(max_examples=25, deadline=None)
@given(st.integers(2, 12), st.integers(0, 1000), st.floats(0.01, 1.5))
def test_any_keyed_tiling_has_no_flaws(count: int, seed: int, far: float) -> None:
    random = np.random.default_rng(seed)
    seeds = random.uniform(0, 10, (count, 2))
    sets = [
        set_of({str(key): cell for key, cell in enumerate(voronoi(places))})
        for places in (seeds, seeds + far * random.normal(size=seeds.shape))
    ]
    change, _, arrivals = coarse(*sets)
    assert flaws(arrivals, change) == []
    assert_no_flash(arrivals)


@settings(max_examples=25, deadline=None)
@given(st.integers(1, 6), st.integers(0, 1000), st.integers(1, 6), st.integers(0, 1000))
def test_tilings_that_have_nothing_to_do_with_each_other_have_no_flaws(
    count: int, seed: int, other_count: int, other_seed: int
) -> None:
    sets = [
        set_of({str(key): cell for key, cell in enumerate(cells)})
        for cells in (tiles(count, seed), tiles(other_count, other_seed))
    ]
    change, _, arrivals = coarse(*sets)
    assert flaws(arrivals, change) == []
    assert_no_flash(arrivals)


def voronoi(places: Floats) -> list[Polygon]:
    square = box(0, 0, 10, 10)
    cells = shapely.voronoi_polygons(shapely.multipoints(places), extend_to=square, ordered=True)
    cut = shapely.intersection(shapely.get_parts(cells), square)
    return [cell if cell.area > 0 else box(20 + i, 0, 20.5 + i, 1) for i, cell in enumerate(cut)]


@needs_real_data
def test_the_creek_fire_grows_without_flaws(tmp_path: Path) -> None:
    steps = [s.regions for s in geotween.load(write_scene(tmp_path, "wildfire_creek2020"))]
    for pair in pairwise(steps[:7]):
        change, _, arrivals = coarse(*pair)
        assert flaws(arrivals, change) == []
        assert_no_flash(arrivals)
