"""Cells of a quadtree: those that a boundary crosses, and a tree that is graded away from them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

# A boundary that misses a cell by less, in cells, is taken to cross it: it would leave slivers.
# Rounding is less by far.
SLACK = 0.1

# Edges that cross less of a column than this, in cells, are taken to fill all of their height in
# it: where they enter it is lost to rounding.
STEEP = 1e-2

AROUND = np.array([(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)])
CHILDREN = np.array([(0, 0), (1, 0), (0, 1), (1, 1)])

# Across the sides of a cell: below, right, above, left.
ACROSS = np.array([(0, -1), (1, 0), (0, 1), (-1, 0)])

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Grid:
    """A square of 2**depth by 2**depth cells: the finest that its quadtree may have.

    ``low`` (2,) is its lower left corner, ``side`` its width.
    """

    low: Floats
    side: float
    depth: int

    @property
    def cell(self) -> float:
        """The width of a cell."""
        return self.side / 2.0**self.depth

    def places(self, halves: Ints) -> Floats:
        """Points (..., 2) from numbers of half cells (..., 2), alike to the bit at all levels."""
        return np.asarray(self.low + halves * (self.cell / 2))

    def cells(self, points: Floats) -> Floats:
        """Points (..., 2) in cells from the lower left corner."""
        return np.asarray((points - self.low) / self.cell)


@dataclass(frozen=True, eq=False)
class Leaves:
    """Cells of a tree that are not split.

    ``low`` (c, 2) are their lower left corners and ``size`` (c,) their widths, in half cells of
    the finest level; ``halved`` (c, 4) tells on which sides (below, right, above, left) the
    neighbours are finer.
    """

    low: Ints
    size: Ints
    halved: Mask

    def chosen(self, mask: Mask) -> Leaves:
        """The leaves where a mask (c,) is True."""
        return Leaves(self.low[mask], self.size[mask], self.halved[mask])


def crossed(edges: Floats, grid: Grid) -> tuple[Ints, Ints]:
    """The cells that some edges (e, 2, 2) cross, or miss by no more than the slack.

    Returns
    -------
    cells : (p, 2) column and row; a cell that several edges meet is there several times.
    which : (p,) the edge.
    """
    ends = grid.cells(edges)
    ends = np.where((ends[:, :1, :1] > ends[:, 1:, :1]), ends[:, ::-1], ends)  # left to right
    start, way = ends[:, 0], ends[:, 1] - ends[:, 0]
    which, column = _counted(*_numbers(ends[:, 0, 0], ends[:, 1, 0], grid))
    start, way = start[which], way[which]
    steep = way[:, 0] < STEEP
    run = np.where(steep, 1, way[:, 0])
    enter = np.where(steep, 0, np.clip((column - SLACK - start[:, 0]) / run, 0, 1))
    leave = np.where(steep, 1, np.clip((column + 1 + SLACK - start[:, 0]) / run, 0, 1))
    heights = start[:, 1] + way[:, 1] * np.stack([enter, leave])
    part, row = _counted(*_numbers(heights.min(axis=0), heights.max(axis=0), grid))
    return np.column_stack([column[part], row]), which[part]


def _numbers(low: Floats, high: Floats, grid: Grid) -> tuple[Ints, Ints]:
    """The first and last column, or row, of ranges (n,) in cells."""
    ends = np.floor(np.stack([low - SLACK, high + SLACK])).astype(np.int64)
    first, last = np.clip(ends, 0, 2**grid.depth - 1)
    return first, last


def _counted(first: Ints, last: Ints) -> tuple[Ints, Ints]:
    """The whole numbers of ranges (n,), one range after the other, and the range of each."""
    counts = last - first + 1
    which = np.repeat(np.arange(len(counts)), counts)
    return which, np.arange(len(which)) - (np.cumsum(counts) - counts - first)[which]


def graded(finest: Ints, depth: int, layers: int) -> Leaves:
    """The leaves of the coarsest graded tree that has some cells (c, 2) at its finest level.

    At least ``layers`` cells of a level lie, also diagonally, between those cells and the next
    level, and between any two levels. With one layer or more no cell has a neighbour of less than
    half its width.

    Notes
    -----
    Built from the finest level upwards. Cost: c log c.
    """
    low, size, halved = [], [], []
    split = np.zeros((0, 2), dtype=np.int64)  # cells of a level that have children
    needed = _unique(finest)  # cells that a level must have
    for level in range(depth, -1, -1):
        for _ in range(layers):
            needed = _unique((needed[:, None] + AROUND).reshape(-1, 2))
            needed = needed[((needed >= 0) & (needed < 2**level)).all(axis=1)]
        parents = _unique(needed // 2)
        cells = (2 * parents[:, None] + CHILDREN).reshape(-1, 2) if level else needed
        leaves = cells[~_among(cells, split)]
        width = 2 ** (depth + 1 - level)
        low.append(width * leaves)
        size.append(np.full(len(leaves), width))
        halved.append(np.stack([_among(leaves + way, split) for way in ACROSS], axis=1))
        split = needed = parents
    return Leaves(np.concatenate(low), np.concatenate(size), np.concatenate(halved))


def keys(pairs: Ints) -> Ints:
    """One number for each pair of whole numbers (..., 2) of less than 2**31."""
    return np.asarray((pairs[..., 0] << 32) + pairs[..., 1])


def _unique(cells: Ints) -> Ints:
    key = np.unique(keys(cells))
    return np.column_stack([key >> 32, key & 0xFFFFFFFF])


def _among(cells: Ints, others: Ints) -> Mask:
    return np.isin(keys(cells), keys(others))
