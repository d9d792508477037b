"""Pins: runs of boundary that two rings have in common."""

from __future__ import annotations

import numpy as np
import pytest

from geotween.motion.match import points_at
from geotween.motion.pins import Pins, common_runs
from geotween.motion.rings import Vertices

SQUARE = np.array([[0, 0], [4, 0], [4, 4], [0, 4]], dtype=float)


def pinned_way(one: Vertices, other: Vertices, pins: Pins) -> float:
    return float(np.abs(points_at(one, pins.here) - points_at(other, pins.there)).max())


def test_a_ring_has_all_of_its_boundary_in_common_with_itself() -> None:
    pins = common_runs(SQUARE, np.roll(SQUARE, 1, axis=0))
    assert pins.common.all()
    assert pins.here.tolist() == [0, 1, 2, 3]
    assert pins.there.tolist() == [1, 2, 3, 0]


def test_a_vertex_on_one_side_only_does_not_break_a_run() -> None:
    taller = np.array([[0, 0], [1, 0], [4, 0], [4, 3], [4, 6], [0, 6]], dtype=float)
    pins = common_runs(SQUARE, taller)
    # From (0, 4) down, round the bottom and up to (4, 4), which lies on an edge of the taller one.
    assert pins.common.sum() == len(pins.common) - 1 == 5
    assert pinned_way(SQUARE, taller, pins) < 1e-14
    assert 0.25 in pins.here
    assert 3 + 1 / 3 in pins.there


def test_boundaries_that_cross_have_no_run() -> None:
    assert len(common_runs(SQUARE, SQUARE + 2).here) == 0


def test_a_corner_in_common_is_no_run() -> None:
    assert len(common_runs(SQUARE, SQUARE * 1.5).here) > 0
    turned = np.array([[4, 4], [8, 4], [8, 8], [4, 8]], dtype=float)
    assert len(common_runs(SQUARE, turned).here) == 0


def test_an_edge_run_the_other_way_is_not_common() -> None:
    assert len(common_runs(SQUARE, SQUARE + np.array([4, 0])).here) == 0


def test_of_runs_in_another_order_the_longest_chain_is_kept() -> None:
    # Both run along the three walls p, q and r, but in different order: p q r, and p r q.
    walls = np.array([[0, 0], [5, 0], [10, 3], [14, 3], [20, 6], [23, 6]], dtype=float)
    one = np.concatenate([walls, [[10, 20]]])
    detour = np.array([[30, 0], [30, -9]])
    other = np.concatenate([walls[:2], detour, walls[4:6], [[8, 8]], walls[2:4], [[0, 30]]])
    pins = common_runs(one, other)
    assert pins.here[pins.common].tolist() == [0, 2]
    assert pinned_way(one, other, pins) == 0
    reversed_roles = common_runs(other, one)
    assert reversed_roles.there[reversed_roles.common].tolist() == [0, 2]


@pytest.mark.parametrize("factor", [1e-9, 1.0, 1e9])
def test_what_is_common_does_not_depend_on_the_scale(factor: float) -> None:
    other = np.array([[0, 0], [4, 0], [4, 4], [2, 6], [0, 4]], dtype=float)
    pins = common_runs(SQUARE * factor, other * factor)
    assert pins.here.tolist() == [3, 0, 1, 2]
    assert pins.common.tolist() == [True, True, True, False]


def test_what_is_nearly_common_is_common_only_within_rounding() -> None:
    assert common_runs(SQUARE, SQUARE + 1e-12).common.all()
    assert len(common_runs(SQUARE, SQUARE + 1e-6).here) == 0
