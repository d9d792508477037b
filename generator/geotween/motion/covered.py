"""Coverage: whether what lies in the same feature at both ends is covered on the way."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely

from geotween.data.polygons import PolygonSet
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
    names = dict.fromkeys(i.key if i.keyed else None for i in origin.identities)
    worst = 0.0
    for name in names:
        mine = [t for t in tracks if (t.key if t.identity.keyed else None) == name]
        common = shapely.intersection(*(_area(end, name) for end in (origin, target)))
        inner = shapely.buffer(common, -tolerance)
        if not mine or inner.is_empty:
            continue
        shapely.prepare(inner)
        if shapely.intersects(inner, _hulls(mine)).any():
            worst = max(worst, *(_bare(mine, inner, t) for t in MOMENTS))
    return worst


def _area(polygons: PolygonSet, name: object) -> Any:
    named = [(i.key if i.keyed else None) == name for i in polygons.identities]
    return shapely.union_all(polygons.polygons[np.array(named, dtype=bool)])


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
