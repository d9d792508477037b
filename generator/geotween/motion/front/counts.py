"""How many bands each region needs so that nobody sees the difference from its field."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely

from geotween.motion.front.coarse import Coarse, coarse
from geotween.motion.front.knots import below
from geotween.motion.front.meshes import LEAST_BAND, TICKS, Flags, Mesh, Spans
from geotween.motion.front.plane import NOTHING, Change, Floats

MOST_BANDS = 32

# Levels may be off by so many tolerances, a pixel, but for the last twentieth of their length.
OFF, MOST_LEVELS = 2.0, 0.95

# A region has one band if its mean width is at most so many tolerances.
THIN = 4.0

# With twice as many bands levels are nearer to the field's by this factor, at best.
GAIN = 4.0

# Levels lie at multiples of a time in which a front runs a tolerance, or of this part of the whole.
LEAST_TICKS = 32

# By how much, as a share of all that changes, the area swept may be off, before the clock is set
# right; and at how many moments it is looked at.
AREA_OFF, MOMENTS = 0.01, 16


def counted(change: Change, mesh: Mesh, spans: Spans, tolerance: float) -> Spans:
    """The spans with as many bands, a power of two, as each region needs.

    From one band on each region doubles its bands, once or more often by how far it is off, until
    its levels, and the area that is swept, are near enough to the field's.
    """
    if not len(spans.counts):
        return spans
    wide, run = _widths(mesh, len(spans.counts))
    ticks = np.exp2(np.ceil(np.log2(np.clip(run / tolerance, LEAST_TICKS, TICKS)))).astype(np.intp)
    spans = replace(spans, ticks=ticks)
    most = np.minimum((spans.last - spans.first) * TICKS / LEAST_BAND, MOST_BANDS)
    most = np.exp2(np.floor(np.log2(np.maximum(most, 1)))).astype(np.intp)
    most[(wide <= THIN * tolerance) | ~_open(mesh, len(most))] = 1
    room = AREA_OFF * shapely.area(change.plane.faces[change.region != NOTHING]).sum()
    counts, opened = np.ones(len(most), dtype=np.intp), most > 1
    uneven = np.zeros((len(most), MOMENTS))
    while opened.any():
        trial = replace(spans, counts=np.where(opened, counts, 1))
        away, area = _off(mesh, opened, _trial(change, mesh, opened, trial, tolerance))
        uneven[opened] = area[opened]
        doublings = np.ceil(np.log(np.maximum(away / (OFF * tolerance), 1)) / np.log(GAIN))
        doublings = np.where(opened & (counts < most), doublings, 0).astype(np.intp)
        if not doublings.any():
            doublings = _to_even(uneven, counts < most, room).astype(np.intp)
        opened = doublings > 0
        counts = np.minimum(counts << doublings, most)
    return replace(spans, counts=counts)


def _to_even(uneven: Floats, free: Flags, room: float) -> Flags:
    """The regions (R,) among free ones whose areas are the most off when all are off by more."""
    total = uneven.sum(axis=0)
    worst = np.argmax(np.abs(total))
    share = np.where(free, uneven[:, worst] * np.sign(total[worst]), 0.0)
    order = np.argsort(-share, kind="stable")
    before = np.cumsum(share[order]) - share[order]
    chosen = np.zeros(len(free), dtype=bool)
    chosen[order] = (before < np.abs(total[worst]) - room) & (share[order] > 0)
    return chosen


def _trial(change: Change, mesh: Mesh, chosen: Flags, spans: Spans, tolerance: float) -> Coarse:
    some = np.append(chosen, False)[change.region]
    part = replace(change, region=np.where(some, change.region, NOTHING))
    return coarse(part, mesh.of(chosen), spans, np.full(len(chosen), tolerance))


def _widths(mesh: Mesh, count: int) -> tuple[Floats, Floats]:
    """How wide regions (R,) are on average, and how far a front runs in each from 0 to 1."""
    area, slope = _slopes(mesh)
    size = np.bincount(mesh.region, area, count)
    sides = np.roll(mesh.points[mesh.triangles], -1, axis=1) - mesh.points[mesh.triangles]
    length = np.where(mesh.numbered[1], np.hypot(sides[..., 0], sides[..., 1]), 0).sum(axis=1)
    rim = np.bincount(mesh.region, length, count)
    some = slope > 0
    swept = np.bincount(mesh.region[some], area[some], count)
    levels = np.bincount(mesh.region[some], (area * slope)[some], count)
    with np.errstate(invalid="ignore", divide="ignore"):
        return 2 * size / rim, np.fmin(swept / levels, rim / 2)


def _open(mesh: Mesh, count: int) -> Flags:
    """Regions whose levels can be told apart in all triangles."""
    pivots = np.isnan(mesh.times).sum(axis=1) > 1
    return np.asarray(np.bincount(mesh.region[pivots], minlength=count) == 0)


def _slopes(mesh: Mesh) -> tuple[Floats, Floats]:
    """The areas (T,) of a mesh's triangles and the slopes (T,) of its times, NaN beside pivots."""
    a, b, c = mesh.points[mesh.triangles].transpose(1, 0, 2)
    area = _cross(b - a, c - a) / 2
    rise = mesh.times[:, 1:] - mesh.times[:, :1]
    way = rise[:, :1] * (c - a) - rise[:, 1:] * (b - a)
    return area, np.hypot(*way.T) / (2 * area)


def _off(mesh: Mesh, chosen: Flags, coarse: Coarse) -> tuple[Floats, Floats]:
    """By how much coarse triangles are off the field in regions: distance (R,), area (R, MOMENTS).

    Levels are looked at in the middle of each of the field's triangles, for their length there.
    """
    count = len(chosen)
    rows = np.flatnonzero(chosen[mesh.region])
    area, slope = (of[rows] for of in _slopes(mesh))
    region, times = mesh.region[rows], mesh.times[rows]
    middle = mesh.points[mesh.triangles[rows]].mean(axis=1)
    known = np.flatnonzero(slope > 0)
    corners = coarse.points[coarse.triangles]
    tree = shapely.STRtree(np.asarray(shapely.polygons(corners), dtype=object))
    place, holder = tree.query(shapely.points(middle[known]), predicate="intersects")
    same = region[known[place]] == coarse.region[holder]
    row, holder = known[place[same]], holder[same]
    found = _interpolated(corners[holder], coarse.times[holder], middle[row])
    away = np.abs(found - times[row].mean(axis=1)) / slope[row]

    order = np.lexsort([away, region[row]])
    owner, away, length = region[row][order], away[order], (area * slope)[row][order]
    total = np.bincount(owner, length, count)
    nearer = np.cumsum(length) - (np.cumsum(total) - total)[owner]
    inside = nearer <= MOST_LEVELS * total[owner]
    distance, uneven = np.zeros(count), np.empty((count, MOMENTS))
    np.maximum.at(distance, owner[inside], away[inside])

    own = _cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    pivots = np.isnan(times)
    known_times = np.where(pivots, 0, times).sum(axis=1) / np.maximum((~pivots).sum(axis=1), 1)
    times = np.where(pivots, known_times[:, None], times)
    for i, moment in enumerate((np.arange(MOMENTS) + 0.5) / MOMENTS):
        real = below(times, np.full(len(times), moment)) * area
        there = below(coarse.times, np.full(len(own), moment)) * own
        uneven[:, i] = np.bincount(coarse.region, there, count) - np.bincount(region, real, count)
    return distance, uneven


def _interpolated(corners: Floats, values: Floats, places: Floats) -> Floats:
    a, b, c = corners.transpose(1, 0, 2)
    whole = _cross(b - a, c - a)
    one, other = _cross(places - a, c - a) / whole, _cross(b - a, places - a) / whole
    return (
        values[:, 0] + one * (values[:, 1] - values[:, 0]) + other * (values[:, 2] - values[:, 0])
    )


def _cross(one: Floats, other: Floats) -> Floats:
    return np.asarray(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])
