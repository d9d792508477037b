"""Matching: which vertex of a piece goes to which of its partner; equal vertex counts after it.

ABCD ↔ abc      a vertex is added on the longest edge of abc, then the ring is turned until
the sum of squared ways is least:  A→b  B→x  C→c  D→a
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from itertools import chain

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.motion.borders import tied_rings
from geotween.motion.divide import Division
from geotween.motion.holes import plan_holes
from geotween.motion.rings import MatchedPiece, Rings, Vertices, rings_of
from geotween.motion.seams import seam_edges
from geotween.motion.tracks import SEAM_AT_ORIGIN, SEAM_AT_TARGET
from geotween.motion.trajectory import trajectory

# Two open rings (n, 2) and (m, 2) in; for each the places of its vertices along itself out: two
# equally long, cyclically rising arrays of ring parameters, k + s for s of the way along edge k.
Technique = Callable[[Vertices, Vertices], tuple[NDArray[np.float64], NDArray[np.float64]]]

# Sums of squared ways closer than this, relative to the largest possible, are ties.
TIE = 1e-12

# The numbers of two rings that belong together; of one that has no partner, None and the point (2,)
# where it comes from or goes to.
_RingPair = tuple[int | None, int | None, Vertices | None]

# Matched vertices (2, n, 2) and seam flags (n,).
_MatchedRing = tuple[NDArray[np.float64], NDArray[np.uint8]]


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
    """Match the rings of each pair of pieces: outer with outer, holes as ``plan_holes`` has them.

    A hole without a partner opens from, or closes to, a point within the other piece. By
    trajectory, what two pieces share at both ends is matched once for both of them.
    """
    align = TECHNIQUES[technique]
    origin = _Side.of(division.origin_pieces, division.indices[:, 0], SEAM_AT_ORIGIN)
    target = _Side.of(division.target_pieces, division.indices[:, 1], SEAM_AT_TARGET)
    paired = [_ring_pairs(origin, target, pair) for pair in range(len(division.indices))]
    tied = _tied(origin, target, chain.from_iterable(paired)) if align is trajectory else {}
    pieces = []
    for of_piece in paired:
        parts = [
            tied.get(rings[:2]) or _match_rings(origin, target, rings, align) for rings in of_piece
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


def _ring_pairs(origin: _Side, target: _Side, pair: int) -> list[_RingPair]:
    """Rings that belong together, and the points where those that have no partner come and go."""
    here, there = list(origin.rings_of(pair)), list(target.rings_of(pair))
    piece, partner = origin.pieces[pair], target.pieces[pair]
    if not here or not there:
        point = shapely.get_coordinates(partner if here else piece)[0]
        return [(ring, None, point) for ring in here] + [(None, ring, point) for ring in there]
    outer = (here[0], there[0], None)
    if len(here) == len(there) == 1:
        return [outer]
    holes = plan_holes(piece, partner)
    return [
        outer,
        *((here[i + 1], there[j + 1], None) for i, j in holes.pairs),
        *((here[i + 1], None, point) for i, point in holes.closing.items()),
        *((None, there[j + 1], point) for j, point in holes.opening.items()),
    ]


def _tied(
    origin: _Side, target: _Side, paired: Iterable[_RingPair]
) -> dict[tuple[int | None, int | None], _MatchedRing]:
    """The rings that have borders with others at both ends, by their numbers, matched."""
    both = [(one, other) for one, other, _ in paired if one is not None and other is not None]
    found: dict[tuple[int | None, int | None], _MatchedRing] = {}
    for k, rings in tied_rings(origin.rings, target.rings, both).items():
        one, other = both[k]
        flags = np.zeros(len(rings.here), dtype=np.uint8)
        for side, ring, at in ((origin, one, rings.here), (target, other, rings.there)):
            # An edge between two vertices at one place has no length, and is no part of a seam.
            flags |= np.where(np.roll(at, -1) == at, 0, side.flags(ring)[at.astype(np.intp)])
        found[one, other] = rings.vertices, flags
    return found


def _match_rings(
    origin: _Side, target: _Side, rings: _RingPair, align: Technique
) -> tuple[NDArray[np.float64], NDArray[np.uint8]]:
    """Matched vertices (2, n, 2) and seam flags (n,) of two rings, or of one and its point."""
    one, other, point = rings
    if one is not None and other is not None:
        here, there = align(origin.rings[one], target.rings[other])
        vertices = [points_at(origin.rings[one], here), points_at(target.rings[other], there)]
        flags = origin.flags(one)[here.astype(np.intp)] | target.flags(other)[there.astype(np.intp)]
        return np.stack(vertices), flags
    assert point is not None
    if one is not None:
        ring = origin.rings[one]
        return np.stack([ring, np.broadcast_to(point, ring.shape)]), origin.flags(one)
    assert other is not None
    ring = target.rings[other]
    return np.stack([np.broadcast_to(point, ring.shape), ring]), target.flags(other)
