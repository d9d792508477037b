"""Nodes: where a polygon's corner lies on another's edge, that edge gets the corner too."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon

from geotween.data.globe.longitudes import TURN
from geotween.data.polygons import (
    RELATIVE_TOLERANCE,
    Feature,
    Shapes,
    extent,
    geometries_of,
    with_geometries,
)

if TYPE_CHECKING:
    from pyproj import CRS

# Coordinates with at most this many decimals were rounded to them; more are as computed.
DECIMALS = 8

# A corner and both ends of the edge that it was meant to be on are each off by up to half a
# diagonal of the grid they were rounded to: together by up to one, in units of the last decimal.
DIAGONAL = 2**0.5

# No edge is bent by more than this share of the extent, a hundredth of a pixel on a map of a
# thousand, however coarsely coordinates were rounded.
FARTHEST_BEND = 1e-5

# Edges are looked at in pieces of at most this share of the extent: the box around a long one that
# runs aslant would hold a good part of all corners.
PIECE = 1 / 32

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def noded_features(
    features: Sequence[list[Feature]], systems: Sequence[CRS | None]
) -> list[list[Feature]]:
    """The features of each source, noded with those of all sources in the same system.

    ``systems`` are those of the sources. To be done while their edges are straight: under a
    projection a long edge bends, and would leave the corner that lies on it.
    """
    noded_ = list(features)
    groups: dict[int, list[int]] = {}
    for i, system in enumerate(systems):
        groups.setdefault(id(system), []).append(i)
    for group in groups.values():
        system = systems[group[0]]
        shapes = [geometries_of(features[i]) for i in group]
        longest = TURN / 2 if system is not None and system.is_geographic else np.inf
        new = noded(np.concatenate(shapes), longest=longest)
        parts = np.split(new, np.cumsum([len(part) for part in shapes])[:-1])
        for i, part in zip(group, parts, strict=True):
            noded_[i] = with_geometries(features[i], part)
    return noded_


def noded(geometries: Shapes, *, longest: float = np.inf) -> Shapes:
    """Polygons whose edges have, bit for bit, every vertex of others that lies on them.

    Then both sides of a border have the same vertices, and are bent, simplified and moved alike.
    On an edge is what lies off it by no more than rounding (``tolerance``); the edge then bends
    by that much.

    Parameters
    ----------
    geometries
        (Multi)Polygons (n,), of all steps together, in any order.
    longest
        Longer edges get no vertex: of more than half a turn of longitude they run the other way.

    Returns
    -------
    geometries
        A polygon that gets no vertex is the same object, and so is one that would become invalid
        and is not mended by leaving out a spike as thin as rounding.

    Notes
    -----
    The distinct edges, in pieces, are looked up in a tree of the distinct vertices: O(n log n) for
    n vertices, unless many lie on one edge.
    """
    if len(geometries) < 2:
        return geometries
    _, points, offset = shapely.to_ragged_array([*geometries, MultiPolygon()], include_z=False)
    offsets = [np.asarray(of_one, dtype=np.int64) for of_one in offset]
    if len(points) == 0:
        return geometries
    near = tolerance(points)
    known, number = np.unique(np.ascontiguousarray(points).view(np.complex128), return_inverse=True)
    corners = known.view(np.float64).reshape(-1, 2)
    number = number.reshape(-1)

    starts = np.ones(len(points), dtype=bool)
    starts[offsets[0][1:] - 1] = False
    first = np.flatnonzero(starts)
    ends = np.sort([number[first], number[first + 1]], axis=0)
    distinct, edge = np.unique(ends[0] * len(known) + ends[1], return_inverse=True)
    low, high = np.divmod(distinct, len(known))
    on, corner = _on_edges(corners, low, high, near, longest)
    if not len(on):
        return geometries

    # As many copies of each edge's corners as there are edges in the rings, from low to high.
    edge = edge.reshape(-1)
    begins, counts = np.searchsorted(on, edge), np.bincount(on, minlength=len(low))[edge]
    which = np.repeat(np.arange(len(edge)), counts)
    along = np.arange(len(which)) - np.repeat(np.cumsum(counts) - counts, counts)
    backward = (number[first] > number[first + 1])[which]
    along = np.where(backward, counts[which] - 1 - along, along)
    new = corners[corner[begins[which] + along]]
    at = first[which] + 1
    found, changed = _with_points(geometries, points, offsets, at, new)
    given = geometries[changed]
    broken = ~shapely.is_valid(found) & shapely.is_valid(given)
    found[broken] = _without_spikes(found[broken], given[broken], near)
    result = geometries.copy()
    result[changed] = found
    return result


def tolerance(points: Floats) -> float:
    """How far off an edge rounding may have put a corner that lies on it, in the data's units.

    ``RELATIVE_TOLERANCE`` of the extent where the ``points`` (n, 2) are as computed. Where all are
    rounded to a number of decimals, the diagonal of that grid, within ``FARTHEST_BEND``.
    """
    size = extent(np.concatenate([points.min(axis=0), points.max(axis=0)]))
    least = RELATIVE_TOLERANCE * size
    for decimals in range(DECIMALS + 1):
        scaled = points * 10.0**decimals
        if (np.abs(scaled - np.rint(scaled)) <= np.spacing(np.abs(scaled))).all():
            return float(np.clip(DIAGONAL / 10.0**decimals, least, FARTHEST_BEND * size))
    return least


def edges_of(geometries: Shapes) -> tuple[Ints, Floats, NDArray[np.bool_]]:
    """Polygons' edges, the same ones next to each other: owners (n,), ends (n, 2, 2), mates (n,).

    An edge is a mate where the one before it is the same, in the other direction.
    """
    parts, owner = shapely.get_parts(geometries, return_index=True)
    rings, part = shapely.get_rings(
        shapely.orient_polygons(parts, exterior_cw=False), return_index=True
    )
    points, ring = shapely.get_coordinates(rings, return_index=True)
    _, number = np.unique(points[:, 0] + 1j * points[:, 1], return_inverse=True)
    edge = np.flatnonzero(ring[1:] == ring[:-1])
    low, high = np.sort([number[edge], number[edge + 1]], axis=0)
    forward = number[edge] == low
    order = np.lexsort([forward, high, low])
    low, high, forward, edge = low[order], high[order], forward[order], edge[order]
    mates = np.zeros(len(edge), dtype=bool)
    mates[1:] = (low[1:] == low[:-1]) & (high[1:] == high[:-1]) & (forward[1:] != forward[:-1])
    return owner[part[ring[edge]]], np.stack([points[edge], points[edge + 1]], axis=1), mates


def _on_edges(
    corners: Floats, low: Ints, high: Ints, near: float, longest: float
) -> tuple[Ints, Ints]:
    """Corners on edges, those of one edge in order: numbers of edges (k,) and of corners (k,)."""
    start, way = corners[low], corners[high] - corners[low]
    length = np.hypot(*way.T)
    looked = np.flatnonzero((length > 2 * near) & (length <= longest))
    most = PIECE * extent(np.concatenate([corners.min(axis=0), corners.max(axis=0)]))
    pieces = np.ceil(length[looked] / most).astype(np.int64)
    edge = np.repeat(looked, pieces)
    place = np.arange(len(edge)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    step = way[edge] / np.repeat(pieces, pieces)[:, None]
    one = start[edge] + step * place[:, None]
    other = one + step
    boxes = shapely.box(*(np.minimum(one, other) - near).T, *(np.maximum(one, other) + near).T)
    places = np.asarray(shapely.points(corners), dtype=object)
    piece, corner = shapely.STRtree(places).query(boxes)
    edge = edge[piece]
    inner = (corner != low[edge]) & (corner != high[edge])
    edge, corner = edge[inner], corner[inner]

    away = corners[corner] - start[edge]
    along = (away * way[edge]).sum(axis=1) / length[edge]
    across = np.abs(away[:, 0] * way[edge, 1] - away[:, 1] * way[edge, 0]) / length[edge]
    within = (across <= near) & (along > near) & (length[edge] - along > near)
    edge, along, corner = edge[within], along[within], corner[within]
    order = np.lexsort([corner, along, edge])
    edge, corner = edge[order], corner[order]
    once = np.ones(len(edge), dtype=bool)  # a corner may lie in the boxes of two pieces
    once[1:] = (edge[1:] != edge[:-1]) | (corner[1:] != corner[:-1])
    return edge[once], corner[once]


def _with_points(
    geometries: Shapes, points: Floats, offsets: Sequence[Ints], at: Ints, new: Floats
) -> tuple[Shapes, Ints]:
    """Geometries with new points, each before the one that is number ``at`` among all their points.

    Only those that get some, and their numbers. ``points`` and ``offsets`` are the ragged array of
    the geometries as MultiPolygons.
    """
    rings, polygons, parts = offsets
    longer = (rings + np.searchsorted(at, rings), polygons, parts)
    kind = shapely.GeometryType.MULTIPOLYGON
    built = shapely.from_ragged_array(kind, np.insert(points, at, new, axis=0), longer)
    last = rings[
        polygons[parts]
    ]  # where each geometry's points begin, and where the last one's end
    changed = np.flatnonzero(np.diff(np.searchsorted(at, last[:-1])))
    found = built[changed]
    single = shapely.get_type_id(geometries[changed]) == shapely.GeometryType.POLYGON
    found[single] = shapely.get_geometry(found[single], 0)
    return found, changed


def _without_spikes(noded_: Shapes, given: Shapes, near: float) -> Shapes:
    """Invalid geometries valid again where all it takes is to leave out spikes, else as given.

    A spike with a corner on its far side has, once noded, two sides that are the same edge.
    """
    mended = shapely.make_valid(noded_, method="structure", keep_collapsed=False)
    multiple = shapely.get_type_id(given) == shapely.GeometryType.MULTIPOLYGON
    multiple &= shapely.get_type_id(mended) == shapely.GeometryType.POLYGON
    mended[multiple] = shapely.multipolygons(mended[multiple][:, None])
    lost = np.abs(shapely.area(mended) - shapely.area(given))
    alike = shapely.get_num_geometries(mended) == shapely.get_num_geometries(given)
    alike &= shapely.get_type_id(mended) == shapely.get_type_id(given)
    good = alike & (lost <= near * shapely.length(given)) & shapely.is_valid(mended)
    return np.asarray(np.where(good, mended, given), dtype=object)
