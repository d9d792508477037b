"""Alignment: no path costs less; near the coarse path none costs much less."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from geotween.motion.alignment import Points, Work, align, path_work
from geotween.motion.arcs import size_of
from tests.motion.shapes import seeds

WORKS = [Work(1.0), Work(0.1, 0.05), Work(0.01, 0.0, 1.0), Work(1.0, 0.03, 30.0)]


def paths(n: int, m: int) -> Iterator[list[tuple[int, int]]]:
    """All paths from (0, 0) to (n - 1, m - 1)."""
    if n == m == 1:
        yield [(0, 0)]
    for i, j in ((1, 1), (1, 0), (0, 1)):
        if n > i and m > j:
            yield from ([*path, (n - 1, m - 1)] for path in paths(n - i, m - j))


def walk(count: int, seed: int, roughness: float = 1.0) -> Points:
    """A rough curve from 0 to 1."""
    rng = np.random.default_rng(seed)
    bends = np.cumsum(rng.normal(size=count) + 1j * rng.normal(size=count))
    straight = np.linspace(0, 1, count)
    bends -= bends[0] + straight * (bends[-1] - bends[0])
    return np.asarray(straight + roughness * bends / count**0.5 / 4)


@given(st.integers(1, 5), st.integers(1, 5), seeds, st.sampled_from(WORKS))
def test_no_path_costs_less(n: int, m: int, seed: int, work: Work) -> None:
    one, other = walk(n + 1, seed), walk(m + 1, seed + 1)
    least = min(path_work(one, other, np.array(p), work, 0.5) for p in paths(n + 1, m + 1))
    found = align(one, other, work, 0.5)
    assert path_work(one, other, found, work, 0.5) == pytest.approx(least, rel=1e-12)


@pytest.mark.parametrize("work", WORKS)
@pytest.mark.parametrize(("n", "m"), [(400, 400), (500, 300), (700, 60)])
def test_coarse_to_fine_is_within_a_hundredth_of_the_best(n: int, m: int, work: Work) -> None:
    for seed in range(4):
        one = walk(n, seed)
        other = walk(m, seed, 0.7) if seed % 2 else one[np.linspace(0, n - 1, m).astype(int)] + 0.2j
        size = size_of(one, other)
        best = path_work(one, other, align(one, other, work, size), work, size)
        near = align(one, other, work, size, whole=20_000)
        assert path_work(one, other, near, work, size) <= 1.01 * best


def test_a_path_moves_on_by_one_along_either_curve_or_both() -> None:
    path = align(walk(300, 1), walk(200, 2), WORKS[1], 0.5, whole=2_000)
    assert path[0].tolist() == [0, 0]
    assert path[-1].tolist() == [299, 199]
    steps = np.diff(path, axis=0)
    assert (steps.min(), steps.max()) == (0, 1)
    assert steps.any(axis=1).all()


def test_a_curve_goes_to_itself_point_by_point() -> None:
    curve = walk(50, 3)
    assert align(curve, curve, WORKS[1], 0.5).tolist() == [[k, k] for k in range(50)]


def test_swapped_curves_have_the_swapped_path() -> None:
    one, other = walk(60, 4), walk(45, 5)
    there_and_back = align(other, one, WORKS[1], 0.5)[:, ::-1]
    assert np.array_equal(align(one, other, WORKS[1], 0.5), there_and_back)


def test_a_point_is_aligned_with_all_of_a_curve() -> None:
    point = np.array([0.5 + 0j])
    assert align(point, walk(4, 1), WORKS[0], 1.0).tolist() == [[0, k] for k in range(4)]
