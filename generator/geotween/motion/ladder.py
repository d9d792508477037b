"""The ladder: what the first matching does not prove is moved in other ways, group by group.

1. All pieces are matched in the first way, and the motion is swept (sweep.py).
2. Groups of pieces in which something crosses take the next way, if they are better off by it.
   The last way is a front between keyframes: their target is laid on the origin first, and what
   changes is swept while both travel (front/carried.py).
3. What still crosses is reported by the certificate.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from geotween.data.problems import Problem
from geotween.motion.common import moved_shares
from geotween.motion.divide import Division
from geotween.motion.front.carried import carried
from geotween.motion.front.fronts import Fronts
from geotween.motion.groups import Groups, Numbers
from geotween.motion.interpolate import interpolate
from geotween.motion.match import match
from geotween.motion.sweep import Proof, sweep
from geotween.motion.techniques import FRONT
from geotween.motion.tracks import Track

# Ways that are named for their path, with the matching that goes with it: on combs, rotation and
# intrinsic paths prove 97%, trajectory and straight ones 78%.
TURNING = {"intrinsic": ("rotation", "intrinsic")}

# What a violation counts at least, as a share of the area; what is wrong for a moment is wrong.
LEAST = 1e-12


@dataclass(frozen=True, eq=False)
class Climbed:
    """Tracks, the way in which each was made, and what had to be proved of them."""

    tracks: tuple[Track, ...]
    ways: tuple[str, ...]
    problems: tuple[Problem, ...]
    proof: Proof | None


@dataclass(frozen=True, eq=False)
class _Moved:
    """Tracks, and for each its group and the share of its common boundary that moves."""

    tracks: tuple[Track, ...]
    groups: Numbers
    boundary: NDArray[np.float64]
    problems: tuple[Problem, ...]

    def chosen(self, kept: NDArray[np.bool_]) -> _Moved:
        """The tracks (n,) for which a mask is True."""
        tracks = tuple(t for t, k in zip(self.tracks, kept, strict=True) if k)
        return replace(self, tracks=tracks, groups=self.groups[kept], boundary=self.boundary[kept])


def climb(
    division: Division,
    groups: Groups,
    ways: Iterable[str],
    path: str,
    layer: str,
    tolerance: float,
    resolution: float,
    company: Fronts,
) -> Climbed:
    """Move the pieces of a division in the first way, and those that it does not prove in others.

    ``company`` moves at the same time, and must not be crossed either.

    ``tolerance`` and ``resolution`` are in the data's units: places nearer than the first are the
    same, and nobody sees the second.
    """
    if not len(division.indices):
        return Climbed((), (), (), company.proof)
    first, *others = ways
    of_pair = groups.of_pairs(division.indices)
    every = np.ones(groups.count, dtype=bool)

    def moved(way: str, chosen: NDArray[np.bool_]) -> _Moved:
        if way == FRONT:
            return _fronts(division, groups, chosen, layer, resolution)
        pairs = chosen[of_pair]
        matching, along = TURNING.get(way, (way, path))
        matched = match(_part(division, pairs), matching)
        tracks, problems = interpolate(matched, layer, tolerance, along, resolution)
        moves = moved_shares(tracks, tolerance) if others else np.zeros(len(tracks))
        return _Moved(tracks, of_pair[pairs], moves, tuple(problems))

    def swept(parts: list[_Moved]) -> tuple[Proof, NDArray[np.float64]]:
        proof = sweep((*_tracks_of(parts), *company.tracks))
        return proof, _wrong(proof, parts, groups.count)

    kept = [moved(first, every)]
    if not others:
        return _climbed(kept, [first], None)
    proof, wrong = swept(kept)
    for way in others:
        if not wrong.any():
            break
        tried = moved(way, wrong > 0)
        parts = [*(one.chosen(wrong[one.groups] == 0) for one in kept), tried]
        found, after = swept(parts)
        better = after < wrong
        if (better == (wrong > 0)).all():
            kept, proof, wrong = parts, found, after
            continue
        kept = [
            *(one.chosen(~better[one.groups]) for one in kept),
            tried.chosen(better[tried.groups]),
        ]
        if better.any():
            proof, wrong = swept(kept)
    return _climbed(kept, [first, *others], proof)


def _climbed(parts: list[_Moved], ways: list[str], proof: Proof | None) -> Climbed:
    """The parts that were moved, each in its way; of those without tracks nothing is told."""
    return Climbed(
        _tracks_of(parts),
        tuple(way for way, part in zip(ways, parts, strict=False) for _ in part.tracks),
        tuple(problem for part in parts if part.tracks for problem in part.problems),
        proof,
    )


def _fronts(
    division: Division, groups: Groups, chosen: NDArray[np.bool_], layer: str, resolution: float
) -> _Moved:
    """Each of the chosen groups as a front of its own, whose common boundary rests."""
    tracks: list[Track] = []
    owners: list[int] = []
    for group in np.flatnonzero(chosen).tolist():
        ends = (
            division.origin.chosen(groups.of_origin == group),
            division.target.chosen(groups.of_target == group),
        )
        found = carried(*ends, layer, resolution)
        tracks += found
        owners += [group] * len(found)
    return _Moved(tuple(tracks), np.array(owners, dtype=np.intp), np.zeros(len(owners)), ())


def _part(division: Division, chosen: NDArray[np.bool_]) -> Division:
    """A division with some of its pairs."""
    return replace(
        division,
        origin_pieces=division.origin_pieces[chosen],
        target_pieces=division.target_pieces[chosen],
        indices=division.indices[chosen],
    )


def _tracks_of(parts: Iterable[_Moved]) -> tuple[Track, ...]:
    return tuple(track for part in parts for track in part.tracks)


def _wrong(proof: Proof, parts: list[_Moved], count: int) -> NDArray[np.float64]:
    """How wrong each group (count,) is: 0 where it is proved and its common boundary rests.

    The area of each violation by its time, as a share of the largest polygon's box, and the share
    of common boundary that moves. A violation without area counts as little as rounding does.
    """
    tracks = _tracks_of(parts)
    groups = np.concatenate([part.groups for part in parts])
    wrong = np.zeros(count)
    np.add.at(wrong, groups, np.concatenate([part.boundary for part in parts]))
    size = max((float(np.ptp(t.vertices[0], axis=0).max(initial=0)) for t in tracks), default=0.0)
    for violation in proof.violations:
        share = violation.area / size**2 * (violation.end - violation.start)
        wrong[_theirs(groups, violation.tracks)] += share + LEAST
    for undecided in proof.undecided:
        wrong[_theirs(groups, undecided.tracks)] += LEAST
    return wrong


def _theirs(groups: Numbers, tracks: tuple[int, ...]) -> list[int]:
    """The groups of some tracks, each once; those behind the last are company."""
    return sorted({int(groups[k]) for k in tracks if k < len(groups)})
