"""Hotspots: where they lie, how exactly, and what they do not depend on."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon, Point

from geotween.data.steps.hotspots import (
    FARTHEST,
    Hotspots,
    density,
    grid_over,
    hotspots,
    scott_bandwidth,
)

Points = NDArray[np.float64]

LEVELS = (0.1, 0.3, 0.6)
UTM = np.array([5e5, 5.2e6])


def in_one(points: Any, **options: Any) -> Hotspots:
    """The hotspots of points in one period."""
    return hotspots(np.array(points, float), np.zeros(len(points), int), 1, **options)


def city(seed: int = 0, count: int = 400) -> tuple[Points, NDArray[np.intp]]:
    """Points around a few places, in three periods."""
    random = np.random.default_rng(seed)
    places = random.uniform(0, 20, (5, 2))
    points = places[random.integers(0, 5, count)] + random.normal(size=(count, 2))
    return points, random.integers(0, 3, count)


def exact(points: Points, places: Points, h: float) -> tuple[Points, Points]:
    """The density at places by its definition, and the length of its gradient."""
    away = places[:, None] - points
    kernels = np.exp(-(away**2).sum(axis=2) / (2 * h**2)) / (2 * np.pi * h**2)
    slopes = (away * kernels[..., None]).sum(axis=1) / h**2
    return kernels.sum(axis=1), np.hypot(*slopes.T)


def assert_same(one: Hotspots, other: Hotspots, moved: Callable[[Points], Points]) -> None:
    """That the other has the first one's polygons, moved, but for rounding."""
    for before, after in zip(one.polygons, other.polygons, strict=True):
        for polygon, found in zip(before, after, strict=True):
            expected = shapely.transform(polygon, moved)
            if polygon.is_empty:
                assert found.is_empty
            else:
                assert shapely.hausdorff_distance(expected, found) < 1e-5 * other.cell


def test_ring_of_points_around_a_stadium_has_a_hole() -> None:
    angle = np.linspace(0, 2 * np.pi, 200, endpoint=False)
    ring = 5 * np.column_stack([np.cos(angle), np.sin(angle)])
    ((found,),) = in_one(ring, levels=[0.5], relative=True, bandwidth=1).polygons
    (polygon,) = found.geoms
    (hole,) = polygon.interiors
    assert polygon.exterior.is_ccw
    assert not hole.is_ccw
    assert shapely.Polygon(hole).contains(Point(0, 0))
    assert shapely.covers(found, shapely.points(ring)).all()


def test_two_places_are_two_polygons_that_a_lower_level_joins() -> None:
    found = in_one([(0, 0), (3, 0)], levels=[0.5, 0.9], relative=True, bandwidth=1)
    ((low, high),) = found.polygons
    assert (len(low.geoms), len(high.geoms)) == (1, 2)


@pytest.mark.parametrize("count", [1, 7])
@pytest.mark.parametrize("share", [0.05, 0.5, 0.9])
@pytest.mark.parametrize("offset", [(0.0, 0.0), (0.11, 0.36)])
def test_one_place_gives_the_disc_of_its_kernel(
    count: int, share: float, offset: tuple[float, float]
) -> None:
    h, place = 2.0, np.array(offset)
    threshold = share * count / (2 * np.pi * h**2)
    points = np.array([place] * count + [(-20, -20), (20, 20)])  # the ends place the grid
    period = np.array([0] * count + [1, 1])
    found = hotspots(points, period, 2, levels=[threshold], relative=False, bandwidth=h)
    radius = h * np.sqrt(2 * np.log(count / (2 * np.pi * h**2 * threshold)))
    (disc,) = found.polygons[0][0].geoms
    away = np.hypot(*(shapely.get_coordinates(disc) - place).T)
    np.testing.assert_allclose(away, radius, atol=0.03 * h)
    assert found.thresholds == pytest.approx((threshold,), rel=1e-12)
    assert found.peak == pytest.approx(count / (2 * np.pi * h**2), rel=0.011)


@pytest.mark.parametrize("origin", [np.zeros(2), UTM])
def test_contours_follow_the_exact_density(origin: Points) -> None:
    off = []
    for seed, count in enumerate([5, 50, 500]):
        points, _ = city(seed, count)
        found = in_one(points + origin, levels=LEVELS, relative=True)
        for threshold, polygons in zip(found.thresholds, found.polygons[0], strict=True):
            vertices = shapely.get_coordinates(polygons) - origin
            value, slope = exact(points, vertices, found.bandwidth)
            np.testing.assert_allclose(value, threshold, rtol=0.05)
            off.append(np.abs(value - threshold) / slope / found.bandwidth)
    together = np.concatenate(off)
    assert np.median(together) < 0.003
    assert np.quantile(together, 0.99) < 0.02


def test_peak_is_that_of_the_exact_density_even_between_nodes() -> None:
    for seed in range(10):
        points, _ = city(seed, 40)
        found = in_one(points, levels=[0.95], relative=True, bandwidth=1)
        low, high = np.reshape(found.polygons[0][0].bounds, (2, 2))
        across, along = np.meshgrid(*np.linspace(low, high, 100).T)
        places = np.column_stack([across.ravel(), along.ravel()])
        assert found.peak == pytest.approx(exact(points, places, 1)[0].max(), rel=0.005)


def test_density_adds_up_to_the_points_and_ends_before_the_rim() -> None:
    points, _ = city()
    for bandwidth in (0.3, 1.0, 20.0):
        grid = grid_over(points + UTM, bandwidth, 1)
        field = density(points + UTM, grid)
        assert field.shape == grid.shape
        assert field.sum() == pytest.approx(len(points), rel=1e-12)
        assert not any(rim.any() for rim in (field[0], field[-1], field[:, 0], field[:, -1]))


def test_period_without_points_has_no_hotspots() -> None:
    points, period = city()
    found = hotspots(points, 2 * period, 6, levels=LEVELS, relative=True)
    empty = [all(level.is_empty for level in levels) for levels in found.polygons]
    assert empty == [False, True, False, True, False, True]
    assert all(isinstance(level, MultiPolygon) for levels in found.polygons for level in levels)


def test_one_scale_for_all_periods() -> None:
    points = np.array([(0, 0)] * 4 + [(0, 0)], float)
    found = hotspots(
        points, np.array([0] * 4 + [1]), 2, levels=[0.2, 0.3], relative=True, bandwidth=1
    )
    assert [[level.is_empty for level in levels] for levels in found.polygons] == [
        [False, False], [False, True],
    ]  # fmt: skip
    assert found.thresholds == pytest.approx((0.2 * found.peak, 0.3 * found.peak))


def test_levels_in_any_order_come_back_ascending() -> None:
    points, period = city()
    one = hotspots(points, period, 3, levels=LEVELS, relative=True)
    other = hotspots(points, period, 3, levels=LEVELS[::-1], relative=True)
    assert one.polygons == other.polygons
    assert one.thresholds == other.thresholds == tuple(sorted(one.thresholds))


def test_shares_and_the_thresholds_that_they_stand_for_give_the_same() -> None:
    points, period = city()
    one = hotspots(points, period, 3, levels=LEVELS, relative=True)
    other = hotspots(points, period, 3, levels=one.thresholds, relative=False)
    assert_same(one, other, lambda p: p)


def test_order_of_points_does_not_matter() -> None:
    points, period = city()
    order = np.random.default_rng(1).permutation(len(points))
    one = hotspots(points, period, 3, levels=LEVELS, relative=True)
    other = hotspots(points[order], period[order], 3, levels=LEVELS, relative=True)
    assert one.polygons == other.polygons
    assert (one.thresholds, one.bandwidth) == (other.thresholds, other.bandwidth)


def test_reversed_periods_reverse_the_result() -> None:
    points, period = city()
    one = hotspots(points, period, 3, levels=LEVELS, relative=True)
    other = hotspots(points, 2 - period, 3, levels=LEVELS, relative=True)
    assert one.polygons == other.polygons[::-1]


@pytest.mark.parametrize("move", [
    lambda p: p + UTM,
    lambda p: p * 1e9,
    lambda p: p * 1e-9,
    lambda p: p * [-1, 1],
    lambda p: p[:, ::-1] * [-1, 1],
    lambda p: -p,
], ids=["to UTM", "1e9", "1e-9", "reflected", "quarter turn", "half turn"])  # fmt: skip
@pytest.mark.parametrize("bandwidth", [None, 1.0])
def test_hotspots_move_with_their_points(
    move: Callable[[Points], Points], bandwidth: float | None
) -> None:
    points, period = city()
    scale = float(np.abs(move(np.eye(2)) - move(np.zeros((1, 2)))).max())
    one = hotspots(points, period, 3, levels=LEVELS, relative=True, bandwidth=bandwidth)
    other = hotspots(
        move(points), period, 3, levels=LEVELS, relative=True,
        bandwidth=None if bandwidth is None else bandwidth * scale,
    )  # fmt: skip
    assert_same(one, other, move)
    assert other.bandwidth == pytest.approx(one.bandwidth * scale, rel=1e-9)
    assert other.cell == pytest.approx(one.cell * scale, rel=1e-9)
    assert other.peak == pytest.approx(one.peak / scale**2, rel=1e-9)
    np.testing.assert_allclose(other.thresholds, np.array(one.thresholds) / scale**2, rtol=1e-9)


LATTICE = st.lists(
    st.tuples(st.integers(0, 9), st.integers(0, 9), st.integers(0, 2)), min_size=1, max_size=25
)


@given(LATTICE, st.sampled_from([0.4, 1.0, 3.0]), st.sampled_from([0, 1, 0.5 * FARTHEST]))
def test_polygons_are_valid_and_each_level_lies_in_the_one_below(
    listed: list[tuple[int, int, int]], bandwidth: float, far: float
) -> None:
    told = np.array(listed)
    points = (told[:, :2] + [0.1, -1] * np.full(2, far)) * bandwidth
    found = hotspots(points, told[:, 2], 3, levels=LEVELS, relative=True, bandwidth=bandwidth)
    for levels in found.polygons:
        assert all(level.is_valid for level in levels)
        for low, high in pairwise(levels):
            assert shapely.difference(high, low).area <= 1e-6 * found.cell**2
    assert not found.polygons[np.argmax(np.bincount(told[:, 2]))][0].is_empty


@given(LATTICE, st.integers(0, 2**32 - 1))
def test_contours_through_nodes_of_the_grid_are_valid(
    listed: list[tuple[int, int, int]], seed: int
) -> None:
    points = np.array(listed, float)[:, :2]
    points = np.concatenate([points, 9 - points, points[:, ::-1], 9 - points[:, ::-1]])
    grid = grid_over(points, 1.0, 1)
    values = np.unique(density(points, grid))
    levels = np.random.default_rng(seed).choice(values[values > 1e-4 * values[-1]], 3, False)
    found = in_one(points, levels=levels / grid.cell**2, relative=False, bandwidth=1)
    assert all(level.is_valid for level in found.polygons[0])


def test_level_met_exactly_at_the_bottom_of_a_hollow_gives_a_hole_of_some_size() -> None:
    points = [(x, y) for x in (0, 3, 6) for y in (0, 3, 6) if (x, y) != (3, 3)]
    grid = grid_over(np.array(points, float), 1.0, 1)
    bottom = density(np.array(points, float), grid)[grid.shape[0] // 2, grid.shape[1] // 2]
    found = in_one(points, levels=[bottom / grid.cell**2], relative=False, bandwidth=1)
    ((polygons,),) = found.polygons
    assert polygons.is_valid
    assert shapely.get_num_interior_rings(polygons.geoms[0]) == 1


def test_level_just_below_the_peak_gives_no_sliver() -> None:
    ((low, high),) = in_one([(0, 0)], levels=[0.99, 1 - 3e-6], relative=True, bandwidth=1).polygons
    assert not low.is_empty
    assert high.is_empty


@pytest.mark.parametrize("scale", [1e9, 1e-9, 0.1, 1 / 3])
@pytest.mark.parametrize("side", range(1, 8))
def test_rounding_does_not_decide_about_the_size_of_the_grid(scale: float, side: int) -> None:
    points = np.array([(0, 0), (side, 2 * side)], float)
    expected = grid_over(points, 1.0, 1).shape
    assert grid_over((points + 0.1) * scale, scale, 1).shape == expected


def test_scott_bandwidth_of_a_normal_distribution() -> None:
    points = np.random.default_rng(0).normal(size=(20_000, 2)) * 3 + UTM
    one = np.zeros(len(points), int)
    assert scott_bandwidth(points, one) == pytest.approx(3 * 20_000 ** (-1 / 6), rel=0.02)
    eight = np.arange(len(points)) % 8 * 2  # every other period without points
    assert scott_bandwidth(points, eight) == pytest.approx(3 * 2_500 ** (-1 / 6), rel=0.02)


def test_scott_bandwidth_does_not_heed_a_few_points_far_away() -> None:
    points = np.random.default_rng(0).normal(size=(1_000, 2))
    usual = scott_bandwidth(points, np.zeros(1_000, int))
    points[:10] *= 1e4
    assert scott_bandwidth(points, np.zeros(1_000, int)) == pytest.approx(usual, rel=0.05)


def test_scott_bandwidth_where_most_points_coincide() -> None:
    points = np.array([(0, 0)] * 6 + [(1, 0), (-1, 0)], float)
    expected = np.sqrt(1 / 8) * 8 ** (-1 / 6)
    assert scott_bandwidth(points, np.zeros(8, int)) == pytest.approx(expected)


@pytest.mark.parametrize(("sides", "periods"), [
    ((1e5, 2e5), 1), ((1e5, 2e5), 12), ((3e4, 0), 1), ((7.7, 1e-3), 400),
])  # fmt: skip
def test_too_small_a_bandwidth_names_the_smallest_that_works(
    sides: tuple[float, float], periods: int
) -> None:
    points = np.array([(0, 0), sides])
    with pytest.raises(ValueError, match="is too small for points that spread over") as told:
        grid_over(points, max(sides) * 1e-7, periods)
    smallest = float(str(told.value).rpartition("at least ")[2].removesuffix(" works"))
    grid_over(points, smallest, periods)
    with pytest.raises(ValueError, match=f"at least {smallest:g} works"):
        grid_over(points, smallest * 0.97, periods)


@pytest.mark.parametrize(("points", "options", "message"), [
    (np.empty((0, 2)), {}, "there are no points"),
    ([(1, 1), (1, 1)], {}, "all points lie in the same place: give a bandwidth"),
    ([(0, 0), (1, np.nan)], {}, "point 2 has a coordinate that is not a finite number"),
    ([(np.inf, 0), (1, 0)], {}, "point 1 has a coordinate"),
    ([(0, 0, 0), (1, 1, 1)], {}, "do not go together"),
    ([(0, 0), (1, 1)], {"bandwidth": 0}, "the bandwidth must be a positive number, not 0"),
    ([(0, 0), (1, 1)], {"bandwidth": -2}, "the bandwidth must be a positive number, not -2"),
    ([(0, 0), (1, 1)], {"bandwidth": np.nan}, "the bandwidth must be a positive number, not nan"),
    ([(0, 0), (1, 1)], {"bandwidth": 1e-5}, "too small for points that spread over 1 by 1"),
    ([(5e6, 0), (5e6, 1e-3)], {"bandwidth": 1e-3}, "too small to tell places apart at coordinates"),
    ([(0, 0), (1, 1)], {"levels": []}, "there are no levels"),
    ([(0, 0), (1, 1)], {"levels": [0.5, 1]}, "a level must be between 0 and 1, not 1"),
    ([(0, 0), (1, 1)], {"levels": [0.0]}, "a level must be between 0 and 1, not 0"),
    ([(0, 0), (1, 1)], {"levels": [np.nan]}, "a level must be between 0 and 1, not nan"),
    ([(0, 0), (1, 1)], {"levels": [0.5, 0.5]}, "a level is given twice"),
    ([(0, 0), (1, 1)], {"levels": [1e-7]}, "a level is too low: 1e-07 of the highest density"),
    ([(0, 0), (1, 1)], {"levels": [-3], "relative": False}, "a level must be a positive number"),
])  # fmt: skip
def test_what_cannot_be_contoured(points: Any, options: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        in_one(points, **{"levels": [0.5], "relative": True, **options})


def test_period_that_is_none() -> None:
    with pytest.raises(ValueError, match="point 2 lies in none of the 3 periods"):
        hotspots(np.eye(2), np.array([0, 3]), 3, levels=[0.5], relative=True)


def test_more_periods_than_any_grid_has_room_for() -> None:
    with pytest.raises(ValueError, match="1000000 periods are too many: at most"):
        grid_over(np.eye(2), 1.0, 1_000_000)
