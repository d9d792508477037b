"""Triangle meshes of polygons by a quadtree.

The tree's cells lie in the polygon, on its boundary, or out of it. Those on the boundary are as
small as the tree may have them, those inside as large as a gentle grading allows. Cells inside
are filled by templates; cells on the boundary are clipped, and the pieces filled by constrained
Delaunay triangulation. Before that, corners of cells that all but lie on the boundary are moved
onto it. The parts of a MultiPolygon are meshed each on its own, by one grid.
"""

from __future__ import annotations

import numpy as np
import shapely
from shapely.geometry import MultiPolygon, Polygon

from geotween.data.polygons import Shapes, too_far
from geotween.mesh.cells import Floats, Grid, Ints, Leaves, Mask, crossed, graded, keys
from geotween.mesh.fill import doubled_areas, flipped
from geotween.mesh.mesh import Mesh
from geotween.mesh.templates import triangulated
from geotween.mesh.warp import CORNERS, Warp, boundary_of, warp

# Cells of a level between the boundary, or a finer level, and the next level. One would do for a
# mesh that conforms; with two, a coast with five vertices to a cell has more of the templates'
# good triangles than of the boundary's poor ones.
LAYERS = 2

# The default depth has cells no larger than so many mean edges of the boundary, and no larger than
# this share of the mean width of the polygon (twice its area by its perimeter).
EDGES = 3
WIDTHS = 0.5
LEAST_DEPTH, MOST_DEPTH = 4, 9
DEEPEST = 16  # that can be asked for: cells of a ten-thousandth of a map's width show no more

# The root is larger than the polygon's box by this share of it. Where rounding spoils a mesh, the
# next one has cells that lie elsewhere.
PADDINGS = (1e-6, 0.011, 0.023, 0.037, 0.053)

# The mesh's area may differ from the polygon's by this share of it; and rounding may move vertices
# that the cells add to the boundary by this share of their coordinates.
AREA_TOLERANCE = 1e-12
ROUNDING = 4 * float(np.finfo(np.float64).eps)


def quadtree(polygon: Polygon | MultiPolygon, depth: int | None = None) -> Mesh:
    """A mesh of a polygon by a quadtree of some depth.

    Parameters
    ----------
    depth
        how often the square around the polygon is halved, from 0: cells on the boundary are
        1 / 2**depth of its width. By default a depth that suits the polygon's edges and width.

    Returns
    -------
    Mesh
        Every vertex of the polygon is one of its points, to the bit, and the boundary has further
        ones where cells meet it. It is the same for the same polygon.

    Raises
    ------
    ValueError
        If the polygon is empty or not valid, lies too far from the origin for its size, or if
        the depth is not from 0 to 16.
    ArithmeticError
        If rounding spoils the mesh wherever the cells are put.

    Notes
    -----
    The cells' templates are fans of right isosceles triangles. Cost: c log c for c cells and
    vertices.

    References
    ----------
    Balanced quadtrees for meshes: Bern, Eppstein, Gilbert, "Provably good mesh generation", 1994.
    Corners that are moved onto the boundary: Labelle, Shewchuk, "Isosurface stuffing", 2007, does
    so in space.
    """
    _check(polygon, depth)
    if depth is None:
        depth = default_depth(polygon)
    grids = [_grid(polygon, depth, padding) for padding in PADDINGS]
    parts = shapely.get_parts(shapely.remove_repeated_points(polygon))
    meshes = [_first_right(part, grids) for part in parts]
    return joined(np.concatenate([mesh.points[mesh.triangles] for mesh in meshes]))


def default_depth(polygon: Polygon | MultiPolygon) -> int:
    """The depth at which cells are as fine as a polygon's edges and width ask for."""
    edges = shapely.get_num_coordinates(polygon) - len(
        shapely.get_rings(shapely.get_parts(polygon))
    )
    length = shapely.length(polygon)
    cell = min(EDGES * length / edges, WIDTHS * 2 * shapely.area(polygon) / length)
    # A little less, so that rounding does not decide where the depth would be whole.
    depth = np.ceil(np.log2(_extent(polygon) / cell) - ROUNDING)
    return int(np.clip(depth, LEAST_DEPTH, MOST_DEPTH))


def _check(polygon: Polygon | MultiPolygon, depth: int | None) -> None:
    if not isinstance(polygon, Polygon | MultiPolygon):
        raise ValueError(f"a mesh is of a Polygon or MultiPolygon, not of {polygon!r}")
    if polygon.is_empty:
        raise ValueError("a mesh is of a polygon that is not empty")
    if not polygon.is_valid:
        reason = shapely.is_valid_reason(polygon)
        raise ValueError(f"a mesh is of a valid polygon; this is not: {reason}")
    if too_far(shapely.bounds(polygon)):
        raise ValueError("the polygon lies too far from the origin for its size; shift it")
    if depth is not None and not 0 <= depth <= DEEPEST:
        raise ValueError(f"a quadtree's depth is from 0 to {DEEPEST}, not {depth}")


def _extent(polygon: Polygon | MultiPolygon) -> float:
    low, high = np.split(shapely.bounds(polygon), 2)
    return float((high - low).max())


def _grid(polygon: Polygon | MultiPolygon, depth: int, padding: float) -> Grid:
    """The grid of a root that is centred on a polygon."""
    low, high = np.split(shapely.bounds(polygon), 2)
    side = _extent(polygon) * (1 + padding)
    return Grid((low + high - side) / 2, side, depth)


def _first_right(polygon: Polygon, grids: list[Grid]) -> Mesh:
    shapely.prepare(polygon)
    for grid in grids:
        mesh = _meshed(polygon, grid)
        if _is_right(mesh, polygon):
            return mesh
    raise ArithmeticError("rounding spoils every mesh of this polygon; simplify it a little")


def _meshed(polygon: Polygon, grid: Grid) -> Mesh:
    boundary = boundary_of(shapely.get_rings(polygon))
    cells, edge = crossed(boundary.edges, grid)
    warped = warp(boundary, cells, edge, grid)
    leaves = graded(cells, grid.depth, LAYERS)
    on = _on(leaves, cells, warped)
    inner = leaves.chosen(~on)
    centres = grid.places(inner.low + inner.size[:, None] // 2)
    inside = np.asarray(shapely.contains_xy(polygon, *centres.T))
    inner = inner.chosen(inside)
    pieces = _clipped(polygon, leaves.low[on] // 2, warped, grid)
    return joined(np.concatenate([triangulated(inner, grid), _filled(pieces)]))


def _on(leaves: Leaves, cells: Ints, warped: Warp) -> Mask:
    """Which leaves are on the boundary, or have a corner that was moved onto it."""
    # The layers see to it that no larger cell has such a corner, nor such a middle of a side.
    finest = leaves.size == 2
    own = leaves.low // 2
    cut = np.isin(keys(own), keys(cells))
    return np.asarray(finest & (cut | warped.moved(own[:, None] + CORNERS).any(axis=1)))


def _clipped(polygon: Polygon, cells: Ints, warped: Warp, grid: Grid) -> Shapes:
    """The pieces (f,) of a polygon in cells of the finest level, with their vertices in common."""
    corners = cells[:, None] + CORNERS
    # Each from its lower or left end, so that cells have the same one.
    sides = np.concatenate([corners[:, pair] for pair in ([0, 1], [3, 2], [0, 3], [1, 2])])
    upright = sides[:, 0, 0] == sides[:, 1, 0]
    name = 2 * keys(sides[:, 0]) + upright
    _, first, count = np.unique(name, return_index=True, return_counts=True)
    lines = warped.sides(sides[first], count == 2, grid)
    noded = shapely.unary_union(np.concatenate([warped.rings, lines]))
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(noded)))
    # Further faces are what lies outside, and what lies between cells.
    inside = shapely.point_on_surface(faces)
    here = np.floor(grid.cells(shapely.get_coordinates(inside))).astype(np.int64)
    return faces[np.isin(keys(here), keys(cells)) & shapely.contains(polygon, inside)]


def _filled(pieces: Shapes) -> Floats:
    """Constrained Delaunay triangles (t, 3, 2) of polygons."""
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(pieces))
    return np.asarray(shapely.get_coordinates(triangles).reshape(-1, 4, 2)[:, :3])


def joined(corners: Floats) -> Mesh:
    """The mesh of triangles (t, 3, 2) that share their corners to the bit."""
    known, number = np.unique(corners.reshape(-1, 2).view(np.complex128), return_inverse=True)
    points = known.view(np.float64).reshape(-1, 2)
    triangles = number.reshape(-1, 3).astype(np.intp)
    clockwise = doubled_areas(points, triangles) < 0
    triangles[clockwise] = triangles[clockwise][:, ::-1]
    # All but straight boundaries may leave flat triangles.
    return Mesh(points, flipped(points, triangles, np.zeros(len(triangles), dtype=np.intp)))


def _is_right(mesh: Mesh, polygon: Polygon) -> bool:
    """Whether a mesh conforms and fills a polygon, with its vertices and no flat triangle."""
    areas = doubled_areas(mesh.points, mesh.triangles) / 2
    slip = ROUNDING * float(np.abs(shapely.bounds(polygon)).max())
    error = AREA_TOLERANCE * polygon.area + slip * polygon.length
    vertices = shapely.get_coordinates(polygon).view(np.complex128)
    return bool(
        areas.min() > 0
        and abs(areas.sum() - polygon.area) <= error
        and np.isin(vertices, mesh.points.view(np.complex128)).all()
        and abs(_rim(mesh) - polygon.length) <= AREA_TOLERANCE * polygon.length + slip * len(areas)
    )


def _rim(mesh: Mesh) -> float:
    """The length of the sides that do not belong to exactly two triangles."""
    start, end = mesh.triangles.ravel(), np.roll(mesh.triangles, -1, axis=1).ravel()
    ends = np.sort(np.column_stack([start, end]), axis=1)
    _, first, count = np.unique(keys(ends), return_index=True, return_counts=True)
    sides = ends[first[count != 2]]
    return float(np.hypot(*(mesh.points[sides[:, 1]] - mesh.points[sides[:, 0]]).T).sum())
