"""Borders between the places nearest to each of several areas: their Voronoi diagram, adaptively.

The outlines are sampled, densely where two areas face each other across a narrow gap, sparsely
elsewhere; the borders are those between the samples' Voronoi cells, thinned.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from geotween.data.polygons import RELATIVE_TOLERANCE
from geotween.motion.divide.faces import Bools, Ints, Points, Shapes, as_numbers

# Samples lie at most so far apart, and are never put nearer, in shares of the polygon's extent.
COARSEST, FINEST = 1 / 32, 1 / 2048

# Samples lie at most this share of the gap apart that a border runs through: it is then off by a
# thirtieth of the gap at most. Nobody sees a gap that is narrower than the finest distance.
SHARE_OF_GAP = 1 / 3

# How often samples are added, into how many parts an edge is divided at a time, and from how many
# samples on none are added any more.
ROUNDS, AT_ONCE, ENOUGH = 6, 8, 10_000

# Outlines and borders are thinned by no more than this, in shares of the polygon's extent.
THIN = FINEST / 2

# A ring of samples around everything, so that all cells in sight are bounded.
FRAME, FAR = 32, 4.0


@dataclass(frozen=True, eq=False)
class _Edges:
    """Edges (m, 2, 2) of outlines, in a box of unit size, and the area (m,) that each is of."""

    ends: Points
    label: Ints


def borders(areas: Shapes, within: BaseGeometry, extent: float) -> Shapes:
    """Lines between the places nearest to each of some areas, as far as they lie within a region.

    Parameters
    ----------
    areas
        Polygons or MultiPolygons (k,), not overlapping.
    within
        The region; lines may reach beyond it, and into the areas.
    extent
        The length that samples' distances are relative to, in the data's units.

    Notes
    -----
    Costs a Delaunay triangulation of the samples for each of a few rounds.
    """
    box = np.array(shapely.bounds(within))
    middle = (box[:2] + box[2:]) / 2
    region = shapely.transform(within, lambda points: (points - middle) / extent)
    shapely.prepare(region)
    edges, reach = _edges_in_sight(areas, region, middle, extent)
    edges, joints = _without_common(edges)
    if not len(edges.label):
        return np.empty(0, dtype=object)
    edges = _graded(_simplified(edges), joints)
    lines, sides = _between(edges, joints, region, reach)
    return np.asarray(
        shapely.transform(thinned(lines, sides), lambda points: points * extent + middle),
        dtype=object,
    )


def _edges_in_sight(
    areas: Shapes, region: BaseGeometry, middle: Points, extent: float
) -> tuple[_Edges, float]:
    """The edges that can be nearest to a place in a region, and how far away they reach.

    No place is farther from what is nearest to it than from the point of any area nearest to the
    region's middle.
    """
    shapes = shapely.transform(areas, lambda points: (points - middle) / extent)
    box = np.array(shapely.bounds(region))
    nearest = shapely.get_coordinates(shapely.shortest_line(shapes, shapely.Point(0, 0)))[::2]
    corners = shapely.get_coordinates(shapely.box(*box))[:4]
    reach = float(np.hypot(*(corners[:, None] - nearest[None]).T).max(axis=1).min())
    seen = box + reach * np.array([-1, -1, 1, 1])
    return _edges_of(shapely.clip_by_rect(shapely.boundary(shapes), *seen)), np.abs(seen).max()


def _edges_of(lines: Shapes) -> _Edges:
    """The edges of (Multi)LineStrings, one for each area."""
    parts, label = shapely.get_parts(lines, return_index=True)
    points, line = shapely.get_coordinates(parts, return_index=True)
    start = np.flatnonzero(line[1:] == line[:-1])
    return _Edges(np.stack([points[start], points[start + 1]], axis=1), label[line[start]])


def _simplified(edges: _Edges) -> _Edges:
    """Edges of outlines without the vertices that nobody sees."""
    goes_on = (edges.ends[1:, 0] == edges.ends[:-1, 1]).all(axis=1)
    first = np.append(True, ~goes_on | (edges.label[1:] != edges.label[:-1]))
    chain = np.cumsum(first) - 1
    last = np.append(first[1:], True)
    points = np.insert(edges.ends[:, 0], np.flatnonzero(last) + 1, edges.ends[last, 1], axis=0)
    lines: Any = shapely.linestrings(points, indices=np.sort(np.append(chain, chain[last])))
    found = _edges_of(shapely.simplify(lines, THIN, preserve_topology=False))
    return _Edges(found.ends, edges.label[first][found.label])


def _without_common(edges: _Edges) -> tuple[_Edges, Points]:
    """Edges without those that two areas share; and the places (j, 2) where areas still touch."""
    corners = _rounded(edges.ends.reshape(-1, 2))
    places, first, number = np.unique(corners, return_index=True, return_inverse=True)
    number = number.reshape(-1, 2)
    key = number.min(axis=1) * len(places) + number.max(axis=1)
    _, edge, counts = np.unique(key, return_inverse=True, return_counts=True)
    low, high = np.full(len(places), len(edges.label)), np.full(len(places), -1)
    for side in (0, 1):
        np.minimum.at(low, number[:, side], edges.label)
        np.maximum.at(high, number[:, side], edges.label)
    common = counts[edge.reshape(-1)] > 1
    touched = np.zeros(len(places), dtype=bool)
    touched[number[~common]] = True
    joints = first[(low != high) & touched]
    return _Edges(edges.ends[~common], edges.label[~common]), edges.ends.reshape(-1, 2)[joints]


def _is_joint(points: Points, joints: Points) -> Bools:
    return np.asarray(np.isin(_rounded(points), _rounded(joints)))


def _rounded(points: Points) -> NDArray[np.complex128]:
    return as_numbers(np.rint(points / RELATIVE_TOLERANCE))


def _graded(edges: _Edges, joints: Points) -> _Edges:
    """Edges divided: twice as far from a joint each time, alike on both of its sides."""
    ways = np.diff(edges.ends, axis=1)[:, 0]
    lengths = np.hypot(*ways.T)
    steps = FINEST * 2.0 ** np.arange(np.log2(COARSEST / FINEST) + 1)
    at_joint = _is_joint(edges.ends.reshape(-1, 2), joints).reshape(-1, 2)
    room = lengths / np.where(at_joint.all(axis=1), 2, 1)
    marks = [(np.arange(len(lengths)), np.zeros(len(lengths)))]
    for side in (0, 1):
        edge, step = np.nonzero(at_joint[:, [side]] & (steps < room[:, None] - FINEST / 2))
        share = steps[step] / lengths[edge]
        marks.append((edge, share if side == 0 else 1 - share))
    edge, share = (np.concatenate(column) for column in zip(*marks, strict=True))
    order = np.lexsort((share, edge))
    edge, share = edge[order], share[order]
    last = np.append(edge[1:] != edge[:-1], True)
    start = edges.ends[edge, 0] + share[:, None] * ways[edge]
    stop = np.where(last[:, None], edges.ends[edge, 1], np.roll(start, -1, axis=0))
    divided = _Edges(np.stack([start, stop], axis=1), edges.label[edge])
    return _parted(divided, np.full(len(edge), COARSEST))


def _parted(edges: _Edges, longest: Points, most: int | None = None) -> _Edges:
    """Edges divided evenly, so that none is longer than given, into ``most`` parts at most."""
    ways = np.diff(edges.ends, axis=1)[:, 0]
    count = np.maximum(np.ceil(np.hypot(*ways.T) / longest * (1 - 1e-9)), 1).astype(np.intp)
    count = count.clip(max=most)
    which = np.repeat(np.arange(len(count)), count)
    part = np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count)
    share, step = (part / count[which])[:, None], (1 / count[which])[:, None]
    start = edges.ends[which, 0] + share * ways[which]
    last = (part == count[which] - 1)[:, None]
    stop = np.where(last, edges.ends[which, 1], edges.ends[which, 0] + (share + step) * ways[which])
    return _Edges(np.stack([start, stop], axis=1), edges.label[which])


def _between(
    edges: _Edges, joints: Points, region: BaseGeometry, reach: float
) -> tuple[Shapes, Ints]:
    """The borders that meet a region, in short lines, and the two areas (m, 2) beside each."""
    for left in range(ROUNDS, -1, -1):
        points, first, number = np.unique(
            as_numbers(edges.ends.reshape(-1, 2)), return_index=True, return_inverse=True
        )
        corners = edges.ends.reshape(-1, 2)[first]
        used = ~_is_joint(corners, joints)
        sample = np.cumsum(used) - 1
        label = np.repeat(edges.label, 2)[first][used]
        pairs, lines = _ridges(corners[used], label, reach)
        met = shapely.intersects(region, lines)
        pairs, lines = pairs[met], lines[met]
        if not left or len(points) > ENOUGH:
            break
        gap = np.full(used.sum() + 1, np.inf)
        lengths = np.hypot(*(corners[used][pairs[:, 0]] - corners[used][pairs[:, 1]]).T)
        for side in (0, 1):
            np.minimum.at(gap, pairs[:, side], lengths)
        at = np.where(used, sample, -1)[number.reshape(-1, 2)]
        gap[gap < FINEST] = np.inf
        finer = _parted(edges, np.maximum(SHARE_OF_GAP * gap[at].min(axis=1), FINEST), AT_ONCE)
        if len(finer.label) == len(edges.label):
            break
        edges = finer
    return lines, np.sort(label[pairs], axis=1)


def _ridges(points: Points, label: Ints, reach: float) -> tuple[Ints, Shapes]:
    """Voronoi edges between samples of different areas: the two samples (m, 2), and a line each.

    Lines that meet have an end in common, to the bit: Qhull's triangles on one circle have one
    centre.
    """
    from scipy.spatial import Delaunay

    angles = 2 * np.pi * np.arange(FRAME) / FRAME
    frame = FAR * reach * np.column_stack([np.cos(angles), np.sin(angles)])
    mesh = Delaunay(np.concatenate([points, frame]))
    planes = mesh.equations
    centres = -planes[:, :2] / (2 * planes[:, 2:3] * mesh.paraboloid_scale)
    label = np.concatenate([label, np.full(FRAME, -1)])
    triangle, corner = np.nonzero(mesh.neighbors > np.arange(len(planes))[:, None])
    one, other = (mesh.simplices[triangle, (corner + k) % 3] for k in (1, 2))
    apart = (label[one] != label[other]) & (label[one] >= 0) & (label[other] >= 0)
    ends = np.stack([centres[triangle], centres[mesh.neighbors[triangle, corner]]], axis=1)
    apart &= (ends[:, 0] != ends[:, 1]).any(axis=1)
    pairs = np.column_stack([one, other])[apart]
    return pairs, np.asarray(shapely.linestrings(ends[apart]), dtype=object)


def thinned(lines: Shapes, sides: Ints) -> Shapes:
    """Lines joined that lie between the same two areas (m, 2), without what nobody sees.

    In a box of unit size.
    """
    if not len(lines):
        return lines
    order = np.lexsort(sides.T[::-1])
    _, pair = np.unique(sides[order], axis=0, return_inverse=True)
    chains = shapely.line_merge(shapely.multilinestrings(lines[order], indices=pair.reshape(-1)))
    together = shapely.multilinestrings(shapely.get_parts(chains))
    return np.asarray(shapely.get_parts(shapely.simplify(together, THIN)), dtype=object)
