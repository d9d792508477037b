"""Polygons as arrays of ring vertices, and their edges; what motion works on after division."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

Vertices = NDArray[np.float64]
Offsets = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Rings:
    """Open rings of many polygons: ring r is ``vertices[offsets[r]:offsets[r + 1]]``.

    ``polygon_of``, one entry a ring, says whose ring it is; a polygon's first ring is the outer.
    """

    vertices: Vertices
    offsets: Offsets
    polygon_of: NDArray[np.intp]

    def __getitem__(self, ring: int) -> Vertices:
        return self.vertices[self.offsets[ring] : self.offsets[ring + 1]]


@dataclass(frozen=True, eq=False)
class MatchedPiece:
    """A piece and its partner with matched vertices: (2, n, 2), ring offsets, seam flags (n,)."""

    vertices: NDArray[np.float64]
    offsets: Offsets
    seams: NDArray[np.uint8]


def rings_of(polygons: NDArray[np.object_]) -> Rings:
    """The rings of polygons, without the repeated last point. Points have no ring."""
    rings, polygon_of = shapely.get_rings(polygons, return_index=True)
    ends = np.cumsum(shapely.get_num_coordinates(rings), dtype=np.intp)
    vertices = np.delete(shapely.get_coordinates(rings), ends - 1, axis=0)
    offsets = np.concatenate([[0], ends - np.arange(1, len(ends) + 1)]).astype(np.intp)
    return Rings(vertices, offsets, polygon_of)


def next_vertex(offsets: Offsets) -> NDArray[np.intp]:
    """For each vertex the index of the one after it in its ring: edge k runs from k to next[k]."""
    following = np.arange(1, offsets[-1] + 1)
    filled = offsets[1:] > offsets[:-1]
    following[offsets[1:][filled] - 1] = offsets[:-1][filled]
    return following


def undirected(start: NDArray[Any], end: NDArray[Any]) -> NDArray[Any]:
    """Edges (m, 4) that are equal whichever way round they run."""
    swap = (start[:, 0] > end[:, 0]) | ((start[:, 0] == end[:, 0]) & (start[:, 1] > end[:, 1]))
    return np.where(swap[:, None], np.hstack([end, start]), np.hstack([start, end]))


def to_polygons(
    vertices: Vertices, offsets: Offsets, polygon_of: NDArray[np.intp]
) -> NDArray[np.object_]:
    """Polygons from rings; a ring whose vertices all coincide has no area and is left out.

    Returns an object array with one entry for each polygon number, None where nothing is left.
    """
    found = np.full(int(polygon_of.max()) + 1 if len(polygon_of) else 0, None, dtype=object)
    counts = np.diff(offsets)
    if not len(counts):
        return found
    spread = np.maximum.reduceat(vertices, offsets[:-1]) != np.minimum.reduceat(
        vertices, offsets[:-1]
    )
    alive = spread.any(axis=1)
    outer = np.append(True, polygon_of[1:] != polygon_of[:-1])
    alive &= alive[outer][np.cumsum(outer) - 1]  # holes go with their outer ring
    kept = np.repeat(alive, counts)
    ring_of = np.repeat(np.cumsum(alive) - 1, counts)
    rings = shapely.linearrings(vertices[kept], indices=ring_of[kept])
    numbers, compact = np.unique(polygon_of[alive], return_inverse=True)
    found[numbers] = shapely.polygons(rings, indices=compact)
    return found
