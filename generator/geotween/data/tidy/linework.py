"""Joint linework: the distinct arcs of many polygon sets, and polygons back from them.

The topology of TopoJSON (Bostock, 2012), taken over all sets at once: a vertex is a **node** where
it has other than two distinct neighbours, counted over all rings of all sets; nodes cut rings into
**arcs**. A vertex within an arc has the same two neighbours wherever it occurs, so it belongs to
one arc only, and what a ring looks like follows from which vertices are kept.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon

Ints = NDArray[np.int64]
Mask = NDArray[np.bool_]
Shapes = NDArray[np.object_]


@dataclass(frozen=True, eq=False)
class Linework:
    """The rings and arcs of polygon sets, over vertices that they share.

    Attributes
    ----------
    shapes : (g,) the (Multi)Polygons of all sets, one set after the other.
    sets, parts, holes : offsets: of each set into ``shapes``, of each shape into the polygons, of
        each polygon into the rings.
    rings : offsets of each ring into ``path``.
    path : (n,) vertex numbers along each ring, its first one not repeated at its end.
    vertices : (v, 2) coordinates of the distinct vertices, in lexicographic order.
    arcs : offsets of each arc into ``arc_path``; arcs of a single edge are not listed.
    arc_path : vertex numbers along each arc, both ends included. A ring without a node is a closed
        arc that begins far from the middle of its box.
    """

    shapes: Shapes
    sets: Ints
    parts: Ints
    holes: Ints
    rings: Ints
    path: Ints
    vertices: NDArray[np.float64]
    arcs: Ints
    arc_path: Ints

    @property
    def inner(self) -> Mask:
        """Which vertices (v,) lie within an arc: those that may be left out."""
        within = np.zeros(len(self.vertices), dtype=bool)
        within[self.arc_path] = True
        within[self.arc_path[self.arcs[:-1]]] = False
        within[self.arc_path[self.arcs[1:] - 1]] = False
        return within

    def of_shapes(self, which: Ints) -> Mask:
        """The vertices (v,) of some shapes."""
        used = np.zeros(len(self.vertices), dtype=bool)
        first, last = (self.rings[self.holes[self.parts[which + end]]] for end in (0, 1))
        used[self.path[spans(first, last)]] = True
        return used

    def shapes_with(self, vertices: Mask) -> Mask:
        """Which shapes (g,) have one of some vertices (v,)."""
        count = np.concatenate([[0], np.cumsum(vertices[self.path])])
        return np.diff(count[self.rings[self.holes[self.parts]]]) > 0

    def vertices_per_ring(self, kept: Mask) -> Ints:
        """How many of its vertices each ring keeps."""
        count = np.concatenate([[0], np.cumsum(kept[self.path])])
        return np.diff(count[self.rings])


def linework(sets: Sequence[Shapes]) -> Linework:
    """The joint linework of sets of valid (Multi)Polygons without repeated points.

    Vertices are the same where their coordinates are equal. Nothing depends on the order of sets
    and shapes, nor on where rings start and which way they run, but the order of the result.
    Cost: O(n log n) for n vertices, all in numpy.
    """
    shapes = np.concatenate([np.empty(0, dtype=object), *sets])
    # With an empty MultiPolygon among them, all are laid out as MultiPolygons.
    _, points, offsets = shapely.to_ragged_array([*shapes, MultiPolygon()], include_z=False)
    ends, holes, parts = (np.asarray(offset, dtype=np.int64) for offset in offsets)
    parts = parts[:-1]
    rings = ends - np.arange(len(ends))
    numbered, number = np.unique(
        np.delete(points, ends[1:] - 1, axis=0).view(np.complex128), return_inverse=True
    )
    vertices = numbered.view(np.float64).reshape(-1, 2)
    path = number.reshape(-1).astype(np.int64)
    arcs, arc_path = _arcs(path, rings, vertices)
    set_offsets = np.concatenate([[0], np.cumsum([len(s) for s in sets], dtype=np.int64)])
    return Linework(shapes, set_offsets, parts, holes, rings, path, vertices, arcs, arc_path)


def polygons(lines: Linework, kept: Mask, which: Ints) -> Shapes:
    """Some shapes with only the kept of their vertices; every ring must keep at least three.

    Shapes stay Polygons or MultiPolygons as they were.
    """
    parts = spans(lines.parts[which], lines.parts[which + 1])
    rings = spans(lines.holes[parts], lines.holes[parts + 1])
    path = lines.path[spans(lines.rings[rings], lines.rings[rings + 1])]
    path = path[kept[path]]
    lasts = np.cumsum(lines.vertices_per_ring(kept)[rings])
    firsts = np.concatenate([[0], lasts])[:-1]
    closed = np.insert(path, lasts, path[firsts])
    offsets = (
        np.concatenate([[0], lasts + np.arange(1, len(lasts) + 1)]),
        _offsets(np.diff(lines.holes)[parts]),
        _offsets(np.diff(lines.parts)[which]),
    )
    kind = shapely.GeometryType.MULTIPOLYGON
    built: Shapes = shapely.from_ragged_array(kind, lines.vertices[closed], offsets)
    single = shapely.get_type_id(lines.shapes[which]) == shapely.GeometryType.POLYGON
    built[single] = shapely.get_geometry(built[single], 0)
    return built


def spans(firsts: Ints, lasts: Ints) -> Ints:
    """The numbers of the ranges from each first up to, without, each last, one after the other."""
    counts = lasts - firsts
    return np.repeat(firsts - np.cumsum(counts) + counts, counts) + np.arange(counts.sum())


def _offsets(counts: Ints) -> Ints:
    return np.concatenate([[0], np.cumsum(counts)])


def _arcs(path: Ints, rings: Ints, vertices: NDArray[np.float64]) -> tuple[Ints, Ints]:
    """Offsets and vertices of the distinct arcs, each in one direction, whatever its rings'."""
    if not len(path):
        return np.zeros(1, dtype=np.int64), path
    firsts, counts = rings[:-1], np.diff(rings)
    cut = _nodes(path, rings, len(vertices))
    cut[_starts(path, rings, vertices, ~np.logical_or.reduceat(cut[path], firsts))] = True

    # Each ring from a cut all the way round to that cut again.
    place = np.where(cut[path], np.arange(len(path)), len(path))
    shift = np.minimum.reduceat(place, firsts) - firsts
    ring = np.repeat(np.arange(len(counts)), counts + 1)
    along = np.arange(len(ring)) - np.repeat(rings[:-1] + np.arange(len(counts)), counts + 1)
    path = path[firsts[ring] + (shift[ring] + along) % counts[ring]]

    # A gap of one is a lone edge, or leads on to the next ring.
    cuts = np.flatnonzero(cut[path])
    longer = np.diff(cuts) > 1
    first, last = cuts[:-1][longer], cuts[1:][longer]
    forward = np.where(
        path[first] == path[last], path[first + 1] < path[last - 1], path[first] < path[last]
    )
    # The vertex after the first one knows its arc; one of the rings that pass stands for them all.
    second = path[np.where(forward, first + 1, last - 1)]
    stands = np.empty(len(vertices), dtype=np.int64)
    stands[second] = np.arange(len(second))
    chosen = stands[second] == np.arange(len(second))
    first, last, forward = first[chosen], last[chosen], forward[chosen]
    arcs = _offsets(last + 1 - first)
    flipped = np.repeat(~forward, last + 1 - first)
    places = spans(first, last + 1)
    return arcs, path[np.where(flipped, np.repeat(first + last, last + 1 - first) - places, places)]


def _nodes(path: Ints, rings: Ints, size: int) -> Mask:
    """Which vertices have other than two distinct neighbours over all rings."""
    before, after = np.roll(path, 1), np.roll(path, -1)
    before[rings[:-1]], after[rings[1:] - 1] = path[rings[1:] - 1], path[rings[:-1]]
    low, high = np.minimum(before, after), np.maximum(before, after)
    lows, highs = np.zeros(size, dtype=np.int64), np.zeros(size, dtype=np.int64)
    lows[path], highs[path] = low, high
    node = np.zeros(size, dtype=bool)
    node[path[(lows[path] != low) | (highs[path] != high)]] = True
    return node


def _starts(path: Ints, rings: Ints, vertices: NDArray[np.float64], which: Mask) -> Ints:
    """For each of some rings the vertex farthest from the middle of its box.

    Unlike the first in lexicographic order it turns with the map.
    """
    firsts, lasts = rings[:-1][which], rings[1:][which]
    if not len(firsts):
        return firsts
    counts = lasts - firsts
    numbers = path[spans(firsts, lasts)]
    points = vertices[numbers]
    begins = _offsets(counts)[:-1]
    low, high = np.minimum.reduceat(points, begins), np.maximum.reduceat(points, begins)
    away = points - np.repeat(low / 2 + high / 2, counts, axis=0)
    distance = np.hypot(away[:, 0], away[:, 1])
    farthest = distance == np.repeat(np.maximum.reduceat(distance, begins), counts)
    return np.minimum.reduceat(np.where(farthest, numbers, len(vertices)), begins)
