"""Divide a polygon by territory: what a correspondent covers is its own, the rest the nearest's.

Seams so run along what is really there, and what is common to a polygon and its correspondent
stays together.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from shapely.geometry import Polygon

from geotween.motion.divide.faces import Ints, Piece, Points, Shapes, array_of, holders
from geotween.motion.divide.nearest import borders
from geotween.motion.divide.partition import SLIVER, Mend, partition
from geotween.motion.divide.weighted import weighted

# Correspondents' outlines are cut off so far from the polygon, in its extents.
MARGIN = 0.1

# What is less of the polygon's area is rounding: everything is covered.
COVERED = 1e-12


def territory(
    polygon: Polygon,
    correspondents: Sequence[Piece],
    connected: bool = True,
    weights: Sequence[float] | None = None,
) -> tuple[list[Piece], list[Mend]]:
    """One piece of the polygon for each correspondent, in their order, and what was mended.

    What several cover goes to the nearest of what each covers alone; what covers nothing alone
    keeps its own, the smallest first. With ``weights`` the pieces' areas are proportional to them:
    seams are moved until they are. Cost: n log n for n vertices, and a few Delaunay triangulations
    of some hundreds to thousands of samples, more where gaps are narrow.
    """
    areas = _alone(polygon, correspondents)
    owners = np.flatnonzero(~shapely.is_empty(areas))
    areas = areas[owners]
    if weights is not None and len(areas) > 1:
        fit, lines = weighted(polygon, areas, np.asarray(weights, dtype=float)[owners])

        def fitting(places: Points) -> Ints:
            return owners[fit.label(places)]

        return partition(polygon, lines, fitting, list(correspondents), connected)
    box = np.array(polygon.bounds)
    extent = float((box[2:] - box[:2]).max())
    outlines = shapely.clip_by_rect(
        shapely.boundary(areas), *(box + MARGIN * extent * np.array([-1, -1, 1, 1]))
    )
    lines = shapely.get_parts(outlines)
    rest = shapely.difference(polygon, shapely.union_all(areas))
    if rest.area > COVERED * polygon.area and len(areas) > 1:
        lines = np.concatenate([lines, borders(areas, rest, extent)])

    def label(places: Points) -> Ints:
        return owners[holders(areas, places)]

    return partition(polygon, lines, label, list(correspondents), connected)


def _alone(polygon: Polygon, correspondents: Sequence[Piece]) -> Shapes:
    """What each correspondent (k,) covers alone; of one that covers nothing alone, what is left."""
    areas = array_of(correspondents)
    one, other = shapely.STRtree(areas).query(areas, predicate="intersects")
    one, other = one[one < other], other[one < other]
    common = shapely.intersection(areas[one], areas[other])
    clash = shapely.area(common) > SLIVER * polygon.area
    if not clash.any():
        return areas
    one, other, common = one[clash], other[clash], common[clash]
    found = areas.copy()
    for k in np.unique(np.concatenate([one, other])):
        found[k] = shapely.difference(
            areas[k], shapely.union_all(common[(one == k) | (other == k)])
        )
    bare = np.flatnonzero(shapely.area(found) <= SLIVER * polygon.area)
    taken = shapely.Polygon()
    for k in bare[np.argsort(shapely.area(areas[bare]), kind="stable")]:
        left = shapely.difference(areas[k], taken)
        found[k] = left if left.area > SLIVER * polygon.area else shapely.Polygon()
        taken = shapely.union(taken, areas[k])
    return found
