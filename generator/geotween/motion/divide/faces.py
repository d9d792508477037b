"""Faces: polygons that tile a polygon, the edges that they share, and unions of them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon, Polygon

from geotween.motion.rings import next_vertex, rings_of

Points = NDArray[np.float64]
Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]
Shapes = NDArray[np.object_]
Piece = Polygon | MultiPolygon


@dataclass(frozen=True, eq=False)
class Seams:
    """Pairs of faces (m,) with a common edge, each once, and that edge (m, 2, 2)."""

    left: Ints
    right: Ints
    ends: Points

    @property
    def lengths(self) -> Floats:
        return np.asarray(np.hypot(*(self.ends[:, 1] - self.ends[:, 0]).T))


@dataclass(frozen=True, eq=False)
class Faces:
    """Polygons (f,) that tile a polygon and have all vertices of their common edges in common."""

    polygons: Shapes

    @cached_property
    def areas(self) -> Floats:
        return np.asarray(shapely.area(self.polygons))

    @cached_property
    def places(self) -> Points:
        """A point within each, (f, 2)."""
        return places_in(self.polygons)

    @cached_property
    def seams(self) -> Seams:
        rings = rings_of(self.polygons)
        _, number = numbered(rings.vertices)
        following = next_vertex(rings.offsets)
        edge = edge_numbers(number, number[following])
        order = np.argsort(edge, kind="stable")
        twin = np.flatnonzero(edge[order][1:] == edge[order][:-1])
        one, other = order[twin], order[twin + 1]
        ends = np.stack([rings.vertices, rings.vertices[following]], axis=1)
        face = np.repeat(rings.polygon_of, np.diff(rings.offsets))
        return Seams(face[one], face[other], ends[one])


def places_in(polygons: Shapes) -> Points:
    """A point within each polygon, (f, 2).

    GEOS's point on the surface is a vertex at times, where several lie on its scan line but for
    rounding; then it is the middle of the largest triangle.
    """
    points: Any = shapely.point_on_surface(polygons)
    places = np.asarray(shapely.get_coordinates(points))
    for k in np.flatnonzero(~shapely.contains(polygons, points)):
        triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(polygons[k]))
        if len(triangles):
            largest = triangles[np.argmax(shapely.area(triangles))]
            places[k] = shapely.get_coordinates(largest.centroid)[0]
    return places


def holders(areas: Shapes, places: Points) -> Ints:
    """The area (f,) that each place lies in, else the one nearest to it."""
    points: Any = shapely.points(places)
    found = np.full(len(places), -1, dtype=np.intp)
    place, area = shapely.STRtree(areas).query(points, predicate="within")
    found[place[::-1]] = area[::-1]
    open_ = np.flatnonzero(found < 0)
    if len(open_):
        outlines, owner = shapely.get_parts(shapely.boundary(areas), return_index=True)
        corners, line = shapely.get_coordinates(outlines, return_index=True)
        start = np.flatnonzero(line[1:] == line[:-1])
        edges: Any = shapely.linestrings(np.stack([corners[start], corners[start + 1]], axis=1))
        place, edge = shapely.STRtree(edges).query_nearest(points[open_], all_matches=False)
        found[open_[place]] = owner[line[start[edge]]]
    return found


def joined(faces: Shapes) -> Piece:
    """Faces as one polygon, or several where they do not hang together by edges."""
    if len(faces) == 1:
        return together(faces)
    try:
        union = shapely.coverage_union_all(faces)
    except shapely.errors.GEOSException:  # some are thinner than their coordinates' roundings
        union = shapely.union_all(faces)
    return together(shapely.get_parts(union))


def together(parts: Shapes) -> Piece:
    """A polygon, or a MultiPolygon where there are several."""
    only: Piece = parts[0]
    return only if len(parts) == 1 else MultiPolygon(list(parts))


def largest_part(parts: Shapes) -> Polygon:
    """The largest of some polygons."""
    largest: Polygon = parts[np.argmax(shapely.area(parts))]
    return largest


def mean_width(polygons: Any) -> Any:
    """The width of a strip of a polygon's area and length, for each."""
    return 2 * shapely.area(polygons) / shapely.length(polygons)


def array_of(shapes: Iterable[Any]) -> Shapes:
    """Geometries as an array (n,)."""
    return np.array(list(shapes), dtype=object)


def as_numbers(points: Points) -> NDArray[np.complex128]:
    """Points (n, 2) as one number each (n,), to sort and find them."""
    return np.asarray(points[:, 0] + 1j * points[:, 1])


def numbered(points: Points) -> tuple[NDArray[np.complex128], Ints]:
    """The different places, and the number of each point's."""
    places, number = np.unique(as_numbers(points), return_inverse=True)
    return places, number.reshape(-1).astype(np.intp)


def edge_numbers(start: Ints, end: Ints) -> Ints:
    """A number for each edge between numbered places, the same whichever way round it runs."""
    base = max(start.max(initial=0), end.max(initial=0)) + 1
    return np.asarray(np.minimum(start, end) * base + np.maximum(start, end), dtype=np.intp)
