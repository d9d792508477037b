"""Matching: which vertex of a piece goes to which of its partner; equal vertex counts after it.

ABCD ↔ abc      a vertex is added on the longest edge of abc, then the ring is turned until
the sum of squared ways is least:  A→b  B→x  C→c  D→a
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Point, Polygon

from geotween.motion.divide import Division
from geotween.motion.rings import MatchedPiece, Rings, Vertices, rings_of
from geotween.motion.seams import seam_edges
from geotween.motion.tracks import SEAM_AT_ORIGIN, SEAM_AT_TARGET
from geotween.motion.trajectory import trajectory

# Two open rings (n, 2) and (m, 2) in; for each the places of its vertices along itself out: two
# equally long, cyclically rising arrays of ring parameters, k + s for s of the way along edge k.
Technique = Callable[[Vertices, Vertices], tuple[NDArray[np.float64], NDArray[np.float64]]]

# Sums of squared ways closer than this, relative to the largest possible, are ties.
TIE = 1e-12

# How near to the innermost point of a ring is near enough, as a share of its extent.
INNERMOST = 1e-3


@dataclass(frozen=True, eq=False)
class _Side:
    """The pieces of one end of the transition, their rings, and which of their edges are seams."""

    pieces: NDArray[np.object_]
    rings: Rings
    seams: NDArray[np.uint8]

    @classmethod
    def of(cls, pieces: NDArray[np.object_], owner: NDArray[np.intp], flag: int) -> _Side:
        rings = rings_of(pieces)
        return cls(pieces, rings, seam_edges(rings, owner) * np.uint8(flag))

    def rings_of(self, pair: int) -> range:
        first, last = np.searchsorted(self.rings.polygon_of, [pair, pair + 1])
        return range(int(first), int(last))

    def flags(self, ring: int) -> NDArray[np.uint8]:
        return self.seams[self.rings.offsets[ring] : self.rings.offsets[ring + 1]]


@dataclass(frozen=True, eq=False)
class Matching:
    """A division whose pieces have equal vertex counts, matched in order."""

    division: Division
    pieces: tuple[MatchedPiece, ...]


def match(division: Division, technique: str = "rotation") -> Matching:
    """Match the rings of each pair of pieces: outer with outer, holes by overlap.

    A hole without a partner opens from, or closes to, a point inside it.
    """
    align = TECHNIQUES[technique]
    origin = _Side.of(division.origin_pieces, division.indices[:, 0], SEAM_AT_ORIGIN)
    target = _Side.of(division.target_pieces, division.indices[:, 1], SEAM_AT_TARGET)
    pieces = []
    for pair in range(len(division.indices)):
        parts = [
            _match_rings(origin, target, pair, one, other, align)
            for one, other in _ring_pairs(origin, target, pair)
        ]
        lengths = [flags.size for _, flags in parts]
        pieces.append(
            MatchedPiece(
                np.concatenate([vertices for vertices, _ in parts], axis=1),
                np.concatenate([[0], np.cumsum(lengths)]).astype(np.intp),
                np.concatenate([flags for _, flags in parts]),
            )
        )
    return Matching(division, tuple(pieces))


def rotation(one: Vertices, other: Vertices) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The paper's matching: equal counts, then the rotation of least trajectory cost.

    Vertices are added to the shorter ring, on its edges in proportion to their length. The sum of
    squared ways over all rotations comes from one cross-correlation by FFT: exact, n log n.
    """
    count = max(len(one), len(other))
    here, there = _subdivision(one, count), _subdivision(other, count)
    turn = _best_turn(points_at(one, here), points_at(other, there))
    return here, np.roll(there, -turn)


TECHNIQUES: Mapping[str, Technique] = {"rotation": rotation, "trajectory": trajectory}


def points_at(ring: Vertices, places: NDArray[np.float64]) -> Vertices:
    """The points (m, 2) at ring parameters; at whole ones exactly the vertices."""
    edge = places.astype(np.intp)
    share = (places - edge)[:, None]
    points = np.take(ring, edge, axis=0)
    if share.any():
        ways = np.roll(ring, -1, axis=0) - ring
        points += share * np.take(ways, edge, axis=0)
    return np.asarray(points)


def _subdivision(ring: Vertices, count: int) -> NDArray[np.float64]:
    """``count`` ring parameters: all vertices, and more in proportion to the edges' length."""
    spare = count - len(ring)
    if not spare:
        return np.arange(count, dtype=np.float64)
    lengths = np.hypot(*(np.roll(ring, -1, axis=0) - ring).T)
    quota = spare * lengths / lengths.sum()
    added = np.floor(quota).astype(np.intp)
    added[_largest(quota - added, spare - int(added.sum()))] += 1  # an edge of no length has none
    edge = np.repeat(np.arange(len(ring)), added + 1)
    first = np.cumsum(added + 1) - (added + 1)
    return np.asarray(edge + (np.arange(count) - first[edge]) / (added + 1)[edge])


def _largest(values: NDArray[np.float64], count: int) -> NDArray[np.intp]:
    """The places of the largest values; of equal ones the first. Cost: n."""
    if not count:
        return np.empty(0, dtype=np.intp)
    bound = np.partition(values, -count)[-count]
    above = np.flatnonzero(values > bound)
    return np.concatenate([above, np.flatnonzero(values == bound)[: count - len(above)]])


def _best_turn(one: Vertices, other: Vertices) -> int:
    """The s for which the sum of |one[i] - other[i + s]|² is least; the smallest turn of a tie."""
    a = (one - one.mean(axis=0)).view(np.complex128)[:, 0]  # x + iy
    b = (other - other.mean(axis=0)).view(np.complex128)[:, 0]
    gain = np.fft.ifft(np.conj(np.fft.fft(a)) * np.fft.fft(b)).real
    most = np.sqrt((np.abs(a) ** 2).sum() * (np.abs(b) ** 2).sum())
    ties = np.flatnonzero(gain >= gain.max() - TIE * most)
    return int(ties[np.argmin(np.minimum(ties, len(one) - ties))])


def _ring_pairs(origin: _Side, target: _Side, pair: int) -> list[tuple[int | None, int | None]]:
    """Numbers of rings that belong together; None for the partner of a ring that has none."""
    here, there = list(origin.rings_of(pair)), list(target.rings_of(pair))
    pairs: list[tuple[int | None, int | None]] = []
    if here and there:
        pairs.append((here.pop(0), there.pop(0)))
    if here and there:
        holes = np.array([Polygon(origin.rings[ring]) for ring in here])
        others = np.array([Polygon(target.rings[ring]) for ring in there])
        overlap = shapely.area(shapely.intersection(holes[:, None], others[None, :]))
        free_here, free_there = dict(enumerate(here)), dict(enumerate(there))
        for best in np.argsort(-overlap, axis=None, kind="stable"):
            i, j = (int(k) for k in np.unravel_index(best, overlap.shape))
            if overlap[i, j] > 0 and i in free_here and j in free_there:
                pairs.append((free_here.pop(i), free_there.pop(j)))
        here, there = list(free_here.values()), list(free_there.values())
    return pairs + [(ring, None) for ring in here] + [(None, ring) for ring in there]


def _match_rings(
    origin: _Side, target: _Side, pair: int, one: int | None, other: int | None, align: Technique
) -> tuple[NDArray[np.float64], NDArray[np.uint8]]:
    """Matched vertices (2, n, 2) and seam flags (n,) of two rings, or of one and its point."""
    if one is not None and other is not None:
        here, there = align(origin.rings[one], target.rings[other])
        vertices = [points_at(origin.rings[one], here), points_at(target.rings[other], there)]
        flags = origin.flags(one)[here.astype(np.intp)] | target.flags(other)[there.astype(np.intp)]
        return np.stack(vertices), flags
    if one is not None:
        ring = origin.rings[one]
        point = _vanishing_point(target.pieces[pair], ring)
        return np.stack([ring, np.broadcast_to(point, ring.shape)]), origin.flags(one)
    assert other is not None
    ring = target.rings[other]
    point = _vanishing_point(origin.pieces[pair], ring)
    return np.stack([np.broadcast_to(point, ring.shape), ring]), target.flags(other)


def _vanishing_point(partner: Polygon | Point, ring: Vertices) -> Vertices:
    """Where a ring without a partner comes from or goes to: its piece's point, or inside itself.

    Inside itself is its centroid, or its innermost point where the centroid lies outside.
    """
    inside = partner
    if not isinstance(inside, Point):
        area = Polygon(ring)
        inside = area.centroid
        if not area.contains(inside):
            reach = np.ptp(ring, axis=0).max()
            inside = shapely.maximum_inscribed_circle(area, tolerance=reach * INNERMOST)
    return np.asarray(shapely.get_coordinates(inside)[0])
