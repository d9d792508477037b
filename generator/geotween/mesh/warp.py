"""A grid warped onto a boundary: what is near it is moved onto it.

Cells that a boundary cuts close to a corner, or close to a vertex of its own, leave slivers. So
such corners are moved onto the boundary, and sides that pass such vertices are bent to them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from geotween.data.polygons import Shapes
from geotween.mesh.cells import Floats, Grid, Ints, Mask, keys

# A corner goes to the nearest vertex or edge within so much, in cells. Less than half of a cell:
# no two go to one place. More for vertices: a place on an edge is then well away from its ends.
VERTEX_REACH = 0.35
EDGE_REACH = 0.3

# A side that has left the boundary with a slope of no more than this, after this share of its
# length or half of it, is left out: there would be a sliver between the two.
SLOPE = 0.3
NEAR = 0.1

# Vertices that are nearer to a side than this, in cells, and seen from its ends within the slope,
# are made points of it. The boundary would cut it close to them otherwise, and leave slivers.
BEND = 0.1

CORNERS = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])


@dataclass(frozen=True, eq=False)
class Boundary:
    """Closed rings, one after the other.

    ``points`` (n, 2), the last one of each ring as its first; ``ring`` (n,) the number of the
    ring; ``start`` (e,) the first point of each edge.
    """

    points: Floats
    ring: Ints
    start: Ints

    @property
    def edges(self) -> Floats:
        """Edges (e, 2, 2)."""
        return np.stack([self.points[self.start], self.points[self.start + 1]], axis=1)


@dataclass(frozen=True, eq=False)
class Warp:
    """Corners that were moved onto a boundary.

    ``corners`` (k,) are their keys, ascending, and ``places`` (k, 2) where they are now. ``rings``
    (r,) are the boundary's, as lines, with those places as points.
    """

    corners: Ints
    places: Floats
    rings: Shapes

    def moved(self, corners: Ints) -> Mask:
        """Which of some corners (..., 2) were moved."""
        return np.isin(keys(corners), self.corners)

    def sides(self, corners: Ints, free: Mask, grid: Grid) -> Shapes:
        """Sides between corners (s, 2, 2) as lines from where these are now.

        Those that go along the boundary are left out, and those that are free (s,) to do so bend
        to vertices that they would pass closely.
        """
        sides, moved = grid.places(2 * corners), self.moved(corners)
        sides[moved] = self.places[np.searchsorted(self.corners, keys(corners[moved]))]
        points = shapely.get_coordinates(self.rings)
        kept = ~self._along(sides, moved)
        return _bent(sides[kept], free[kept], points, BEND * grid.cell)

    def _along(self, sides: Floats, moved: Mask) -> Mask:
        """Which sides (s, 2, 2), some of their ends (s, 2) moved, go along the boundary."""
        shares = np.array([NEAR, 0.5, 1 - NEAR])
        tried = np.column_stack([moved[:, 0], moved.all(axis=1), moved[:, 1]])
        side, which = np.nonzero(tried)
        start, way = sides[:, 0], sides[:, 1] - sides[:, 0]
        points = shapely.points(start[side] + shares[which, None] * way[side])
        reach = SLOPE * np.minimum(shares, 1 - shares)[which] * np.hypot(*way[side].T)
        edges: Shapes = np.asarray(shapely.linestrings(boundary_of(self.rings).edges))
        found, _ = shapely.STRtree(edges).query(points, predicate="dwithin", distance=reach)
        along = np.zeros(len(sides), dtype=bool)
        along[side[found]] = True
        return along


def _bent(sides: Floats, free: Mask, points: Floats, reach: float) -> Shapes:
    """Sides (s, 2, 2) as lines; the free ones go through points (n, 2) within reach of them."""
    where = np.flatnonzero(free)
    lines: Shapes = np.asarray(shapely.linestrings(sides[where]))
    point, side = shapely.STRtree(lines).query(
        shapely.points(points), predicate="dwithin", distance=reach
    )
    side = where[side]
    start, way = sides[side, 0], sides[side, 1] - sides[side, 0]
    place, length = points[point], np.hypot(*way.T)
    share = ((place - start) * way).sum(axis=1) / length**2
    away = distances(place, start + share[:, None] * way)
    # All of a straight boundary or nothing: what is within the slopes from both ends is convex.
    well = away < SLOPE * length * np.minimum(share, 1 - share)
    side, share, place = side[well], share[well], place[well]
    every = np.arange(len(sides))
    owner = np.concatenate([every, side, every])
    share = np.concatenate([np.zeros(len(sides)), share, np.ones(len(sides))])
    order = np.lexsort((share, owner))
    places = np.concatenate([sides[:, 0], place, sides[:, 1]])[order]
    return np.asarray(shapely.linestrings(places, indices=owner[order]))


def boundary_of(rings: Shapes) -> Boundary:
    """The boundary that closed rings without repeated points are."""
    points, ring = shapely.get_coordinates(rings, return_index=True)
    return Boundary(points, ring, np.flatnonzero(ring[1:] == ring[:-1]))


def warp(boundary: Boundary, cells: Ints, edge: Ints, grid: Grid) -> Warp:
    """The corners that are near a boundary, moved onto it.

    Parameters
    ----------
    cells, edge
        the cells (p, 2) that edges (p,) cross, each pair once.

    Notes
    -----
    What is nearest to a corner within half a cell crosses one of the four cells around it. Cost:
    p log p.
    """
    corners = (cells[:, None] + CORNERS).reshape(-1, 2)
    key, edge = keys(corners), np.repeat(edge, 4)
    at, (start, end) = grid.places(2 * corners), boundary.edges[edge].transpose(1, 0, 2)

    far = np.stack([distances(at, start), distances(at, end)])
    to_vertex = _nearest(key, far.min(axis=0), VERTEX_REACH * grid.cell)
    vertex = (boundary.start[edge] + (far[1] < far[0]))[to_vertex]

    way = end - start
    share = np.clip(((at - start) * way).sum(axis=1) / (way**2).sum(axis=1), 0, 1)
    foot = start + share[:, None] * way
    to_edge = _nearest(key, distances(at, foot), EDGE_REACH * grid.cell)
    to_edge = to_edge[~np.isin(key[to_edge], key[to_vertex])]

    moved = np.concatenate([key[to_vertex], key[to_edge]])
    places = np.concatenate([boundary.points[vertex], foot[to_edge]])
    order = np.argsort(moved, kind="stable")
    rings = _with_places(boundary, edge[to_edge], share[to_edge], foot[to_edge])
    return Warp(moved[order], places[order], rings)


def distances(points: Floats, others: Floats) -> Floats:
    """The distance of each of some points (n, 2) from another."""
    return np.asarray(np.hypot(*(points - others).T))


def _nearest(key: Ints, distance: Floats, reach: float) -> Ints:
    """For each key that has a distance within reach, the number of its least one."""
    near = np.flatnonzero(distance <= reach)
    near = near[np.lexsort((distance[near], key[near]))]
    return near[np.unique(key[near], return_index=True)[1]]


def _with_places(boundary: Boundary, edge: Ints, share: Floats, places: Floats) -> Shapes:
    """Rings as lines, with further places (k, 2): on which edge, after which share of it."""
    order = np.lexsort((share, edge))
    after = boundary.start[edge[order]]
    points = np.insert(boundary.points, after + 1, places[order], axis=0)
    ring = np.insert(boundary.ring, after + 1, boundary.ring[after])
    return np.asarray(shapely.linestrings(points, indices=ring))
