"""Moving vertices as arrays, and the search for edges that come near each other."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from geotween.motion.rings import Offsets, next_vertex

Floats = NDArray[np.float64]
Numbers = NDArray[np.intp]
Flags = NDArray[np.bool_]

# Pairs of nodes compared in one go: a few hundred bytes each.
CHUNK = 200_000

# Slices of the time between key times in the search for near edges. Their ends are odd: what
# touches at such a moment only is not looked for.
SLICES = np.array([0, 0.2479, 0.5147, 0.7536, 1])

# The directions of projections that tell two edges apart; x and y first.
AXES = np.array([[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, -1.0]]).T


@dataclass(frozen=True, eq=False)
class Moving:
    """Rings between two key times; t runs from 0 to 1 in between.

    ``places`` (2, m, 2) are the moving vertices at both key times. ``vertex`` (n,) says which of
    them each corner of the rings is; equal ones move alike throughout. Ring r has the corners
    ``offsets[r]`` to ``offsets[r + 1]``, none where all its vertices move alike; edge k runs from
    corner k to the next one. ``track`` (r,) is the track of each ring. What is nearer than
    ``tolerance``, in units of the places, touches.
    """

    places: Floats
    vertex: Numbers
    offsets: Offsets
    track: Numbers
    tolerance: float

    @classmethod
    def of(cls, places: Floats, offsets: Offsets, track: Numbers, tolerance: float) -> Moving:
        """From the vertices (2, n, 2) of rings at both key times."""
        rows = np.concatenate([places[0], places[1]], axis=1) + 0.0  # -0.0 is 0.0
        order = np.lexsort(rows.T)
        new = np.append(True, (rows[order][1:] != rows[order][:-1]).any(axis=1))
        alike = np.empty(len(rows), dtype=np.intp)
        alike[order] = np.cumsum(new) - 1
        distinct = rows[order][new]
        alike = _same_but_for_rounding(distinct, tolerance)[alike]
        following = next_vertex(offsets)
        kept = np.empty(len(rows), dtype=bool)
        kept[following] = alike[following] != alike  # a corner that repeats the one before goes
        counts = np.add.reduceat(np.append(kept, False), offsets[:-1]) * (np.diff(offsets) > 0)
        return cls(
            np.stack([distinct[:, :2], distinct[:, 2:]]),
            alike[kept],
            np.concatenate([[0], np.cumsum(counts)]).astype(np.intp),
            track,
            tolerance,
        )

    @cached_property
    def following(self) -> Numbers:
        """The corner after each corner."""
        return next_vertex(self.offsets)

    @cached_property
    def before(self) -> Numbers:
        """The corner before each corner."""
        before = np.empty_like(self.following)
        before[self.following] = np.arange(len(before))
        return before

    @cached_property
    def ring(self) -> Numbers:
        """The ring of each corner."""
        return np.repeat(np.arange(len(self.track)), np.diff(self.offsets))

    def at(self, t: float) -> Floats:
        """The places (m, 2) of the moving vertices."""
        return np.asarray(self.places[0] * (1 - t) + self.places[1] * t)

    def ways(self, start: Numbers, end: Numbers) -> Floats:
        """The vectors (2, k, 2) from vertices to vertices, at both key times."""
        return np.asarray(self.places[:, end] - self.places[:, start])


def _same_but_for_rounding(rows: Floats, tolerance: float) -> Numbers:
    """For each moving vertex the number of the one that stands for all that move like it.

    Sorted along an odd direction at an odd moment, those are next to each other.
    """
    same = np.arange(len(rows))
    along = rows @ np.array([0.3141, 0.2718, 0.4159, 0.3183])
    order = np.argsort(along)
    for step in range(1, len(rows)):
        near = np.flatnonzero(along[order[step:]] - along[order[:-step]] <= 1.5 * tolerance)
        if not len(near):
            break
        one, other = order[near], order[near + step]
        close = (np.abs(rows[one] - rows[other]) <= tolerance).all(axis=1)
        for i, j in zip(one[close].tolist(), other[close].tolist(), strict=True):
            same[same == max(same[i], same[j])] = min(same[i], same[j])
    return same


def near_edges(moving: Moving, moments: Floats) -> tuple[Numbers, Numbers]:
    """Pairs of edges that may touch between the key times; the first number is the smaller.

    Edges next to each other are paired up to a tree, and the tree is compared with itself level
    by level. Two nodes are apart over a slice of time where their projections on one axis are so,
    on the same side, at both ends of it: distances that move linearly have no zero in between.
    So edges that travel together cost nothing, however far they travel. Cost: n log n for
    boundaries that run along, and linear in the pairs that come near.

    ``moments`` are further ends of slices: what touches then only is not found, so where a ring
    shrinks to a point and grows again not every pair of its edges is.
    """
    order = _in_strips(moving)
    levels = [_projections(moving, order, np.unique(np.concatenate([SLICES, moments])))]
    while levels[-1].shape[1] > 1:
        low, high = levels[-1]
        pad = ((0, len(low) % 2), (0, 0), (0, 0))
        low = np.pad(low, pad, constant_values=np.inf)
        high = np.pad(high, pad, constant_values=-np.inf)
        above = np.minimum(low[::2], low[1::2]), np.maximum(high[::2], high[1::2])
        levels.append(np.stack(above))
    one = other = np.zeros(min(len(order), 1), dtype=np.intp)
    for level in levels[-2::-1]:
        one, other = _children(one, other, level.shape[1])
        parts = [
            _near(level, one[k : k + CHUNK], other[k : k + CHUNK], moving.tolerance)
            for k in range(0, len(one), CHUNK)
        ]
        one, other = np.concatenate(parts, axis=1) if parts else (one, other)
    one, other = order[one[one != other]], order[other[one != other]]
    return np.minimum(one, other), np.maximum(one, other)


def _in_strips(moving: Moving) -> Numbers:
    """The corners in the order of their rings; rings that are near each other come in a row."""
    counts = np.diff(moving.offsets)
    filled = np.flatnonzero(counts)
    places = moving.places.mean(axis=0)[moving.vertex]
    starts = moving.offsets[filled]
    middle = np.add.reduceat(places, starts) / counts[filled, None] if len(filled) else places
    strips = max(int(np.sqrt(len(filled))), 1)
    strip = np.argsort(np.argsort(middle[:, 0])) * strips // max(len(filled), 1)
    ranked = np.empty(len(counts), dtype=np.intp)
    ranked[filled[np.lexsort((middle[:, 1], strip))]] = np.arange(len(filled))
    return np.argsort(ranked[moving.ring], kind="stable")


def _projections(moving: Moving, order: Numbers, times: Floats) -> Floats:
    """The least and the largest (2, n, times, axes) of each edge, in some order."""
    one, other = moving.vertex[order], moving.vertex[moving.following[order]]
    projected = np.stack([moving.at(t) @ AXES for t in times], axis=1)
    one, other = projected[one], projected[other]
    return np.stack([np.minimum(one, other), np.maximum(one, other)])


def _children(one: Numbers, other: Numbers, count: int) -> tuple[Numbers, Numbers]:
    """The pairs of children of pairs of nodes, each once; there are ``count`` children in all."""
    left = np.concatenate([2 * one, 2 * one, 2 * one + 1, 2 * one + 1])
    right = np.concatenate([2 * other, 2 * other + 1, 2 * other, 2 * other + 1])
    kept = (left <= right) & (right < count)
    return left[kept], right[kept]


def _near(level: Floats, one: Numbers, other: Numbers, tolerance: float) -> Numbers:
    """The pairs of nodes (2, k) that are not apart in every slice of time, but for its ends."""
    left = np.flatnonzero(one != other)
    for first in range(level.shape[2] - 1):
        low, high = level[:, :, first : first + 2]
        a, b = one[left], other[left]
        gaps = low[a] - high[b], low[b] - high[a]
        clear = [(gap.min(axis=1) >= 0) & (gap.max(axis=1) > tolerance) for gap in gaps]
        left = left[(clear[0] | clear[1]).any(axis=1)]
    apart = np.zeros(len(one), dtype=bool)
    apart[left] = True
    return np.stack([one[~apart], other[~apart]])
