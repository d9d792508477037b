"""Rigid paths: a shape turns as a whole, and what else changes is straight in the turning frame.

With c(t) the straight way of the centroid and R(x) the rotation by x, a vertex that goes from a
to b is at c(t) + R(tθ) [(1 - t) (a - c(0)) + t R(-θ) (b - c(1))]. The rotation θ is the one that
brings the outlines nearest to each other (Procrustes). At any one time all vertices go by the same
affine map of (a, b): what lies on a straight edge at both ends does so throughout, as on straight
paths.

Size is left to the straight part. It changes linearly, the less a shape turns the more its path is
straight, and what grows from almost nothing moves as what grows from a point does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geotween.data.polygons import RELATIVE_TOLERANCE
from geotween.motion.rings import Offsets, Vertices, next_vertex

Floats = NDArray[np.float64]
Ends = NDArray[np.float64]  # (2, n, 2): matched vertices at the origin and at the target

# Rotations nearer to half a turn than this, in radians, are half a turn; smaller ones are none.
LEAST_TURN = RELATIVE_TOLERANCE


@dataclass(frozen=True, eq=False)
class Turn:
    """A rotation by ``angle``, in radians, around a centre that moves straight.

    ``centres`` (2, 2) is where it is at both ends.
    """

    angle: float
    centres: Vertices

    def at(self, vertices: Ends, times: Floats) -> Floats:
        """The places (K, n, 2) of matched vertices at times (K,); exact at 0 and 1.

        Each number comes from the same few sums and products wherever its vertex is listed, so
        that vertices which are equal at both ends are equal to the bit throughout.
        """
        t = times[:, None]
        x, y = (vertices[0] - self.centres[0]).T
        u, v = self._turned_back(vertices[1])
        places = _turned((1 - t) * x + t * u, (1 - t) * y + t * v, t * self.angle)
        found = np.stack(places, axis=-1)
        found += self.centre(times)[:, None]
        found[times == 0], found[times == 1] = vertices
        return found

    def centre(self, times: Floats) -> Vertices:
        """Where the centre is: (K, 2)."""
        t = times[:, None]
        return np.asarray((1 - t) * self.centres[0] + t * self.centres[1])

    def steps(self, vertices: Ends, tolerance: float) -> float:
        """The number of equal steps in which straight lines stay within a tolerance of the path.

        Along a step of h a chord is off by at most h² / 8 of the largest acceleration.
        """
        start = vertices[0] - self.centres[0]
        end = np.column_stack(self._turned_back(vertices[1]))
        reach = max(float(np.hypot(*side.T).max(initial=0)) for side in (start, end))
        change = float(np.hypot(*(end - start).T).max(initial=0))
        bend = self.angle**2 * reach + 2 * abs(self.angle) * change
        return float(np.sqrt(bend / (8 * tolerance))) if tolerance else np.inf

    def _turned_back(self, target: Vertices) -> tuple[Floats, Floats]:
        x, y = (target - self.centres[1]).T
        return _turned(x, y, -self.angle)


def best_turn(outlines: Sequence[tuple[Ends, Offsets]]) -> Turn | None:
    """The rotation that brings matched outlines of several rings nearest to their targets.

    Vertices count by the length of boundary that they stand for, at both ends. None where there
    is nothing to turn, no rotation is better than others, or the best is none. Cost: n.
    """
    vertices = np.concatenate([ends for ends, _ in outlines], axis=1)
    weights = np.concatenate([boundary_weights(*outline) for outline in outlines])
    if not weights.sum():
        return None
    centres = centroids(vertices, weights)
    shares = weights / weights.sum()
    a, b = (complex_of(side) for side in vertices - centres[:, None])
    fit = complex((shares * b * a.conj()).sum())
    spread = [float(np.sqrt((shares * np.abs(side) ** 2).sum())) for side in (a, b)]
    if abs(fit) <= LEAST_TURN * spread[0] * spread[1]:
        return None
    angle = shorter(float(np.angle(fit)))
    return Turn(angle, centres) if abs(angle) > LEAST_TURN else None


def shorter(angle: float) -> float:
    """An angle the shorter way round; half a turn goes counter-clockwise."""
    return angle - 2 * np.pi * float(np.ceil((angle - np.pi - LEAST_TURN) / (2 * np.pi)))


def boundary_weights(vertices: Ends, offsets: Offsets) -> Floats:
    """The length (n,) of boundary that each vertex stands for, at both ends together."""
    following = next_vertex(offsets)
    lengths = np.hypot(*np.moveaxis(vertices[:, following] - vertices, -1, 0)).sum(axis=0)
    weights = lengths.copy()
    weights[following] += lengths
    return np.asarray(weights / 2)


def centroids(vertices: Ends, weights: Floats) -> Vertices:
    """The weighted means (2, 2) of vertices at both ends."""
    return np.asarray(np.average(vertices, axis=1, weights=weights))


def complex_of(vertices: Vertices) -> NDArray[np.complex128]:
    """Vertices (..., 2) as x + iy."""
    return np.asarray(vertices[..., 0] + 1j * vertices[..., 1])


def _turned(x: Floats, y: Floats, angle: Floats | float) -> tuple[Floats, Floats]:
    # Not in complex numbers: their products may be rounded differently at the end of an array.
    cosine, sine = np.cos(angle), np.sin(angle)
    return x * cosine - y * sine, x * sine + y * cosine
