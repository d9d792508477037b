"""Better triangles from given ones: diagonals flipped, points moved, where quality improves."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from geotween.mesh.fill import twins

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Bools = NDArray[np.bool_]

ENOUGH = 0.85  # quality beyond this counts for no more: no good triangle pays for a better one
WORST = 0.05  # weight of the worst triangle beside the mean: a sliver must not cost good ones
GAIN = 1e-9  # less is rounding
FLIPS = 10  # rounds of flips that do not touch each other

# Between where a point is and where it could be, these shares of the way are tried.
WAYS = (1.0, 0.5, 0.25)


def signed_quality(a: Floats, b: Floats, c: Floats) -> Floats:
    """Twice inradius over circumradius of triangles with corners (n, 2); negative if clockwise."""
    one, two, three = b - a, c - b, a - c
    area = one[:, 0] * -three[:, 1] + one[:, 1] * three[:, 0]
    x, y, z = (np.hypot(side[:, 0], side[:, 1]) for side in (one, two, three))
    with np.errstate(invalid="ignore", divide="ignore"):
        value = 4 * (area / (x + y + z)) * (np.abs(area) / (x * y * z))
    return np.asarray(np.nan_to_num(value, nan=0.0))


def improved(
    points: Floats, triangles: Ints, free: Bools, owner: Ints, rounds: int
) -> tuple[Floats, Ints]:
    """Points (n, 2) and triangles (m, 3), flipped and smoothed by turns, and flipped once more.

    Only free points (n,) move; no triangle is flipped with one of another owner (m,).
    """
    for _ in range(rounds):
        triangles = flipped(points, triangles, owner)
        points = smoothed(points, triangles, free)
    return points, flipped(points, triangles, owner)


def flipped(points: Floats, triangles: Ints, owner: Ints) -> Ints:
    """Triangles, of which pairs have their diagonal flipped where that makes them better.

    Notes
    -----
    In a round those flips are made that gain more than any other with the same triangles. Cost:
    n log n, for each of at most ten rounds.
    """
    triangles = triangles.copy()
    changed = np.ones(len(triangles), dtype=bool)
    for _ in range(FLIPS):
        pairs, same = twins(triangles, owner)
        pairs = pairs[same]
        pairs = pairs[changed[pairs // 3].any(axis=1)]
        (one, other), (side, mate) = (pairs // 3).T, (pairs % 3).T
        a, b, c = (triangles[one, side - k] for k in (3, 2, 1))
        d = triangles[other, mate - 1]
        before = _worth(points, (a, b, c), (b, a, d))
        after = _worth(points, (a, d, c), (d, b, c))
        good = np.flatnonzero(after - before > GAIN)
        good = good[np.argsort((before - after)[good], kind="stable")]
        rank, first = np.arange(len(good)), np.full(len(triangles), len(good))
        np.minimum.at(first, np.concatenate([one[good], other[good]]), np.tile(rank, 2))
        good = good[(first[one[good]] == rank) & (first[other[good]] == rank)]
        if not len(good):
            break
        triangles[one[good]] = np.column_stack([a, d, c])[good]
        triangles[other[good]] = np.column_stack([d, b, c])[good]
        changed[:] = False
        changed[np.concatenate([one[good], other[good]])] = True
    return triangles


def smoothed(points: Floats, triangles: Ints, free: Bools, rounds: int = 2) -> Floats:
    """Points, of which free ones are moved where that improves the triangles about them.

    A point goes towards the mean of its neighbours (Laplacian smoothing), or towards the mean of
    the places that would make its triangles equilateral, poor ones weighing more. It goes only
    where the mean quality about it gets larger, and nothing turns over.

    Notes
    -----
    Points that share no triangle move at the same time, colour by colour. Cost: linear.
    """
    points = points.copy()
    groups = list(_groups(len(points), triangles, free))
    for _ in range(rounds):
        for fans in groups:
            _smooth(points, fans)
    return points


def _worth(points: Floats, one: tuple[Ints, Ints, Ints], other: tuple[Ints, Ints, Ints]) -> Floats:
    """How good pairs of triangles are (n,), given by their corners."""
    pair = [signed_quality(*(points[corner] for corner in of)) for of in (one, other)]
    worst, mean = np.minimum(*pair), np.minimum(pair, ENOUGH).mean(axis=0)
    return _together(worst, mean)


def _together(worst: Floats, mean: Floats) -> Floats:
    """The worth of some triangles; next to nothing where one is turned over."""
    return np.where(worst > 0, WORST * worst + mean, worst - 1)


def _smooth(points: Floats, fans: Ints) -> None:
    """Move the first corners of triangles (k, 3), sorted by them, where that is better."""
    centres, first, number = np.unique(fans[:, 0], return_index=True, return_inverse=True)
    one, other = points[fans[:, 1]], points[fans[:, 2]]
    count = np.bincount(number)[:, None]
    start = points[centres]

    def worth(places: Floats) -> Floats:
        quality = np.minimum(signed_quality(places[number], one, other), ENOUGH)
        worst = np.minimum.reduceat(quality, first)
        mean = np.add.reduceat(quality, first) / count[:, 0]
        return _together(worst, mean)

    side = other - one
    ideal = (one + other) / 2 + np.column_stack([-side[:, 1], side[:, 0]]) * (3**0.5 / 2)
    # Good triangles weigh a little, too: a point all of whose triangles are good stays.
    weight = 1.02 - np.clip(signed_quality(start[number], one, other), 0, 1)[:, None]
    goals = (
        np.add.reduceat(one, first) / count,
        np.add.reduceat(ideal * weight, first) / np.add.reduceat(weight, first),
    )
    best, place = worth(start), start.copy()
    for goal in goals:
        for way in WAYS:
            _try(start + way * (goal - start), place, best, worth)
    points[centres] = place


def _try(places: Floats, place: Floats, best: Floats, worth: Callable[[Floats], Floats]) -> None:
    value = worth(places)
    better = value > best + GAIN
    place[better], best[better] = places[better], value[better]


def _groups(count: int, triangles: Ints, free: Bools) -> Iterator[Ints]:
    """The triangles about free points, by colours of these; each begins with its free point."""
    colour = _colours(count, triangles, free)
    turned = np.concatenate([np.roll(triangles, -k, axis=1) for k in range(3)])
    turned = turned[np.argsort(turned[:, 0], kind="stable")]
    for value in range(colour.max(initial=-1) + 1):
        yield turned[colour[turned[:, 0]] == value]


def _colours(count: int, triangles: Ints, free: Bools) -> Ints:
    """A number for each free point, other than its neighbours'; -1 for the rest. Greedy."""
    ends = np.concatenate([triangles[:, [i, j]] for i in range(3) for j in range(3) if i != j])
    ends = ends[free[ends].all(axis=1)]
    ends = ends[np.argsort(ends[:, 0], kind="stable")]
    starts = np.searchsorted(ends[:, 0], np.arange(count + 1)).tolist()
    neighbours = ends[:, 1].tolist()
    # Sets of colours as bits: one point at a time, plain integers are faster than arrays.
    bits = [0] * count
    for point in np.flatnonzero(free).tolist():
        taken = 0
        for other in neighbours[starts[point] : starts[point + 1]]:
            taken |= bits[other]
        bits[point] = ~taken & (taken + 1)
    return np.array([bit.bit_length() - 1 for bit in bits], dtype=np.intp)
