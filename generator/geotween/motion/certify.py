"""The certificate: what is known about a transition."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from geotween.data.problems import Problem
from geotween.motion.divide import Division


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
    error = max(
        _partition_error(division.origin.polygons, division.origin_pieces, division.indices[:, 0]),
        _partition_error(division.target.polygons, division.target_pieces, division.indices[:, 1]),
    )
    measures = {
        "partition error": error,
        "pieces": float(len(division.indices)),
        "mends": float(len(division.problems)),
    }
    return Certificate(False, problems, measures)


def _partition_error(whole: np.ndarray, pieces: np.ndarray, owner: np.ndarray) -> float:
    """The worst relative difference between a polygon's area and that of its pieces."""
    if not len(whole):
        return 0.0
    areas = shapely.area(whole)
    cut = owner >= 0
    total = np.bincount(owner[cut], shapely.area(pieces[cut]), minlength=len(whole))
    return float((np.abs(total - areas) / areas).max())
