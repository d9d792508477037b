"""Matching by least trajectory cost: corners, common boundary, every vertex, any start."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely.geometry import Polygon, box

from geotween.motion.match import points_at
from geotween.motion.rings import Vertices
from geotween.motion.trajectory import trajectory
from tests.motion.shapes import seeds, star

SQUARE = np.array([[0, 0], [4, 0], [4, 4], [0, 4]], dtype=float)
ELL = np.array([[0, 0], [6, 0], [6, 2], [2, 2], [2, 5], [0, 5]], dtype=float)


def ring(polygon: Polygon) -> Vertices:
    return np.array(shapely.orient_polygons(polygon).exterior.coords[:-1])


def turned(vertices: Vertices, degrees: float) -> Vertices:
    a = np.radians(degrees)
    return np.asarray(vertices @ [[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]])


def partner(one: Vertices, other: Vertices) -> dict[int, float]:
    """For each vertex of one ring the place of its partner in the other."""
    here, there = trajectory(one, other)
    return {int(p): float(q) for p, q in zip(here, there, strict=True) if p % 1 == 0}


def ways(one: Vertices, other: Vertices) -> Vertices:
    """Matched points of both ends, as rows (x, y, x', y') in an order of their own."""
    here, there = trajectory(one, other)
    rows = np.hstack([points_at(one, here), points_at(other, there)])
    return rows[np.lexsort(rows.round(6).T)]


def notched(seed: int) -> tuple[Vertices, Vertices]:
    """A rough outline, and the same with some of its boundary grown outwards."""
    one = ring(star(60, seed))
    other = one.copy()
    other[10:25] *= 1.3
    other[40:44] *= 1.2
    return one, np.delete(other, [12, 15, 41], axis=0)


def test_corners_go_to_corners_past_vertices_on_edges() -> None:
    other = np.array([[1, 0], [2, 0], [4, 0], [4, 1], [4, 2], [4, 3], [4, 4], [0, 4], [0, 0]])
    assert partner(SQUARE, other * 1.2 + 0.3) == {0: 8, 1: 2, 2: 6, 3: 7}


@pytest.mark.parametrize("degrees", [-20, -5, 5, 20])
def test_corners_of_an_l_that_turns_go_to_its_corners(degrees: float) -> None:
    assert partner(ELL, turned(ELL, degrees)) == {k: k for k in range(6)}


def test_what_travels_keeps_its_shape() -> None:
    assert partner(ELL, ELL + np.array([100, 70])) == {k: k for k in range(6)}


def test_a_bump_grows_out_of_its_own_edge() -> None:
    bump = np.array([[0, 0], [4, 0], [4, 4], [3, 4], [2, 7], [1, 4], [0, 4]], dtype=float)
    moved = ways(SQUARE, bump)
    moved = moved[(moved[:, :2] != moved[:, 2:]).any(axis=1)]
    assert len(moved) == 1
    assert moved[0].tolist() == pytest.approx([2, 4, 2, 7], abs=0.05)


def same(vertices: Vertices) -> Vertices:
    return vertices


def mirrored(vertices: Vertices) -> Vertices:
    return vertices[::-1] * [-1, 1]


@pytest.mark.parametrize("change", [same, mirrored, lambda v: turned(v, 37), lambda v: v * 1e9])
@pytest.mark.parametrize("seed", range(4))
def test_common_boundary_does_not_move(change: Callable[[Vertices], Vertices], seed: int) -> None:
    one, other = (change(vertices) for vertices in notched(seed))
    common = shapely.intersection(Polygon(one).exterior, Polygon(other).exterior).length
    assert common > 0
    for origin, target in ((one, other), (other, one)):
        here, there = trajectory(origin, target)
        a, b = points_at(origin, here), points_at(target, there)
        still = np.abs(a - b).max(axis=1) <= 1e-15 * np.abs(a).max()
        still &= np.roll(still, -1)
        unmoved = np.hypot(*(np.roll(a, -1, axis=0) - a)[still].T).sum()
        assert unmoved == pytest.approx(common)


@pytest.mark.parametrize("seed", range(4))
def test_vertices_on_the_edges_of_one_side_do_not_move_common_boundary(seed: int) -> None:
    one, other = notched(seed)
    finer = shapely.segmentize(Polygon(one), 0.03)
    here, there = trajectory(ring(finer), other)
    a, b = points_at(ring(finer), here), points_at(other, there)
    apart = shapely.distance(shapely.points(a), Polygon(other).exterior) > 1e-9
    apart |= shapely.distance(shapely.points(b), Polygon(one).exterior) > 1e-9
    still = np.abs(a - b).max(axis=1) < 1e-14
    assert still.sum() > 100
    # A point common to both either stays, or is where an arc that moves crosses the other ring.
    assert (still | apart).mean() > 0.97


@given(st.integers(3, 40), st.integers(3, 40), seeds, st.sampled_from([0.0, 0.7, 30.0]))
def test_every_vertex_is_kept_and_the_rest_lies_on_edges(
    n: int, m: int, seed: int, x: float
) -> None:
    one, other = ring(star(n, seed)), ring(star(m, seed + 1, x=x))
    here, there = trajectory(one, other)
    assert len(here) == len(there) <= n + m
    for places, vertices in zip((here, there), (one, other), strict=True):
        assert sorted(places[places == np.floor(places)]) == list(range(len(vertices)))
        steps = np.diff(np.append(places, places[0])) % len(vertices)
        assert (steps > 0).all()
        assert steps.sum() == pytest.approx(len(vertices))


@given(seeds, st.integers(0, 59), st.integers(0, 56), st.booleans())
def test_it_does_not_matter_where_the_rings_start(s: int, k: int, m: int, pinned: bool) -> None:
    one, other = notched(s)
    if not pinned:
        other = turned(other, 10) + 0.1
    rolled = ways(np.roll(one, k, axis=0), np.roll(other, m, axis=0))
    assert np.allclose(ways(one, other), rolled, atol=1e-9)


@given(seeds, st.booleans())
def test_back_is_the_same_way(seed: int, pinned: bool) -> None:
    one, other = notched(seed)
    if not pinned:
        other = turned(other, 10) + 0.1
    there = ways(one, other)
    back = ways(other, one)[:, [2, 3, 0, 1]]
    assert np.allclose(there, back[np.lexsort(back.round(6).T)], atol=1e-9)


@pytest.mark.parametrize("factor", [1e-9, 1e9])
def test_a_scale_changes_nothing(factor: float) -> None:
    one, other = ring(star(30, 1)), ring(star(25, 2, x=0.3))
    here, there = trajectory(one, other)
    again = trajectory(one * factor, other * factor)
    assert np.allclose(here, again[0])
    assert np.allclose(there, again[1])


def test_a_ring_onto_itself_moves_nothing() -> None:
    for vertices in (ELL, ring(star(50, 3)), ring(box(0, 0, 1, 1))):
        assert partner(vertices, vertices) == {k: k for k in range(len(vertices))}


@pytest.mark.parametrize("seed", range(5))
def test_no_frame_of_a_grown_outline_crosses_itself(seed: int) -> None:
    one, other = notched(seed)
    here, there = trajectory(one, other)
    a, b = points_at(one, here), points_at(other, there)
    assert all(Polygon((1 - t) * a + t * b).is_valid for t in np.linspace(0, 1, 51))
