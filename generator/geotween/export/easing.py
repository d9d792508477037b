"""Easings as cubic Béziers, and their parts between key times."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Spline = tuple[float, float, float, float]

# The curves of CSS: x1, y1, x2, y2 of a cubic Bézier from (0, 0) to (1, 1).
EASINGS: dict[str, Spline | None] = {
    "linear": None,
    "ease": (0.25, 0.1, 0.25, 1.0),
    "ease-in": (0.42, 0.0, 1.0, 1.0),
    "ease-out": (0.0, 0.0, 0.58, 1.0),
    "ease-in-out": (0.42, 0.0, 0.58, 1.0),
}


def ease(spline: Spline | None, share: float) -> float:
    """t, after easing, at a share of the transition's duration."""
    if spline is None or share <= 0 or share >= 1:
        return min(max(share, 0.0), 1.0)
    points = _points(spline)
    return float(_at(points, _solve(points[:, 0], share))[1])


def share_at(spline: Spline | None, t: float) -> float:
    """The share of the transition's duration at which t, after easing, is reached."""
    if spline is None or t <= 0 or t >= 1:
        return min(max(t, 0.0), 1.0)
    points = _points(spline)
    return float(_at(points, _solve(points[:, 1], t))[0])


def segments(
    spline: Spline | None, times: Sequence[float]
) -> list[tuple[float, float, Spline | None]]:
    """The way between each two consecutive key times.

    Start and end are shares of the duration; the third value is the part of the easing between
    them, as a spline of its own.
    """
    if spline is None:
        return [(a, b, None) for a, b in pairwise(times)]
    points = _points(spline)
    cuts = [_solve(points[:, 1], t) for t in times]
    found: list[tuple[float, float, Spline | None]] = []
    for start, end in pairwise(cuts):
        part = _part(points, start, end)
        size = part[3] - part[0]
        inner = (part[1:3] - part[0]) / size
        x1, y1, x2, y2 = (round(float(v), 6) for v in inner.ravel())
        found.append((float(part[0, 0]), float(part[3, 0]), (x1, y1, x2, y2)))
    return found


def _points(spline: Spline) -> NDArray[np.float64]:
    x1, y1, x2, y2 = spline
    return np.array([[0, 0], [x1, y1], [x2, y2], [1, 1]], dtype=np.float64)


def _at(points: NDArray[np.float64], s: float) -> NDArray[np.float64]:
    r = 1 - s
    weights = np.array([r * r * r, 3 * r * r * s, 3 * r * s * s, s * s * s])
    return np.asarray(weights @ points)


def _solve(ordinates: NDArray[np.float64], value: float) -> float:
    """The parameter at which a rising coordinate of the curve has a value; by bisection."""
    low, high = 0.0, 1.0
    if value <= 0 or value >= 1:
        return min(max(value, 0.0), 1.0)
    for _ in range(60):
        middle = (low + high) / 2
        if _at(ordinates[:, None], middle)[0] < value:
            low = middle
        else:
            high = middle
    return (low + high) / 2


def _part(points: NDArray[np.float64], start: float, end: float) -> NDArray[np.float64]:
    """The control points of the curve between two parameters (blossoming)."""

    def blossom(*parameters: float) -> NDArray[np.float64]:
        level = points
        for s in parameters:
            level = level[:-1] * (1 - s) + level[1:] * s
        return np.asarray(level[0])

    return np.array(
        [
            blossom(start, start, start),
            blossom(start, start, end),
            blossom(start, end, end),
            blossom(end, end, end),
        ]
    )
