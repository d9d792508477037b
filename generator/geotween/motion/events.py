"""What the edges of a layer tell: when rings cross, touch, turn over or vanish, as intervals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from geotween.motion.contacts import (
    ROUNDING,
    Runs,
    between,
    cross,
    crossings,
    lies_on,
    quadratic,
    turns,
    value,
)
from geotween.motion.moving import Flags, Floats, Moving, Numbers, near_edges
from geotween.motion.passages import overlapping, passages
from geotween.motion.tracks import Track

# A touch this near in time to an interval of crossing is its beginning or end: double roots are
# found to the square root of rounding.
NEAR = 1e-6

# One row an interval: a track, the same or a later one, start and end in [0, 1].
Rows = Floats
Pair = tuple[int, int]


@dataclass(frozen=True, eq=False)
class Events:
    """What the edges tell, in rows.

    ``wrong``: crossing, passing at a vertex, inverted. ``doubtful``: crossing less deep than the
    tolerance. ``touching``: a ring that touches itself for a while; ``instants`` (k, 4): for a
    moment, as track, t, x, y. ``breaks`` (k,): times from which on rings may lie elsewhere without
    having crossed: where they are born, die, or shrink to nothing.
    """

    wrong: Rows
    doubtful: Rows
    touching: Rows
    instants: Floats
    breaks: Floats
    events: int = 0
    looks: int = 0


def events_of(tracks: Sequence[Track], tolerance: float) -> Events:
    times = np.unique(np.concatenate([track.times for track in tracks]))
    owner = np.repeat(np.arange(len(tracks)), [len(track.offsets) - 1 for track in tracks])
    lives = np.array([track.life for track in tracks])
    spans = list(pairwise(times.tolist()))
    there = [(lives[:, 0] <= start) & (lives[:, 1] >= end) for start, end in spans]
    movings = [
        _moving(
            [tracks[k] for k in np.flatnonzero(mine).tolist()], span, owner[mine[owner]], tolerance
        )
        for span, mine in zip(spans, there, strict=True)
    ]
    alive = np.zeros((len(spans) + 2, len(owner)), dtype=bool)
    for k, moving in enumerate(movings):
        alive[k + 1, there[k][owner]] = np.diff(moving.offsets) > 0
    found = [
        _Span(moving, *span, alive[k, mine], alive[k + 2, mine], lives).events()
        for k, (moving, span) in enumerate(zip(movings, spans, strict=True))
        for mine in (there[k][owner],)
    ]
    changes = (alive[1:-2] != alive[2:-1]).any(axis=1)
    breaks = [times[1:-1][changes], *(events.instants[:, 1] for events in found)]
    return Events(
        np.concatenate([events.wrong for events in found]),
        np.concatenate([events.doubtful for events in found]),
        np.concatenate([events.touching for events in found]),
        np.concatenate([events.instants for events in found]),
        np.unique(np.concatenate(breaks)),
        sum(events.events for events in found),
        sum(events.looks for events in found),
    )


def _moving(
    tracks: list[Track], span: tuple[float, float], owner: Numbers, tolerance: float
) -> Moving:
    """Tracks between two key times; ``owner`` are the tracks of their rings."""
    places = [np.stack([track.at(t) for t in span]) for track in tracks]
    counts = [np.diff(track.offsets) for track in tracks]
    offsets = np.concatenate([[0], *map(np.cumsum, [np.concatenate(counts)] if counts else [])])
    every = np.concatenate(places, axis=1) if places else np.empty((2, 0, 2))
    return Moving.of(every, offsets.astype(np.intp), owner, tolerance)


@dataclass(frozen=True, eq=False)
class _Span:
    """A layer between two key times; ``before`` and ``after`` (r,) tell whose rings live beyond.

    ``lives`` (k, 2) are those of all tracks.
    """

    moving: Moving
    start: float
    end: float
    before: Flags
    after: Flags
    lives: Floats

    def events(self) -> Events:
        """What happens in between."""
        moving, track = self.moving, self.moving.track[self.moving.ring]
        inverted, thin, collapsed = self._areas()
        wrong, doubtful, touches = [inverted], [np.empty((0, 4))], []
        contacts = [np.empty((2, 0), dtype=np.intp)]
        events = looks = 0
        moments = (collapsed[:, 1] - self.start) / (self.end - self.start)
        for found in crossings(moving, *near_edges(moving, moments)):
            rows = self._rows(found.runs, track[found.one], track[found.other])
            wrong.append(rows[found.runs.deep])
            doubtful.append(rows[~found.runs.deep])
            contacts.append(np.stack([found.corner, found.edge]))
            touches.append(found.touches)
            events, looks = events + found.events, looks + found.looks
        meeting = passages(moving, *np.unique(np.concatenate(contacts, axis=1), axis=1))
        passing, touching, more = overlapping(moving, meeting)
        one, other = track[meeting.corner], track[meeting.other]
        wrong.append(self._rows(passing, one[passing.row], other[passing.row]))
        own = moving.ring[meeting.corner] == moving.ring[meeting.other]
        touched = self._rows(touching, one[touching.row], other[touching.row])[own[touching.row]]
        every = np.concatenate(wrong)
        told = np.concatenate([every, collapsed[:, [0, 0, 1, 1]]])
        instants = [collapsed, *(self._instants(*touch, told) for touch in touches)]
        return Events(
            every,
            np.concatenate(doubtful),
            np.concatenate([touched, thin]),
            np.concatenate(instants),
            collapsed[:, 1],
            events,
            looks + more,
        )

    def _rows(self, runs: Runs, one: Numbers, other: Numbers) -> Rows:
        times = self._global(np.column_stack([runs.start, runs.end]))
        return np.column_stack([np.minimum(one, other), np.maximum(one, other), times])

    def _global(self, t: Floats) -> Floats:
        return np.asarray(self.start + (self.end - self.start) * t)

    def _areas(self) -> tuple[Rows, Rows, Floats]:
        """Rings inverted, rings without area throughout, and moments without area."""
        moving = self.moving
        rings = np.flatnonzero(np.diff(moving.offsets))
        if not len(rings):
            return np.empty((0, 4)), np.empty((0, 4)), np.empty((0, 4))
        starts, track = moving.offsets[rings], moving.track[rings]
        outer = np.append(True, moving.track[1:] != moving.track[:-1])[rings]
        first = np.repeat(moving.vertex[starts], np.diff(np.append(starts, len(moving.vertex))))
        begin = moving.ways(first, moving.vertex)
        way = moving.ways(moving.vertex, moving.vertex[moving.following])
        twice = np.add.reduceat(quadratic(cross, begin, way), starts, axis=1)
        twice *= np.where(outer, 1, -1)
        length = np.add.reduceat(np.hypot(way[..., 0], way[..., 1]), starts, axis=1)
        least = moving.tolerance * length.max(axis=0)
        thin = np.abs(twice).max(axis=0) <= least

        times, moments = between(twice[None])
        negative = (value(twice, moments) < -least[:, None]) & ~thin[:, None]
        runs = Runs.of(negative, negative, times)
        inverted = self._rows(runs, track[runs.row], track[runs.row])
        flat = track[thin]
        span = np.broadcast_to([self.start, self.end], (len(flat), 2))

        moments = np.column_stack([turns(twice), np.zeros(len(rings)), np.ones(len(rings))])
        zero = (np.abs(value(twice, moments)) <= least[:, None]) & ~thin[:, None]
        zero &= (moments > ROUNDING) | self.before[rings, None]
        zero &= (moments < 1 - ROUNDING) | self.after[rings, None]
        rows = [
            (track[row], self._global(moments[row, column]), *place)
            for row, column in np.argwhere(zero).tolist()
            if (place := self._vanishes(int(rings[row]), moments[row, column])) is not None
        ]
        return inverted, np.column_stack([flat, flat, span]), np.array(rows).reshape(-1, 4)

    def _corners(self, ring: int, t: float) -> Floats:
        """The places (k, 2) of a ring's corners."""
        mine = self.moving.vertex[self.moving.offsets[ring] : self.moving.offsets[ring + 1]]
        return np.asarray(self.moving.places[0, mine] * (1 - t) + self.moving.places[1, mine] * t)

    def _vanishes(self, ring: int, t: float) -> list[float] | None:
        """The place where a ring has no area at t, or None where it has some."""
        corners = self._corners(ring, t)
        way = np.roll(corners, -1, axis=0) - corners
        twice = abs(cross(corners - corners[0], way).sum())
        thickness = self.moving.tolerance * np.hypot(way[:, 0], way[:, 1]).sum()
        return corners[0].tolist() if twice <= thickness + self.moving.tolerance**2 else None

    def _instants(self, corner: Numbers, edge: Numbers, t: Floats, told: Rows) -> Floats:
        """Moments (k, 4) at which a ring touches itself, but for those already told."""
        moving, times = self.moving, self._global(t)
        track = moving.track[moving.ring[corner]]
        since, until = self.lives[track].T
        kept = (times > since + ROUNDING) & (times < until - ROUNDING)
        for number in np.unique(track[kept]):
            mine = np.flatnonzero(kept & (track == number))
            spans = merged(told[(told[:, 0] == number) & (told[:, 1] == number), 2:])
            kept[mine] = ~within(times[mine], spans, NEAR)
        corner, edge, t = corner[kept], edge[kept], t[kept]
        # What touches when it begins or ends may take its time to leave.
        for end, moment in enumerate((self.start, self.end)):
            path = np.column_stack([(t + end) / 2, np.full(len(t), float(end))])
            leaving = self.lives[moving.track[moving.ring[corner]], end] == moment
            leaving &= lies_on(moving, corner, edge, path).all(axis=1)
            corner, edge, t = corner[~leaving], edge[~leaving], t[~leaving]
        rows = [
            (moving.track[moving.ring[k]], self._global(moment), *place)
            for k, e, moment in zip(corner.tolist(), edge.tolist(), t.tolist(), strict=True)
            if (place := self._touches(k, e, moment)) is not None
        ]
        return np.array(rows).reshape(-1, 4)

    def _touches(self, corner: int, edge: int, t: float) -> list[float] | None:
        """Where a corner touches an edge of its ring; None if all between them is one point."""
        ring = int(self.moving.ring[corner])
        corners = self._corners(ring, t)
        lengths = np.hypot(*(np.roll(corners, -1, axis=0) - corners).T)
        first = int(self.moving.offsets[ring])
        k, e, count = corner - first, edge - first, len(corners)
        there = lengths[(k + np.arange((e - k) % count)) % count].sum()
        back = lengths[(e + 1 + np.arange((k - e - 1) % count)) % count].sum()
        joined = min(there, back) <= 4 * self.moving.tolerance
        return None if joined else corners[k].tolist()


def merged(intervals: Floats) -> Floats:
    """Intervals (k, 2) in order, those that meet but for rounding in one."""
    if not len(intervals):
        return intervals
    intervals = intervals[np.argsort(intervals[:, 0], kind="stable")]
    reached = np.maximum.accumulate(intervals[:, 1])
    new = np.append(True, intervals[1:, 0] > reached[:-1] + ROUNDING)
    return np.column_stack([intervals[new, 0], reached[np.append(new[1:], True)]])


def within(t: Floats, intervals: Floats, slack: float) -> Flags:
    """Whether times (k,) are in merged intervals (m, 2)."""
    if not len(intervals):
        return np.zeros(len(t), dtype=bool)
    k = np.searchsorted(intervals[:, 0] - slack, t, side="right") - 1
    return np.asarray((k >= 0) & (t <= intervals[k, 1] + slack))


def by_pair(rows: Rows) -> dict[Pair, Floats]:
    """The merged intervals of each pair of tracks."""
    rows = rows[np.lexsort(rows.T[::-1])]
    if not len(rows):
        return {}
    cuts = np.flatnonzero((rows[1:, :2] != rows[:-1, :2]).any(axis=1)) + 1
    return {
        (int(group[0, 0]), int(group[0, 1])): merged(group[:, 2:]) for group in np.split(rows, cuts)
    }
