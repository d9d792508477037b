"""Holes of a piece and its partner: which go together, and where the others close and open.

Holes that overlap go together, then those near to each other between which nothing lies. Any
other closes to a point within the partner, or opens from one within the piece.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Point, Polygon

from geotween.motion.innermost import innermost

Place = NDArray[np.float64]  # (2,)
Objects = NDArray[np.object_]

# Holes farther apart than this do not go together; in sums of their widths. Discs that touch are
# half a sum apart.
REACH = 1.0

# A hole closes this far within the partner, in its own depths, so that the rim keeps off; in a
# narrow partner, as far as this share of that one's depth.
WITHIN, NARROW = 0.1, 0.5


@dataclass(frozen=True, eq=False)
class HolePlan:
    """What becomes of the holes of a piece and its partner; they are numbered on each side.

    ``pairs`` go together. ``closing`` says for the other holes of the piece to which point within
    the partner they close, ``opening`` for those of the partner from which one within the piece.
    """

    pairs: tuple[tuple[int, int], ...]
    closing: Mapping[int, Place]
    opening: Mapping[int, Place]


def plan_holes(piece: Polygon, partner: Polygon) -> HolePlan:
    """What becomes of the holes of a piece and its partner.

    A piece that does not overlap with its partner takes its holes along; in others holes are
    compared where they lie. Cost: the holes of one times those of the other, and an innermost
    point for each that overlaps with none.
    """
    way = _way(piece, partner)
    laid = shapely.transform(partner, lambda places: places - way)
    holes, others = _holes(piece), _holes(laid)
    overlapping = tuple(_by_overlap(holes, others))
    here = np.setdiff1d(np.arange(len(holes)), [i for i, _ in overlapping])
    there = np.setdiff1d(np.arange(len(others)), [j for _, j in overlapping])
    if not len(here) + len(there):
        return HolePlan(overlapping, {}, {})
    points = innermost(np.concatenate([holes[here], others[there]]))
    closing = dict(zip(here.tolist(), points[: len(here)], strict=True))
    opening = dict(zip(there.tolist(), points[len(here) :], strict=True))
    near = tuple(_by_distance(piece, laid, closing, opening))
    for i, j in near:
        del closing[i], opening[j]
    return HolePlan(
        overlapping + near,
        {i: _within(laid, holes.item(i), point) + way for i, point in closing.items()},
        {j: _within(piece, others.item(j), point) for j, point in opening.items()},
    )


def _way(piece: Polygon, partner: Polygon) -> Place:
    """How far a piece travels as a whole; not at all where it overlaps with its partner."""
    one, other = Polygon(piece.exterior), Polygon(partner.exterior)
    if one.intersection(other).area:
        return np.zeros(2)
    here, there = shapely.get_coordinates([one.centroid, other.centroid])
    return np.asarray(there - here)


def _holes(polygon: Polygon) -> Objects:
    found = np.empty(len(polygon.interiors), dtype=object)
    found[:] = [Polygon(ring) for ring in polygon.interiors]
    return found


def _by_overlap(holes: Objects, others: Objects) -> Iterator[tuple[int, int]]:
    """Pairs of holes that overlap, each once; those that do most go first."""
    overlap = shapely.area(shapely.intersection(holes[:, None], others[None, :]))
    taken: tuple[set[int], set[int]] = set(), set()
    for best in np.argsort(-overlap, axis=None, kind="stable")[: np.count_nonzero(overlap)]:
        i, j = (int(k) for k in np.unravel_index(best, overlap.shape))
        if i not in taken[0] and j not in taken[1]:
            taken[0].add(i)
            taken[1].add(j)
            yield i, j


def _by_distance(
    piece: Polygon, partner: Polygon, here: Mapping[int, Place], there: Mapping[int, Place]
) -> Iterator[tuple[int, int]]:
    """Pairs among the holes left, as many as may be, of the least sum of squared ways."""
    if not here or not there:
        return
    numbers, partners = list(here), list(there)
    ways = np.array([[np.hypot(*(there[j] - here[i])) for j in partners] for i in numbers])
    widths = _widths(_holes(piece)[numbers])[:, None] + _widths(_holes(partner)[partners])
    allowed = ways <= REACH * widths
    for a, b in np.argwhere(allowed).tolist():
        allowed[a, b] = _is_free(piece, partner, numbers[a], partners[b])
    if not allowed.any():
        return
    from scipy.optimize import linear_sum_assignment

    cost = np.where(allowed, (ways / ways[allowed].max()) ** 2, 1 + ways.size)
    for a, b in zip(*(found.tolist() for found in linear_sum_assignment(cost)), strict=True):
        if allowed[a, b]:
            yield numbers[a], partners[b]


def _widths(holes: Objects) -> NDArray[np.float64]:
    """The diameters of discs of the same area."""
    return np.asarray(2 * np.sqrt(shapely.area(holes) / np.pi))


def _is_free(piece: Polygon, partner: Polygon, i: int, j: int) -> bool:
    """Whether hole i that becomes hole j meets neither rim nor other holes, of either end."""
    both = shapely.convex_hull(shapely.union(_holes(piece)[i], _holes(partner)[j]))
    ends = ((piece, i), (partner, j))
    return all(
        Polygon(end.exterior, [*end.interiors[:k], *end.interiors[k + 1 :]]).covers(both)
        for end, k in ends
    )


def _within(polygon: Polygon, hole: Polygon, point: Place) -> Place:
    """The point, or the one nearest to it that lies well within a polygon."""
    at = Point(point)
    margin = WITHIN * hole.boundary.distance(at)
    if polygon.contains(at) and polygon.boundary.distance(at) >= margin:
        return point
    deepest = shapely.maximum_inscribed_circle(polygon).length
    inside = polygon.buffer(-min(margin, NARROW * deepest))
    return np.asarray(shapely.get_coordinates(shapely.shortest_line(inside, at))[0])
