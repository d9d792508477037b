"""The faces between the borders of polygons: noded, with vertices where they were."""

from __future__ import annotations

from functools import partial

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import Geometry

from geotween.data.polygons import extent

# A vertex is nowhere nearer to an edge than this share of the extent, or than some roundings of
# the coordinates, or it lies on it: triangles can be told from their mirror images.
NEAREST, ROUNDINGS = 1e-12, 32

# What is left of that where vertices that were snapped to a grid are put back.
APART = 1 / 8

# By how much the faces of a polygon may add up to more or less than it, relative to its area.
AREA_ERROR = 1e-12

# Where lines all but meet they are crossed on a grid of that size, and then on coarser ones.
COARSER = (1, 16, 256)

Ints = NDArray[np.intp]
Floats = NDArray[np.float64]
Shapes = NDArray[np.object_]


def faces_between(polygons: Shapes) -> tuple[Shapes, Ints, Ints]:
    """The faces into which the boundaries of polygons part the plane, and who covers them.

    Parameters
    ----------
    polygons
        Valid polygons (n,), in any number of layers over each other; at least one.

    Returns
    -------
    faces
        Polygons, outer rings counter-clockwise, that share their vertices to the bit.
    holder, face
        The numbers of a polygon and of a face that it covers, each such pair once.

    Raises
    ------
    ArithmeticError
        Where the faces do not add up to the polygons, however they are noded.

    Notes
    -----
    Noding is OverlayNG's (Davis, JTS) without a grid size: vertices stay where they are, and new
    ones are crossings only. Where lines differ by nothing but rounding that can fail, or leave
    faces as thin as that. Then lines are snapped to a grid (Hobby, 1999), on which all but equal
    places become equal, and the vertices are put back where they were. O(n log n) for n vertices
    and crossings.
    """
    box = shapely.total_bounds(polygons)
    rounding = float(np.finfo(float).eps * np.abs(box).max())
    near = max(NEAREST * extent(box), ROUNDINGS * rounding)
    lines: Geometry = shapely.union_all(shapely.boundary(polygons))
    if _clear(lines, near):
        faces = _polygonized(lines)
        holder, face = _covered(faces, polygons)
        if _add_up(faces, polygons, holder, face, rounding):
            return faces, holder, face
    for times in COARSER:
        grid = float(2.0 ** np.ceil(np.log2(times * near)))
        snapped = shapely.union_all(shapely.boundary(polygons), grid_size=grid)
        for lines in (_put_back(snapped, polygons, grid), snapped):
            faces = _polygonized(lines)
            if _clear(lines, near * APART) and shapely.is_valid(faces).all():
                holder, face = _covered(faces, polygons)
                if _add_up(faces, polygons, holder, face, grid):
                    return faces, holder, face
    raise ArithmeticError("the borders of both steps cannot be cut with each other")


def _polygonized(lines: Geometry) -> Shapes:
    faces = shapely.get_parts(shapely.polygonize([lines]))
    return np.asarray(shapely.orient_polygons(faces, exterior_cw=False), dtype=object)


def _clear(lines: Geometry, near: float) -> bool:
    """Whether no vertex of noded lines is nearer than that to an edge of which it is no end."""
    points, line = shapely.get_coordinates(shapely.get_parts(lines), return_index=True)
    within = line[1:] == line[:-1]
    ends = np.stack([points[:-1][within], points[1:][within]], axis=1)
    places = np.unique(points, axis=0)
    tree = shapely.STRtree(np.asarray(shapely.linestrings(ends), dtype=object))
    place, edge = tree.query(shapely.points(places), predicate="dwithin", distance=near)
    incident = (places[place][:, None] == ends[edge]).all(axis=2).any(axis=1)
    return bool(incident.all())


def _covered(faces: Shapes, polygons: Shapes) -> tuple[Ints, Ints]:
    tree = shapely.STRtree(shapely.point_on_surface(faces))
    holder, face = tree.query(polygons, predicate="contains")
    return holder, face


def _add_up(faces: Shapes, polygons: Shapes, holder: Ints, face: Ints, off: float) -> bool:
    """Whether faces add up to their polygons, whose outlines may be off by some length."""
    areas = shapely.area(polygons)
    found = np.bincount(holder, weights=shapely.area(faces)[face], minlength=len(polygons))
    allowed = AREA_ERROR * areas + off * shapely.length(polygons)
    return bool((np.abs(found - areas) <= allowed).all())


def _put_back(lines: Geometry, polygons: Shapes, grid: float) -> Geometry:
    """Lines on a grid with each vertex moved to the first one of the polygons in its cell."""
    given = np.unique(shapely.get_coordinates(polygons), axis=0)
    on_grid = shapely.get_coordinates(shapely.set_precision(shapely.points(given), grid))
    cells, first = np.unique(_numbers(on_grid), return_index=True)
    return shapely.transform(lines, partial(_found, cells, given[first]))


def _found(cells: NDArray[np.complex128], places: Floats, points: Floats) -> Floats:
    wanted = _numbers(points)
    at = np.searchsorted(cells, wanted).clip(max=len(cells) - 1)
    return np.where((cells[at] == wanted)[:, None], places[at], points)


def _numbers(points: Floats) -> NDArray[np.complex128]:
    """Points as one number each, to sort and find them."""
    return points[:, 0] + 1j * points[:, 1]
