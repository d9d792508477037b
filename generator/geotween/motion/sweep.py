"""The proof: at which times moving polygons cross themselves or overlap, all t in [0, 1].

What is proved, of tracks whose vertices move on straight lines between key times: outside of the
intervals that are reported, and of those left undecided, every ring meets neither itself nor
another ring of its polygon but in touching, keeps its orientation, and holes stay inside; no two
polygons overlap. Births, deaths and contact when a track begins or ends, at t = 0 and t = 1 as in
between, are no violation; what begins right after that is.

Up to which rounding: what is no deeper than ``TOUCH`` of the tracks' extent (or sixteen units in
the last place of the largest coordinate, if that is more) touches; what is more than four times
deeper is found. A ring that touches itself between the ends is not simple and is reported, too,
as is one that shrinks to nothing on the way.

What is only measured: the areas and places of violations, by looks at a few moments of each.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.motion.contacts import ROUNDING
from geotween.motion.events import NEAR, Events, Pair, by_pair, events_of, within
from geotween.motion.looks import overlaps, polygons_at, polygons_with, rebuilt, wrong_area
from geotween.motion.moving import Floats
from geotween.motion.tracks import Track

Row = tuple[int, int, float, float]  # two tracks, or one twice, and an interval
Kind = Literal["self-crossing", "self-touch", "overlap"]

# Contacts no deeper than this share of the tracks' extent touch. Planning leaves some 1e-13 of it
# as rounding; a map shows 1e-4.
TOUCH = 1e-10

# Where rounding of the coordinates alone exceeds this share of the extent, nothing is decided.
COARSEST = 1e-6

# Where in an interval it is looked at: not half-way, where symmetric motions do odd things.
ODD = 0.4772

NONE = np.empty((0, 2))

# Moments at which the area of a violation is measured, as shares of its interval.
MEASURED = (0.25, 0.5, 0.75)


@dataclass(frozen=True)
class Violation:
    """What is wrong from ``start`` to ``end``, on one track or between two, by their positions.

    ``self-crossing``: a ring crosses itself or another one of its polygon, a hole lies outside, a
    ring is inverted. ``self-touch``: a ring touches itself between the ends, or shrinks to
    nothing. ``overlap``: two tracks cover the same area, or their borders cross; beside a ring
    that is wrong itself, its wrong side may be what overlaps, and the area 0. ``area``, in square
    units of the tracks, is the largest that was measured, of what is covered twice or turned
    inside out; ``place`` lies in it.
    """

    kind: Kind
    tracks: tuple[int, ...]
    start: float
    end: float
    area: float
    place: tuple[float, float]


@dataclass(frozen=True)
class Undecided:
    """An interval in which rounding leaves no decision about some tracks."""

    tracks: tuple[int, ...]
    start: float
    end: float
    reason: str


@dataclass(frozen=True)
class Proof:
    """What is wrong in a layer over all t in [0, 1], and what could not be decided.

    ``events`` and ``looks`` count the roots and the moments between them that were looked at;
    what is within ``tolerance``, in units of the tracks, touches.
    """

    violations: tuple[Violation, ...]
    undecided: tuple[Undecided, ...]
    events: int
    looks: int
    tolerance: float

    @property
    def clean(self) -> bool:
        """Whether nothing is wrong, at any t."""
        return not self.violations and not self.undecided


def sweep(tracks: Sequence[Track], tolerance: float = TOUCH) -> Proof:
    """All violations among the tracks of one layer.

    ``tolerance`` is a share of the tracks' extent. Cost: n log n for n vertices, and linear in
    the pairs of edges that come near each other.
    """
    places = [track.vertices.reshape(-1, 2) for track in tracks]
    if not sum(map(len, places)):
        return Proof((), (), 0, 0, 0.0)
    every = np.concatenate(places)
    extent = float(np.ptp(every, axis=0).max())
    if not extent:
        return Proof((), (), 0, 0, 0.0)
    scale = float(2.0 ** -np.round(np.log2(extent)))  # exact, and squares do not overflow
    rounding = 16 * float(np.spacing(np.abs(every).max()))
    if rounding > COARSEST * extent:
        reason = "the coordinates are too large for the extent"
        whole = Undecided(tuple(range(len(tracks))), 0.0, 1.0, reason)
        return Proof((), (whole,), 0, 0, rounding)
    limit = max(tolerance * extent, rounding)
    scaled = [replace(track, vertices=track.vertices * scale) for track in tracks]
    found = events_of(scaled, limit * scale)
    wrong, touching, looks = _settled(scaled, found, limit * scale)
    violations = _measured(scaled, _rows(wrong), scale)
    for pair, intervals in touching.items():
        known = wrong.get(pair, NONE)
        rest = [_gaps(known, span, NEAR) for span in intervals]
        violations += [
            _touch(scaled[pair[0]], pair[0], start, end, scale)
            for start, end in np.concatenate(rest).tolist()
        ]
    instants = np.concatenate([found.instants, _at_key_times(scaled)])
    violations += _momentary(instants, {**touching, **wrong}, scale)
    violations.sort(key=lambda v: (v.start, v.end, v.tracks, v.kind))
    return Proof(tuple(violations), (), found.events, found.looks + looks, limit)


def in_other_order(proof: Proof, places: Sequence[int]) -> Proof:
    """A proof of the same tracks in another order; ``places`` says where each of them is now."""

    def renamed(found: Violation) -> Violation:
        return replace(found, tracks=tuple(sorted(places[k] for k in found.tracks)))

    undecided = tuple(
        replace(one, tracks=tuple(sorted(places[k] for k in one.tracks))) for one in proof.undecided
    )
    return replace(proof, violations=tuple(map(renamed, proof.violations)), undecided=undecided)


def _settled(
    tracks: Sequence[Track], found: Events, tolerance: float
) -> tuple[dict[Pair, Floats], dict[Pair, Floats], int]:
    """When pairs of tracks are wrong, and tracks touch themselves; and the number of looks.

    Where edges do not cross, one look tells on which side of each other the rings are. It holds
    as far as no ring is born, dies or shrinks to nothing.
    """
    crossing = by_pair(found.wrong)
    breaks = np.unique(np.concatenate([[0.0], found.breaks, [1.0]]))
    wrong, touching, looks = [found.wrong], [found.touching], 0
    for start, end in pairwise(breaks.tolist()):
        bad, touches = _one_look(tracks, start + ODD * (end - start), tolerance, crossing)
        for rows, pairs in ((wrong, bad), (touching, touches)):
            rows += [np.array([[*pair, start, end]], dtype=float) for pair in pairs]
        looks += 1
    spans = _rows({pair: _gaps(intervals, breaks) for pair, intervals in crossing.items()})
    for pair, intervals in by_pair(found.doubtful).items():
        lasting = intervals[np.ptp(intervals, axis=1) > ROUNDING]
        lasting = lasting[~within(lasting.mean(axis=1), crossing.get(pair, NONE), 0)]
        spans += _rows({pair: lasting})
    moments = [start + ODD * (end - start) for *_, start, end in spans]
    chosen = _are_wrong(tracks, [(i, j) for i, j, *_ in spans], moments, tolerance)
    wrong.append(np.array(spans, dtype=float).reshape(-1, 4)[chosen])
    looks += len(spans)
    return by_pair(np.concatenate(wrong)), by_pair(np.concatenate(touching)), looks


def _one_look(
    tracks: Sequence[Track], t: float, tolerance: float, known: Collection[Pair]
) -> tuple[list[Pair], list[Pair]]:
    """The pairs that are wrong at t, and the tracks that touch themselves, but for known pairs."""
    polygons = polygons_at(tracks, t)
    invalid = np.flatnonzero(~shapely.is_valid(polygons))
    fresh = [(k, k) for k in invalid.tolist() if (k, k) not in known]
    wrong = _wrong_of(tracks, fresh, t, tolerance)
    one, other = shapely.STRtree(polygons).query(polygons)
    alone = np.setdiff1d(invalid, one[one != other])
    polygons[alone] = shapely.Polygon()  # rebuilding what is beyond repair takes its time
    polygons = rebuilt(polygons)
    tree = shapely.STRtree(shapely.point_on_surface(polygons))
    inside = np.sort(tree.query(polygons, predicate="contains"), axis=0)
    pairs = {(i, j) for i, j in inside.T.tolist() if i != j and (i, j) not in known}
    wrong += _wrong_of(tracks, sorted(pairs), t, tolerance)
    return wrong, [pair for pair in fresh if pair not in wrong]


def _rows(of_pairs: Mapping[Pair, Floats]) -> list[Row]:
    """Pairs with each of their intervals."""
    return [
        (*pair, start, end)
        for pair, intervals in of_pairs.items()
        for start, end in intervals.tolist()
    ]


def _wrong_of(
    tracks: Sequence[Track], pairs: Sequence[Pair], t: float, tolerance: float
) -> list[Pair]:
    bad = _are_wrong(tracks, pairs, [t] * len(pairs), tolerance)
    return [pair for pair, is_bad in zip(pairs, bad.tolist(), strict=True) if is_bad]


def _are_wrong(
    tracks: Sequence[Track], pairs: Sequence[Pair], moments: Sequence[float], tolerance: float
) -> NDArray[np.bool_]:
    """Whether what is wrong is wider than borders that touch within the tolerance explain.

    A sliver is as wide as twice its area by its length: half of that is one of its sides. A
    valid polygon is not wrong itself.
    """
    areas = _wrong_at(tracks, pairs, moments)
    alone = np.flatnonzero([one == other for one, other in pairs])
    numbers = np.array([pairs[k][0] for k in alone.tolist()], dtype=np.intp)
    drawn = _polygons(tracks, numbers, np.array(moments)[alone])
    areas[alone[shapely.is_valid(drawn)]] = shapely.MultiPolygon()
    parts, owner = shapely.get_parts(areas, return_index=True)
    found = np.zeros(len(pairs), dtype=bool)
    found[owner[shapely.area(parts) > 2 * tolerance * shapely.length(parts)]] = True
    return found


def _wrong_at(
    tracks: Sequence[Track], pairs: Sequence[Pair], moments: Sequence[float]
) -> NDArray[np.object_]:
    """What is wrong with each pair (n,) at its moment, as area."""
    found = np.full(len(pairs), shapely.MultiPolygon(), dtype=object)
    numbers, times = np.array(pairs, dtype=np.intp).reshape(-1, 2), np.array(moments)
    apart = numbers[:, 0] != numbers[:, 1]
    one, other = (_polygons(tracks, of[apart], times[apart]) for of in numbers.T)
    found[apart] = overlaps(one, other)
    for k in np.flatnonzero(~apart).tolist():
        found[k] = wrong_area(tracks[numbers[k, 0]], moments[k])
    return found


def _polygons(
    tracks: Sequence[Track], numbers: NDArray[np.intp], moments: Floats
) -> NDArray[np.object_]:
    """The polygons (n,) of tracks by number, each at a moment of its own."""
    found = np.full(len(numbers), shapely.Polygon(), dtype=object)
    seen = [(tracks[k], t) for k, t in zip(numbers.tolist(), moments.tolist(), strict=True)]
    there = np.flatnonzero([track.is_there(t) for track, t in seen])
    seen = [seen[k] for k in there.tolist()]
    found[there] = polygons_with([track for track, _ in seen], [track.at(t) for track, t in seen])
    return found


def _gaps(intervals: Floats, breaks: Floats, least: float = ROUNDING) -> Floats:
    """What merged intervals leave of the time between breaks, cut at each; in pieces."""
    inner = intervals.clip(breaks[0], breaks[-1]).ravel()
    gaps = [
        (start, end)
        for start, end in pairwise(np.unique(np.concatenate([breaks, inner])).tolist())
        if end - start > least and not within(np.array([(start + end) / 2]), intervals, 0)[0]
    ]
    return np.array(gaps).reshape(-1, 2)


def _measured(tracks: Sequence[Track], rows: Sequence[Row], scale: float) -> list[Violation]:
    """Violations, each with the largest area that looks at it find."""
    moments = [[start + share * (end - start) for share in MEASURED] for *_, start, end in rows]
    pairs = [(i, j) for i, j, *_ in rows for _ in MEASURED]
    areas = _wrong_at(tracks, pairs, [t for times in moments for t in times])
    sizes = shapely.area(areas).reshape(-1, len(MEASURED))
    found = []
    for k, (one, other, start, end) in enumerate(rows):
        largest = int(sizes[k].argmax())
        parts = shapely.get_parts(areas[len(MEASURED) * k + largest])
        if len(parts):
            place = shapely.point_on_surface(parts[np.argmax(shapely.area(parts))])
            x, y = place.x, place.y
        else:
            x, y = tracks[one].at(moments[k][largest])[0].tolist()
        kind: Kind = "self-crossing" if one == other else "overlap"
        numbers = (one,) if one == other else (one, other)
        area = float(sizes[k, largest]) / scale**2
        found.append(Violation(kind, numbers, start, end, area, (x / scale, y / scale)))
    return found


def _at_key_times(tracks: Sequence[Track]) -> Floats:
    """Rings that are not simple at a key time in between, as (track, t, x, y).

    What touches then, and at no moment before or after, has no event between two key times.
    """
    inner = np.unique(np.concatenate([track.times for track in tracks]))[1:-1]
    rows = []
    for t in inner.tolist():
        polygons = polygons_at(tracks, t)
        rows += [
            (k, t, *_place_of_touch(tracks[k], t))
            for k in np.flatnonzero(~shapely.is_valid(polygons)).tolist()
            if tracks[k].life[0] < t
        ]
    return np.array(rows).reshape(-1, 4)


def _place_of_touch(track: Track, t: float) -> tuple[float, float]:
    """Where GEOS finds a track invalid at t; any of its vertices where it does not."""
    reason = str(shapely.is_valid_reason(polygons_at([track], t)[0]))
    told = reason.partition("[")[2].rstrip("]").split()
    x, y = [float(number) for number in told] if told else track.at(t)[0].tolist()
    return x, y


def _touch(track: Track, number: int, start: float, end: float, scale: float) -> Violation:
    """A ring that touches itself for a while; GEOS says where."""
    x, y = _place_of_touch(track, start + ODD * (end - start))
    return Violation("self-touch", (number,), start, end, 0.0, (x / scale, y / scale))


def _momentary(instants: Floats, known: dict[Pair, Floats], scale: float) -> list[Violation]:
    """Touches at one moment each, outside of known intervals."""
    instants = instants[np.lexsort(instants.T[1::-1])]
    found: list[Violation] = []
    for track, t, x, y in instants.tolist():
        number = int(track)
        if within(np.array([t]), known.get((number, number), NONE), NEAR)[0]:
            continue
        if found and found[-1].tracks == (number,) and t - found[-1].start < NEAR:
            continue
        found.append(Violation("self-touch", (number,), t, t, 0.0, (x / scale, y / scale)))
    return found
