"""The certificate: what is known about a transition."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.problems import Problem
from geotween.motion.divide import Division
from geotween.motion.sweep import Proof, Violation, sweep
from geotween.motion.tracks import Track

Objects = NDArray[np.object_]

# Pieces may miss or exceed their polygon by this share of its area: rounding, no more.
PARTITION_TOLERANCE = 1e-9


@dataclass(frozen=True, eq=False)
class LayerMotion:
    """The motion of one layer: its tracks, the division behind them, and the matching taken.

    ``near`` are the tracks where coordinates have digits to spare, which may be elsewhere than
    where they are drawn.
    """

    layer: str
    tracks: tuple[Track, ...]
    division: Division
    problems: tuple[Problem, ...]
    matching: str
    near: tuple[Track, ...]

    @cached_property
    def proof(self) -> Proof:
        """What is wrong with the tracks, at any t in [0, 1]."""
        return sweep(self.near)


@dataclass(frozen=True)
class Certificate:
    """What was proved about a transition, what was measured, and what was met on the way.

    ``valid`` is True where it was proved, for all t in [0, 1], that every polygon is simple and
    that no two of a layer overlap (``motion/sweep.py`` says up to which rounding), and that the
    pieces make up their polygons. ``matchings`` tells by layer which one was taken.
    """

    valid: bool
    problems: tuple[Problem, ...]
    measures: dict[str, float]
    matchings: dict[str, str]


def certify(layers: Sequence[LayerMotion], problems: tuple[Problem, ...]) -> Certificate:
    """Prove or disprove that polygons cross nowhere, and measure how exact the pieces are.

    ``partition error`` is the largest area, relative to its polygon, by which the pieces of one
    polygon miss or exceed it; ``pieces`` and ``mends`` are counts; ``crossing`` is the share of
    time in which some polygon crosses itself or another one.
    """
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
    measures = {
        "partition error": error,
        "pieces": float(sum(len(division.indices) for division in divisions)),
        "mends": float(sum(len(division.problems) for division in divisions)),
        "crossing": _time_of(v for layer in layers for v in layer.proof.violations),
    }
    met = [problem for layer in layers for problem in layer.problems]
    allowed = [_rounding(whole) for whole, _, _ in sides]
    exact = not any((d > a).any() for d, a in zip(differences, allowed, strict=True))
    if not exact:
        message = "pieces miss or exceed their polygon"
        hint = "look for slivers in the data"
        met.append(Problem("partition", "error", message, (), "", error, "of its area", hint))
    for layer in layers:
        met += _crossings(layer)
    return Certificate(
        exact and all(layer.proof.clean for layer in layers),
        (*problems, *met),
        measures,
        {layer.layer: layer.matching for layer in layers},
    )


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
        hint = "frames there are not to be trusted; try matching: trajectory, or rotation"
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
