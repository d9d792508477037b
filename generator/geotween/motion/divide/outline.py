"""The outline of a partition: the polygon's own, to the bit, whatever noding made of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon

from geotween.data.polygons import RELATIVE_TOLERANCE
from geotween.motion.divide.faces import (
    Bools,
    Piece,
    Points,
    array_of,
    as_numbers,
    edge_numbers,
    mean_width,
    numbered,
    together,
)
from geotween.motion.groups import connected
from geotween.motion.rings import Rings, next_vertex, rings_of, to_polygons

# Places nearer to each other than this share of the polygon's mean width, or than some roundings
# of the coordinates, are one, but for the polygon's own; a vertex nearer than this to the line
# between its neighbours lies on it.
SAME, ROUNDINGS = 1e-12, 32

# A vertex nearer to its neighbour than so many times that is not told from the line by it.
BEYOND = 100

Places = NDArray[np.complex128]


def with_own_vertices(polygon: Polygon, pieces: Sequence[Piece]) -> list[Piece]:
    """Pieces with the polygon's own vertices, and others only where seams bend, meet or end.

    Noding leaves vertices where lines cross that are no seams, several in one place but for
    rounding, and may move the polygon's own by some roundings.
    """
    parts, owner = shapely.get_parts(array_of(pieces), return_index=True)
    rings = rings_of(parts)
    own = np.unique(as_numbers(shapely.get_coordinates(polygon)))
    rounding = ROUNDINGS * np.finfo(float).eps * float(np.abs(polygon.bounds).max())
    near = max(SAME * float(mean_width(polygon)), rounding)
    vertices = _merged(_with_missing(rings.vertices, own, polygon), own, near)
    merged = replace(rings, vertices=vertices)
    for candidate in (merged, rings):
        kept = _needed(candidate, own, near)
        offsets = np.concatenate([[0], np.cumsum(kept)])[rings.offsets]
        if (np.diff(offsets) >= 3).all():
            found = to_polygons(candidate.vertices[kept], offsets, rings.polygon_of)
            if not shapely.is_valid(found).all():
                continue
            return [together(found[owner == k]) for k in range(len(pieces))]
    return list(pieces)


def _needed(rings: Rings, own: Places, near: float) -> Bools:
    """Which vertices (n,) of rings are a polygon's own, or ends or bends of edges."""
    places, number = numbered(rings.vertices)
    following = next_vertex(rings.offsets)
    edges = np.unique(edge_numbers(number, number[following]))
    ends = np.column_stack(np.divmod(edges, len(places)))
    ends = ends[ends[:, 0] != ends[:, 1]]
    needed = np.isin(places, own) | (np.bincount(ends.ravel(), minlength=len(places)) != 2)
    repeated = number == number[following]
    return np.asarray((needed[number] | ~_on_line(rings, near)) & ~repeated, dtype=bool)


def _merged(vertices: Points, own: Places, near: float) -> Points:
    """Vertices, of which those in one place are the same, a polygon's own if there is one."""
    from scipy.spatial import cKDTree

    places = np.unique(as_numbers(vertices))
    places = np.concatenate([own, places[~np.isin(places, own)]])
    tree = cKDTree(np.column_stack([places.real, places.imag]))
    pairs = tree.query_pairs(near, output_type="ndarray")
    group = connected(pairs, len(places))
    first = np.full(len(places), len(places))
    np.minimum.at(first, group, np.arange(len(places)))
    moves = np.flatnonzero(first[group] < np.arange(len(places)))
    moves = moves[moves >= len(own)]
    return replaced(vertices, places[moves], places[first[group[moves]]])


def replaced(points: Points, old: Places, new: Places) -> Points:
    """Points with some places, sorted, replaced by others."""
    if not len(old):
        return points
    wanted = as_numbers(points)
    at = np.searchsorted(old, wanted).clip(max=len(old) - 1)
    found = np.where(old[at] == wanted, new[at], wanted)
    return np.column_stack([found.real, found.imag])


def _with_missing(vertices: Points, own: Places, polygon: Polygon) -> Points:
    """Vertices, of which those next to a missing one of a polygon's own are moved there."""
    places = np.unique(as_numbers(vertices))
    missing = own[~np.isin(own, places)]
    if not len(missing):
        return vertices
    strays = places[~np.isin(places, own)]
    extent = np.ptp(shapely.get_coordinates(polygon), axis=0).max()
    there: Any = shapely.points(strays.real, strays.imag)
    wanted, stray = shapely.STRtree(there).query_nearest(
        shapely.points(missing.real, missing.imag),
        max_distance=RELATIVE_TOLERANCE * extent,
        all_matches=False,
    )
    order = np.argsort(strays[stray])
    return replaced(vertices, strays[stray][order], missing[wanted][order])


def _on_line(rings: Rings, near: float) -> Bools:
    """Which vertices (n,) of rings lie on the line between those before and after them."""
    following = next_vertex(rings.offsets)
    before = np.empty_like(rings.vertices)
    before[following] = rings.vertices
    way, rest = rings.vertices - before, rings.vertices[following] - rings.vertices
    doubled_area = np.abs(way[:, 0] * rest[:, 1] - way[:, 1] * rest[:, 0])
    shorter, longer = np.sort([np.hypot(*way.T), np.hypot(*rest.T)], axis=0)
    straight = (doubled_area <= near * longer) & ((way * rest).sum(axis=1) > 0)
    return np.asarray(straight & (shorter > BEYOND * near), dtype=bool)
