"""A front that travels: the target is laid on the origin, what changes is swept on the way.

Where no matching of vertices keeps an outline from crossing itself, this does: the frames of a
front are simple by construction, and all of its vertices are moved alike.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.polygons import PolygonSet, moved
from geotween.motion.front.fronts import front
from geotween.motion.tracks import Track


def carried(
    origin: PolygonSet, target: PolygonSet, layer: str, resolution: float
) -> tuple[Track, ...]:
    """Tracks from one set to another that overlap with themselves at no time."""
    way = _way(origin, target)
    swept = front(origin, moved(target, -way), layer, resolution)
    return tuple(
        replace(track, vertices=track.vertices + track.times[:, None, None] * way)
        for track in swept.tracks
    )


def _way(origin: PolygonSet, target: PolygonSet) -> NDArray[np.float64]:
    """The vector (2,) by which to travel: none, or between the centroids if more is shared so.

    What has boundary in common where it lies does not travel.
    """
    still = np.zeros(2)
    if not len(origin) or not len(target):
        return still
    here, there = shapely.union_all(origin.polygons), shapely.union_all(target.polygons)
    if shapely.intersection(here.boundary, there.boundary).length > 0:
        return still
    way = shapely.get_coordinates(there.centroid)[0] - shapely.get_coordinates(here.centroid)[0]
    laid = shapely.transform(there, lambda points: points - way)
    shared = [shapely.area(shapely.intersection(here, one)) for one in (there, laid)]
    return way if shared[1] > shared[0] else still
