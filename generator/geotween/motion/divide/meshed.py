"""Divide a polygon by a triangle mesh: each triangle goes to a correspondent as a whole.

A triangle that meets correspondents goes to the one that has the largest share of it, any other
to the nearest. Seams run along the mesh; smoothing takes its zigzag away.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import shapely
from shapely.geometry import Polygon

from geotween.mesh.mesh import Mesh
from geotween.motion.divide.faces import Faces, Ints, Piece, Shapes, array_of, holders
from geotween.motion.divide.partition import Mend, of_faces
from geotween.motion.divide.smooth import smoothed

# A triangle that shares less of its area than this with a correspondent only touches it.
TOUCHING = 1e-9

# A mesh has at least so many triangles, of equal size, as would fill the polygon, and so many for
# each correspondent; but no deeper a quadtree than this for their sake.
LEAST, EACH, DEEPEST = 1000, 20, 8


def advancing_front(
    polygon: Polygon,
    correspondents: Sequence[Piece],
    connected: bool = True,
    smooth: bool = False,
) -> tuple[list[Piece], list[Mend]]:
    """One piece of the polygon for each correspondent, along a mesh by advancing front."""
    from geotween.mesh import advancing_front as mesh

    size = _size(polygon, len(correspondents))
    # Of a polygon with long edges the mesh would be coarse: it divides none.
    return by_mesh(
        lambda outline: mesh(outline.segmentize(size), size),
        polygon,
        correspondents,
        connected,
        smooth,
    )


def quadtree(
    polygon: Polygon,
    correspondents: Sequence[Piece],
    connected: bool = True,
    smooth: bool = False,
) -> tuple[list[Piece], list[Mend]]:
    """One piece of the polygon for each correspondent, along a quadtree mesh."""
    from geotween.mesh.quadtree import default_depth
    from geotween.mesh.quadtree import quadtree as mesh

    box = np.array(polygon.bounds)
    cells = (box[2:] - box[:2]).max() / _size(polygon, len(correspondents))
    depth = max(default_depth(polygon), min(int(np.ceil(np.log2(cells))), DEEPEST))
    return by_mesh(lambda outline: mesh(outline, depth), polygon, correspondents, connected, smooth)


def by_mesh(
    mesher: Callable[[Polygon], Mesh],
    polygon: Polygon,
    correspondents: Sequence[Piece],
    connected: bool = True,
    smooth: bool = False,
) -> tuple[list[Piece], list[Mend]]:
    """One piece of the polygon for each correspondent, in their order, and what was mended.

    Cost: the mesh's, and an intersection for each triangle that crosses a correspondent's outline.
    """
    mesh = mesher(polygon)
    triangles = np.asarray(shapely.polygons(mesh.points[mesh.triangles]), dtype=object)
    owner = _owners(triangles, array_of(correspondents))
    pieces, mends = of_faces(polygon, Faces(triangles), owner, list(correspondents), connected)
    if smooth:
        pieces = smoothed(polygon, pieces, list(correspondents), connected)
    return pieces, mends


def _size(polygon: Polygon, count: int) -> float:
    """The side of triangles that are enough to divide a polygon among so many."""
    triangles = max(LEAST, EACH * count)
    return max(float(np.sqrt(4 / 3**0.5 * polygon.area / triangles)), polygon.length / triangles)


def _owners(triangles: Shapes, areas: Shapes) -> Ints:
    """The area (m,) that has the largest share of each triangle, else the one nearest to it."""
    tree = shapely.STRtree(triangles)
    area, triangle = tree.query(areas, predicate="intersects")
    whole = np.zeros((len(areas), len(triangles)), dtype=bool)
    whole[tuple(tree.query(areas, predicate="contains"))] = True
    size = shapely.area(triangles)
    shared = size[triangle].copy()
    crossed = np.flatnonzero(~whole[area, triangle])
    shared[crossed] = shapely.area(
        shapely.intersection(triangles[triangle[crossed]], areas[area[crossed]])
    )
    meets = shared > TOUCHING * size[triangle]
    owner = holders(areas, np.asarray(shapely.get_coordinates(shapely.centroid(triangles))))
    order = np.flatnonzero(meets)
    order = order[np.lexsort((-area[order], shared[order]))]
    owner[triangle[order]] = area[order]
    return owner
