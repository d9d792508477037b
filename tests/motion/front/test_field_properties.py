"""Properties of arrival fields: symmetries, any tiling, and fires whose arrival is known."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.motion.front.fires import likeness, pair, signed_distance
from tests.motion.front.test_field import areas_of, field_of, hangs_together, swept

BOX = shapely.box(0, 0, 1, 1)


def tiling(seeds):
    cells = shapely.voronoi_polygons(
        shapely.MultiPoint(seeds), extend_to=shapely.box(-2, -2, 3, 3), ordered=True
    )
    return dict(enumerate(shapely.intersection(shapely.get_parts(cells), BOX)))


def sampled(field, places):
    """The field at places (n, 2), NaN where nothing changes or at a pivot's triangle."""
    corners = field.points[field.triangles]
    tree = shapely.STRtree(shapely.polygons(corners))
    place, triangle = tree.query(shapely.points(places), predicate="intersects")
    start, one, other = corners[triangle].transpose(1, 0, 2)
    way = np.linalg.solve(
        np.stack([one - start, other - start], axis=2), (places[place] - start)[..., None]
    )
    share = way[..., 0]
    times = field.times[triangle]
    found = np.full(len(places), np.nan)
    found[place] = times[:, 0] + ((times[:, 1:] - times[:, :1]) * share).sum(axis=1)
    return found


def places_in(shape, count=60):
    low, high = np.split(np.array(shape.bounds), 2)
    grid = (np.indices((count, count)).reshape(2, -1).T + 0.5) / count
    return low + grid * (high - low)


@pytest.fixture(scope="module")
def fire():
    origin, target, _ = pair(4, 80)
    return origin, target, places_in(target)


def times_of(origin, target, places):
    _, field = field_of({"f": origin}, {"f": target})
    return sampled(field, places)


def turned(angle):
    return np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


@pytest.mark.parametrize(
    "matrix",
    [turned(np.pi / 2), turned(0.4), np.diag([-1.0, 1.0]), 1e9 * np.eye(2), 1e-9 * np.eye(2)],
    ids=["quarter turn", "turn", "mirror", "1e9", "1e-9"],
)
def test_fronts_turn_and_grow_with_the_data(fire, matrix):
    origin, target, places = fire
    there = [shapely.transform(shape, lambda points: points @ matrix) for shape in (origin, target)]
    plain, other = times_of(*fire), times_of(*there, places @ matrix)
    both = ~np.isnan(plain) & ~np.isnan(other)
    assert both.sum() >= 0.99 * (~np.isnan(plain)).sum()
    assert np.abs(plain - other)[both].mean() < 0.01


def test_a_fire_that_shrinks_is_one_that_grows_backwards(fire):
    origin, target, places = fire
    assert times_of(target, origin, places) == pytest.approx(
        1 - times_of(*fire), abs=0.02, nan_ok=True
    )


def test_half_way_fires_are_nearer_the_truth_than_by_signed_distance():
    better = []
    for seed in range(4):
        origin, target, truth = pair(seed)
        places = places_in(target, 120)
        real = shapely.contains_xy(truth, *places.T)
        burnt = shapely.contains_xy(origin, *places.T)
        _, field = field_of({"f": origin}, {"f": target})
        front = burnt | (sampled(field, places) < 0.5)
        middle = signed_distance(origin, places) + signed_distance(target, places)
        plain = middle < np.quantile(middle, real.mean())
        better.append(likeness(front, real) - likeness(plain, real))
    assert np.mean(better) > 0.005


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    count=st.integers(2, 12),
    move=st.sampled_from([0.01, 0.1, 0.5]),
)
def test_any_tiling_changes_soundly(seed, count, move):
    random = np.random.default_rng(seed)
    seeds = random.random((count, 2))
    there = np.mod(seeds + move * random.normal(size=(count, 2)), 1.0)
    origin, target = (
        {f"k{key}": cell for key, cell in tiling(of).items()} for of in (seeds, there)
    )
    change, field = field_of(origin, target)
    assert areas_of(field).min() > 0
    changing = change.region >= 0
    regions = np.bincount(change.region[changing], shapely.area(change.plane.faces[changing]))
    assert np.bincount(field.region, areas_of(field)) == pytest.approx(regions, rel=1e-11)
    assert np.nanmin(field.times) >= 0
    assert np.nanmax(field.times) <= 1
    assert np.isnan(field.times).sum(axis=1).max() <= 1
    for level in (0.25, 0.5, 0.75):
        assert hangs_together(change, 1 - field.times, level, "losses")


def test_again_gives_the_same_bytes():
    pairs = [field_of(tiling_, moved) for _ in range(2) for tiling_, moved in [TILES]]
    (_, one), (_, other) = pairs
    assert one.times.tobytes() == other.times.tobytes()
    assert one.points.tobytes() == other.points.tobytes()


def test_the_order_of_polygons_does_not_matter():
    origin, target = TILES
    _, one = field_of(origin, target)
    _, other = field_of(dict(reversed(origin.items())), dict(reversed(target.items())))
    places = places_in(BOX)
    plain, turned_ = sampled(one, places), sampled(other, places)
    assert np.nanmean(np.abs(plain - turned_)) < 1e-3
    assert np.array_equal(np.isnan(plain), np.isnan(turned_))


def test_all_tiles_together_sweep_evenly():
    _, field = field_of(*TILES)
    for time in np.linspace(0.1, 0.9, 9):
        assert swept(field, time) == pytest.approx(time, abs=0.01)


TILES = tuple(
    {f"k{key}": cell for key, cell in tiling(np.random.default_rng(5).random((9, 2)) + way).items()}
    for way in (0.0, 0.03)
)
