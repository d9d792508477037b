"""Contacts of moving edges: near pairs, quadratics, crossings, passing at a vertex."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from geotween.motion.contacts import between, crossings, turns, value
from geotween.motion.moving import Moving, near_edges
from geotween.motion.passages import overlapping, passages
from tests.motion.shapes import seeds

Floats = NDArray[np.float64]

SQUARE = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
NONE = np.empty(0)


def shifted(ring: Floats, x: float, y: float) -> Floats:
    return ring + np.array([x, y])


def moving(*rings: tuple[Floats, Floats]) -> Moving:
    """Rings, each a track of its own, between two key times."""
    places = np.concatenate([np.stack(ring) for ring in rings], axis=1)
    offsets = np.cumsum([0, *(len(start) for start, _ in rings)])
    return Moving.of(places, offsets, np.arange(len(rings)), 1e-10)


def scattered(count: int, seed: int) -> Moving:
    """Small triangles that fly about and turn over."""
    rng = np.random.default_rng(seed)
    middles = rng.uniform(0, 5, (2, count, 1, 2))
    corners = middles + rng.uniform(-0.5, 0.5, (2, count, 3, 2))
    return moving(*zip(corners[0], corners[1], strict=True))


@given(seeds)
def test_no_pair_that_crosses_is_overlooked(seed: int) -> None:
    layer = scattered(12, seed)
    one, other = np.triu_indices(len(layer.vertex), 1)
    near = set(zip(*(found.tolist() for found in near_edges(layer, NONE)), strict=True))
    for found in crossings(layer, one, other):
        deep = found.runs.deep
        pairs = zip(found.one[deep].tolist(), found.other[deep].tolist(), strict=True)
        assert near.issuperset(pairs)


@given(seeds)
def test_crossings_are_those_that_many_moments_show(seed: int) -> None:
    layer = scattered(6, seed)
    one, other = near_edges(layer, NONE)
    (found,) = crossings(layer, one, other)
    spans: dict[tuple[int, int], list[tuple[float, float]]] = {}
    for i, j, start, end in zip(
        found.one.tolist(), found.other.tolist(), found.runs.start, found.runs.end, strict=True
    ):
        spans.setdefault((i, j), []).append((start, end))

    def left(a: Floats, b: Floats, c: Floats) -> bool:
        return bool((b[0] - a[0]) * (c[1] - a[1]) > (b[1] - a[1]) * (c[0] - a[0]))

    for t in np.linspace(0, 1, 60)[1:-1]:
        at = layer.at(float(t))[layer.vertex]
        for i, j in zip(one.tolist(), other.tolist(), strict=True):
            if layer.ring[i] == layer.ring[j]:
                continue  # edges of a triangle share a corner
            a, b, c, d = at[[i, layer.following[i], j, layer.following[j]]]
            crossing = left(a, b, c) != left(a, b, d) and left(c, d, a) != left(c, d, b)
            told = any(start < t < end for start, end in spans.get((i, j), []))
            assert crossing == told


def test_edges_that_travel_together_are_few_pairs() -> None:
    angles = 2 * np.pi * np.arange(500) / 500
    ring = np.column_stack([np.cos(angles), np.sin(angles)])
    one, _ = near_edges(moving((ring, 3 * ring + [40, 7])), NONE)
    assert len(one) < 3 * len(ring)


def test_edges_that_grow_out_of_a_point_are_few_pairs() -> None:
    angles = 2 * np.pi * np.arange(500) / 500
    ring = np.column_stack([np.cos(angles), np.sin(angles)])
    one, _ = near_edges(moving((0 * ring + [0.3, 0.1], ring)), NONE)
    assert len(one) < 3 * len(ring)


@pytest.mark.parametrize(
    ("coefficients", "roots"),
    [
        ([1, -1, 1], [0.5]),  # (1 - 2t)², once
        ([-1, 0, 1], [0.5]),  # a straight line
        ([-1, 5, -1], [0.5 - np.sqrt(1 / 6), 0.5 + np.sqrt(1 / 6)]),
        ([1e-20, -1, -1], [0.0]),  # all but touching at the start
        ([0, 0, 1], [0.0]),
    ],
)
def test_roots(coefficients: list[float], roots: list[float]) -> None:
    q = np.array(coefficients, dtype=float)[:, None]
    found = turns(q)
    for root in roots:
        assert np.abs(found - root).min() <= 1e-9
    assert np.abs(value(q, np.array([roots]))).max() <= 1e-9


@given(st.lists(st.floats(-1, 1), min_size=3, max_size=3))
def test_between_two_events_a_quadratic_keeps_its_sign(coefficients: list[float]) -> None:
    q = np.array(coefficients)[:, None]
    times, moments = between(q[None])
    for start, end, moment in zip(times[0, :-1], times[0, 1:], moments[0], strict=True):
        if end - start < 1e-6:
            continue
        inner = value(q, np.linspace(start, end, 11)[None, 1:-1])
        middle = value(q, np.array([[moment]]))[0, 0]
        assert (inner * np.sign(middle) >= -1e-12).all()
        assert np.abs(inner).max() <= 4 * abs(middle) + 1e-9


def test_vertices_that_move_alike_are_one() -> None:
    layer = moving((SQUARE, shifted(SQUARE, 2, 0)), (shifted(SQUARE, 1, 0), shifted(SQUARE, 3, 0)))
    assert layer.places.shape == (2, 6, 2)
    assert len(layer.vertex) == 8


def test_vertices_that_move_alike_but_for_rounding_are_one() -> None:
    rough = shifted(SQUARE, 1 + 3e-16, -2e-16)
    layer = moving((SQUARE, SQUARE), (rough, rough))
    assert len(np.unique(layer.vertex)) == 6


def test_vertices_that_meet_at_one_end_only_are_two() -> None:
    layer = moving((SQUARE, SQUARE), (shifted(SQUARE, 1, 0), shifted(SQUARE, 2, 0)))
    assert layer.places.shape == (2, 8, 2)


def test_a_corner_that_repeats_the_one_before_goes() -> None:
    ring = SQUARE[[0, 0, 1, 2, 2, 2, 3]]
    assert len(moving((ring, ring)).vertex) == 4


def passing(*rings: tuple[Floats, Floats]) -> list[tuple[float, float]]:
    layer = moving(*rings)
    (found,) = crossings(layer, *near_edges(layer, NONE))
    runs, _, _ = overlapping(layer, passages(layer, found.corner, found.edge))
    return sorted(set(zip(runs.start.tolist(), runs.end.tolist(), strict=True)))


def test_squares_that_share_a_corner_do_not_pass() -> None:
    assert passing((SQUARE, SQUARE), (SQUARE + 1, SQUARE + 1)) == []


def test_squares_that_share_an_edge_do_not_pass() -> None:
    beside = shifted(SQUARE, 1, 0)
    assert passing((SQUARE, SQUARE), (beside, beside)) == []


def test_a_half_of_an_edge_that_is_shared_does_not_pass() -> None:
    small = shifted(SQUARE / 2, 1, 0.2)
    assert passing((SQUARE, SQUARE), (small, small)) == []


def test_a_small_square_in_a_corner_of_a_large_one_passes() -> None:
    assert passing((SQUARE, SQUARE), (SQUARE / 2, SQUARE / 2)) == [(0, 1)]


def test_a_small_square_inside_an_edge_passes() -> None:
    small = shifted(SQUARE / 2, 0.2, 0)
    assert passing((SQUARE, SQUARE), (small, small)) == [(0, 1)]


def test_a_triangle_that_swings_round_its_corner_into_its_neighbour() -> None:
    # Its lower edge goes from 45° above the shared edge to as far below it: level half-way.
    neighbour = np.array([[0, 0], [0, -2], [2, -2], [2, 0]], dtype=float)
    above = np.array([[0, 0], [1, 1], [0, 1]], dtype=float)
    below = np.array([[0, 0], [1, -1], [0, 1]], dtype=float)
    (span,) = passing((neighbour, neighbour), (above, below))
    assert span == pytest.approx((0.5, 1), abs=1e-12)
