"""The certificate: what is known about a transition."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.polygons import RELATIVE_TOLERANCE
from geotween.data.problems import Problem
from geotween.motion.areas import area_over_time
from geotween.motion.common import moved_shares
from geotween.motion.correspond import Correspondence
from geotween.motion.covered import bared
from geotween.motion.divide import Division
from geotween.motion.sweep import Proof, Violation, sweep
from geotween.motion.techniques import FRONT
from geotween.motion.tracks import Track

Objects = NDArray[np.object_]

# Pieces may miss or exceed their polygon by this share of its area: rounding, no more.
PARTITION_TOLERANCE = 1e-9


@dataclass(frozen=True, eq=False)
class LayerMotion:
    """The motion of one layer: its tracks, in what way each was made, and what is behind them.

    ``division`` is of what travels, ``swept`` what corresponds in the rest, which a front moves.
    ``ways`` are parallel to ``tracks``: names of matchings, or ``front``. ``near`` are the tracks
    where coordinates have digits to spare, which may be elsewhere than where they are drawn;
    ``known`` is what planning had to prove already.
    """

    layer: str
    tracks: tuple[Track, ...]
    ways: tuple[str, ...]
    division: Division
    swept: Correspondence
    problems: tuple[Problem, ...]
    near: tuple[Track, ...]
    known: Proof | None = None

    @cached_property
    def proof(self) -> Proof:
        """What is wrong with the tracks, at any t in [0, 1]."""
        return self.known or sweep(self.near)


@dataclass(frozen=True)
class Certificate:
    """What was proved about a transition, what was measured, and what was met on the way.

    ``valid`` is True where it was proved, for all t in [0, 1], that every polygon is simple and
    that no two of a layer overlap (``motion/sweep.py`` says up to which rounding), that the pieces
    make up their polygons, and that common boundary rests. ``ways`` tells by layer in which ways
    its pieces were moved, and how many in each.
    """

    valid: bool
    problems: tuple[Problem, ...]
    measures: dict[str, float]
    ways: dict[str, dict[str, int]]


def certify(layers: Sequence[LayerMotion], problems: tuple[Problem, ...]) -> Certificate:
    """Prove or disprove that polygons cross nowhere, and measure how exact the pieces are.

    ``partition error`` is the largest area, relative to its polygon, by which the pieces of one
    polygon miss or exceed it; ``pieces`` and ``mends`` are counts; ``crossing`` is the share of
    time in which some polygon crosses itself or another one; ``common boundary moved`` the
    share of it that does not rest; ``bared`` the share of what a feature covers at both ends that
    is bare on the way, where 0 is proved and more is measured at a few moments. ``area off linear``
    and ``area overshoot`` are the most by which a layer's area leaves its straight way, and goes
    beyond both its ends, as shares of the larger end: computed from the motion itself, for all t.
    """
    partition, exact, met = _partition(layers)
    moved = [_boundary_moved(layer) for layer in layers]
    off, overshoot = zip(*(_area(layer) for layer in layers), strict=True)
    measures = {
        "partition error": partition,
        "pieces": float(sum(len(layer.division.indices) for layer in layers)),
        "mends": float(sum(len(layer.division.problems) for layer in layers)),
        "crossing": _time_of(v for layer in layers for v in layer.proof.violations),
        "common boundary moved": max(moved),
        "bared": max(_bared(layer) for layer in layers),
        "area off linear": max(off),
        "area overshoot": max(overshoot),
    }
    met = [*(problem for layer in layers for problem in layer.problems), *met]
    for layer in layers:
        met += _crossings(layer)
    if max(moved) > 0:
        message = "boundary that both ends have in common moves on the way"
        hint = "matching: trajectory pins it, and method: front never moves it"
        share = max(moved)
        met.append(Problem("moved", "warning", message, (), "", share, "of its places", hint))
    return Certificate(
        exact and not any(moved) and all(layer.proof.clean for layer in layers),
        (*problems, *met),
        measures,
        {layer.layer: _counted(layer) for layer in layers},
    )


def _partition(layers: Sequence[LayerMotion]) -> tuple[float, bool, list[Problem]]:
    """The partition error, whether it is no more than rounding, and a problem where it is more."""
    divisions = [layer.division for layer in layers]
    sides = [
        side
        for division in divisions
        for side in (
            (division.origin.polygons, division.origin_pieces, division.indices[:, 0]),
            (division.target.polygons, division.target_pieces, division.indices[:, 1]),
        )
    ]
    differences = [_differences(*side) for side in sides]
    error = max(float(found.max(initial=0)) for found in differences)
    allowed = [_rounding(whole) for whole, _, _ in sides]
    if not any((d > a).any() for d, a in zip(differences, allowed, strict=True)):
        return error, True, []
    message, hint = "pieces miss or exceed their polygon", "look for slivers in the data"
    return (
        error,
        False,
        [Problem("partition", "error", message, (), "", error, "of its area", hint)],
    )


def _counted(layer: LayerMotion) -> dict[str, int]:
    """How many pieces were moved in which way; a front counts the things that it moves."""
    pieces = enumerate(zip(layer.ways, layer.tracks, strict=True))
    found = {(way, track.ends if way == FRONT else k) for k, (way, track) in pieces}
    return dict(Counter(way for way, _ in sorted(found, key=str)))


def _boundary_moved(layer: LayerMotion) -> float:
    """The largest share of a track's common boundary that moves; none of a front's does."""
    tracks = [t for t, way in zip(layer.near, layer.ways, strict=True) if way != FRONT]
    if not tracks:
        return 0.0
    every = np.concatenate([track.vertices.reshape(-1, 2) for track in tracks])
    reach = float(np.ptp(every, axis=0).max(initial=0)) if len(every) else 0.0
    return float(moved_shares(tracks, RELATIVE_TOLERANCE * reach).max(initial=0))


def _bared(layer: LayerMotion) -> float:
    """The most that travelling pieces lay bare; a front keeps covered what is common."""
    tracks = [t for t, way in zip(layer.tracks, layer.ways, strict=True) if way != FRONT]
    if not tracks:
        return 0.0
    ends = [end.in_layer(layer.layer) for end in (layer.division.origin, layer.division.target)]
    reach = float(np.ptp(np.concatenate([t.vertices[0] for t in tracks]), axis=0).max(initial=0))
    return bared(tracks, ends[0], ends[1], RELATIVE_TOLERANCE * reach)


def _area(layer: LayerMotion) -> tuple[float, float]:
    """How far a layer's area gets from its straight way, and beyond its ends; as shares."""
    area = area_over_time(layer.near)
    low, high = sorted(area.ends)
    if not high:
        return 0.0, 0.0
    least, most = area.extremes()
    off = max(map(abs, area.extremes(linear=True)))
    return off / high, max(0.0, low - least, most - high) / high


def _crossings(layer: LayerMotion) -> list[Problem]:
    """A problem for each kind of crossing in a layer, that names the worst."""
    found = []
    for kind, one, many in (
        ("overlap", "overlap", "pairs of polygons overlap"),
        ("self-crossing", "crosses itself", "polygons cross themselves"),
        ("self-touch", "touches itself", "polygons touch themselves"),
    ):
        those = [v for v in layer.proof.violations if v.kind == kind]
        if not those:
            continue
        worst = max(those, key=lambda v: v.area * (v.end - v.start))
        names = " and ".join(dict.fromkeys(layer.tracks[i].identity.called for i in worst.tracks))
        pairs = len({v.tracks for v in those})
        span = f"from {worst.start:.0%} to {worst.end:.0%} of the way"
        message = f"{names} {one} {span}"
        if pairs > 1:
            message = f"{pairs} {many}, most of all {names} {span}"
        covered = shapely.area(layer.division.origin.polygons).sum()
        covered = max(covered, shapely.area(layer.division.target.polygons).sum())
        share = worst.area / covered if covered else 0.0
        hint = "name no matching, or take method: front; motion: {key: …} does so for some only"
        found.append(Problem(kind, "warning", message, (), "", share, "of all area", hint))
    found += [
        Problem("undecided", "warning", f"not proved: {one.reason}")
        for one in layer.proof.undecided
    ]
    return found


def _time_of(violations: Iterable[Violation]) -> float:
    """The share of time that some intervals cover together."""
    covered, until = 0.0, 0.0
    for start, end in sorted((v.start, v.end) for v in violations):
        covered += max(0.0, end - max(start, until))
        until = max(until, end)
    return covered


def _rounding(whole: Objects) -> NDArray[np.float64]:
    """For each polygon the relative difference that the rounding of coordinates explains."""
    if not len(whole):
        return np.empty(0)
    ulp = np.spacing(np.abs(shapely.total_bounds(whole)).max())
    return np.asarray(PARTITION_TOLERANCE + 4 * ulp * shapely.length(whole) / shapely.area(whole))


def _differences(whole: Objects, pieces: Objects, owner: NDArray[np.intp]) -> NDArray[np.float64]:
    """For each polygon the area by which its pieces miss or exceed it, relative to its own."""
    areas = shapely.area(whole)
    cut = owner >= 0
    total = np.bincount(owner[cut], shapely.area(pieces[cut]), minlength=len(whole))
    return np.asarray(np.abs(total - areas) / areas)
