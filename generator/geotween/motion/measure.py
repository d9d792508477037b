"""Measures: how good a motion looks in evenly spaced frames, whatever method made it.

They are taken from what is drawn, and know nothing of the proof over continuous time.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import astuple, dataclass
from typing import Any, TypeVar

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon

from geotween.data.polygons import RELATIVE_TOLERANCE, Identity, PolygonSet, bounds_of, extent
from geotween.motion.common import common_places, edges_of
from geotween.motion.looks import Objects, rebuilt
from geotween.motion.tracks import Track, frame

Floats = NDArray[np.float64]
Item = TypeVar("Item")

# Polygons that cover more than this share of their area twice overlap; less is rounding.
OVERLAP = 1e-9


@dataclass(frozen=True)
class Measures:
    """How good a motion is; 0 is best. The worst layer counts, each figure on its own.

    Attributes
    ----------
    overlap
        The largest share of the polygons' area in a frame that lies on another one of them.
    invalid_time
        The share of frames with an invalid polygon, or an overlap of more than ``OVERLAP``.
    inexact_ends
        What the polygons of each feature at t = 0 and t = 1, or the feature itself, cover alone,
        as a share of what they cover together; the larger end.
    area_mean, area_largest
        By how much the sum of areas differs from its straight way from end to end, as a share of
        the mean of both ends' areas; over all frames.
    lost
        The largest share of what both ends cover that a frame leaves bare.
    boundary_moved
        The farthest from a boundary in a frame that a place is which lies on one at both ends:
        vertices and middles of the edges of the common boundary. In extents of both ends.
    stray
        The farthest from the convex hull of both ends that a polygon gets, in extents.
    jump
        The largest Hausdorff distance between the vertices of a track in one frame and in the
        next, in extents.
    """

    overlap: float = 0.0
    invalid_time: float = 0.0
    inexact_ends: float = 0.0
    area_mean: float = 0.0
    area_largest: float = 0.0
    lost: float = 0.0
    boundary_moved: float = 0.0
    stray: float = 0.0
    jump: float = 0.0


def measure(
    tracks: Sequence[Track], origin: PolygonSet, target: PolygonSet, frames: int = 201
) -> Measures:
    """The measures of a motion between two polygon sets, over evenly spaced frames.

    Invalid polygons cover what their outer rings go round, less what their holes do. Cost: for
    each frame some overlays, n log n for n vertices; 201 frames of 1,000 vertices take a second.

    Raises
    ------
    ValueError
        For fewer than two frames.
    """
    if frames < 2:
        raise ValueError(f"a motion is measured in two frames or more, not in {frames}")
    size = extent(bounds_of([origin, target]))
    layers = dict.fromkeys([*origin.layers, *target.layers, *(t.layer for t in tracks)])
    found = [
        _layer(
            [track for track in tracks if track.layer == layer],
            (origin.in_layer(layer), target.in_layer(layer)),
            size or 1.0,
            np.linspace(0, 1, frames),
        )
        for layer in layers
    ]
    return Measures(*(max(column) for column in zip(*map(astuple, found), strict=True)))


def invalid_frames(tracks: Sequence[Track], times: Floats) -> NDArray[np.bool_]:
    """At which times (k,) some polygon is invalid, or polygons of a layer overlap."""
    found = np.zeros(len(times), dtype=bool)
    for layer in dict.fromkeys(track.layer for track in tracks):
        mine = [track for track in tracks if track.layer == layer]
        drawn = (_drawn(mine, t) for t in times.tolist())
        found |= [_is_invalid(polygons, _overlap(polygons)[0]) for polygons in drawn]
    return found


def _layer(
    tracks: Sequence[Track], ends: tuple[PolygonSet, PolygonSet], size: float, times: Floats
) -> Measures:
    covered = [_united(end.polygons) for end in ends]
    common = shapely.intersection(*covered)
    hull = shapely.convex_hull(shapely.union_all(covered))
    places: Any = shapely.points(
        common_places(ends[0].polygons, ends[1].polygons, RELATIVE_TOLERANCE * size)[0]
    )
    moved = 0.0
    rows = []
    for t in _middle_first(times):
        polygons = _drawn(tracks, t)
        overlap, area = _overlap(polygons)
        left = shapely.area(shapely.intersection(area, common))
        moved = _farther(places, polygons, moved)
        rows.append(
            (
                t,
                overlap,
                _is_invalid(polygons, overlap),
                shapely.area(polygons).sum(),
                _share(shapely.area(common) - left, shapely.area(common)),
                _distance_from(hull, polygons),
            )
        )
    at, overlaps, invalid, areas, lost, stray = np.array(rows).T
    start, end = areas[[np.argmin(at), np.argmax(at)]]
    off = np.abs(areas - start * (1 - at) - end * at)
    mean = (start + end) / 2
    return Measures(
        float(overlaps.max()),
        float(invalid.mean()),
        max(_inexact(tracks, ends, t) for t in (0, 1)),
        _share(off.mean(), mean),
        _share(off.max(), mean),
        float(lost.max()),
        moved / size,
        float(stray.max()) / size,
        _jump(tracks, times) / size,
    )


def _drawn(tracks: Sequence[Track], t: float) -> Objects:
    return _objects(frame(tracks, t).polygons)


def _overlap(polygons: Objects) -> tuple[float, Any]:
    """The share of the area that lies on other polygons, and the area that all cover."""
    whole = rebuilt(polygons)
    area = _united(whole)
    total = float(shapely.area(whole).sum())
    return _share(total - shapely.area(area), total), area


def _is_invalid(polygons: Objects, overlap: float) -> bool:
    return bool(overlap > OVERLAP or not shapely.is_valid(polygons).all())


def _inexact(tracks: Sequence[Track], ends: tuple[PolygonSet, PolygonSet], t: int) -> float:
    """By how much the tracks at an end miss or exceed the features that they belong to there.

    Features without a key are told apart by their class only: nothing else of theirs is seen.
    """
    features: dict[object, list[Polygon]] = _grouped(
        map(_seen, ends[t].identities), ends[t].polygons
    )
    pieces = _grouped([_seen(track.ends[t]) for track in tracks], tracks)
    wrong = whole = 0.0
    for identity in {**features, **pieces}:
        feature = _united(_objects(features.get(identity, [])))
        drawn = _united(rebuilt(_drawn(pieces.get(identity, []), t)))
        wrong += shapely.area(shapely.symmetric_difference(feature, drawn))
        whole += shapely.area(shapely.union(feature, drawn))
    return _share(wrong, whole)


def _seen(identity: Identity) -> object:
    return identity.key if identity.keyed else ("class", identity.class_)


def _grouped(names: Iterable[Any], items: Sequence[Item] | Objects) -> dict[Any, list[Item]]:
    found: dict[Any, list[Item]] = {}
    for name, item in zip(names, items, strict=True):
        found.setdefault(name, []).append(item)
    return found


def _distance_from(hull: Any, polygons: Objects) -> float:
    """How far polygons stick out of a convex hull: their own hull's farthest vertex."""
    if hull.is_empty or not len(polygons):
        return 0.0
    own = shapely.convex_hull(shapely.multipoints(shapely.get_coordinates(polygons)))
    return float(shapely.distance(hull, shapely.points(shapely.get_coordinates(own))).max())


def _farther(places: Objects, polygons: Objects, known: float) -> float:
    """The largest distance of places from the nearest boundary, if more than is known."""
    if not len(places) or not len(polygons):
        return known
    drawn: Any = shapely.boundary(shapely.multipolygons(polygons))
    shapely.prepare(drawn)
    far = places[~shapely.dwithin(drawn, places, known)]
    if not len(far):
        return known
    tree = shapely.STRtree(edges_of(polygons)[0])
    _, found = tree.query_nearest(far, return_distance=True, all_matches=False)
    return max(known, float(found.max()))


def _jump(tracks: Sequence[Track], times: Floats) -> float:
    """The largest Hausdorff distance between a track's vertices at two consecutive times.

    Tracks that last for a part of the time, of one polygon at both ends, are looked at together.
    """
    whole = [track for track in tracks if track.life == (0, 1)]
    others = [track for track in tracks if track.life != (0, 1)]
    names = [(track.identity, track.ends) for track in others]
    jumps = [_jump_together(of_one, times) for of_one in _grouped(names, others).values()]
    return max([_jump_of_whole(whole, times), *jumps])


def _jump_together(tracks: Sequence[Track], times: Floats) -> float:
    from scipy.spatial import KDTree

    jump, before = 0.0, np.empty((0, 2))
    for t in times.tolist():
        there = [track.at(t) for track in tracks if track.is_there(t)]
        after = np.unique(np.concatenate([np.empty((0, 2)), *there]), axis=0)
        if len(before) and len(after):
            for one, other in ((before, after), (after, before)):
                jump = max(jump, float(np.max(KDTree(other).query(one)[0])))
        before = after
    return jump


def _jump_of_whole(tracks: Sequence[Track], times: Floats) -> float:
    """Of tracks that are there throughout.

    No vertex is farther from the next frame's than its own way: only those whose way is longer
    than the largest distance so far are looked at, the longest ways first.
    """
    from scipy.spatial import KDTree

    ways = [_ways(track, times) for track in tracks]
    longest = np.array([way.max(axis=1) for way in ways]).reshape(-1, len(times) - 1)
    jump = 0.0
    for place in np.argsort(-longest, axis=None, kind="stable").tolist():
        k, step = divmod(place, len(times) - 1)
        if longest[k, step] <= jump:
            break
        far = ways[k][step] > jump
        before, after = (tracks[k].at(t) for t in times[step : step + 2])
        for one, other in ((before, after), (after, before)):
            jump = max(jump, float(np.max(KDTree(other).query(one[far])[0])))
    return jump


def _ways(track: Track, times: Floats) -> Floats:
    """How far (k - 1, n) each vertex gets from each time to the next."""
    places = np.stack([track.at(t) for t in times])
    return np.asarray(np.hypot(*np.moveaxis(np.diff(places, axis=0), -1, 0)))


def _middle_first(times: Floats) -> list[float]:
    """Most has moved half-way; what moved less need not be looked at closely then."""
    return list(times[np.argsort(np.abs(times - 0.5), kind="stable")].tolist())


def _objects(polygons: Sequence[Polygon]) -> Objects:
    found = np.empty(len(polygons), dtype=object)
    found[:] = polygons
    return found


def _united(polygons: Objects) -> Any:
    return polygons[0] if len(polygons) == 1 else shapely.union_all(polygons)


def _share(part: float, whole: float) -> float:
    """A part of a whole, from 0 to 1; rounding may make a part negative."""
    return float(np.clip(part / whole, 0, 1)) if whole else 0.0
