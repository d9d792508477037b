"""Common boundary: what lies on the boundary at both ends, and whether it rests on the way."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.motion.looks import Objects, polygons_with
from geotween.motion.rings import Vertices, next_vertex, rings_of
from geotween.motion.tracks import Track

Floats = NDArray[np.float64]
Numbers = NDArray[np.intp]


def moved_shares(tracks: Sequence[Track], tolerance: float) -> Floats:
    """The share (n,) of each track's common boundary that does not rest, over all t in [0, 1].

    Its places are the vertices and the middles of the edges that a track's polygon has in common
    with itself at the other end. One rests where an edge goes on covering it: one whose vertices
    rest, or slide along its own line. What is nearer than ``tolerance``, in the data's units, is
    the same. For tracks that last from 0 to 1. Cost: n log n.
    """
    ends = [polygons_with(tracks, [track.vertices[end] for track in tracks]) for end in (0, -1)]
    owners = [np.flatnonzero(~shapely.is_empty(polygons)) for polygons in ends]
    here, there = (polygons[owner] for polygons, owner in zip(ends, owners, strict=True))
    places, owner = common_places(here, there, tolerance, (owners[0], owners[1]))
    if not len(places):
        return np.zeros(len(tracks))
    points: Any = shapely.points(places)
    resting = np.zeros(len(points), dtype=bool)
    for chained in (False, True):
        left = np.unique(owner[~resting])
        lines, of = _resting(tracks, left, tolerance, chained)
        if len(lines):
            found = shapely.STRtree(lines).query(points, predicate="dwithin", distance=tolerance)
            resting[found[0][owner[found[0]] == of[found[1]]]] = True
    counts, moved = (np.bincount(owner, w, len(tracks)) for w in (None, ~resting))
    return np.asarray(moved / np.maximum(counts, 1))


def common_places(
    origin: Objects,
    target: Objects,
    tolerance: float,
    owners: tuple[Numbers, Numbers] | None = None,
) -> tuple[Vertices, Numbers]:
    """Vertices and middles (p, 2) of the edges of boundary that polygons of both ends share.

    Places nearer than the tolerance are the same. The origin's edges are cut at the target's
    vertices; those of which both ends and the middle lie on the target's boundary are common.
    ``owners`` restrict that to polygons of one owner; the owner (p,) of each place comes back.
    """
    here, there = owners or (np.zeros(len(origin), np.intp), np.zeros(len(target), np.intp))
    if not len(origin) or not len(target):
        return np.empty((0, 2)), np.empty(0, dtype=np.intp)
    edges, of_edge = edges_of(origin)
    others, of_other = edges_of(target)
    of_edge, of_other = here[of_edge], there[of_other]
    corners: Any = shapely.get_point(others, 0)
    corner, edge = shapely.STRtree(edges).query(corners, predicate="dwithin", distance=tolerance)
    mine = of_edge[edge] == of_other[corner]
    corner, edge = corner[mine], edge[mine]
    along: Any = shapely.line_locate_point(edges[edge], corners[corner], normalized=True)
    every = np.arange(len(edges))
    edge = np.concatenate([every, every, edge])
    along = np.concatenate([np.zeros(len(edges)), np.ones(len(edges)), along])
    order = np.lexsort((along, edge))
    edge, along = edge[order], along[order]
    inner = np.flatnonzero((edge[1:] == edge[:-1]) & (along[1:] > along[:-1]))
    shares = np.stack([along[inner], (along[inner] + along[inner + 1]) / 2, along[inner + 1]])
    points = shapely.line_interpolate_point(edges[edge[inner]], shares, normalized=True)
    owner = np.broadcast_to(of_edge[edge[inner]], points.shape)
    near = shapely.STRtree(others).query(points.ravel(), predicate="dwithin", distance=tolerance)
    near = near[:, owner.ravel()[near[0]] == of_other[near[1]]]
    on_target = np.isin(np.arange(points.size), near[0]).reshape(points.shape)
    kept = on_target.all(axis=0)
    found = shapely.get_coordinates(points[:, kept].ravel())
    rows = np.unique(np.column_stack([owner[:, kept].ravel(), found]), axis=0)
    return rows[:, 1:], rows[:, 0].astype(np.intp)


def edges_of(polygons: Objects) -> tuple[Objects, Numbers]:
    """The edges of polygons as lines (n,), and the polygon of each."""
    rings = rings_of(polygons)
    ends = rings.vertices[next_vertex(rings.offsets)]
    lines: Any = shapely.linestrings(np.stack([rings.vertices, ends], axis=1))
    return np.asarray(lines), np.repeat(rings.polygon_of, np.diff(rings.offsets))


def _resting(
    tracks: Sequence[Track], chosen: Numbers, tolerance: float, chained: bool
) -> tuple[Objects, Numbers]:
    """Lines (m,) that edges of chosen tracks cover throughout, and the track of each.

    ``chained`` joins edges of a ring that stay on one line, between which a vertex slides.
    """
    segments, owners = [np.empty((0, 2, 2))], [np.empty(0, dtype=np.intp)]
    for k in chosen.tolist():
        track = tracks[k]
        following = next_vertex(track.offsets)
        start, end = track.vertices, track.vertices[:, following]
        ways = end - start
        lengths = np.hypot(ways[..., 0], ways[..., 1])
        longest = lengths.argmax(axis=0), np.arange(len(following))
        direction = ways[longest] / np.maximum(lengths[longest], np.finfo(float).tiny)[:, None]
        base = start[longest]
        along = np.stack([((p - base) * direction).sum(axis=-1) for p in (start, end)])
        aside = np.stack(
            [
                (p - base)[..., 0] * direction[:, 1] - (p - base)[..., 1] * direction[:, 0]
                for p in (start, end)
            ]
        )
        straight = (np.abs(aside) <= tolerance).all(axis=(0, 1)) & (lengths[longest] > 0)
        if chained:
            found = _chains(track, straight, direction, base, tolerance)
        else:
            low, high = along.min(axis=0).max(axis=0), along.max(axis=0).min(axis=0)
            kept = straight & (high > low)
            found = np.stack(
                [base[kept] + s[kept, None] * direction[kept] for s in (low, high)], axis=1
            )
        segments.append(found)
        owners.append(np.full(len(found), k))
    lines: Any = shapely.linestrings(np.concatenate(segments))
    return np.asarray(lines), np.concatenate(owners)


def _chains(
    track: Track, straight: NDArray[np.bool_], direction: Floats, base: Floats, tolerance: float
) -> Floats:
    """What runs of edges that stay on one line cover throughout: lines (m, 2, 2)."""
    found = [np.empty((0, 2, 2))]
    for first, last in zip(track.offsets[:-1].tolist(), track.offsets[1:].tolist(), strict=True):
        edges = np.arange(first, last)
        after = np.roll(edges, -1)
        off = base[after] - base[edges]
        turned = (
            direction[edges, 0] * direction[after, 1] - direction[edges, 1] * direction[after, 0]
        )
        aside = direction[edges, 0] * off[:, 1] - direction[edges, 1] * off[:, 0]
        joined = straight[edges] & straight[after] & (np.abs(aside) <= 2 * tolerance)
        size = max(float(np.ptp(track.vertices[:, edges], axis=1).max()), tolerance)
        joined &= np.abs(turned) * size <= 2 * tolerance
        breaks = np.flatnonzero(~joined)
        if not len(breaks):
            continue
        for start, stop in zip(
            breaks.tolist(), [*breaks[1:].tolist(), breaks[0] + len(edges)], strict=True
        ):
            run = edges[(np.arange(start + 1, stop + 1)) % len(edges)]
            if not straight[run].all():
                continue
            places = track.vertices[:, np.append(run, after[run[-1] - first])]
            along = (places - base[run[0]]) @ direction[run[0]]
            low, high = along.min(axis=1).max(), along.max(axis=1).min()
            if high > low:
                ends = base[run[0]] + np.outer([low, high], direction[run[0]])
                found.append(ends[None])
    return np.concatenate(found)
