"""The background quadtree of an advancing front: the size of elements, and where the front lies."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geotween.mesh.sizes import Size

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Side = tuple[int, int]  # an edge of the front, by the numbers of its ends; what is open lies left

# A cell never gets smaller than the root halved so often: doubles end there.
DEEPEST = 50

# A cell that a line passes this far outside of, as a share of coordinates, counts as met: rounding.
ROUNDING = 1e-15


class FrontTree:
    """A quadtree whose leaves know the size of elements, and the edges of the front that meet them.

    A cell is divided while its side is larger than the size at its centre. As sizes grow by less
    than a third of the distance, neighbouring leaves differ by one level at most.

    Parameters
    ----------
    box : the square to cover: its middle's x and y, and half its side.
    size : of elements, at places (n, 2).
    """

    def __init__(self, box: tuple[float, float, float], size: Size) -> None:
        centres, half = np.array([box[:2]]), box[2]
        self._slack = ROUNDING * (abs(box[0]) + abs(box[1]) + 2 * half)
        self.diagonal = 8**0.5 * half
        levels: list[tuple[Floats, float, Floats, Ints]] = []
        count = 0
        while len(centres):
            sizes = size(centres)
            split = 2 * half > sizes if len(levels) < DEEPEST else np.zeros(len(centres), bool)
            count += len(centres)
            first = np.full(len(centres), -1)
            first[split] = count + 4 * np.arange(split.sum())
            levels.append((centres, half, sizes, first))
            half /= 2
            corners = half * np.array([[-1, -1], [1, -1], [-1, 1], [1, 1]])
            centres = (centres[split, None] + corners).reshape(-1, 2)
        self._centres = np.concatenate([level[0] for level in levels])
        self._halves = np.concatenate([np.full(len(level[0]), level[1]) for level in levels])
        # The walks through the tree take one cell at a time: there lists are faster than arrays.
        self._x: list[float] = self._centres[:, 0].tolist()
        self._y: list[float] = self._centres[:, 1].tolist()
        self._half: list[float] = self._halves.tolist()
        self._size: list[float] = np.concatenate([level[2] for level in levels]).tolist()
        self._first: list[int] = np.concatenate([level[3] for level in levels]).tolist()
        self.members: list[dict[Side, None]] = [{} for _ in self._x]

    def leaves(self) -> tuple[Floats, Floats, Floats]:
        """Of each leaf the centre (n, 2), the side (n,) and the size of elements (n,)."""
        leaf = np.array(self._first) < 0
        return self._centres[leaf], 2 * self._halves[leaf], np.array(self._size)[leaf]

    def size(self, x: float, y: float) -> float:
        """The size of elements at a place."""
        node, first = 0, self._first
        while first[node] >= 0:
            node = first[node] + (x >= self._x[node]) + 2 * (y >= self._y[node])
        return self._size[node]

    def along(self, x0: float, y0: float, x1: float, y1: float) -> list[int]:
        """The numbers of the leaves that the segment between two places meets."""
        dx, dy = x1 - x0, y1 - y0
        reach = abs(dx) + abs(dy)
        xs, ys, halves, slack = self._x, self._y, self._half, self._slack
        box = (min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1))
        return [
            leaf
            for leaf in self._within(*box)
            if abs(dx * (ys[leaf] - y0) - dy * (xs[leaf] - x0)) <= (halves[leaf] + slack) * reach
        ]

    def near(self, west: float, south: float, east: float, north: float) -> dict[Side, None]:
        """The edges of the front that may meet a box, as an ordered set."""
        found: dict[Side, None] = {}
        for leaf in self._within(west, south, east, north):
            found.update(self.members[leaf])
        return found

    def _within(self, west: float, south: float, east: float, north: float) -> list[int]:
        """The leaves that a box meets."""
        xs, ys, firsts = self._x, self._y, self._first
        found = []
        stack = [0]
        while stack:
            node = stack.pop()
            first = firsts[node]
            if first < 0:
                found.append(node)
                continue
            x, y = xs[node], ys[node]
            if south <= y:
                if west <= x:
                    stack.append(first)
                if east >= x:
                    stack.append(first + 1)
            if north >= y:
                if west <= x:
                    stack.append(first + 2)
                if east >= x:
                    stack.append(first + 3)
        return found
