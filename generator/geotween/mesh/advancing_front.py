"""Triangulate a polygon by a front that advances from its boundary inwards.

The technique is that of Miranda, A.C.O., Cavalcante Neto, J.B., Martha, L.F. (1999), "An algorithm
for two-dimensional mesh generation for arbitrary regions with cracks", SIBGRAPI: the boundary is
given as segments; a background quadtree grades the size of elements; an edge of the front takes a
point near its ideal one, or the ideal one, and else any point that makes a valid triangle; where
that leaves poor ones, the front is set back; points are smoothed where quality improves.

Beyond it: every test of validity is exact, so that the front closes in all cases; edges that are
long for their surroundings advance first, through ever shorter ones, before short edges take their
room; and diagonals are flipped where that makes two triangles better.
"""

from __future__ import annotations

from math import frexp

import numpy as np
import shapely
from shapely.geometry import MultiPolygon, Polygon

from geotween.data.polygons import Shapes, extent
from geotween.mesh.front_advance import Front
from geotween.mesh.front_retreat import retreated
from geotween.mesh.front_tree import FrontTree
from geotween.mesh.mesh import Mesh
from geotween.mesh.sizes import Floats, size_function
from geotween.mesh.smoothing import Ints, improved

# Sizes grow inwards by this share of the distance: slowly, for quality; faster by steps where few
# short edges among long ones would take more triangles than there should be for each edge.
GROWTH, FASTER, FASTEST = 0.08, 1.25, 0.3
PER_EDGE = 60

MOST = 5_000_000  # triangles; more would hardly fit in memory
ROUNDS = 2  # of flips and smoothing
EQUILATERAL = 3**0.5 / 4  # the area of a triangle, in squares of its side


def advancing_front(polygon: Polygon | MultiPolygon, size: float | None = None) -> Mesh:
    """A mesh of a polygon, with triangles as equilateral as its edges permit.

    Parameters
    ----------
    polygon : valid, with holes or not. The parts of a MultiPolygon are meshed one by one.
    size : the longest that a triangle's sides should be, in the polygon's units. Without it, sizes
        grow inwards from the lengths of the edges, to some 60 triangles for each edge at most.

    Returns
    -------
    The boundary's points come first, to the bit, and no other ones lie on the boundary: each of its
    edges is a side of a triangle. Where rings touch within an edge, it is two edges.

    Raises
    ------
    ValueError
        If the polygon is empty or invalid, or the size not positive, or too small for the polygon.

    Notes
    -----
    Edges are not divided. So a triangle is poor where the boundary has sharp angles, or long edges
    beside short ones or nearer to other edges than they are long. Cost: n log n for n triangles.
    """
    _check(polygon, size)
    meshes = [_mesh(part, size) for part in shapely.get_parts([polygon])]
    shifts = np.cumsum([0, *(len(mesh.points) for mesh in meshes)])
    return Mesh(
        np.concatenate([mesh.points for mesh in meshes]),
        np.concatenate([m.triangles + s for m, s in zip(meshes, shifts, strict=False)]),
    )


def _check(polygon: Polygon | MultiPolygon, size: float | None) -> None:
    if not isinstance(polygon, Polygon | MultiPolygon):
        raise ValueError(f"only polygons are triangulated, not a {polygon.geom_type}")
    if polygon.is_empty:
        raise ValueError("an empty polygon has no triangles")
    if not polygon.is_valid:
        raise ValueError(f"the polygon is not valid: {shapely.is_valid_reason(polygon)}")
    if size is not None and not size > 0:
        raise ValueError(f"a size is a positive length, not {size:g}")
    if size is not None and polygon.area / size / size > MOST * EQUILATERAL:
        raise ValueError(f"size {size:g} would take more than {MOST:,} triangles: choose a larger")


def _mesh(polygon: Polygon, size: float | None) -> Mesh:
    original, edges = _boundary(polygon)
    # Scaled by a power of two, nothing is rounded, and squares of lengths do not overflow.
    power = frexp(extent(np.array(polygon.bounds)))[1]
    points = np.ldexp(original, -power)
    unit = shapely.transform(polygon, lambda places: np.ldexp(places, -power))
    tree = _tree(unit, points, edges, size and float(np.ldexp(size, -power)))

    front = Front(points, tree)
    for a, b in edges.tolist():
        front.add(a, b)
    front.advance()
    points = np.column_stack([front.x, front.y])
    triangles = np.array(front.triangles, dtype=np.intp)

    points, triangles = _improved(points, triangles, len(original), ROUNDS)
    points, triangles = retreated(points, triangles, tree, len(original))
    points, triangles = _improved(points, triangles, len(original), 1)
    used = np.unique(triangles)
    points = np.ldexp(points, power)
    points[: len(original)] = original
    return Mesh(points[used], np.searchsorted(used, triangles))


def _improved(points: Floats, triangles: Ints, fixed: int, rounds: int) -> tuple[Floats, Ints]:
    """Points and triangles, flipped and smoothed; the first points stay."""
    free = np.arange(len(points)) >= fixed
    return improved(points, triangles, free, np.zeros(len(triangles), dtype=np.intp), rounds)


def _boundary(polygon: Polygon) -> tuple[Floats, Ints]:
    """The boundary's points (n, 2), each once, and its edges (k, 2), the polygon at their left."""
    edges = _edges(shapely.orient_polygons(shapely.force_2d(polygon)))
    places = edges.reshape(-1, 2)
    _, first, number = np.unique(places, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first, kind="stable")
    rank = np.empty(len(order), dtype=np.intp)
    rank[order] = np.arange(len(order))
    return places[first[order]], rank[number.reshape(-1)].reshape(-1, 2)


def _edges(polygon: Polygon) -> Floats:
    """The boundary's edges (k, 2, 2), divided where another ring touches them."""
    rings: Shapes = shapely.get_rings(polygon)
    places, ring = shapely.get_coordinates(rings, return_index=True)
    edges = _proper(np.stack([places[:-1], places[1:]], axis=1)[ring[:-1] == ring[1:]])
    starts = edges[:, 0]
    lines: Shapes = np.asarray(shapely.linestrings(edges), dtype=object)
    on, edge = shapely.STRtree(lines).query(shapely.points(starts), predicate="intersects")
    within = (starts[on, None] != edges[edge]).any(axis=2).all(axis=1)
    on, edge = on[within], edge[within]
    if not len(on):
        return edges
    along = np.hypot(*(starts[on] - edges[edge, 0]).T)
    owner = np.concatenate([np.arange(len(edges)), edge])
    order = np.lexsort([np.concatenate([np.zeros(len(edges)), along]), owner])
    corners = np.concatenate([starts, starts[on]])[order]
    ends = np.concatenate([corners[1:], corners[:1]])
    last = np.append(owner[order][1:] != owner[order][:-1], True)
    ends[last] = edges[:, 1]
    return _proper(np.stack([corners, ends], axis=1))


def _proper(edges: Floats) -> Floats:
    """Edges (k, 2, 2) that have a length."""
    return np.asarray(edges[(edges[:, 0] != edges[:, 1]).any(axis=1)])


def _tree(polygon: Polygon, points: Floats, edges: Ints, size: float | None) -> FrontTree:
    """The background quadtree of a polygon, by its own edges and perhaps a largest size."""
    middles = points[edges].mean(axis=1)
    lengths = np.hypot(*(points[edges[:, 1]] - points[edges[:, 0]]).T)
    low, high = points.min(axis=0), points.max(axis=0)
    x, y = ((low + high) / 2).tolist()
    box = x, y, float((high - low).max()) / 2
    shapely.prepare(polygon)
    growth = GROWTH
    while True:
        tree = FrontTree(box, size_function(middles, lengths, growth, size or np.inf))
        count = _count(polygon, tree)
        if size is not None or count <= PER_EDGE * len(edges) or growth >= FASTEST:
            return tree
        growth *= FASTER


def _count(polygon: Polygon, tree: FrontTree) -> float:
    """How many triangles there are going to be, about."""
    centres, sides, sizes = tree.leaves()
    inside = shapely.contains_xy(polygon, *centres.T)
    return float(((sides / sizes) ** 2)[inside].sum()) / EQUILATERAL
