"""Divide a polygon by the Voronoi cells of one seed for each of its correspondents.

The seeds are the paper's: of each correspondent the vertex nearest to the centroid of the polygon
that is divided. What degenerates is mended, so that the pieces partition the polygon, each is one
polygon, and none is empty. Cost: n log n for n vertices and seeds together, times the mended cells.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from shapely.geometry import MultiPoint, Point, Polygon

from geotween.data.polygons import RELATIVE_TOLERANCE
from geotween.motion.divide.faces import Ints, Piece, Points, Shapes
from geotween.motion.divide.partition import Mend, partition


def voronoi(
    polygon: Polygon, correspondents: Sequence[Piece], connected: bool = True
) -> tuple[list[Piece], list[Mend]]:
    """One piece of the polygon for each correspondent, in their order, and what was mended."""
    seeds, mends = _seeds(polygon, correspondents)

    def nearest(places: Points) -> Ints:
        distances = ((places[:, None] - seeds[None]) ** 2).sum(axis=2)
        return np.asarray(distances.argmin(axis=1))

    lines = _voronoi_lines(polygon, seeds)
    aims = [Point(seed) for seed in seeds]
    pieces, more = partition(polygon, lines, nearest, aims, connected)
    return pieces, mends + more


def _seeds(polygon: Polygon, correspondents: Sequence[Piece]) -> tuple[Points, list[Mend]]:
    """A distinct seed for each correspondent, (k, 2): its vertex nearest to the centroid.

    Of vertices equally near, the leftmost, then the lowest: no matter where a ring begins.
    """
    centre = shapely.get_coordinates(polygon.centroid)[0]
    reach = np.ptp(shapely.get_coordinates(polygon), axis=0).max()
    tolerance = RELATIVE_TOLERANCE * reach
    seeds = np.empty((0, 2))
    mends = []
    for cell, correspondent in enumerate(correspondents):
        candidates, clashed = shapely.get_coordinates(correspondent), False
        longest = correspondent.length
        while True:
            distances = np.rint(np.hypot(*(candidates - centre).T) / tolerance)
            order = np.lexsort((candidates[:, 1], candidates[:, 0], distances))
            gaps = np.hypot(*(candidates[order][:, None] - seeds[None]).T).T
            free = (gaps > tolerance).all(axis=1)
            clashed |= not free[0]
            if free.any():
                break
            # All its vertices are others' seeds: take points along its edges, then around it.
            longest /= 2
            if longest > tolerance:
                candidates = shapely.get_coordinates(shapely.segmentize(correspondent, longest))
            else:
                steps = np.arange(1, len(seeds) + 2)[:, None]
                candidates = candidates[:1] + 2 * tolerance * steps * [1.0, 0.0]
        seeds = np.vstack([seeds, candidates[order[np.argmax(free)]]])
        if clashed:
            mends.append(Mend("coincident seeds", cell))
    return seeds, mends


def _voronoi_lines(polygon: Polygon, seeds: Points) -> Shapes:
    """The borders between the cells, reaching beyond the polygon on all sides."""
    box = np.array(shapely.total_bounds([polygon, MultiPoint(seeds)]))
    middle, size = (box[:2] + box[2:]) / 2, (box[2:] - box[:2]).max()
    # In a unit box of its own, whatever the data's scale and place.
    edges = shapely.voronoi_polygons(
        MultiPoint((seeds - middle) / size), extend_to=shapely.box(-2, -2, 2, 2), only_edges=True
    )
    lines = shapely.transform(shapely.get_parts(edges), lambda points: points * size + middle)
    return np.asarray(lines, dtype=object)
