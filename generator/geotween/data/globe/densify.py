"""Polygons under a map of the plane, with points added where straight edges bend."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.globe.longitudes import TURN, on_grid

Points = NDArray[np.float64]

# How far an edge may run from where it should, as a share of the map's extent: a twentieth of a
# pixel on a map of a thousand.
BEND = 1 / 20_000

# Edges longer than this share of the extent are looked at in their quarters too: an edge bent like
# an S passes through the middle of its chord.
LONG = 1 / 50

# An edge is halved at most this many times: 4,096 pieces of a line around the globe are finer than
# the page, and one that runs off to infinity must end somewhere.
HALVINGS = 12


def placed(
    polygons: NDArray[np.object_],
    place: Callable[[Points], Points],
    *,
    from_globe: bool,
    to_globe: bool = False,
) -> NDArray[np.object_]:
    """Polygons (m,) under a map of points (k, 2) to points, with points added where edges bend.

    An edge is halved while the image of its middle lies off the chord of its images by more than
    the share `BEND` of the extent. Both sides of a shared edge get the same points, bit for bit.
    ``from_globe`` and ``to_globe`` say that x is a longitude before, or after. Cost: one image per
    point and edge, all edges of a round at once.
    """
    if not len(polygons):
        return polygons
    _, points, (rings, members) = shapely.to_ragged_array(polygons)
    if from_globe:
        points[:, 0] = on_grid(points[:, 0])
    images = place(points)
    tolerance = BEND * _extent(images, to_globe)
    starts = np.ones(len(points), dtype=bool)
    starts[rings[1:] - 1] = False
    first = np.flatnonzero(starts)
    # A new point is filed between its neighbours by a number halfway between theirs.
    numbers = [np.arange(len(points), dtype=float)]
    found = [images]
    here = np.column_stack([numbers[0], points, images])
    before, after = here[first], here[first + 1]
    for halving in range(HALVINGS):
        middle = _between(before, after, place, from_globe)
        with np.errstate(invalid="ignore"):  # what is not finite is not bent
            bent = _off(before, after, middle, to_globe) > tolerance
            if not halving:
                length = np.hypot(*(after - before)[:, 3:].T)
                long = np.flatnonzero(~bent & (length > tolerance / BEND * LONG))
                for end in (before[long], after[long]):
                    quarter = _between(end, middle[long], place, from_globe)
                    bent[long] |= _off(before[long], after[long], quarter, to_globe) > tolerance
        if not bent.any():
            break
        before, middle, after = before[bent], middle[bent], after[bent]
        numbers.append(middle[:, 0])
        found.append(middle[:, 3:])
        before, after = np.concatenate([before, middle]), np.concatenate([middle, after])
    if len(numbers) > 1:
        number = np.concatenate(numbers)
        order = np.argsort(number)
        images = np.concatenate(found)[order]
        rings = np.searchsorted(number[order], rings).astype(rings.dtype)
    new = shapely.from_ragged_array(shapely.GeometryType.POLYGON, images, (rings, members))
    return np.asarray(new, dtype=object)


def _between(
    before: Points, after: Points, place: Callable[[Points], Points], from_globe: bool
) -> Points:
    """Number, point and image (k, 5) of the middles of edges, the same for both directions."""
    middle = (before + after) / 2
    if from_globe:
        middle[:, 1] = on_grid(middle[:, 1])
    middle[:, 3:] = place(middle[:, 1:3])
    return middle


def _off(before: Points, after: Points, middle: Points, to_globe: bool) -> Points:
    """How far images of points lie off the chords (k,), the same for both directions."""
    u, v = before[:, 3:] - middle[:, 3:], after[:, 3:] - middle[:, 3:]
    if to_globe:
        for way in (u, v):
            way[:, 0] -= TURN * np.rint(way[:, 0] / TURN)
            way[:, 0] *= np.cos(np.radians(middle[:, 4]))
    chord, off = v - u, (u + v) / 2
    length = np.hypot(*chord.T)
    safe = np.where(length > 0, length, 1)
    across = np.abs(chord[:, 0] * off[:, 1] - chord[:, 1] * off[:, 0]) / safe
    beyond = np.abs((chord * off).sum(axis=1)) / safe - length / 2
    return np.asarray(np.where(length > 0, np.maximum(across, beyond), np.hypot(*off.T)))


def _extent(images: Points, to_globe: bool) -> float:
    """The larger side of the bounds of the finite points; across the antimeridian on a globe."""
    finite = images[np.isfinite(images).all(axis=1)]
    if not len(finite):
        return np.inf
    width, height = np.ptp(finite, axis=0)
    if to_globe:
        width = min(width, np.ptp(finite[:, 0] % TURN))
    return float(max(width, height))
