"""Borders: what two rings share at both ends is matched once, for both of them.

origin  k │ l   target  k ╲ l      The border of k and l goes to their border, its ends go to its
        ──┴──           ───┴─      ends, and its vertices are the same in k and in l at any time.
          m               m

Borders that are tied so cut rings into stretches; the rest of each ring is matched by itself,
from tie to tie.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from geotween.motion.alignment import Points
from geotween.motion.arcs import Places, complex_points, outer_places, points_along, stretch
from geotween.motion.neighbours import Indices
from geotween.motion.pins import Pins, common_runs
from geotween.motion.rings import Rings, Vertices
from geotween.motion.ties import Bordered, ties_between
from geotween.motion.trajectory import matched_curves, trajectory

# A border is not tied if that would move more common boundary of one of its rings than this share
# of its lengths at both ends: then rather its other ring passes along a ring that stays.
BROKEN = 0.5


@dataclass(frozen=True, eq=False)
class TiedRings:
    """Two rings that are matched along their borders with others.

    ``vertices`` (2, q, 2) are matched, and along a tied border equal to the bit to those of the
    ring beyond. ``here`` and ``there`` (q,) are their ring parameters; they rise, but several
    vertices may be at one place, where a stretch grows from a point or shrinks to one.
    """

    vertices: NDArray[np.float64]
    here: Places
    there: Places


@dataclass(frozen=True, eq=False)
class _Part:
    """A stretch of two rings: where it starts, and how many edges long it is; (2,) each."""

    start: Indices
    count: Indices


@dataclass(frozen=True, eq=False)
class _Matched:
    """Matched places (2, q), and the points (2, q) there, x + iy."""

    places: NDArray[np.float64]
    points: NDArray[np.complex128]

    def backwards(self, last: Indices) -> _Matched:
        """The same for rings that run the other way, from ``last`` (2,) back to place 0."""
        return _Matched((last[:, None] - self.places)[:, ::-1], self.points[:, ::-1])


@dataclass(frozen=True, eq=False)
class _Two:
    """Two rings that become each other, with their neighbours' vertices, and what they share."""

    rings: tuple[Points, Points]
    pins: Pins

    @classmethod
    def of(cls, one: Vertices, other: Vertices) -> _Two:
        return cls((complex_points(one), complex_points(other)), common_runs(one, other))

    @property
    def sizes(self) -> Indices:
        return np.array([len(ring) for ring in self.rings])

    def behind(self, start: Indices) -> Places:
        """How far (2, p) the pins are behind a place of each ring."""
        return (np.stack([self.pins.here, self.pins.there]) - start[:, None]) % self.sizes[:, None]

    def keeps(self, part: _Part) -> bool:
        """Whether not too much common boundary lies in the part of one ring only."""
        inside = self.behind(part.start) < part.count[:, None]
        points = points_along(self.rings[0], self.pins.here)
        moved = np.abs(np.roll(points, -1) - points)[self.pins.common & (inside[0] != inside[1])]
        both = self._stretches(part.start, part.start + part.count)
        length = sum(np.abs(np.diff(curve)).sum() for _, curve in both)
        return bool(moved.sum() <= BROKEN * length)

    def matched(self, part: _Part) -> _Matched:
        """A part matched from end to end; places are counted from its start."""
        ties, common = self._ties(part)
        found = []
        for tie, following, still in zip(ties.T, ties.T[1:], common, strict=False):
            if still:
                found.append(tie[:, None])
            elif (tie != following).any():
                places = self._between(part.start + tie, part.start + following)
                found.append(places[:, :-1] - part.start[:, None])
        places = np.concatenate([*found, ties[:, -1:]], axis=1)
        return _Matched(places, _points(self.rings, part.start[:, None] + places))

    def all_round(self, parts: Sequence[tuple[_Part, _Matched]]) -> _Matched:
        """The whole rings, given some matched parts of them."""
        parts = sorted(parts, key=lambda one: int(one[0].start[0]))
        found = []
        for (part, matched), (following, _) in pairwise([*parts, parts[0]]):
            end = part.start + part.count
            gap = _Part(end, (following.start - end) % self.sizes)
            found.append((part.start, matched))
            if gap.count.any():
                found.append((gap.start, self.matched(gap)))
        return _Matched(
            np.concatenate([start[:, None] + m.places[:, :-1] for start, m in found], axis=1),
            np.concatenate([m.points[:, :-1] for _, m in found], axis=1),
        )

    def _stretches(
        self, starts: Places | Indices, ends: Places | Indices
    ) -> list[tuple[Places, Points]]:
        return [stretch(*one) for one in zip(self.rings, starts, ends, strict=True)]

    def _between(self, starts: Places, ends: Places) -> Places:
        """Matched places (2, q) of what lies between two ties, from one to the other."""
        (here, a), (there, b) = self._stretches(starts, ends)
        if starts[0] == ends[0]:
            here = np.full(len(there), starts[0])
        elif starts[1] == ends[1]:
            there = np.full(len(here), starts[1])
        else:
            first, second = matched_curves(a, b)
            here, there = outer_places(here, first), outer_places(there, second)
        return np.stack([here, there])

    def _ties(self, part: _Part) -> tuple[Places, NDArray[np.bool_]]:
        """The ends of a part and the pins within (2, p); and after which the boundary is common."""
        behind = self.behind(part.start)
        inside = np.flatnonzero((behind <= part.count[:, None]).all(axis=0))
        inside = inside[np.lexsort(behind[::-1, inside])]
        inside = inside[behind[1, inside] >= np.maximum.accumulate(behind[1, inside])]
        common = self.pins.common[inside]
        common &= np.roll(inside, -1) == (inside + 1) % len(self.pins.common)
        common[-1:] = False
        return (
            np.column_stack([np.zeros(2), behind[:, inside], part.count]),
            np.concatenate([[False], common]),
        )


def tied_rings(
    origin: Rings, target: Rings, pairs: Sequence[tuple[int, int]]
) -> Mapping[int, TiedRings]:
    """Those of some pairs of rings, by position, that have borders with others at both ends.

    Cost: n log n for n vertices, and that of ``trajectory`` for each border and each rest.
    """
    if len(pairs) < 2:
        return {}
    numbers = np.array(pairs, dtype=np.intp).T
    ends = (Bordered.of(origin, numbers[0]), Bordered.of(target, numbers[1]))
    ties = ties_between(*ends)
    tied = np.concatenate([ends[0].arcs.ring[ties[:, 0]], ends[0].arcs.beyond[ties[:, 0]]])
    two = {k: _Two.of(ends[0].ring(k), ends[1].ring(k)) for k in np.unique(tied).tolist()}
    parts: dict[int, list[tuple[_Part, _Matched]]] = {}
    for tie in ties.tolist():
        (k, part), (beyond, mate) = _sides(ends, tie)
        if two[k].keeps(part) and two[beyond].keeps(mate):
            matched = two[k].matched(part)
            parts.setdefault(k, []).append((part, matched))
            parts.setdefault(beyond, []).append((mate, matched.backwards(part.count)))
    found = {k: two[k].all_round(own) for k, own in parts.items()}
    for k, beyond in _enclosed(ends):
        found[k], found[beyond] = _closed(ends, k)
    return {k: _tied(ends, k, matched) for k, matched in found.items()}


def _sides(ends: tuple[Bordered, Bordered], tie: Sequence[int]) -> list[tuple[int, _Part]]:
    """A tie from both sides: the ring, and the part of it at both ends."""
    mates = [int(end.arcs.mate[arc]) for end, arc in zip(ends, tie, strict=True)]
    found = []
    for arcs in (tie, mates):
        both = list(zip(ends, arcs, strict=True))
        part = _Part(
            np.array([end.arcs.start[arc] for end, arc in both]),
            np.array([end.arcs.count[arc] for end, arc in both]),
        )
        found.append((int(ends[0].arcs.ring[arcs[0]]), part))
    return found


def _enclosed(ends: tuple[Bordered, Bordered]) -> list[tuple[int, int]]:
    """Rings that have only each other for neighbours, at both ends; each two once."""
    found = [{(k, beyond) for k, beyond in end.enclosed.tolist() if k < beyond} for end in ends]
    return sorted(found[0] & found[1])


def _closed(ends: tuple[Bordered, Bordered], k: int) -> tuple[_Matched, _Matched]:
    """A ring that has one neighbour all round, and that neighbour, which runs the other way."""
    places = np.stack(trajectory(ends[0].ring(k), ends[1].ring(k)))
    rings = [complex_points(end.ring(k)) for end in ends]
    matched = _Matched(places, _points(rings, places))
    last = [end.opposite(k) + len(ring) for end, ring in zip(ends, rings, strict=True)]
    return matched, matched.backwards(np.array(last))


def _points(rings: Sequence[Points], places: Places) -> NDArray[np.complex128]:
    """The points at places (2, q) along two rings."""
    return np.stack([points_along(ring, own) for ring, own in zip(rings, places, strict=True)])


def _tied(ends: tuple[Bordered, Bordered], k: int, matched: _Matched) -> TiedRings:
    """What is matched as vertices, at ring parameters of the rings as they were."""
    here, there = (end.given(k, own) for end, own in zip(ends, matched.places, strict=True))
    start = -int(np.argmin(here))
    vertices = np.ascontiguousarray(matched.points).view(np.float64).reshape(2, -1, 2)
    return TiedRings(np.roll(vertices, start, axis=1), np.roll(here, start), np.roll(there, start))
