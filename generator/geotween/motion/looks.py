"""Looks at tracks at one moment: which area is covered twice, or turned inside out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from geotween.data.tidy.repair import made_valid
from geotween.motion.rings import Offsets, Vertices, next_vertex, to_polygons
from geotween.motion.tracks import Track

Objects = NDArray[np.object_]

# Winding numbers are counted for so many pairs of place and edge in one go.
CHUNK = 4_000_000


def polygons_at(tracks: Sequence[Track], t: float) -> Objects:
    """The polygon of each track at t, valid or not; an empty one where nothing is left, or yet."""
    drawn = np.full(len(tracks), shapely.Polygon(), dtype=object)
    there = np.flatnonzero([track.is_there(t) for track in tracks])
    seen = [tracks[k] for k in there.tolist()]
    drawn[there] = polygons_with(seen, [track.at(t) for track in seen])
    return drawn


def polygons_with(tracks: Sequence[Track], places: Sequence[Vertices]) -> Objects:
    """The polygon of each track with its vertices at some places; empty where nothing is left."""
    drawn = np.full(len(tracks), shapely.Polygon(), dtype=object)
    if not len(tracks):
        return drawn
    counts = [np.diff(track.offsets) for track in tracks]
    owner = np.repeat(np.arange(len(tracks)), [len(count) for count in counts])
    offsets = np.concatenate([[0], np.cumsum(np.concatenate(counts))]).astype(np.intp)
    found = to_polygons(np.concatenate(places), offsets, owner)
    left = np.flatnonzero([polygon is not None for polygon in found])
    drawn[left] = found[left]
    return drawn


def wrong_area(track: Track, t: float) -> BaseGeometry:
    """What a track's rings at t go round more than once, or the wrong way: empty if all is well.

    The faces of the rings' arrangement whose winding number is neither 0 nor 1.
    """
    vertices = track.at(t)
    rings = [vertices[a:b] for a, b in zip(track.offsets[:-1], track.offsets[1:], strict=True)]
    lines = [shapely.LineString(np.vstack([ring, ring[:1]])) for ring in rings if len(ring) > 1]
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(shapely.union_all(lines))))
    winding = _winding(
        shapely.get_coordinates(shapely.point_on_surface(faces)), vertices, track.offsets
    )
    return shapely.MultiPolygon(list(faces[(winding < 0) | (winding > 1)]))


def overlaps(ones: Objects, others: Objects) -> Objects:
    """The area (n,) that polygons and their counterparts cover both; invalid ones are rebuilt."""
    common = shapely.intersection(rebuilt(ones), rebuilt(others))
    parts, owner = shapely.get_parts(common, return_index=True)
    parts, inner = shapely.get_parts(parts, return_index=True)
    areas = shapely.get_type_id(parts) == shapely.GeometryType.POLYGON
    found = np.full(len(ones), shapely.MultiPolygon(), dtype=object)
    if areas.any():
        shapely.multipolygons(parts[areas], indices=owner[inner[areas]], out=found)
    return found


def rebuilt(polygons: Objects) -> Objects:
    """Polygons, the invalid ones as what their outer rings cover, less what their holes do."""
    found = polygons.copy()
    for k in np.flatnonzero(~shapely.is_valid(polygons)).tolist():
        found[k] = made_valid(polygons[k])
    return found


def _winding(places: Vertices, vertices: Vertices, offsets: Offsets) -> NDArray[np.intp]:
    """How often rings go round places (k, 2), counter-clockwise."""
    start, end = vertices, vertices[next_vertex(offsets)]
    winding = np.zeros(len(places), dtype=np.intp)
    step = max(CHUNK // max(len(vertices), 1), 1)
    for first in range(0, len(places), step):
        x, y = places[first : first + step].T[..., None]
        upward = (start[:, 1] <= y) & (end[:, 1] > y)
        downward = (start[:, 1] > y) & (end[:, 1] <= y)
        way = end - start
        side = way[:, 0] * (y - start[:, 1]) - (x - start[:, 0]) * way[:, 1]
        winding[first : first + step] = (upward & (side > 0)).sum(axis=1) - (
            downward & (side < 0)
        ).sum(axis=1)
    return winding
