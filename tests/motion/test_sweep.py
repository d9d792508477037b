"""The proof over continuous time: known cases, a dense search, and what must not matter."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import ArrayLike, NDArray

from geotween.data.polygons import Identity
from geotween.motion.looks import polygons_at
from geotween.motion.sweep import Proof, sweep
from geotween.motion.tracks import Track
from tests.motion.shapes import blobs, hulls, seeds, star, tiles, travelled

Floats = NDArray[np.float64]

SQUARE = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
HOLE = (SQUARE * 0.2 + 0.4)[::-1]
TURN = np.array([[0.8, 0.6], [-0.6, 0.8]])
NOBODY = Identity("a")


def track(
    *keys: ArrayLike, offsets: Sequence[int] = (), times: Sequence[float] | None = None
) -> Track:
    vertices = np.array(keys, dtype=float)
    count = vertices.shape[1]
    return Track(
        NOBODY,
        (NOBODY, NOBODY),
        "regions",
        np.linspace(0, 1, len(keys)) if times is None else np.array(times),
        vertices,
        np.array(offsets or [0, count]),
        np.zeros(count, dtype=np.uint8),
    )


def shifted(ring: Floats, x: float, y: float) -> Floats:
    return ring + np.array([x, y])


def still(ring: Floats) -> Track:
    return track(ring, ring)


Told = list[tuple[str, tuple[int, ...], float, float]]


def told(proof: Proof) -> Told:
    assert not proof.undecided
    return [(v.kind, v.tracks, v.start, v.end) for v in proof.violations]


def one(*tracks: Track) -> tuple[str, tuple[int, ...], float, float]:
    (violation,) = told(sweep(tracks))
    return violation


def about(start: float, end: float) -> tuple[float, float]:
    return pytest.approx((start, end), abs=1e-9)


# What is clean.


def test_nothing_and_what_stays() -> None:
    assert told(sweep([])) == told(sweep([still(SQUARE)])) == []


def test_birth_at_a_point_and_death_into_one() -> None:
    point = np.full((4, 2), 0.3)
    assert told(sweep([track(point, SQUARE)])) == told(sweep([track(SQUARE, point)])) == []


def test_a_hole_that_opens_from_a_point() -> None:
    closed = np.vstack([SQUARE, np.full((4, 2), 0.5)])
    assert told(sweep([track(closed, np.vstack([SQUARE, HOLE]), offsets=[0, 4, 8])])) == []


def test_a_birth_that_comes_late() -> None:
    point = np.full((4, 2), 0.5)
    assert told(sweep([track(point, point, SQUARE, times=[0, 0.5, 1])])) == []


@pytest.mark.parametrize("turn", [np.eye(2), TURN])
def test_sliding_along_a_wall(turn: Floats) -> None:
    slider = track((shifted(SQUARE, 1, -3)) @ turn, (shifted(SQUARE, 1, 3)) @ turn)
    assert told(sweep([still(SQUARE @ turn), slider])) == []


@pytest.mark.parametrize("turn", [np.eye(2), TURN])
def test_vertices_that_pass_each_other_on_a_common_border(turn: Floats) -> None:
    left = np.array([[0, 0], [2, 0], [2, 1], [2, 2], [2, 4], [0, 4]], dtype=float)
    right = np.array([[2, 0], [4, 0], [4, 4], [2, 4], [2, 3], [2, 2.5]], dtype=float)
    down = left + np.array([0, 0, 1.7, 1.9, 0, 0])[:, None] * [0, 1]
    up = right - np.array([0, 0, 0, 0, 1.9, 1.7])[:, None] * [0, 1]
    assert told(sweep([track(left @ turn, down @ turn), track(right @ turn, up @ turn)])) == []


def test_a_tiling_whose_inner_borders_move() -> None:
    rng = np.random.default_rng(3)
    corners = np.stack(np.meshgrid(np.arange(6.0), np.arange(6.0), indexing="ij"), axis=-1)
    moved = corners.copy()
    moved[1:-1, 1:-1] += rng.uniform(-0.3, 0.3, (4, 4, 2))
    cells = [
        track(*([c[i, j], c[i + 1, j], c[i + 1, j + 1], c[i, j + 1]] for c in (corners, moved)))
        for i in range(5)
        for j in range(5)
    ]
    assert told(sweep(cells)) == []


@pytest.mark.parametrize("way", [[1, 0], [1, 5], [0, 0.3]])
def test_a_seam_that_opens(way: list[float]) -> None:
    beside = shifted(SQUARE, 1, 0)
    assert told(sweep([still(SQUARE), track(beside, beside + way)])) == []
    assert told(sweep([still(SQUARE), track(beside + way, beside)])) == []


def test_a_hole_that_touches_the_rim_at_a_vertex() -> None:
    hole = np.array([[0, 0.0], [0.2, 0.6], [0.6, 0.2]])
    both = np.vstack([SQUARE, hole])
    assert told(sweep([track(both, both @ TURN, offsets=[0, 4, 7])])) == []


def test_an_island_in_a_lake() -> None:
    lake = track(*[np.vstack([SQUARE, HOLE])] * 2, offsets=[0, 4, 8])
    assert told(sweep([lake, still(HOLE[::-1]), still(shifted(SQUARE, 1, 0))])) == []


# What is wrong, and when.


def test_squares_that_swap_places() -> None:
    left, right = SQUARE, shifted(SQUARE, 2, 0)
    assert one(track(left, right), track(right, left)) == ("overlap", (0, 1), 0.25, 0.75)


def test_a_square_that_turns_inside_out() -> None:
    kind, tracks, *span = one(track(SQUARE, SQUARE * [-1, 1]))
    assert (kind, tracks, tuple(span)) == ("self-crossing", (0,), about(0.5, 1))


def test_a_square_that_spins_half_round_shrinks_to_a_point() -> None:
    kind, _, *span = one(track(SQUARE - 0.5, 0.5 - SQUARE))
    assert (kind, tuple(span)) == ("self-touch", about(0.5, 0.5))


def test_a_hole_that_pierces_the_rim() -> None:
    start, end = np.vstack([SQUARE, HOLE]), np.vstack([SQUARE, shifted(HOLE, 0.5, 0)])
    kind, _, *span = one(track(start, end, offsets=[0, 4, 8]))
    assert (kind, tuple(span)) == ("self-crossing", about(0.8, 1))


def test_a_hole_that_leaves_stays_wrong_outside() -> None:
    start, end = np.vstack([SQUARE, HOLE]), np.vstack([SQUARE, shifted(HOLE, 4, 0)])
    kind, _, *span = one(track(start, end, offsets=[0, 4, 8]))
    assert (kind, tuple(span)) == ("self-crossing", about(0.1, 1))


def test_a_tiny_hole_that_opens_outside_of_a_ring_that_crosses_itself_later() -> None:
    tie, tiny = SQUARE[[0, 1, 3, 2]], (HOLE - 0.5) * 1e-4 + 1.5
    keys = ((SQUARE, np.full((4, 2), 1.5)), (SQUARE, tiny), (tie, tiny))
    kind, _, *span = one(track(*(np.vstack(key) for key in keys), offsets=[0, 4, 8]))
    assert (kind, tuple(span)) == ("self-crossing", about(0, 1))


def test_two_holes_that_meet() -> None:
    low, high = shifted(HOLE * 0.5, 0, 0.3), shifted(HOLE * 0.5, 0.5, 0.3)
    start, end = np.vstack([SQUARE, low, high]), np.vstack([SQUARE, high, shifted(high, 0, 1e-3)])
    kind, _, *span = one(track(start, end, offsets=[0, 4, 8, 12]))
    assert (kind, span[1]) == ("self-crossing", 1)
    assert span[0] == pytest.approx(0.8, abs=1e-3)


def test_a_crescent_whose_tip_crosses_its_back() -> None:
    crescent = np.array([[0, 0], [4, 0], [4, 4], [3, 1], [1, 1]], dtype=float)
    bent = crescent.copy()
    bent[2] = [2, -2]  # the tip travels down, through the edge at y = 0
    kind, _, *span = one(track(crescent, bent))
    assert (kind, tuple(span)) == ("self-crossing", about(2 / 3, 1))


def test_passing_through_from_side_to_side() -> None:
    small = shifted(SQUARE, -3, 3.3)
    kind, tracks, *span = one(still(SQUARE * 9), track(small, shifted(small, 15, 0)))
    assert (kind, tracks, tuple(span)) == ("overlap", (0, 1), about(2 / 15, 12 / 15))


def test_birth_inside_another() -> None:
    born = track(np.full((4, 2), 0.5), SQUARE * 0.5 + 0.25)
    (violation,) = sweep([still(SQUARE), born]).violations
    assert (violation.start, violation.end) == (0, 1)
    assert violation.area == pytest.approx(0.25 * 0.75**2)
    assert 0.25 < violation.place[0] < 0.75


def test_neighbours_that_overlap_right_after_the_start() -> None:
    beside = shifted(SQUARE, 1, 0)
    assert one(track(SQUARE, shifted(SQUARE, 0.1, 0)), still(beside))[2:] == about(0, 1)
    assert one(track(shifted(SQUARE, 0.1, 0), SQUARE), still(beside))[2:] == about(0, 1)


def test_the_same_twice() -> None:
    assert one(track(SQUARE, SQUARE + 1), track(SQUARE, SQUARE + 1))[2:] == (0, 1)


def test_a_spike_is_not_simple() -> None:
    spiked = np.vstack([SQUARE, [[0, 2], [0, 1]]])
    assert one(still(spiked))[0] == "self-touch"


def test_touching_itself_for_a_moment() -> None:
    # A notch whose tip reaches the bottom edge half-way and comes back.
    notched = np.array([[0, 0], [4, 0], [4, 2], [2, 1], [0, 2]], dtype=float)
    reached = notched.copy()
    reached[3] = [2, 0]
    kind, _, *span = one(track(notched, reached, notched))
    assert (kind, tuple(span)) == ("self-touch", about(0.5, 0.5))


def test_several_key_times() -> None:
    away, over = shifted(SQUARE, 3, 0), shifted(SQUARE, 0.5, 0)
    kind, _, *span = one(still(SQUARE), track(away, over, away, times=[0, 0.4, 1]))
    assert (kind, tuple(span)) == ("overlap", about(0.32, 0.52))


def test_too_far_from_the_origin_is_undecided() -> None:
    proof = sweep([track(SQUARE + 1e14, SQUARE + 1e14 + 3)])
    assert proof.undecided


# What must not matter.


def spoiled(seed: int) -> list[Track]:
    """Some stars; their vertices travel to those of others, in any rotation."""
    rng = np.random.default_rng(seed)
    found = []
    for k in range(3):
        count = int(rng.integers(3, 12))
        start, end = (
            np.array(star(count, seed * 10 + k + m, 1.0, *rng.uniform(0, 2, 2)).exterior.coords)
            for m in (0, 5)
        )
        found.append(track(start[:-1], np.roll(end[:-1], int(rng.integers(count)), axis=0)))
    return found


def changed(tracks: Sequence[Track], change: object) -> list[Track]:
    assert callable(change)
    return [replace(t, vertices=change(t.vertices)) for t in tracks]


def assert_same(proof: Proof, other: Proof) -> None:
    one, two = told(proof), told(other)
    assert [(kind, tracks) for kind, tracks, *_ in sorted(one)] == [
        (kind, tracks) for kind, tracks, *_ in sorted(two)
    ]
    for (*_, start, end), (*_, first, last) in zip(sorted(one), sorted(two), strict=True):
        assert (start, end) == pytest.approx((first, last), abs=1e-7)


@given(seeds)
def test_rotated_shifted_and_rescaled(seed: int) -> None:
    tracks = spoiled(seed)
    proof = sweep(tracks)
    assert_same(proof, sweep(changed(tracks, lambda v: v @ TURN + [7, -3])))
    assert_same(proof, sweep(changed(tracks, lambda v: v * 1e9)))
    assert_same(proof, sweep(changed(tracks, lambda v: v * 1e-9)))


@given(seeds)
def test_reflected(seed: int) -> None:
    tracks = spoiled(seed)
    mirrored = changed(tracks, lambda v: (v * [-1, 1])[:, ::-1])
    assert_same(sweep(tracks), sweep(mirrored))


@given(seeds)
def test_time_reversed(seed: int) -> None:
    tracks = spoiled(seed)
    proof = sweep(tracks)
    mirrored = tuple(replace(v, start=1 - v.end, end=1 - v.start) for v in proof.violations)
    assert_same(replace(proof, violations=mirrored), sweep(changed(tracks, lambda v: v[::-1])))


@given(seeds)
def test_tracks_in_another_order(seed: int) -> None:
    tracks = spoiled(seed)
    proof = sweep(tracks)
    turned = tuple(
        replace(v, tracks=tuple(sorted(2 - k for k in v.tracks))) for v in proof.violations
    )
    assert_same(replace(proof, violations=turned), sweep(tracks[::-1]))


@given(seeds, st.integers(1, 3))
def test_more_key_times_on_the_same_lines(seed: int, inner: int) -> None:
    tracks = spoiled(seed)
    times = np.linspace(0, 1, inner + 2) ** 1.3
    halved = [
        replace(t, times=times, vertices=np.stack([t.at(float(s)) for s in times])) for t in tracks
    ]
    assert_same(sweep(tracks), sweep(halved))


# Against a dense search.

FRAMES = 101
SLACK = 1e-6


def wrongs(tracks: Sequence[Track], t: float, share: float) -> set[tuple[int, ...]]:
    """Tracks invalid or inverted at t, and pairs that share more than so much of the smaller."""
    polygons = polygons_at(tracks, t)
    oriented = shapely.is_ccw(shapely.get_exterior_ring(polygons)) | shapely.is_empty(polygons)
    found = {(k,) for k in np.flatnonzero(~shapely.is_valid(polygons) | ~oriented).tolist()}
    rebuilt = shapely.make_valid(polygons)
    i, j = shapely.STRtree(rebuilt).query(rebuilt)
    i, j = i[i < j], j[i < j]
    common = shapely.area(shapely.intersection(rebuilt[i], rebuilt[j]))
    least = share * np.minimum(*shapely.area(np.stack([rebuilt[i], rebuilt[j]])))
    return found | set(zip(*(k[common > least].tolist() for k in (i, j)), strict=True))


def assert_agrees_with_frames(tracks: Sequence[Track], both_ways: bool = True) -> None:
    violations = sweep(tracks).violations
    for t in np.linspace(0, 1, FRAMES)[1:-1].tolist():
        seen = wrongs(tracks, t, 1e-9)
        assert seen <= {v.tracks for v in violations if v.start - SLACK <= t <= v.end + SLACK}
    if not both_ways:
        return
    for v in violations:
        inside = [s for s in (v.start + SLACK, v.end - SLACK) if v.start < s < v.end and 0 < s < 1]
        for t in inside:
            assert v.tracks in wrongs(tracks, t, 0)


@given(seeds)
def test_stars_in_any_rotation_agree_with_frames(seed: int) -> None:
    assert_agrees_with_frames(spoiled(seed))


@given(st.sampled_from([blobs, tiles, hulls]), st.sampled_from([blobs, tiles, hulls]), seeds)
def test_morphs_agree_with_frames(origin: object, target: object, seed: int) -> None:
    assert callable(origin)
    assert callable(target)
    morph = travelled(origin(1 + seed % 5, seed), target(1 + seed % 4, seed + 1))
    assert_agrees_with_frames(morph.tracks, both_ways=False)


@given(st.integers(4, 30), seeds)
def test_what_is_clean_is_clean_in_all_frames(count: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    start = np.array(star(count, seed).exterior.coords)[:-1]
    tracks = [track(start, start * rng.uniform(0.7, 1.3, (count, 1)))]
    if not sweep(tracks).violations:
        assert not any(wrongs(tracks, t, 0) for t in np.linspace(0, 1, 201).tolist())


@pytest.mark.parametrize("shape", [blobs, tiles, hulls])
def test_sets_that_grow_stay_clean(shape: object) -> None:
    assert callable(shape)
    polygons = shape(6, 11)
    rings = [shapely.get_rings(polygon) for polygon in polygons]
    offsets = [np.cumsum([0, *(len(r.coords) - 1 for r in mine)]).tolist() for mine in rings]
    places = [np.vstack([np.array(r.coords)[:-1] for r in mine]) for mine in rings]
    oriented = [shapely.orient_polygons(p, exterior_cw=False) for p in polygons]
    places = [np.vstack([np.array(r.coords)[:-1] for r in shapely.get_rings(p)]) for p in oriented]
    tracks = [
        track(p, 2 * p @ TURN + [3, 1], offsets=o) for p, o in zip(places, offsets, strict=True)
    ]
    assert told(sweep(tracks)) == []
