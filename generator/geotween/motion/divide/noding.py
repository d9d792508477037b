"""The faces into which lines part a polygon: all noded at once, so that seams match to the bit."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from shapely.geometry import Polygon

from geotween.motion.divide.faces import (
    Faces,
    Shapes,
    array_of,
    as_numbers,
    joined,
    mean_width,
    places_in,
)
from geotween.motion.divide.outline import replaced

# By how much faces may miss their polygon, relative to its area and length, before they are noded
# in another way.
MISSING = 3e-10

# A face narrower than this on average, in extents, is nothing but rounding.
HAIR = 1e-11

# Where lines all but meet they are noded on a grid of this size, in shares of the extent or in
# roundings of the coordinates, whichever is larger; and then on coarser ones.
GRID, ROUNDINGS, COARSER = 1e-14, 8, (1, 16, 256, 4096, 65536)


def faces_between(polygon: Polygon, lines: Shapes) -> Faces:
    """The faces into which lines part a polygon, ordered by place. Cost: n log n.

    Noding is OverlayNG's (Davis, JTS). Where lines all but meet it can lose a face, or leave one
    that is as thin as rounding and as long as the lines; then they are snapped to a grid (Hobby,
    1999), and the polygon's vertices are put back where they were.
    """
    shapely.prepare(polygon)
    extent = float(np.ptp(shapely.get_coordinates(polygon), axis=0).max())
    every = np.concatenate([array_of([polygon.boundary]), lines])
    found: list[tuple[float, int, int, Faces]] = []
    for grid in (None, *_grids(polygon)):
        noded = shapely.union_all(every, grid_size=grid)
        parts = shapely.get_parts(shapely.polygonize([_put_back(noded, polygon, grid)]))
        places = places_in(parts)
        inside = np.asarray(shapely.contains_xy(polygon, *places.T), dtype=bool)
        faces = Faces(parts[inside][np.lexsort(places[inside].T)])
        wrong, hairs = _wrong(faces, polygon), int((mean_width(parts) < HAIR * extent).sum())
        found.append((wrong if wrong > MISSING else 0.0, hairs, len(found), faces))
        if not any(found[-1][:2]):
            break
    return min(found, key=lambda attempt: attempt[:3])[3]


def rejoined(polygon: Polygon, faces: Shapes) -> Polygon:
    """A polygon with the vertices that its faces have on its outline.

    These need not lie on its edges to the bit: lines that end there would miss the polygon's own.
    """
    whole = joined(faces)
    return whole if isinstance(whole, Polygon) and whole.is_valid else polygon


def _wrong(faces: Faces, polygon: Polygon) -> float:
    """By how much faces do not tile a polygon: in area, and in edges that no two of them share."""
    if not shapely.is_valid(faces.polygons).all():
        return np.inf
    outline = shapely.length(faces.polygons).sum() - 2 * faces.seams.lengths.sum()
    return float(abs(faces.areas.sum() / polygon.area - 1) + abs(outline / polygon.length - 1))


def _grids(polygon: Polygon) -> list[float]:
    """The sizes of grids, from fine to coarse: powers of two."""
    box = np.array(polygon.bounds)
    rounding = np.finfo(float).eps * np.abs(box).max()
    finest = max(GRID * (box[2:] - box[:2]).max(), ROUNDINGS * rounding)
    return [float(2.0 ** np.ceil(np.log2(times * finest))) for times in COARSER]


def _put_back(lines: Any, polygon: Polygon, grid: float | None) -> Any:
    """Lines on a grid with each vertex moved to the first one of the polygon in its cell."""
    if grid is None:
        return lines
    given = np.unique(as_numbers(shapely.get_coordinates(polygon)))
    points: Any = shapely.points(given.real, given.imag)
    on_grid = as_numbers(shapely.get_coordinates(shapely.set_precision(points, grid)))
    cells, first = np.unique(on_grid, return_index=True)
    return shapely.transform(lines, lambda places: replaced(places, cells, given[first]))
