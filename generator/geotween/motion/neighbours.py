"""Neighbours: for each edge of many rings, the edge of another ring that runs back along it.

a──b──c      The edge abc of one ring gets the vertex b of the other, whose edges are cb and ba;
└──b──┘      then ab has ba for its neighbour, and bc has cb.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.polygons import RELATIVE_TOLERANCE
from geotween.motion.rings import Offsets, Rings, Vertices, next_vertex

NOTHING = -1  # beyond an edge with nothing, or with several things, on its other side

Indices = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Outlines:
    """Rings with a vertex wherever a vertex of another ring lies on them.

    Ring r is ``vertices[offsets[r]:offsets[r + 1]]``; edge k leads from vertex k to the next one
    of its ring. ``places`` (n,) are ring parameters along the rings as they were; ``beyond`` (n,)
    is for each edge the one that runs back along it, or NOTHING. Vertices that are the same but
    for rounding are equal to the bit.
    """

    vertices: Vertices
    offsets: Offsets
    places: NDArray[np.float64]
    beyond: Indices

    def __getitem__(self, ring: int) -> Vertices:
        return self.vertices[self.offsets[ring] : self.offsets[ring + 1]]

    def ring_of(self, vertices: Indices) -> Indices:
        """The rings of some vertices, or of the edges that lead from them."""
        return np.asarray(np.searchsorted(self.offsets, vertices, "right") - 1)


def outlines(rings: Rings) -> Outlines:
    """The rings with each other's vertices, and what lies beyond their edges.

    Cost: n log n for n vertices; only edges without an equal one are looked at as places.
    """
    points = np.ascontiguousarray(rings.vertices).view(np.complex128)[:, 0]
    numbered, number = np.unique(points, return_inverse=True)
    number = number.reshape(-1).astype(np.intp)
    offsets = rings.offsets
    places = (np.arange(len(points)) - np.repeat(offsets[:-1], np.diff(offsets))).astype(float)
    lonely = np.flatnonzero(_beyond(number, offsets) == NOTHING)
    if len(lonely):
        same, edges, shares, added = _contacts(numbered, number, offsets, lonely)
        number = np.insert(same[number], edges + 1, same[added])
        places = np.insert(places, edges + 1, places[edges] + shares)
        offsets = offsets + np.searchsorted(edges, offsets)
    vertices = numbered[number].view(np.float64).reshape(-1, 2)
    return Outlines(vertices, offsets, places, _beyond(number, offsets))


def _beyond(number: Indices, offsets: Offsets) -> Indices:
    """For each edge between numbered vertices the only one that runs back along it, or NOTHING."""
    after = number[next_vertex(offsets)]
    count = int(number.max(initial=0)) + 1
    codes, back = number * count + after, after * count + number
    order = np.argsort(codes, kind="stable")
    ordered = codes[order]
    first, last = (np.searchsorted(ordered, back, side) for side in ("left", "right"))
    alone = np.searchsorted(ordered, codes, "right") - np.searchsorted(ordered, codes) == 1
    known = alone & (last - first == 1) & (number != after)
    return np.where(known, order[np.minimum(first, len(order) - 1)], NOTHING)


def _contacts(
    points: NDArray[np.complex128], number: Indices, offsets: Offsets, lonely: Indices
) -> tuple[Indices, Indices, NDArray[np.float64], Indices]:
    """Where vertices of lonely edges lie on other such edges.

    Returns for each point the one that stands for it; and, in order along the rings, the edges
    that get a vertex, the share of the way along them, and the number of its point.
    """
    places = points.view(np.float64).reshape(-1, 2)
    tolerance = RELATIVE_TOLERANCE * float(np.ptp(places, axis=0).max())
    start, end = number[lonely], number[next_vertex(offsets)[lonely]]
    corners = np.union1d(start, end)
    lines: Any = shapely.linestrings(np.stack([places[start], places[end]], axis=1))
    found, edge = shapely.STRtree(lines).query(
        shapely.points(places[corners]), "dwithin", distance=tolerance
    )
    corner = corners[found]
    other = (corner != start[edge]) & (corner != end[edge])
    corner, edge = corner[other], edge[other]
    way, off = points[end[edge]] - points[start[edge]], points[corner] - points[start[edge]]
    share = (off * np.conj(way)).real / np.maximum(np.abs(way) ** 2, np.finfo(float).tiny)
    at_start = np.abs(off) <= tolerance
    at_end = ~at_start & (np.abs(points[corner] - points[end[edge]]) <= tolerance)
    same = np.arange(len(points))
    for at, ends in ((at_start, start), (at_end, end)):
        one, two = corner[at], ends[edge[at]]
        np.minimum.at(same, np.maximum(one, two), np.minimum(one, two))
    inner = ~at_start & ~at_end & (share > 0) & (share < 1)
    rows = np.column_stack([lonely[edge[inner]], same[corner[inner]]])
    _, kept = np.unique(rows, axis=0, return_index=True)
    edges, shares, added = rows[kept, 0], share[inner][kept], rows[kept, 1]
    order = np.lexsort((shares, edges))
    return same, edges[order], shares[order], added[order]


@dataclass(frozen=True, eq=False)
class Arcs:
    """The stretches of rings along which they have one neighbour; arrays are parallel.

    ``ring`` and ``beyond`` are the numbers of rings, ``mate`` is the number of the arc that runs
    back. An arc starts at vertex ``start`` of its ring and is ``count`` edges long; ``rank`` is
    its place among those of its ring. ``length`` is in the data's units, ``middle`` that of the
    ends, x + iy.
    """

    ring: Indices
    beyond: Indices
    mate: Indices
    start: Indices
    count: Indices
    rank: Indices
    length: NDArray[np.float64]
    middle: NDArray[np.complex128]


def arcs_of(lines: Outlines) -> tuple[Arcs, Indices]:
    """The arcs, ring by ring in order; and the rings that have one neighbour all round."""
    beyond, offsets = lines.beyond, lines.offsets
    following, sizes = next_vertex(offsets), np.diff(offsets)
    known = beyond != NOTHING
    joined = known & known[following]
    joined[joined] = following[beyond[following[joined]]] == beyond[joined]
    starts = known.copy()
    starts[following[joined]] = False
    first, last = np.flatnonzero(starts), np.flatnonzero(known & ~joined)
    # An arc ends with the next last edge in its ring, or past the ring's end with its first one.
    ring = lines.ring_of(first)
    after = np.searchsorted(last, first)
    past = after == np.searchsorted(last, offsets[ring + 1])
    last = last[np.where(past, np.searchsorted(last, offsets[ring]), after)]
    points = np.ascontiguousarray(lines.vertices).view(np.complex128)[:, 0]
    along = np.concatenate([[0.0], np.cumsum(np.abs(points[following] - points))])
    around = (along[offsets[1:]] - along[offsets[:-1]])[ring]
    arcs = Arcs(
        ring,
        lines.ring_of(beyond[first]),
        np.searchsorted(first, beyond[last]),
        first - offsets[ring],
        (last - first) % sizes[ring] + 1,
        np.arange(len(first)) - np.searchsorted(ring, ring),
        along[last + 1] - along[first] + np.where(past, around, 0),
        (points[first] + points[following[last]]) / 2,
    )
    return arcs, np.flatnonzero(np.logical_and.reduceat(joined, offsets[:-1]))
