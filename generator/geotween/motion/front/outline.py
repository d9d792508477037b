"""The regions of change as polygons whose edges are divided, alike on both sides of each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from geotween.motion.front.plane import INNER, NONE, Change, Floats, Ints, Plane, Shapes


@dataclass(frozen=True, eq=False)
class Outline:
    """The regions of change, and the points that divide their edges.

    Attributes
    ----------
    points : (k, 2) those of the plane first.
    edge : (k,) the edge of the plane that a point was put on; -1 for the plane's own.
    share : (k,) how far along that edge; 0 for the plane's own.
    regions : (r,) polygons; all their coordinates are ``points``, to the bit.
    """

    points: Floats
    edge: Ints
    share: Floats
    regions: Shapes


def outline(change: Change, regions: Shapes, spacing: Floats) -> Outline:
    """Divide the edges of regions (r,), so that no part is longer than the spacing (r,) there.

    Of an edge between two regions the smaller spacing counts.
    """
    plane = change.plane
    finest = _finest(change, spacing)
    with np.errstate(invalid="ignore"):
        parts = np.maximum(np.ceil(plane.lengths / finest), 1).astype(np.intp)
    first = len(plane.points) + np.cumsum(parts - 1) - (parts - 1)
    edge = np.repeat(np.arange(len(parts)), parts - 1)
    share = (np.arange(len(edge)) + len(plane.points) - first[edge] + 1) / parts[edge]
    points = np.concatenate([plane.points, on_edges(plane, edge, share)])
    whole = len(plane.points)
    return Outline(
        points,
        np.concatenate([np.full(whole, -1), edge]),
        np.concatenate([np.zeros(whole), share]),
        _divided(plane, regions, points, parts, first),
    )


def regions_of(change: Change) -> Shapes:
    """The regions of change (r,) as polygons."""
    count = int(change.region.max(initial=-1)) + 1
    order = np.argsort(change.region, kind="stable")
    order = order[change.region[order] >= 0]
    sizes = np.bincount(change.region[order], minlength=count)
    ends = np.cumsum(sizes)
    regions: Shapes = change.plane.faces[order[ends - sizes]]
    for region in np.flatnonzero(sizes > 1):
        faces = change.plane.faces[order[ends[region] - sizes[region] : ends[region]]]
        regions[region] = shapely.get_parts(shapely.coverage_union_all(faces))[0]
    return regions


def on_edges(plane: Plane, edge: Ints, share: Floats) -> Floats:
    """The points (k, 2) at shares (k,) of edges (k,)."""
    start, end = plane.points[plane.edges[edge]].transpose(1, 0, 2)
    return np.asarray(start + share[:, None] * (end - start))


def numbers_of(points: Floats, wanted: Floats) -> Ints:
    """Which of some distinct points (n, 2) each wanted one (k, 2) is, to the bit; else -1."""
    known = np.ascontiguousarray(points).view(np.complex128).reshape(-1)
    sought = np.ascontiguousarray(wanted).view(np.complex128).reshape(-1)
    order = np.argsort(known, kind="stable")
    place = order[np.minimum(np.searchsorted(known[order], sought), len(known) - 1)]
    return np.where(known[place] == sought, place, -1)


def edge_between(plane: Plane, one: Ints, other: Ints) -> Ints:
    """The edge (k,) between points (k,) and (k,) of the plane; they must have one."""
    key = plane.edges.min(axis=1) * len(plane.points) + plane.edges.max(axis=1)
    order = np.argsort(key, kind="stable")
    sought = np.minimum(one, other) * len(plane.points) + np.maximum(one, other)
    return np.asarray(order[np.searchsorted(key[order], sought)])


def _finest(change: Change, spacing: Floats) -> Floats:
    """The spacing (m,) on each edge; infinite on those that bound no region of change."""
    bounding = (change.roles != NONE) & (change.roles != INNER)
    finest = np.full(change.roles.shape, np.inf)
    finest[bounding] = spacing[change.region[change.plane.sides[bounding]]]
    return np.asarray(finest.min(axis=1))


def _divided(plane: Plane, regions: Shapes, points: Floats, parts: Ints, first: Ints) -> Shapes:
    """Regions with the points on their edges: ``parts`` - 1 (m,) on each, from number ``first``."""
    if not len(regions):
        return regions
    kind, coordinates, (rings, owners) = shapely.to_ragged_array(regions)
    number = numbers_of(plane.points, coordinates)
    last = np.zeros(len(number), dtype=bool)
    last[rings[1:] - 1] = True
    place = np.flatnonzero(~last)
    edge = np.full(len(number), -1)
    edge[place] = edge_between(plane, number[place], number[place + 1])
    counts = np.where(last, 1, parts[edge])
    backward = np.zeros(len(number), dtype=bool)
    backward[place] = plane.edges[edge[place], 0] != number[place]

    at = np.repeat(np.arange(len(number)), counts)
    begins = np.cumsum(counts) - counts
    along = np.arange(len(at)) - begins[at]
    step = np.where(backward[at], counts[at] - along, along)
    numbers = np.where(along == 0, number[at], first[edge[at]] + step - 1)
    offsets = np.append(begins, len(at))[rings]
    divided: Shapes = shapely.from_ragged_array(kind, points[numbers], (offsets, owners))
    return divided
