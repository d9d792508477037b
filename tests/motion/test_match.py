"""Matching: equal counts, in proportion; the best rotation; holes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from shapely.geometry import Polygon, box

from geotween.data.polygons import Feature, polygon_set
from geotween.motion.correspond import correspond
from geotween.motion.divide import divide
from geotween.motion.match import MatchedPiece, match, points_at, rotation
from tests.motion.shapes import seeds, star

SQUARE = np.array([[0, 0], [4, 0], [4, 4], [0, 4]], dtype=float)


def ring(polygon: Polygon) -> NDArray[np.float64]:
    return np.array(polygon.exterior.coords[:-1])


def matched(one: Polygon, other: Polygon) -> MatchedPiece:
    related = correspond(polygon_set([Feature(one)]), polygon_set([Feature(other)]))
    (piece,) = match(divide(related)).pieces
    return piece


def test_abcd_to_abcd_stays_where_it_is() -> None:
    here, there = rotation(SQUARE, SQUARE)
    assert here.tolist() == there.tolist() == [0, 1, 2, 3]


def test_abcd_to_cdab_is_turned_back() -> None:
    here, there = rotation(SQUARE, np.roll(SQUARE, 2, axis=0))
    assert points_at(SQUARE, here).tolist() == SQUARE.tolist()
    assert points_at(np.roll(SQUARE, 2, axis=0), there).tolist() == SQUARE.tolist()


def test_abc_gets_vertices_in_proportion_to_its_edges() -> None:
    # Edges of 8, 6 and 10: nine new vertices are shared out 3, 2.25, 3.75, so 3, 2, 4.
    triangle = np.array([[0, 0], [8, 0], [8, 6]], dtype=float)
    circle = np.array([[np.cos(a), np.sin(a)] for a in np.linspace(0, 2 * np.pi, 13)[:-1]])
    here, _ = rotation(triangle, circle)
    assert np.bincount(here.astype(int)).tolist() == [4, 3, 5]
    first_edge = sorted(p for p in here if p < 1)
    assert first_edge == [0, 0.25, 0.5, 0.75]


def test_an_edge_of_no_length_gets_no_vertex() -> None:
    pinched = np.array([[0, 0], [4, 0], [4, 0], [4, 4]], dtype=float)
    here, _ = rotation(pinched, np.array(star(9, 1).exterior.coords[:-1]))
    assert np.bincount(here.astype(int), minlength=4)[1] == 1


@given(st.integers(3, 40), st.integers(3, 40), seeds)
def test_no_rotation_is_cheaper(n: int, m: int, seed: int) -> None:
    one, other = ring(star(n, seed)), ring(star(m, seed + 1, x=3))
    here, there = rotation(one, other)
    a, b = points_at(one, here), points_at(other, there)
    costs = [((a - np.roll(b, -s, axis=0)) ** 2).sum() for s in range(len(a))]
    assert len(a) == len(b) == max(n, m)
    assert costs[0] == pytest.approx(min(costs), rel=1e-9)


@given(st.integers(3, 40), st.integers(3, 40), seeds)
def test_every_vertex_is_kept_and_the_rest_lies_on_edges(n: int, m: int, seed: int) -> None:
    one, other = ring(star(n, seed)), ring(star(m, seed + 1))
    for places, vertices in zip(rotation(one, other), (one, other), strict=True):
        whole = places[places == np.floor(places)]
        assert sorted(whole) == list(range(len(vertices)))
        steps = np.diff(np.append(places, places[0])) % len(vertices)
        assert (steps > 0).all()
        assert steps.sum() == pytest.approx(len(vertices))


def test_holes_that_overlap_go_together() -> None:
    left, right = box(1, 1, 2, 2), box(6, 1, 7, 2)
    one = Polygon(box(0, 0, 8, 3).exterior, [left.exterior, right.exterior])
    moved = [box(5.5, 1, 6.5, 2).exterior, box(1.5, 1, 2.5, 2).exterior]
    piece = matched(one, Polygon(box(0, 0, 8, 3).exterior, moved))
    ways = piece.vertices[1] - piece.vertices[0]
    assert len(piece.offsets) == 4
    assert np.abs(ways).max() == pytest.approx(0.5)


def test_a_hole_without_partner_opens_from_a_point_inside_itself() -> None:
    hole = Polygon([(1, 1), (3, 1), (3, 3), (2.8, 1.2)])
    piece = matched(box(0, 0, 8, 8), Polygon(box(0, 0, 8, 8).exterior, [hole.exterior]))
    start = piece.vertices[0, piece.offsets[1] :]
    assert len(np.unique(start, axis=0)) == 1
    assert hole.contains(box(*start[0], *start[0]).centroid)


def test_a_hole_that_closes_is_the_reverse_of_one_that_opens() -> None:
    whole, holed = box(0, 0, 8, 8), Polygon(box(0, 0, 8, 8).exterior, [box(2, 2, 3, 3).exterior])
    opening, closing = matched(whole, holed), matched(holed, whole)
    assert np.array_equal(opening.vertices, closing.vertices[::-1])
