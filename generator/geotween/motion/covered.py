"""Coverage: whether what lies in the same feature at both ends is covered on the way."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely

from geotween.data.polygons import Identity, Key, PolygonSet
from geotween.motion.looks import Objects, polygons_at, rebuilt
from geotween.motion.rings import next_vertex
from geotween.motion.tracks import Track

# Moments at which is looked where it is not proved that something stays covered.
MOMENTS = (0.25, 0.5, 0.75)


def bared(
    tracks: Sequence[Track], origin: PolygonSet, target: PolygonSet, tolerance: float
) -> float:
    """The largest share that is bare on the way of what a feature covers at both ends.

    0 is proved, for all t: no edge that moves gets into that area, farther than ``tolerance``, in
    the data's units. An edge stays within the hull of where it is at two key times. More than 0
    is measured, at a few moments. Features without a key count as one. For tracks that last from
    0 to 1. Cost: n log n.
    """
    of_tracks = _named([track.identity for track in tracks])
    names, others = _named(origin.identities), _named(target.identities)
    shared = [name for name in names if name in others and name in of_tracks]
    starts, ends = (
        np.array([shapely.union_all(end.polygons[of[name]]) for name in shared], dtype=object)
        for end, of in ((origin, names), (target, others))
    )
    inners = shapely.buffer(shapely.intersection(starts, ends), -tolerance)
    worst = 0.0
    for name, inner in zip(shared, inners, strict=True):
        mine = [tracks[k] for k in of_tracks[name]]
        if inner.is_empty:
            continue
        shapely.prepare(inner)
        if shapely.intersects(inner, _hulls(mine)).any():
            worst = max(worst, *(_bare(mine, inner, t) for t in MOMENTS))
    return worst


def _named(identities: Sequence[Identity]) -> dict[Key | None, list[int]]:
    """The places of those of each key, in order; those without one together."""
    found: dict[Key | None, list[int]] = {}
    for place, identity in enumerate(identities):
        found.setdefault(identity.key if identity.keyed else None, []).append(place)
    return found


def _hulls(tracks: Sequence[Track]) -> Objects:
    """The hulls (m,) of where each edge that moves is at each key time and at the next."""
    found = [np.empty((0, 4, 2))]
    for track in tracks:
        start, end = track.vertices, track.vertices[:, next_vertex(track.offsets)]
        corners = np.stack([start[:-1], end[:-1], end[1:], start[1:]], axis=2)
        moves = (corners[..., :2, :] != corners[..., [3, 2], :]).any(axis=(-1, -2))
        found.append(corners[moves])
    points: Any = shapely.multipoints(np.concatenate(found))
    return np.asarray(shapely.convex_hull(points))


def _bare(tracks: Sequence[Track], area: Any, t: float) -> float:
    drawn = shapely.union_all(rebuilt(polygons_at(tracks, t)))
    return float(1 - shapely.area(shapely.intersection(drawn, area)) / area.area)
