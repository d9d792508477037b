"""Intrinsic paths: edges change their length and their direction, and vertices follow.

After T. W. Sederberg, P. Gao, G. Wang and H. Mu, "2-D shape blending: an intrinsic solution to the
vertex path problem", 1993. Edges described by their lengths and directions at both ends are
interpolated; what they then miss to close the ring is taken from their lengths, their directions
stay. Here each edge gives in proportion to its length, so that vertices added along an edge change
nothing, and what turns unaltered closes by itself.

An edge that has no length at one end has no direction there. It turns as its neighbours along the
ring do, in between in proportion to length: a corner that unfolds into edges unfolds in its frame.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from geotween.data.polygons import RELATIVE_TOLERANCE
from geotween.motion.rigid import (
    Ends,
    Floats,
    Turn,
    boundary_weights,
    centroids,
    complex_of,
    shorter,
)
from geotween.motion.rings import Offsets

# An edge that gives way by more than this share of its length to close the ring is another edge.
MOST_STRAIN = 0.9

# A ring that must grow by more than this to be as large as half-way between its ends has folded.
MOST_GROWTH = 4.0

# Turning angles of a simple ring add up to a full turn, but for this rounding, in radians.
ROUND = 1e-6


@dataclass(frozen=True, eq=False)
class Edges:
    """The edges of a ring: ``lengths`` (2, n) at both ends, ``directions`` (n,) at the origin.

    ``turns`` (n,) are the angles by which they turn, in radians, all on the same winding.
    """

    lengths: Floats
    directions: Floats
    turns: Floats

    @property
    def mean_turn(self) -> float:
        """The mean over the length of boundary, at both ends together."""
        return float(np.average(self.turns, weights=self.lengths.sum(axis=0)))


def intrinsic(vertices: Ends, offsets: Offsets, times: Floats) -> Floats | None:
    """The places (K, n, 2) of a piece's matched vertices at times (K,), or None.

    The whole turns the shorter way round, its edges on average, and its centroid moves straight.
    Holes turn nearest to their outer ring; their centroids, and holes that open or close, are
    carried in its frame. None where rings do not keep their sense, or cannot be closed on the way.
    Cost: n for each time.
    """
    outer, *holes = (vertices[:, a:b] for a, b in pairwise(offsets))
    edges = edges_of(outer, 1)
    if edges is None:
        return None
    angle = shorter(edges.mean_turn)
    turn = Turn(angle, _centroids(outer))
    parts = [_placed(edges, angle, outer, turn.centre(times), times)]
    for hole in holes:
        if not np.ptp(hole, axis=1).any(axis=1).all():
            parts.append(turn.at(hole, times))
            continue
        edges = edges_of(hole, -1)
        if edges is None:
            return None
        nearest = angle + shorter(edges.mean_turn - angle)
        centre = turn.at(_centroids(hole)[:, None], times)[:, 0]
        parts.append(_placed(edges, nearest, hole, centre, times))
    found = [part for part in parts if part is not None]
    return np.concatenate(found, axis=1) if len(found) == len(parts) else None


def edges_of(ring: Ends, sense: int) -> Edges | None:
    """The edges of a matched ring (2, n, 2); None where it does not go round once at both ends.

    ``sense`` is 1 for an outer ring, counter-clockwise, and -1 for a hole.
    """
    ways = complex_of(np.roll(ring, -1, axis=1) - ring)
    lengths = np.abs(ways)
    there = lengths > RELATIVE_TOLERANCE * lengths.sum(axis=1, keepdims=True)
    lengths = np.where(there, lengths, 0.0)
    both = there.all(axis=0)
    if not both.any():
        return None
    start, end = (_directions(ways[k], there[k], sense) for k in (0, 1))
    if start is None or end is None:
        return None
    along = np.cumsum(lengths.sum(axis=0))
    middles, whole = along - lengths.sum(axis=0) / 2, float(along[-1])
    turns = np.interp(middles, middles[both], (end - start)[both], period=whole)
    directions = np.where(there[0], start, end - turns)
    return Edges(lengths, directions, turns)


def _directions(
    ways: NDArray[np.complex128], there: NDArray[np.bool_], sense: int
) -> Floats | None:
    """Directions (n,) that go on from edge to edge; None if not round once in a sense."""
    left = ways[there]
    turning = np.angle(np.roll(left, -1) * left.conj())
    if abs(turning.sum() - sense * 2 * np.pi) > ROUND:
        return None
    directions = np.zeros(len(ways))
    directions[there] = np.angle(left[0]) + np.concatenate([[0.0], np.cumsum(turning[:-1])])
    return directions


def _placed(edges: Edges, angle: float, ring: Ends, centre: Floats, times: Floats) -> Floats | None:
    """The places of a ring of edges whose mean turn is ``angle``, with its centroid at a place."""
    t = times[:, None]
    turns = edges.turns + (angle - edges.mean_turn)
    directions = edges.directions + t * turns
    unit = np.stack([np.cos(directions), np.sin(directions)], axis=-1)
    lengths = (1 - t) * edges.lengths[0] + t * edges.lengths[1]
    closed = _closed(unit, lengths)
    if closed is None:
        return None
    ways = closed[..., None] * unit
    places = np.cumsum(ways, axis=1) - ways
    grown = _growth(places, times)
    if grown is None:
        return None
    weights = boundary_weights(ring, np.array([0, ring.shape[1]]))
    middle = np.average(places, axis=1, weights=weights)
    places = (places - middle[:, None]) * grown[:, None, None] + centre[:, None]
    places[times == 0], places[times == 1] = ring
    return np.asarray(places)


def _growth(places: Floats, times: Floats) -> Floats | None:
    """By how much (K,) to grow a ring so that its size, the root of its area, changes linearly.

    Times run from 0 to 1. None where the ring covers nothing to speak of, or turns over.
    """
    x, y = np.moveaxis(places, -1, 0)
    areas = (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)
    areas = areas * np.sign(areas[0])
    sizes = np.sqrt(np.maximum(areas, 0))
    goals = (1 - times) * sizes[0] + times * sizes[-1]
    if (sizes < goals / MOST_GROWTH).any():
        return None
    return np.asarray(goals / sizes)


def _closed(unit: Floats, lengths: Floats) -> Floats | None:
    """Lengths (K, n) of edges in given directions (K, n, 2) that add up to nothing.

    The least sum of squared changes, each relative to its length: edge k becomes
    ``lengths[k] (1 - λ · unit[k])``. None where an edge would change by more than MOST_STRAIN.
    """
    error = np.einsum("kn,kni->ki", lengths, unit)
    spread = np.einsum("kn,kni,knj->kij", lengths, unit, unit)
    if (np.linalg.det(spread) <= RELATIVE_TOLERANCE * lengths.sum(axis=1) ** 2).any():
        return None
    multiplier = np.linalg.solve(spread, error[..., None])[..., 0]
    strain = np.einsum("kni,ki->kn", unit, multiplier)
    if np.abs(np.where(lengths > 0, strain, 0)).max() > MOST_STRAIN:
        return None
    return np.asarray(lengths * (1 - strain))


def _centroids(ring: Ends) -> Floats:
    return centroids(ring, boundary_weights(ring, np.array([0, ring.shape[1]])))
