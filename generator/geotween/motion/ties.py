"""Ties: which borders between two neighbours at the origin become which at the target."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from geotween.data.tidy.linework import spans
from geotween.motion.alignment import Points
from geotween.motion.arcs import Places, complex_points
from geotween.motion.neighbours import NOTHING, Arcs, Indices, Outlines, arcs_of, outlines
from geotween.motion.pins import Runs, consistent
from geotween.motion.rings import Rings, Vertices, next_vertex

# Of the arcs that two rings share, only the longest may be tied. Rings that fit badly touch in
# hundreds, and every one at the origin could be every one at the target.
MOST = 32


@dataclass(frozen=True, eq=False)
class Bordered:
    """The borders of one end of a transition, of p rings that have a partner at the other end.

    Rings go by their position among these, also in ``arcs``, where other rings are NOTHING.

    Attributes
    ----------
    lines : all rings of this end.
    numbers : (p,) the rings' numbers among all.
    counts : (p,) of the vertices that the rings have themselves.
    enclosed : (c, 2) rings that border on one other ring all round, and that ring.
    middles : (p,) the centroids of the rings as lines, x + iy.
    lengths : (p,) of the rings, in the data's units.
    """

    lines: Outlines
    numbers: Indices
    counts: Indices
    arcs: Arcs
    enclosed: Indices
    middles: Points
    lengths: NDArray[np.float64]

    @classmethod
    def of(cls, rings: Rings, numbers: Indices) -> Bordered:
        """The borders of rings with these numbers (p,), each of another one."""
        lines = outlines(rings)
        arcs, closed = arcs_of(lines)
        position = np.full(len(rings.polygon_of), NOTHING)
        position[numbers] = np.arange(len(numbers))
        beyond = lines.ring_of(lines.beyond[lines.offsets[closed]])
        enclosed = np.column_stack([position[closed], position[beyond]])
        points = complex_points(lines.vertices)
        after = points[next_vertex(lines.offsets)]
        sizes = np.abs(after - points)
        lengths = np.add.reduceat(sizes, lines.offsets[:-1])
        moments: Points = np.add.reduceat((points + after) * sizes / 2, lines.offsets[:-1])
        return cls(
            lines,
            numbers,
            np.diff(rings.offsets)[numbers],
            replace(arcs, ring=position[arcs.ring], beyond=position[arcs.beyond]),
            enclosed[(enclosed != NOTHING).all(axis=1)],
            moments[numbers] / lengths[numbers],
            lengths[numbers],
        )

    def ring(self, k: int) -> Vertices:
        return self.lines[int(self.numbers[k])]

    def opposite(self, k: int) -> int:
        """The vertex that the first one of a ring is in the ring beyond its first edge."""
        edge = self.lines.beyond[self.lines.offsets[self.numbers[k]]]
        return int(edge - self.lines.offsets[self.lines.ring_of(edge)]) + 1

    def given(self, k: int, places: Places) -> Places:
        """Places on a ring as places on the ring that was given, without others' vertices."""
        first, last = self.lines.offsets[self.numbers[k]], self.lines.offsets[self.numbers[k] + 1]
        own = np.append(self.lines.places[first:last], self.counts[k])
        places = places % (last - first)
        edge = places.astype(np.intp)
        return np.asarray(own[edge] + (places - edge) * (own[edge + 1] - own[edge]))


def ties_between(origin: Bordered, target: Bordered) -> Indices:
    """Pairs (t, 2) of arcs between the same two rings, one at each end of the transition.

    In no ring do they pass each other. Of several that could be chosen, those are taken that are
    long at both ends, and move on with their rings. Each border is there once, from the side of
    the ring with the smaller number.
    """
    one, other = _candidates(origin, target)
    weights = _weights(origin, target, one, other)
    # Both sides of a border must be free to tie it; what both rings chose is in order in both.
    arcs = np.concatenate([one, origin.arcs.mate[one]])
    others = np.concatenate([other, target.arcs.mate[other]])
    weights = np.concatenate([weights, weights])
    ring = origin.arcs.ring[arcs]
    sizes = [
        np.bincount(end.arcs.ring + 1, minlength=len(end.numbers) + 1)[1:]
        for end in (origin, target)
    ]
    order = np.argsort(ring, kind="stable")
    chosen = np.zeros(len(arcs), dtype=bool)
    for mine in np.split(order, np.flatnonzero(np.diff(ring[order])) + 1):
        if len(mine) < 2:
            chosen[mine] = True
            continue
        k = ring[mine[0]]
        ranks = np.column_stack([origin.arcs.rank[arcs[mine]], target.arcs.rank[others[mine]]])
        nodes = 2 * np.array([size[k] for size in sizes])
        runs = Runs(nodes, 2 * ranks, np.ones_like(ranks), weights[mine])
        chosen[mine[consistent(runs)]] = True
    both = chosen.reshape(2, -1).all(axis=0)
    return np.column_stack([one, other])[both]


def _candidates(origin: Bordered, target: Bordered) -> tuple[Indices, Indices]:
    """Pairs of long arcs of the same two rings, from the side of the smaller number."""
    count = len(origin.numbers)
    arcs, codes = [], []
    for end in (origin, target):
        own = np.flatnonzero((end.arcs.ring != NOTHING) & (end.arcs.beyond > end.arcs.ring))
        code = end.arcs.ring[own] * count + end.arcs.beyond[own]
        order = np.lexsort((-end.arcs.length[own], code))
        own, code = own[order], code[order]
        long = np.arange(len(code)) - np.searchsorted(code, code) < MOST
        arcs.append(own[long])
        codes.append(code[long])
    first, last = (np.searchsorted(codes[1], codes[0], side) for side in ("left", "right"))
    return np.repeat(arcs[0], last - first), arcs[1][spans(first, last)]


def _weights(
    origin: Bordered, target: Bordered, one: Indices, other: Indices
) -> NDArray[np.float64]:
    """The shorter length, and less for what does not move as its rings do."""
    rings = np.stack([origin.arcs.ring[one], origin.arcs.beyond[one]])
    way = (target.middles - origin.middles)[rings].mean(axis=0)
    reach = (origin.lengths + target.lengths)[rings].sum(axis=0) / (8 * np.pi)
    off = np.abs(target.arcs.middle[other] - origin.arcs.middle[one] - way) / reach
    shorter = np.minimum(origin.arcs.length[one], target.arcs.length[other])
    return np.asarray(shorter / (1 + off**2))
