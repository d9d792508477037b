"""Alignment: the way through two open curves at once that costs the least work.

After T. W. Sederberg and E. Greenwood, "A physically based approach to 2-D shape blending",
1992: a path through the table of all pairs of points, from both first to both last, on which
each step moves on along one curve or along both.

       b0  b1  b2  b3
    a0  ●               a1 goes to b1 and to b2,
    a1      ●───●       a2 and a3 both to b3
    a2              ●
    a3              ●
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.complex128]  # x + iy: products of places are then ordinary arithmetic

# A table of up to this many cells is filled in whole; a larger one only near the coarse path.
WHOLE = 250_000

# The next coarser curve has one of this many points, and the path found on it may be off by the
# band, in points of the finer curve, to either side. A wider band costs time and gains nothing:
# on rough outlines of 1,300 points the path is within 1% of the exact one's work.
COARSER = 4
BAND = 32

# Cells whose steps are worked out at once: as many as stay in a processor's cache.
CHUNK = 1 << 16

BOTH, ALONG_ONE, ALONG_OTHER = 0, 1, 2


@dataclass(frozen=True)
class Work:
    """What a step costs beside its squared displacement; dimensionless.

    ``strain`` is the work of turning an edge and of changing its length, ``bend`` that of changing
    the turning angle at a point, and ``sweep`` that of area swept, which is least where nothing
    is swept twice.
    """

    strain: float
    bend: float = 0.0
    sweep: float = 0.0


@dataclass(frozen=True, eq=False)
class Curve:
    """An open curve; ``edges`` (n,) lead to its points, ``turns`` (n,) are the angles at them."""

    points: Points
    edges: Points
    lengths: NDArray[np.float64]
    turns: NDArray[np.float64]

    @classmethod
    def through(cls, points: Points) -> Curve:
        edges = np.diff(points, prepend=points[:1])
        turns = np.zeros(len(points))
        turns[1:-1] = np.angle(edges[2:] * np.conj(edges[1:-1]))
        return cls(points, edges, np.abs(edges), turns)

    def __len__(self) -> int:
        return len(self.points)


def align(
    one: Points, other: Points, work: Work, size: float, *, whole: int = WHOLE
) -> NDArray[np.intp]:
    """The path (p, 2) of least work through two curves (n,) and (m,), as pairs of their points.

    ``size`` is the length, in the data's units, by which displacements are measured. Exact where
    the table has at most ``whole`` cells; else sought near the path through coarser curves, in
    time and memory that grow with n + m.
    """
    return _align(Curve.through(one), Curve.through(other), work, size, whole)


def path_work(one: Points, other: Points, path: NDArray[np.intp], work: Work, size: float) -> float:
    """The work of a path (p, 2) through two curves, in the data's units."""
    i, j = path[1:].T
    costs = _steps(Curve.through(one), Curve.through(other), i, j, work, size)
    moved = np.diff(path, axis=0)
    kind = np.where(moved.all(axis=1), BOTH, np.where(moved[:, 0], ALONG_ONE, ALONG_OTHER))
    return float(np.choose(kind, costs).sum())


def _align(one: Curve, other: Curve, work: Work, size: float, whole: int) -> NDArray[np.intp]:
    n, m = len(one), len(other)
    diagonal = np.arange(n + m - 1)
    if n * m <= whole or min(n, m) <= COARSER:
        return _solve_whole(one, other, work, size)
    here, there = _coarser(one), _coarser(other)
    coarse = _align(
        Curve.through(one.points[here]), Curve.through(other.points[there]), work, size, whole
    )
    i, j = here[coarse[:, 0]], there[coarse[:, 1]]
    centre = np.interp(diagonal, i + j, i)
    first = np.clip(np.rint(centre).astype(np.intp) - BAND, 0, max(n - 1 - BAND, 0))
    return _solve(one, other, first, 2 * BAND + 1, work, size)


def _coarser(curve: Curve) -> NDArray[np.intp]:
    """Points of a coarser curve: its ends, and those nearest to equal steps along it."""
    along = np.cumsum(curve.lengths)
    goals = np.linspace(0, along[-1], max(len(curve) // COARSER, 2))
    after = np.clip(np.searchsorted(along, goals), 1, len(curve) - 1)
    nearest = after - (goals - along[after - 1] < along[after] - goals)
    nearest[[0, -1]] = 0, len(curve) - 1
    return np.unique(nearest)


def _steps(
    one: Curve,
    other: Curve,
    i: NDArray[np.intp],
    j: NDArray[np.intp],
    work: Work,
    size: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """The work of the steps to cells (i, j): along both curves, along one, along the other.

    The indices are broadcast against each other.

    Displacements, squared, count by the length of boundary that they stand for: half of each
    edge. With no edge on the other side, an edge is taken in, which strains it by its length.
    """
    e, f = one.edges[i], other.edges[j]
    long, wide = one.lengths[i], other.lengths[j]
    bend_one, bend_other = np.abs(one.turns[i]), np.abs(other.turns[j])
    bend_both = np.abs(one.turns[i] - other.turns[j])
    here = other.points[j] - one.points[i]
    without_e, without_f = here + e, here - f  # before a step along one, and along the other
    before = without_e - f
    square = _square(here)
    total = long + wide
    unit = 0.25 / size**2

    both = unit * total * (square + _square(before))
    along_one = unit * long * (square + _square(without_e))
    along_other = unit * wide * (square + _square(without_f))
    both += work.strain * _square(e - f) / np.where(total > 0, total, 1)
    along_one += work.strain * long
    along_other += work.strain * wide
    if work.bend:
        both += work.bend * size * bend_both
        along_one += work.bend * size * bend_one
        along_other += work.bend * size * bend_other
    if work.sweep:
        # An area swept is half a product; over a cell it is the mean of those at its corners.
        unit = work.sweep / size
        corners = [_cross(d, edge) for d in (here, before) for edge in (e, f)]
        both += unit / 4 * np.sum(np.abs(corners), axis=0)
        along_one += unit / 2 * np.abs(_cross(here, e))
        along_other += unit / 2 * np.abs(_cross(here, f))
    return both, along_one, along_other


def _square(vector: Points) -> NDArray[np.float64]:
    return np.asarray(vector.real**2 + vector.imag**2)


def _cross(one: Points, other: Points) -> NDArray[np.float64]:
    return np.asarray(one.real * other.imag - one.imag * other.real)


def _solve_whole(one: Curve, other: Curve, work: Work, size: float) -> NDArray[np.intp]:
    """The best path through the whole table: what a band as wide as the table gives, but faster.

    Rows of the arrays are the table's diagonals, columns the points of the shorter curve.
    """
    n, m = len(one), len(other)
    width, diagonals = min(n, m), n + m - 1
    along = np.full((diagonals, 2, width), np.inf)  # a step along the shorter curve, the longer
    both = np.full((diagonals, width), np.inf)
    short, long = (0, 1) if n <= m else (1, 0)
    tables = [_slanted(costs, n, m) for costs in (both, along[:, short], along[:, long])]
    rows = max(CHUNK // m, 1)
    for start in range(0, n, rows):
        i = np.arange(start, min(start + rows, n))[:, None]
        costs = _steps(one, other, i, np.arange(m), work, size)
        for table, part in zip(tables, costs, strict=True):
            table[start : start + rows] = part
    # The work up to a cell, with a column and two diagonals to spare; infinite outside the table.
    spent = np.full((diagonals + 2, width + 1), np.inf)
    spent[2, 1] = 0.0
    # For each cell those before it and beside it on the last diagonal: shape (diagonals, 2, width).
    last = np.lib.stride_tricks.sliding_window_view(spent[1:-1], width, axis=1)
    rows_of = (both, along, along[:, 0], along[:, 1], spent[:-2, :-1], last, spent[2:, 1:])
    for x, yz, y, z, before, beside, cells in list(zip(*rows_of, strict=True))[1:]:
        x += before
        yz += beside
        np.minimum(y, z, out=cells)
        np.minimum(cells, x, out=cells)
    y, z = along[:, 0], along[:, 1]
    single = np.minimum(y, z) < both
    starts = [0] * diagonals
    if n <= m:
        return _way_back(single, z < y, starts, n, m)
    return _way_back(single, z <= y, starts, m, n)[:, ::-1]


def _slanted(rows: NDArray[np.float64], n: int, m: int) -> NDArray[np.float64]:
    """A table (n, m) whose cell (i, j) is that of row i + j, in the column of the shorter side."""
    down, right = rows.strides
    strides = (down + right, down) if n <= m else (down, down + right)
    return np.lib.stride_tricks.as_strided(rows, (n, m), strides)


def _solve(
    one: Curve, other: Curve, first: NDArray[np.intp], width: int, work: Work, size: float
) -> NDArray[np.intp]:
    """The best path through the band of cells i in first[d] ... first[d] + width - 1, i + j = d.

    All cells of a diagonal d depend on the two diagonals before it only, so that each is a few
    operations on arrays.
    """
    n, m = len(one), len(other)
    diagonals = n + m - 1
    single = np.empty((diagonals, width), dtype=bool)  # not along both
    second = np.empty((diagonals, width), dtype=bool)  # if single, along the other
    # The work up to the cells of three diagonals, at i + 1; infinite outside the band.
    now, last, earlier = (np.full(n + width + 2, np.inf) for _ in range(3))
    starts = first.tolist()
    rows = max(CHUNK // width, 1)
    for begin in range(0, diagonals, rows):
        block = np.arange(begin, min(begin + rows, diagonals))
        i = first[block][:, None] + np.arange(width)
        j = block[:, None] - i
        outside = (i >= n) | (j < 0) | (j >= m)
        i[outside] = j[outside] = 0
        both, along_one, along_other = _steps(one, other, i, j, work, size)
        for costs in (both, along_one, along_other):
            costs[outside] = np.inf
        for row, d in enumerate(block.tolist()):
            low = starts[d]
            cells, left = slice(low + 1, low + 1 + width), slice(low, low + width)
            x, y, z = both[row], along_one[row], along_other[row]
            x += earlier[left]
            y += last[left]
            z += last[cells]
            np.less(z, y, out=second[d])
            np.minimum(y, z, out=y)
            np.less(y, x, out=single[d])
            if d >= 3:
                old = starts[d - 3]
                now[old + 1 : old + 1 + width] = np.inf
            np.minimum(x, y, out=now[cells])
            if d == 0:
                now[1] = 0.0
            now, last, earlier = earlier, now, last
    return _way_back(single, second, starts, n, m)


def _way_back(
    single: NDArray[np.bool_], second: NDArray[np.bool_], starts: list[int], n: int, m: int
) -> NDArray[np.intp]:
    i, j = n - 1, m - 1
    path = [(i, j)]
    while i or j:
        d = i + j
        k = i - starts[d]
        alone = single[d, k]
        along_other = alone and second[d, k]
        i -= not along_other
        j -= not alone or along_other
        path.append((i, j))
    return np.array(path[::-1], dtype=np.intp)
