"""How far through its band each corner of a triangle is swept, as the field says."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geotween.motion.front.meshes import TICKS, Mesh, Rim, Spans
from geotween.motion.front.plane import NOTHING, SINK, SOURCE, Change, Floats, Ints
from geotween.motion.front.skeleton import Skeleton
from geotween.motion.front.triangulate import twins

# Within a band, corners are swept after so many parts of it: few times, few key frames.
QUARTERS = 4

# Stands for the band coordinate of a pivot.
PIVOT = -1.0


@dataclass(frozen=True, eq=False)
class _Sides:
    """The sides (T, 3) of triangles from each corner to the next.

    Attributes
    ----------
    region, level : (T,) the triangles' region, and which of its bands they are in.
    keys : (T, 3) twice the edge of the plane that a side is a part of, plus the side of that edge;
        NOTHING for others.
    other : (T, 3) the side of another triangle of the region that is the same, NOTHING if none is.
    """

    triangles: Ints
    region: Ints
    level: Ints
    keys: Ints
    other: Ints


def corner_shares(
    change: Change,
    mesh: Mesh,
    rim: Rim,
    spans: Spans,
    skeleton: Skeleton,
    triangles: Ints,
    band: Ints,
) -> Floats:
    """Shares (T, 3) of the bands: 0 and 1 on its levels, NaN at pivots, else a quarter or near it.

    Where a neighbour's level ends within the band its time counts; where a triangle would be swept
    at one time, the field's own time does.
    """
    region = spans.region[band]
    level = band - spans.base[region]
    keys = _keys(skeleton, triangles)
    sides = _Sides(triangles, region, level, keys, twins(triangles, region))
    coordinates = _coordinates(change, mesh, rim, spans, skeleton, sides)
    exact = np.clip(coordinates - level[:, None], 0, 1)
    exact[coordinates == PIVOT] = np.nan
    found = _rounded(exact, skeleton, triangles, spans, band)
    _hold(change, sides, found)

    flat = (found == found[:, :1]).all(axis=1) & (found[:, 0] > 0) & (found[:, 0] < 1)
    if flat.any():
        low, high = spans.ends[band].T[..., None]
        tick = 1 / (TICKS * (high - low))
        finer = np.clip(np.rint(exact / tick) * tick, tick, 1 - tick)
        code = region[:, None] * len(skeleton.points) + triangles
        chosen = np.isin(code, code[flat]) & (found > 0) & (found < 1)
        found[chosen] = finer[chosen]
    return found


def _rounded(
    exact: Floats, skeleton: Skeleton, triangles: Ints, spans: Spans, band: Ints
) -> Floats:
    """Shares within bands at a quarter, or as a neighbour's level says if that is nearer."""
    quarters = np.rint(exact * QUARTERS) / QUARTERS
    inner = (exact > 0) & (exact < 1)
    row, corner = np.nonzero(inner)
    quarters[row, corner] = spans.within(quarters[row, corner], band[row])
    end = triangles - skeleton.plain
    is_end = (end >= 0) & (end < len(skeleton.ends))
    low, high = spans.ends[band].T[..., None]
    theirs = np.full(triangles.shape, np.nan)
    theirs[is_end] = skeleton.key_times[end[is_end]]
    theirs = (theirs - low) / (high - low)
    with np.errstate(invalid="ignore"):
        nearer = (theirs > 0) & (theirs < 1) & (np.abs(theirs - exact) <= np.abs(quarters - exact))
    return np.where(inner, np.where(nearer, theirs, quarters), exact)


def _keys(skeleton: Skeleton, triangles: Ints) -> Ints:
    size = len(skeleton.points)
    on = skeleton.lines != NOTHING
    edges, lines = skeleton.edges[on], skeleton.lines[on]
    code = np.concatenate([edges @ [size, 1], edges[:, ::-1] @ [size, 1]])
    key = np.concatenate([2 * lines, 2 * lines + 1])
    order = np.argsort(code, kind="stable")
    wanted = triangles * size + np.roll(triangles, -1, axis=1)
    place = order[np.searchsorted(code, wanted, sorter=order).clip(max=len(code) - 1)]
    return np.where(code[place] == wanted, key[place], NOTHING)


def _coordinates(
    change: Change, mesh: Mesh, rim: Rim, spans: Spans, skeleton: Skeleton, sides: _Sides
) -> Floats:
    """The band coordinates (T, 3) of corners, or ``PIVOT``.

    A corner beside an edge of the plane has the field's there. A point may have several, where a
    region touches itself: between others, corners have what those around them have.
    """
    triangles, region = sides.triangles, sides.region
    levels = skeleton.levels[triangles]
    found = np.where(levels == NOTHING, np.nan, levels.astype(float))
    row, corner = np.nonzero(sides.keys != NOTHING)
    for at in (corner, (corner + 1) % 3):
        key, point = sides.keys[row, corner], triangles[row, at]
        time = _time_on_rim(change, mesh, rim, skeleton, key, point)
        there = spans.band(time, region[row])
        found[row, at] = np.where(np.isnan(time), PIVOT, there)

    code = np.unique(region[:, None] * len(skeleton.points) + triangles, return_inverse=True)[1]
    code = code.reshape(triangles.shape)
    known = ~np.isnan(found)
    least = np.full(code.max(initial=0) + 1, np.inf)
    most = -least
    np.minimum.at(least, code[known], found[known])
    np.maximum.at(most, code[known], found[known])
    one = (least == most)[code]
    found[one] = least[code[one]]
    _spread(sides, found)
    # A corner that nothing is known of is halfway.
    return np.where(np.isnan(found), sides.level[:, None] + 0.5, found)


def _spread(sides: _Sides, found: Floats) -> None:
    """Tell corners (T, 3) what is known of the same corner of a triangle beside, in place."""
    while (unknown := np.isnan(found)).any():
        row, corner = np.nonzero(unknown)
        for side, at_start in ((corner, True), ((corner + 2) % 3, False)):
            other = sides.other[row, side]
            there, back = np.divmod(other, 3)
            told = found[there, (back + 1) % 3 if at_start else back]
            better = (other != NOTHING) & np.isnan(found[row, corner]) & ~np.isnan(told)
            found[row[better], corner[better]] = told[better]
        if (np.isnan(found) == unknown).all():
            return


def _time_on_rim(
    change: Change, mesh: Mesh, rim: Rim, skeleton: Skeleton, key: Ints, point: Ints
) -> Floats:
    """The field's times (n,) at points on edges of the plane, for the region on one side."""
    edge = change.plane.edges[key // 2]
    share = np.where(point == edge[:, 1], 1.0, 0.0)
    end = point >= skeleton.plain
    share[end] = skeleton.shares[point[end] - skeleton.plain]
    shares = np.sort(rim.shares, axis=1)
    times = mesh.times[rim.triangle[:, None], (rim.corner[:, None] + [0, 1]) % 3]
    times = np.where(rim.left[:, None], times, times[:, ::-1])
    # Keys are whole numbers and shares at most 1: both in one number keep the order.
    code = rim.key + shares[:, 0] / 2
    order = np.argsort(code)
    row = order[np.searchsorted(code, key + share / 2, side="right", sorter=order) - 1]
    (start, stop), (begin, final) = shares[row].T, times[row].T
    with np.errstate(invalid="ignore"):
        between = begin + (share - start) / (stop - start) * (final - begin)
    between = np.where(np.isnan(begin), final, np.where(np.isnan(final), begin, between))
    return np.select([share == start, share == stop], [begin, final], between)


def _hold(change: Change, sides: _Sides, shares: Floats) -> None:
    """Keep sides between two pivots where they are: on the source, the sink, a level; in place."""
    pivots = np.isnan(shares)
    row, corner = np.nonzero(pivots & np.roll(pivots, -1, axis=1))
    if not len(row):
        return
    key, other = sides.keys[row, corner], sides.other[row, corner]
    role = np.where(key == NOTHING, 0, change.roles[key // 2, key % 2])
    ahead = np.where(other == NOTHING, 0, sides.level[other // 3] - sides.level[row])
    low, high = (role == SOURCE) | (ahead < 0), (role == SINK) | (ahead > 0)
    held = np.zeros((*shares.shape, 2), dtype=bool)
    for at in (corner, (corner + 1) % 3):
        held[row[low], at[low], 0] = True
        held[row[high], at[high], 1] = True
    shares[held[..., 0] & ~held[..., 1]] = 0.0
    shares[held[..., 1] & ~held[..., 0]] = 1.0
