"""The certificate: what is known about a transition."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.problems import Problem
from geotween.motion.divide import Division

Objects = NDArray[np.object_]

# Pieces may miss or exceed their polygon by this share of its area: rounding, no more.
PARTITION_TOLERANCE = 1e-9


@dataclass(frozen=True)
class Certificate:
    """What was proved about a transition, what was measured, and what was met on the way.

    ``valid`` is True only where the promise was proved over continuous time. This version proves
    nothing yet, so it is False throughout: it means not proved, not wrong.
    """

    valid: bool
    problems: tuple[Problem, ...]
    measures: dict[str, float]


def certify(divisions: Sequence[Division], problems: tuple[Problem, ...]) -> Certificate:
    """Measure how exactly the pieces of each layer's division make up their polygons.

    ``partition error`` is the largest area, relative to its polygon, by which the pieces of one
    polygon miss or exceed it; ``pieces`` and ``mends`` are counts.
    """
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
    }
    allowed = [_rounding(whole) for whole, _, _ in sides]
    if any((d > a).any() for d, a in zip(differences, allowed, strict=True)):
        message = "pieces miss or exceed their polygon"
        hint = "look for slivers in the data"
        found = Problem("partition", "error", message, (), "", error, "of its area", hint)
        problems = (*problems, found)
    return Certificate(False, problems, measures)


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
