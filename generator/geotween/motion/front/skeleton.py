"""The lines of a coarse picture: edges of the plane, divided where levels end, and levels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geotween.motion.front.cuts import Cuts, cut_levels
from geotween.motion.front.meshes import Mesh, Rim, Spans
from geotween.motion.front.outline import on_edges
from geotween.motion.front.plane import INNER, NOTHING, Change, Floats, Ints

# Two levels that end on one edge of the plane within this share of it end at one point.
NEARLY = 1e-7

# Points are no nearer to each other than this many roundings of the largest coordinate.
ROUNDINGS = 16


@dataclass(frozen=True, eq=False)
class Skeleton:
    """Lines between bands, and what is known about their points.

    Attributes
    ----------
    points : (p, 2) the plane's, then the ends of levels on its edges, then those on levels.
    plain : the number of the plane's points, the first.
    ends : (e,) the edge that each of the points after those lies on ...
    shares : (e,) ... and how far along it.
    key_times : (e,) the time of a level that ends there.
    levels : (p,) the level of the points after the ends; NOTHING for others.
    edges : (m, 2) parts of the plane's edges, then lines between bands.
    lines : (m,) the edge of the plane that it is a part of, NOTHING for lines between bands.
    bands : (m, 2) the band to the left and to the right, NOTHING where nothing changes.
    """

    points: Floats
    plain: int
    ends: Ints
    shares: Floats
    key_times: Floats
    levels: Ints
    edges: Ints
    lines: Ints
    bands: Ints


def skeleton_of(change: Change, mesh: Mesh, rim: Rim, spans: Spans) -> Skeleton:
    """The lines between the bands of all regions."""
    cuts = cut_levels(mesh, rim, spans)
    one, two = cuts.vertices.T
    inner_rim = np.zeros(len(mesh.points), dtype=bool)
    inner_rim[mesh.triangles[rim.triangle, rim.corner]] = True
    at_vertex = one == two
    ending = cuts.on_rim | (at_vertex & inner_rim[one] & (one >= mesh.plain))
    number = np.where(one < mesh.plain, one, NOTHING)
    number[~at_vertex] = NOTHING
    found = _ends(change, mesh, spans, cuts, np.flatnonzero(ending))
    number[ending], edge, share, key_time = found

    free = np.flatnonzero(number == NOTHING)
    count = mesh.plain + len(edge)
    number[free] = count + np.arange(len(free))
    start, way = mesh.points[one[free]], mesh.points[two[free]] - mesh.points[one[free]]
    points = np.concatenate(
        [
            change.plane.points,
            on_edges(change.plane, edge, share),
            start + cuts.share[free, None] * way,
        ]
    )
    levels = np.full(len(points), NOTHING, dtype=np.intp)
    levels[count:] = cuts.level[free]
    edges, line, bands = _parts(change, rim, spans, cuts, mesh.plain, edge, share)
    lines = number[cuts.lines]
    real = lines[:, 0] != lines[:, 1]
    return Skeleton(
        points,
        mesh.plain,
        edge,
        share,
        key_time,
        levels,
        np.concatenate([edges, lines[real]]),
        np.append(line, np.full(real.sum(), NOTHING)),
        np.concatenate([bands, cuts.bands[real]]),
    )


def _ends(
    change: Change, mesh: Mesh, spans: Spans, cuts: Cuts, nodes: Ints
) -> tuple[Ints, Ints, Floats, Floats]:
    """Points for nodes that lie on edges of the plane, one where several lie all but together.

    Returns the points' numbers, and for each new one edge, share and the time of a level.
    """
    one, two = cuts.vertices[nodes].T
    plane = change.plane
    edge, shares = mesh.on_plane(change, one, two)
    share = shares[:, 0] + cuts.share[nodes] * (shares[:, 1] - shares[:, 0])
    rounding = np.finfo(float).eps * np.abs(plane.points).max(initial=0.0)
    nearly = np.maximum(NEARLY, ROUNDINGS * rounding / plane.lengths[edge])

    order = np.lexsort([share, edge])
    new = np.ones(len(order), dtype=bool)
    near = np.diff(share[order]) <= nearly[order][1:]
    new[1:] = (np.diff(edge[order]) != 0) | ~near
    group = np.empty(len(order), dtype=np.intp)
    group[order] = np.cumsum(new) - 1
    first = order[new]
    corner = np.where(share[first] <= nearly[first], plane.edges[edge[first], 0], NOTHING)
    corner = np.where(share[first] >= 1 - nearly[first], plane.edges[edge[first], 1], corner)
    kept = corner == NOTHING
    number = np.where(kept, mesh.plain + np.cumsum(kept) - 1, corner)
    first = first[kept]
    key_time = spans.key_time(cuts.level[nodes[first]], cuts.region[nodes[first]])
    return number[group], edge[first], share[first], key_time


def _parts(
    change: Change, rim: Rim, spans: Spans, cuts: Cuts, plain: int, edge: Ints, share: Floats
) -> tuple[Ints, Ints, Ints]:
    """The plane's edges, divided at points on them, and the bands on both sides."""
    plane = change.plane
    every = np.arange(len(plane.edges))
    on = np.concatenate([every, edge, every])
    place = np.concatenate([np.zeros(len(every)), share, np.ones(len(every))])
    number = np.concatenate([plane.edges[:, 0], plain + np.arange(len(edge)), plane.edges[:, 1]])
    order = np.lexsort([place, on])
    on, place, number = on[order], place[order], number[order]
    first = np.flatnonzero(on[1:] == on[:-1])
    line, middle = on[first], (place[first] + place[first + 1]) / 2
    region = np.append(change.region, NOTHING)[plane.sides[line]]
    region[change.roles[line] == INNER] = NOTHING
    bands = np.where(region == NOTHING, NOTHING, spans.base[region] if len(spans.base) else 0)
    several = (region != NOTHING) & (np.append(spans.counts, 1)[region] > 1)
    row, side = np.nonzero(several)
    if len(row):
        # Keys are whole numbers and shares lie between 0 and 1: both in one number keep the order.
        parts = cuts.part_key + cuts.part_start / 2
        wanted = 2 * line[row] + side + middle[row] / 2
        bands[row, side] = cuts.part_band[np.searchsorted(parts, wanted, side="right") - 1]
    return np.column_stack([number[first], number[first + 1]]), line, bands
