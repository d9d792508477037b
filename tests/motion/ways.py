"""Matched outlines that turn and change, and their ways."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray
from shapely.geometry import Polygon

from geotween.data.polygons import Identity
from geotween.motion.paths import (
    Path,
    travel,
)
from geotween.motion.rings import MatchedPiece
from geotween.motion.sweep import Proof, sweep
from geotween.motion.tracks import Track
from tests.motion.shapes import star

Floats = NDArray[np.float64]

NOBODY = Identity("a")
SQUARE = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
HOLE = (SQUARE * 0.2 + 0.6)[::-1]
TIMES = np.linspace(0, 1, 501)
FINE = 1e-4  # tolerance, of shapes of size 1 or so


def turned(ring: ArrayLike, degrees: float, around: Sequence[float] = (0, 0)) -> Floats:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return (np.asarray(ring) - around) @ np.array([[c, s], [-s, c]]) + around


def comb(teeth: int = 5) -> Floats:
    x = np.arange(teeth)[:, None] + np.array([0, 0, 0.5, 0.5])
    y = np.tile([1.0, 5.0, 5.0, 1.0], (teeth, 1))
    edge = np.stack([x, y], axis=-1).reshape(-1, 2)
    return np.vstack([edge, [[teeth, 1], [teeth, 0], [-0.5, 0], [-0.5, 1]]])[::-1] / 5


def shifted(ring: ArrayLike, x: float, y: float) -> Floats:
    return np.asarray(np.asarray(ring) + np.array([x, y]))


def spiral(windings: float, count: int = 60) -> Floats:
    """A band that winds itself up; always of one length and width. 0 windings are straight."""
    s = np.linspace(0.05, 1, count)
    direction = 2 * np.pi * windings * np.sqrt(s)
    ahead = np.column_stack([np.cos(direction), np.sin(direction)])
    middle, side = np.cumsum(ahead, axis=0) * 12 / count, 0.15 * ahead[:, ::-1] * [-1, 1]
    return np.vstack([middle - side, (middle + side)[::-1]])


def outline(seed: int, count: int = 20) -> Floats:
    return np.asarray(star(count, seed).exterior.coords[:-1])


def ends(one: ArrayLike, other: ArrayLike) -> Floats:
    return np.stack([np.asarray(one, dtype=float), np.asarray(other, dtype=float)])


def piece(one: ArrayLike, other: ArrayLike, *cuts: int) -> MatchedPiece:
    vertices = ends(one, other)
    count = vertices.shape[1]
    return MatchedPiece(vertices, np.array([0, *cuts, count]), np.zeros(count, dtype=np.uint8))


def way(matched: MatchedPiece, technique: str, tolerance: float = FINE) -> Path:
    return travel(matched.vertices, matched.offsets, technique, tolerance)


def track(path: Path, matched: MatchedPiece) -> Track:
    both = (NOBODY, NOBODY)
    return Track(NOBODY, both, "regions", path.times, path.places, matched.offsets, matched.seams)


def proof(matched: MatchedPiece, technique: str) -> Proof:
    return sweep([track(way(matched, technique), matched)])


def area(ring: Floats) -> float:
    return float(Polygon(ring).area)


def at(path: Path, times: Floats) -> Floats:
    """The places (t, n, 2) at some times."""
    flat = path.places.reshape(len(path.times), -1)
    columns = [np.interp(times, path.times, column) for column in flat.T]
    return np.stack(columns, axis=-1).reshape(len(times), -1, 2)


def centre(ring: Floats) -> Floats:
    """The centroid of an outline."""
    return np.asarray(shapely.get_coordinates(shapely.LinearRing(ring).centroid)[0])
