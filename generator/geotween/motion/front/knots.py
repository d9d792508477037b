"""When the corners of a band's triangles are swept, so that no triangle is swept at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geotween.motion.front.exact import turns
from geotween.motion.front.meshes import TICKS, Flags, Spans
from geotween.motion.front.plane import NOTHING, Floats, Ints
from geotween.motion.front.triangulate import twins

# A triangle smaller than this share of all that changes may flash.
UNSEEN = 1e-10

# Where in a band its middle may be, from end to end.
MIDDLES = np.array([0.5, 0.375, 0.625, 0.25, 0.75])

# What the area of a band must be nearer to its aim by, as a share, for another middle than 0.5.
WORTH = 0.01

# The corners of the parts of a triangle whose sides (bits 1, 2, 4) are divided: 0, 1, 2 are its
# own, 3, 4, 5 lie in the middle of its sides.
PARTS = {
    0: ((0, 1, 2),),
    1: ((0, 3, 2), (3, 1, 2)),
    2: ((1, 4, 0), (4, 2, 0)),
    4: ((2, 5, 1), (5, 0, 1)),
    3: ((3, 1, 4), (0, 3, 4), (0, 4, 2)),
    6: ((4, 2, 5), (1, 4, 5), (1, 5, 0)),
    5: ((5, 0, 3), (2, 5, 3), (2, 3, 1)),
    7: ((0, 3, 5), (1, 4, 3), (2, 5, 4), (3, 4, 5)),
}


@dataclass(frozen=True, eq=False)
class Knots:
    """Triangles with how far through their band each corner is swept.

    Attributes
    ----------
    points : (p, 2)
    triangles : (T, 3)
    face, band : (T,)
    share : (T, 3) 0 at the lower level, 1 at the upper; NaN: the band's middle, wherever that is.
    delay : (T, 3) of a middle: halfway from there to the band's end (1) or start (-1), and halfway
        again (2, -2), and so on.
    """

    points: Floats
    triangles: Ints
    face: Ints
    band: Ints
    share: Floats
    delay: Ints

    def of(self, chosen: Flags) -> Knots:
        """Some of the triangles (T,)."""
        rows = np.flatnonzero(chosen)
        return Knots(
            self.points,
            self.triangles[rows],
            self.face[rows],
            self.band[rows],
            self.share[rows],
            self.delay[rows],
        )

    def at(self, middle: Floats) -> Floats:
        """The shares (T, 3) where the bands' middles (B,) are known."""
        along = middle[self.band][:, None]
        delayed = np.where(
            self.delay < 0,
            along * 0.5 ** np.abs(self.delay),
            1 - (1 - along) * 0.5 ** np.abs(self.delay),
        )
        return np.where(np.isnan(self.share), delayed, self.share)


def divided(knots: Knots) -> Knots:
    """Triangles whose inner sides do not join two corners on one level: divided in the middle."""
    area = turns(knots.points, knots.triangles) / 2
    other = twins(knots.triangles, knots.face)
    seen = area > UNSEEN * area.sum()
    share = knots.share
    follow = np.roll(share, -1, axis=1)
    level = np.where((share == follow) & ((share == 0) | (share == 1)), share, NOTHING)
    there = np.append(level, NOTHING)[other.ravel()].reshape(-1, 3)
    wanted = (other != NOTHING) & ((level != NOTHING) | (there != NOTHING))
    wanted &= seen[:, None] | np.append(seen, False)[np.where(other == NOTHING, -1, other // 3)]
    level = np.where(level == NOTHING, there, level)
    level[(there != NOTHING) & (there != level)] = NOTHING
    while True:
        found, parent = _parted(knots, wanted, other, level)
        broken = np.unique(parent[turns(found.points, found.triangles) <= 0])
        if not len(broken):
            return found
        stop = wanted & np.isin(np.arange(len(wanted)), broken)[:, None]
        if not stop.any():
            return found
        wanted[stop] = False
        wanted.reshape(-1)[other[stop]] = False


def _parted(knots: Knots, wanted: Flags, other: Ints, level: Ints) -> tuple[Knots, Ints]:
    """Triangles with some sides divided, and the one that each is a part of."""
    side = np.arange(wanted.size).reshape(-1, 3)
    first = np.where(other == NOTHING, side, np.minimum(side, other))
    chosen, number = np.unique(first[wanted], return_inverse=True)
    triangle, corner = np.divmod(chosen, 3)
    ends = knots.triangles[triangle, [corner, (corner + 1) % 3]]
    middle = np.zeros(wanted.shape, dtype=np.intp)
    middle[wanted] = len(knots.points) + number
    delay = np.zeros(wanted.shape, dtype=np.intp)
    flat = (knots.share == knots.share[:, :1]).all(axis=1) & np.isin(knots.share[:, 0], [0, 1])
    delay[wanted] = _delays(wanted, flat, other, level)[wanted]
    slots = np.concatenate([knots.triangles, middle], axis=1)
    shares = np.concatenate([knots.share, np.full(wanted.shape, np.nan)], axis=1)
    delays = np.concatenate([knots.delay, delay], axis=1)
    mask = wanted @ [1, 2, 4]
    parents, corners = [], []
    for bits, parts in PARTS.items():
        rows = np.flatnonzero(mask == bits)
        parents += [rows] * len(parts)
        corners += [np.broadcast_to(part, (len(rows), 3)) for part in parts]
    parent = np.concatenate(parents)
    order = np.argsort(parent, kind="stable")
    parent, corner = parent[order], np.concatenate(corners)[order]
    row = parent[:, None]
    points = np.concatenate([knots.points, knots.points[ends].mean(axis=0)])
    found = Knots(
        points,
        slots[row, corner],
        knots.face[parent],
        knots.band[parent],
        shares[row, corner],
        delays[row, corner],
    )
    return found, parent


def _delays(wanted: Flags, flat: Flags, other: Ints, level: Ints) -> Ints:
    """By how much the middles of sides (T, 3) wait, so that no part has three of one time.

    Triangles that lie on one level with all corners hang together in trees. In each the middle of
    the side towards the root, where another level is, waits for those of both other sides: so no
    middle is an island.
    """
    delay = np.zeros(wanted.shape, dtype=np.intp)
    if not (wanted.sum(axis=1) == 3).any():
        return delay
    inner = (flat & wanted.any(axis=1)) | wanted.all(axis=1)
    rank = np.where(inner, len(wanted), 0)
    one, side = np.nonzero(wanted & inner[:, None])
    beside = other[one, side] // 3
    while True:
        nearer = rank.copy()
        np.minimum.at(nearer, one, rank[beside] + 1)
        if (nearer == rank).all():
            break
        rank = nearer
    # Each waits for those of higher rank: one after another, for what depends on nothing else.
    distant = np.where(wanted, rank[other // 3], len(wanted) + 1)
    roots = distant.argmin(axis=1)
    order = np.argsort(-rank[one], kind="stable")
    chosen = np.array(list(dict.fromkeys(one[order].tolist())), dtype=np.intp)
    root = 3 * chosen + roots[chosen]
    leaves = 3 * chosen[:, None] + (roots[chosen, None] + [1, 2]) % 3
    leaves = np.where(wanted.reshape(-1)[leaves], leaves, wanted.size)
    rising = (level.reshape(-1)[root] == 0).tolist()
    both: list[bool] = np.all(leaves < wanted.size, axis=1).tolist()
    waits = [0] * (wanted.size + 1)
    mirrors = other.reshape(-1)[root].tolist()
    found = zip(root.tolist(), mirrors, leaves.tolist(), both, rising, strict=True)
    for mine, its, (left, right), two, up in found:
        first, second = abs(waits[left]), abs(waits[right])
        longest = max(first, second) + (two and first == second)
        waits[mine] = waits[its] = longest if up else -longest
    return np.array(waits[:-1], dtype=np.intp).reshape(wanted.shape)


def opened(knots: Knots, times: Floats, spans: Spans) -> tuple[Knots, Floats]:
    """Triangles and their times (T, 3); what would still be swept at once is so around its middle.

    So are parts of a field that lie apart, and such as are all but level.
    """
    area = turns(knots.points, knots.triangles)
    flat = (times == times[:, :1]).all(axis=1) & (area > UNSEEN * area.sum())
    corners, time = knots.triangles[flat], times[flat, 0]
    low, high = spans.ends[knots.band[flat]].T
    middle = (time + np.where(time - low < high - time, high, low)) / 2
    number = len(knots.points) + np.arange(len(time))
    fan = np.stack([corners, np.roll(corners, -1, axis=1), np.repeat(number[:, None], 3, axis=1)])
    fans = fan.transpose(1, 2, 0).reshape(-1, 3)
    found = np.repeat(np.column_stack([time, time, np.rint(middle * TICKS) / TICKS]), 3, axis=0)
    every = np.concatenate([np.flatnonzero(~flat), np.repeat(np.flatnonzero(flat), 3)])
    result = Knots(
        np.concatenate([knots.points, knots.points[corners].mean(axis=1)]),
        np.concatenate([knots.triangles[~flat], fans]),
        knots.face[every],
        knots.band[every],
        knots.share[every],
        knots.delay[every],
    )
    if (turns(result.points, fans) <= 0).any():
        return knots, times
    return result, np.concatenate([times[~flat], found])


def below(times: Floats, at: Floats) -> Floats:
    """The share (T,) of triangles with corner times (T, 3) that is swept at a time (T,)."""
    low, middle, high = np.sort(times, axis=1).T
    with np.errstate(invalid="ignore", divide="ignore"):
        rising = (at - low) ** 2 / ((middle - low) * (high - low))
        falling = 1 - (high - at) ** 2 / ((high - middle) * (high - low))
    return np.select([at <= low, at >= high, at < middle], [0.0, 1.0, rising], falling)


def middles(knots: Knots, spans: Spans) -> Floats:
    """Where each band's middle (B,) is, so that area is as even as can be."""
    bands = len(spans.region)
    some = np.zeros(bands, dtype=bool)
    some[knots.band[np.isnan(knots.share).any(axis=1)]] = True
    part = knots.of(some[knots.band])
    area = turns(part.points, part.triangles) / 2
    whole = np.maximum(np.bincount(part.band, area, bands), np.finfo(float).tiny)
    every = np.arange(bands)
    found = [spans.within(np.full(bands, middle), every) for middle in MIDDLES]
    off = np.empty((len(MIDDLES), bands))
    for i, middle in enumerate(found):
        swept = below(part.at(middle), middle[part.band]) * area
        off[i] = np.abs(np.bincount(part.band, swept, bands) / whole - middle)
    off[1:] += WORTH
    return np.asarray(np.array(found)[np.argmin(off, axis=0), every])
