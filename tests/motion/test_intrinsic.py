"""Intrinsic paths: bands unroll, corners unfold, and what cannot be closed gives way."""

from __future__ import annotations

import numpy as np
import pytest

from geotween.motion.paths import (
    OPEN,
    TOUCHING,
)
from geotween.motion.sweep import sweep
from tests.motion.ways import (
    SQUARE,
    TIMES,
    area,
    at,
    comb,
    outline,
    piece,
    proof,
    shifted,
    spiral,
    track,
    turned,
    way,
)


def test_a_spiral_unrolls_on_an_intrinsic_path() -> None:
    matched = piece(spiral(2.2), shifted(spiral(0.1), 1, 0))
    for technique in ("straight", "rigid"):
        assert not proof(matched, technique).clean
    path = way(matched, "intrinsic")
    assert sweep([track(path, matched)]).clean
    for places in path.places:
        across = np.hypot(*(places[:60] - places[:59:-1]).T)
        assert np.allclose(across, 0.3, rtol=0.15)


def test_a_corner_unfolds_into_edges_and_folds_again() -> None:
    triangle = np.array([[0, 0], [2, 0], [2, 0], [2, 0], [1, 2]], dtype=float)
    cut = np.array([[0, 0], [1.5, -0.3], [1.9, 0.2], [1.8, 0.6], [1, 2]], dtype=float)
    for one, other in ((triangle, cut), (cut, triangle), (triangle, turned(cut, 130))):
        matched = piece(one, other)
        path = way(matched, "intrinsic")
        assert not path.gave_way
        assert (path.places[[0, -1]] == matched.vertices).all()
        assert sweep([track(path, matched)]).clean
        assert np.hypot(*np.diff(at(path, TIMES), axis=0).reshape(-1, 2).T).max() < 0.03
        for start in range(1, 5):
            other = way(piece(*np.roll(matched.vertices, start, axis=1)), "intrinsic")
            assert np.allclose(other.places, np.roll(path.places, start, axis=1))


def test_vertices_added_along_edges_change_nothing() -> None:
    one, other = comb(), turned(comb() * [1, 1.4], 60)
    path = way(piece(one, other), "intrinsic")
    added = [
        np.insert(ring, 4, ring[3] + 0.3 * (ring[4] - ring[3]), axis=0) for ring in (one, other)
    ]
    finer = way(piece(*added), "intrinsic")
    assert np.allclose(at(path, TIMES), np.delete(at(finer, TIMES), 4, axis=1), atol=1e-9)


def test_size_changes_linearly_on_an_intrinsic_path() -> None:
    path = way(piece(outline(1), turned(3 * outline(2), 50)), "intrinsic")
    sizes = np.sqrt([area(places) for places in path.places])
    assert np.allclose(sizes, np.interp(path.times, [0, 1], sizes[[0, -1]]))


def test_an_outline_that_cannot_be_closed_turns_as_a_whole() -> None:
    backwards = np.vstack([SQUARE[:1], SQUARE[:0:-1]])
    for one, other in ((SQUARE, backwards), (turned(backwards, 50), SQUARE)):
        path = way(piece(one, other), "intrinsic")
        assert path.gave_way == OPEN
        assert (path.places == way(piece(one, other), "rigid").places).all()


def test_rings_that_touch_stay_together() -> None:
    hole = np.array([[0, 0], [0.2, 0.6], [0.6, 0.2]])
    both = np.vstack([SQUARE, hole])
    other = turned(both * [2, 1], 40)
    matched = piece(both, other, 4)
    path = way(matched, "intrinsic")
    assert path.gave_way == TOUCHING
    assert (path.places[:, 0] == path.places[:, 4]).all()
    assert sweep([track(path, matched)]).clean


@pytest.mark.parametrize("windings", [0.1, -2.2])
def test_a_band_whose_ends_do_not_match_turns_as_a_whole(windings: float) -> None:
    other = np.roll(spiral(windings), 30, axis=0) + 1
    assert way(piece(spiral(2.2), other), "intrinsic").gave_way == OPEN


def test_a_sliver_turns_as_a_whole() -> None:
    sliver = np.array([[0, 0], [1, 0], [0.5, 1e-6]])
    assert way(piece(sliver, turned(sliver, 40)), "intrinsic").gave_way == OPEN
