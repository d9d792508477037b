"""The clock: arrival times at which the area swept grows evenly."""

from __future__ import annotations

from math import comb

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# Area is added up at so many equal steps of time, and so often: each round the times of corners
# are put right, and between corners they stay linear.
KNOTS, PASSES = 512, 6

# Corners nearer in time are taken to be so far apart: what is nearly flat flips in no less time.
APART = 1e-4


def even(times: Floats, areas: Floats, clocks: Ints) -> Floats:
    """Times (T, 3) of triangles' corners, put right so that each clock sweeps its area evenly.

    Parameters
    ----------
    times
        Between 0 and 1, linear on each triangle; NaN at a corner that all levels run through.
    areas
        (T,) of the triangles.
    clocks
        (T,) the number of the clock that each goes by.

    Notes
    -----
    A corner's time becomes the share of its clock's area that was swept until then. What is equal
    stays equal and the order stays. O(T) for T triangles.
    """
    if not len(times):
        return times
    for _ in range(PASSES):
        swept = swept_area(times, areas, clocks, KNOTS)
        total = swept[:, -1:]
        share = np.divide(swept, total, out=np.zeros_like(swept), where=total > 0).clip(0.0, 1.0)
        share[:, 0], share[:, -1] = 0.0, 1.0
        times = _read(share, times, clocks)
    return times


def swept_area(times: Floats, areas: Floats, clocks: Ints, knots: int) -> Floats:
    """The area (clocks, knots) whose time has come at equally spaced times from 0 to 1.

    Below a level s lies, of a triangle with corners at a, b, c, its area times the divided
    difference of max(s - x, 0)^2 over a, b, c: a sum of squares that begin at the corners. Of one
    with a pivot it is linear from a to b.
    """
    ordered = np.sort(times, axis=1)  # NaN last
    pivot = np.isnan(ordered[:, 2])
    a, b, c = ordered[~pivot].T
    a, c = np.minimum(a, b - APART), np.maximum(c, b + APART)
    squares = np.stack([1 / (b - a) / (c - a), -1 / (b - a) / (c - b), 1 / (c - a) / (c - b)])
    swept = _powers(np.stack([a, b, c]), squares * areas[~pivot], clocks[~pivot], knots, 2, clocks)
    a, b = ordered[pivot, 0], np.maximum(ordered[pivot, 1], ordered[pivot, 0] + APART)
    lines = np.stack([1 / (b - a), -1 / (b - a)]) * areas[pivot]
    return swept + _powers(np.stack([a, b]), lines, clocks[pivot], knots, 1, clocks)


def _powers(
    begin: Floats, factor: Floats, clocks: Ints, knots: int, power: int, every: Ints
) -> Floats:
    """Sums (clocks, knots) of factor * max(knot - begin, 0)^power, both (c, T)."""
    level = np.linspace(0.0, 1.0, knots)
    number = int(every.max()) + 1
    first = np.clip(np.ceil(begin * (knots - 1)), 0, knots).astype(np.intp)
    place = (clocks * (knots + 1) + first).ravel()
    found = np.zeros((number, knots))
    for k in range(power + 1):
        term = np.bincount(place, (factor * (-begin) ** k).ravel(), number * (knots + 1))
        sums = term.reshape(number, -1)[:, :knots].cumsum(axis=1)
        found += comb(power, k) * sums * level ** (power - k)
    return found


def _read(share: Floats, times: Floats, clocks: Ints) -> Floats:
    """What clocks (clocks, knots) show at times (T, 3)."""
    last = share.shape[1] - 1
    at = np.nan_to_num(times) * last
    knot = np.minimum(at.astype(np.intp), last - 1)
    before, after = share[clocks[:, None], knot], share[clocks[:, None], knot + 1]
    return np.where(np.isnan(times), np.nan, before + (at - knot) * (after - before))
