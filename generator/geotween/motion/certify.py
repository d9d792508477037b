"""The certificate: what is known about a transition."""

from __future__ import annotations

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


def certify(division: Division, problems: tuple[Problem, ...]) -> Certificate:
    """Measure how exactly the pieces make up their polygons.

    ``partition error`` is the largest area, relative to its polygon, by which the pieces of one
    polygon miss or exceed it; ``pieces`` and ``mends`` are counts.
    """
    sides = (
        (division.origin.polygons, division.origin_pieces, division.indices[:, 0]),
        (division.target.polygons, division.target_pieces, division.indices[:, 1]),
    )
    error = max(_partition_error(*side) for side in sides)
    measures = {
        "partition error": error,
        "pieces": float(len(division.indices)),
        "mends": float(len(division.problems)),
    }
    if any(_inexact(*side) for side in sides):
        message = "pieces miss or exceed their polygon"
        hint = "look for slivers in the data"
        found = Problem("partition", "error", message, (), "", error, "of its area", hint)
        problems = (*problems, found)
    return Certificate(False, problems, measures)


def _partition_error(whole: Objects, pieces: Objects, owner: NDArray[np.intp]) -> float:
    """The worst relative difference between a polygon's area and that of its pieces."""
    return float(_differences(whole, pieces, owner).max(initial=0))


def _inexact(whole: Objects, pieces: Objects, owner: NDArray[np.intp]) -> bool:
    """Whether a polygon and its pieces differ by more than the rounding of coordinates explains."""
    if not len(whole):
        return False
    ulp = np.spacing(np.abs(shapely.total_bounds(whole)).max())
    allowed = PARTITION_TOLERANCE + 4 * ulp * shapely.length(whole) / shapely.area(whole)
    return bool((_differences(whole, pieces, owner) > allowed).any())


def _differences(whole: Objects, pieces: Objects, owner: NDArray[np.intp]) -> NDArray[np.float64]:
    """For each polygon the area by which its pieces miss or exceed it, relative to its own."""
    areas = shapely.area(whole)
    cut = owner >= 0
    total = np.bincount(owner[cut], shapely.area(pieces[cut]), minlength=len(whole))
    return np.asarray(np.abs(total - areas) / areas)
