"""Points inside at which a sweep begins or ends, where no side of its region does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely

from geotween.motion.front.meshes import SNAP, Mesh, Rim, Spans
from geotween.motion.front.plane import NOTHING, Floats, Ints, Shapes
from geotween.motion.front.skeleton import Skeleton

# The innermost place of a face is found to within this share of its size.
INNERMOST = 0.01

# A point inside is at least this share of a face's inner radius from its sides.
CLEAR = 0.1


def innermost(
    mesh: Mesh, rim: Rim, spans: Spans, skeleton: Skeleton, faces: Shapes, band: Ints
) -> tuple[Skeleton, Ints]:
    """The skeleton with a point for each region that is first, or last, swept within.

    Returns also the pairs (k, 2) of faces and the points within them.
    """
    points, levels, inside = [skeleton.points], [skeleton.levels], []
    count = len(skeleton.points)
    for first in (True, False):
        region, vertex = _extremes(mesh, rim, spans, first=first)
        which = spans.base[region] + (0 if first else spans.counts[region] - 1)
        place, face = _within(faces, band, which, mesh.points[vertex])
        points.append(place)
        levels.append(np.where(first, 0, spans.counts[region])[face != NOTHING])
        place_number = count + np.arange(len(place))
        inside.append(np.column_stack([face[face != NOTHING], place_number]))
        count += len(place)
    found = replace(skeleton, points=np.concatenate(points), levels=np.concatenate(levels))
    return found, np.concatenate(inside).astype(np.intp)


def _extremes(mesh: Mesh, rim: Rim, spans: Spans, *, first: bool) -> tuple[Ints, Ints]:
    """Regions whose rim is nowhere first (or last), and the vertex of each that is."""
    times = mesh.times if first else -mesh.times
    least = spans.first if first else -spans.last
    rims = times[rim.triangle, rim.corner]
    region = mesh.region[rim.triangle]
    at_rim = np.zeros(len(least), dtype=bool)
    with np.errstate(invalid="ignore"):
        at_rim[region[np.isnan(rims) | (rims <= least[region] + SNAP)]] = True
    rows = np.flatnonzero(~at_rim[mesh.region])
    flat_times, region = times[rows].ravel(), np.repeat(mesh.region[rows], 3)
    vertex = mesh.triangles[rows].ravel()
    order = np.lexsort([vertex, flat_times, region])
    region, vertex = region[order], vertex[order]
    once = np.append(True, region[1:] != region[:-1]) if len(region) else np.zeros(0, dtype=bool)
    return region[once], vertex[once]


def _within(faces: Shapes, band: Ints, wanted: Ints, places: Floats) -> tuple[Floats, Ints]:
    """The face of a wanted band (k,) that each place (k, 2) is in, and the places that are in one.

    Where simplification has left a place outside, or all but so, it is the innermost one of its
    face, or of the largest one; the face is NOTHING if its band has none.
    """
    face = np.full(len(wanted), NOTHING, dtype=np.intp)
    if not len(wanted):
        return places, face
    some = np.flatnonzero(np.isin(band, wanted))
    tree = shapely.STRtree(np.asarray(shapely.points(places), dtype=object))
    holder, place = tree.query(faces[some], predicate="contains")
    fits = band[some[holder]] == wanted[place]
    face[place[fits]] = some[holder[fits]]
    largest = np.flatnonzero(face == NOTHING)
    for lost in largest.tolist():
        mine = np.flatnonzero(band == wanted[lost])
        if len(mine):
            face[lost] = mine[np.argmax(shapely.area(faces[mine]))]
    placed = np.flatnonzero(face != NOTHING)
    own = faces[face[placed]]
    radius = shapely.maximum_inscribed_circle(own, INNERMOST * np.sqrt(shapely.area(own)))
    clear = shapely.distance(shapely.boundary(own), shapely.points(places[placed]))
    near = (clear < CLEAR * shapely.length(radius)) | np.isin(placed, largest)
    found = places[placed]
    found[near] = shapely.get_coordinates(shapely.get_point(radius[near], 0))
    return found, face
