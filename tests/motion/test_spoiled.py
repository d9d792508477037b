"""Morphs spoiled on purpose: what a dense search in time finds wrong, the proof finds, and when.

The search looks at some hundreds of moments, and halves the time between two that differ until it
knows the change to a billionth. It misses what lasts shorter than its step, so the proof may tell
more; what it tells of beginnings and ends, the search looks up right before and right after.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, pairwise
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from geotween.data.polygons import Identity
from geotween.motion.correspond import correspond
from geotween.motion.divide import divide
from geotween.motion.events import merged
from geotween.motion.looks import polygons_at
from geotween.motion.match import match
from geotween.motion.sweep import Violation, sweep
from geotween.motion.tracks import Track
from tests.motion.made import FAMILIES, made, techniques
from tests.motion.test_measure import PROVING

Floats = NDArray[np.float64]
Objects = NDArray[np.object_]
States = NDArray[np.int8]
Random = np.random.Generator
Spoil = Callable[[Floats, Random], Floats]

# Not at halves and quarters, where symmetric motions do odd things.
MOMENTS = (np.arange(300) + 0.4772) / 300
EXACT = 1e-9
SLACK = 1e-6  # within which the times of search and proof agree

FINE, WRONG, UNTOLD = 0, 1, -1


# Spoiling: what a ring (n, 2) of the target is when its vertices arrive in another order.


def swapped(ring: Floats, random: Random) -> Floats:
    """Two vertices arrive in each other's places; mostly two that are near in the ring."""
    first, way = int(random.integers(len(ring))), int(random.choice([1, 2, 3, len(ring) // 2]))
    places = [first, (first + way) % len(ring)]
    found = ring.copy()
    found[places] = found[places[::-1]]
    return found


def rotated(ring: Floats, random: Random) -> Floats:
    """Every vertex arrives some places farther along."""
    most = min(max(len(ring) // 3, 1), 12)
    return np.roll(ring, int(random.integers(1, most + 1)) * int(random.choice([-1, 1])), axis=0)


SPOILS: Mapping[str, Spoil] = {"swapped": swapped, "rotated": rotated}


@dataclass(frozen=True, eq=False)
class Spoiled:
    """A transition's tracks, one of them spoiled, and the pairs that share no border at either end.

    Where borders touch, the search would take rounding for overlap.
    """

    tracks: list[Track]
    apart: list[tuple[int, int]]


def spoiled(family: str, seed: int, matching: str, spoil: str) -> Spoiled:
    origin, target = made(family, seed)
    chosen = techniques(family, matching)
    division = divide(correspond(origin, target, chosen.correspondence), chosen.division)
    random = np.random.default_rng(seed)
    tracks = []
    for k, piece in enumerate(match(division, chosen.matching).pieces):
        who = Identity(k)
        times = np.array([0.0, 1.0])
        tracks.append(
            Track(who, (who, who), "regions", times, piece.vertices, piece.offsets, piece.seams)
        )
    apart = pairs_apart(tracks)
    lasting = lasting_rings(tracks)
    if lasting:
        k, first, last = lasting[int(random.integers(len(lasting)))]
        vertices = tracks[k].vertices.copy()
        vertices[1, first:last] = SPOILS[spoil](vertices[1, first:last], random)
        tracks[k] = replace(tracks[k], vertices=vertices)
    return Spoiled(tracks, apart)


def lasting_rings(tracks: Sequence[Track]) -> list[tuple[int, int, int]]:
    """The rings that are there at both ends: their track, first vertex, and one past the last."""
    return [
        (k, first, last)
        for k, track in enumerate(tracks)
        for first, last in pairwise(track.offsets.tolist())
        if np.ptp(track.vertices[:, first:last], axis=1).all()
    ]


def pairs_apart(tracks: Sequence[Track]) -> list[tuple[int, int]]:
    """The pairs of tracks that do not touch at either end."""
    here, there = polygons_at(tracks, 0), polygons_at(tracks, 1)
    return [
        (i, j)
        for i, j in combinations(range(len(tracks)), 2)
        if not any(shapely.distance(end[i], end[j]) < SLACK for end in (here, there))
    ]


# What a look at one moment tells.


def sound(polygons: Objects) -> NDArray[np.bool_]:
    """Which polygons (k,) are valid and not inside out: outer rings to the left, holes not."""
    rings, owner = shapely.get_rings(polygons, return_index=True)
    outer = np.append(True, owner[1:] != owner[:-1])[: len(owner)]
    good = np.asarray(shapely.is_valid(polygons))
    good[owner[shapely.is_ccw(rings) != outer]] = False
    return good


def overlapping(one: Any, other: Any) -> States:
    """Whether polygons (k,) and (k,) have inner points in common.

    Untold where one crosses itself and their rings do not meet: what it covers is a matter of
    opinion then.
    """
    valid = shapely.is_valid(one) & shapely.is_valid(other)
    meet = shapely.intersects(shapely.boundary(one), shapely.boundary(other))
    found = np.where(meet, WRONG, UNTOLD).astype(np.int8)
    found[valid] = shapely.relate_pattern(one[valid], other[valid], "T********")
    return found


def states_of(subject: tuple[int, ...], polygons: Objects) -> States:
    """The states (m,) of a track, or a pair, in looks (m, n) at all tracks."""
    if len(subject) == 1:
        return np.where(sound(polygons[:, subject[0]]), FINE, WRONG).astype(np.int8)
    return overlapping(*polygons[:, subject].T)


@dataclass(frozen=True, eq=False)
class Search:
    """A dense search for what is wrong with a track, or with a pair."""

    tracks: Sequence[Track]
    subject: tuple[int, ...]
    states: States  # at MOMENTS

    def at(self, t: float) -> int:
        """The state at one moment."""
        mine = polygons_at([self.tracks[k] for k in self.subject], t)
        return int(states_of(tuple(range(len(mine))), mine[None])[0])

    def changes(self) -> list[float]:
        """The times, to EXACT, at which it goes wrong, or is fine again."""
        known = (self.states[1:] != UNTOLD) & (self.states[:-1] != UNTOLD)
        steps = np.flatnonzero(known & (self.states[1:] != self.states[:-1])).tolist()
        found = [self._change(k) for k in steps]
        return [t for t in found if t is not None]

    def _change(self, step: int) -> float | None:
        before = int(self.states[step])
        start, end = map(float, MOMENTS[step : step + 2])
        while end - start > EXACT:
            middle = (start + end) / 2
            state = self.at(middle)
            if state == UNTOLD:
                return None
            start, end = (middle, end) if state == before else (start, middle)
        return (start + end) / 2


def searches(case: Spoiled) -> list[Search]:
    looks = np.array([polygons_at(case.tracks, t) for t in MOMENTS.tolist()])
    subjects = [*((k,) for k in range(len(case.tracks))), *case.apart]
    return [Search(case.tracks, subject, states_of(subject, looks)) for subject in subjects]


# The agreement.


def assert_agrees_with_search(case: Spoiled) -> int:
    """The proof and the search agree; how many beginnings and ends the search found comes back."""
    proof = sweep(case.tracks)
    assert not proof.undecided
    told: dict[tuple[int, ...], list[Violation]] = {}
    for violation in proof.violations:
        told.setdefault(violation.tracks, []).append(violation)
    return sum(_agrees(search, told.get(search.subject, [])) for search in searches(case))


def _agrees(search: Search, violations: Sequence[Violation]) -> int:
    spans = np.array([(v.start, v.end) for v in violations]).reshape(-1, 2)
    for t in MOMENTS[search.states == WRONG].tolist():
        assert ((spans[:, 0] - SLACK <= t) & (t <= spans[:, 1] + SLACK)).any(), f"wrong at {t}"
    changes = search.changes()
    for t in changes:
        assert np.abs(spans - t).min() < SLACK, f"goes wrong, or is fine again, at {t}"
    touches = {t for v in violations if v.kind == "self-touch" for t in (v.start, v.end)}
    for start, end in joined(spans):
        for bound, inwards in ((start, SLACK), (end, -SLACK)):
            if SLACK < bound < 1 - SLACK and bound not in touches:
                assert search.at(bound - inwards) != WRONG, f"wrong beyond {bound}"
                assert search.at(bound + inwards) != FINE, f"fine within {bound}"
    return len(changes)


def joined(spans: Floats) -> list[tuple[float, float]]:
    """Spans that last, those joined between which there is no time to look."""
    room = 2 * SLACK * np.array([-1, 1])
    return [(a, b) for a, b in (merged(spans + room) - room).tolist() if b - a > 2 * SLACK]


@pytest.mark.parametrize("spoil", SPOILS)
@pytest.mark.parametrize("family", FAMILIES)
def test_proof_and_search_agree_on_one_of_each_family(family: str, spoil: str) -> None:
    assert_agrees_with_search(spoiled(family, 1, "rotation", spoil))


@pytest.mark.skipif(not PROVING, reason="takes minutes; make prove has it")
@given(
    st.sampled_from(list(FAMILIES)),
    st.integers(0, 10_000),
    st.sampled_from(["rotation", "trajectory"]),
    st.sampled_from(list(SPOILS)),
)
def test_proof_and_search_agree(family: str, seed: int, matching: str, spoil: str) -> None:
    assert_agrees_with_search(spoiled(family, seed, matching, spoil))
