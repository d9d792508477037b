"""Arcs: which vertex goes to which between two open curves whose ends match.

Both are sampled finely and aligned. The vertices of each then go where the alignment sends them,
and in proportion between its best pairs, so that no edge shrinks to a point.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geotween.motion.alignment import Curve, Points, Work, align
from geotween.motion.rings import Vertices

Places = NDArray[np.float64]  # along a curve or a ring: k + s for s of the way along edge k
Indices = NDArray[np.intp]

# Samples along an arc: at least so many for each vertex, but not more than enough for a small one,
# and at least so many for each vertex of a long one, beside the vertices themselves.
FINE, ENOUGH, COARSE = 8, 128, 0.5

# The square of the difference of two turning angles, beside that of a displacement relative to the
# arcs' size, in the choice of the pairs that must be kept of those that an alignment offers.
CORNER = 0.05

# Vertices nearer to each other than this, in samples, are matched with each other; edges count as
# at least a share of the mean edge, so that two vertices of one curve never come as near.
SAME, LEAST = 1e-9, 1e-4

# Places closer than this are one but for rounding.
TIE = 1e-9

# Keeps what has no length from dividing by 0.
TINY = 1e-300


def matched(a: Points, b: Points, work: Work) -> tuple[Places, Places]:
    """The places of matched vertices along two open curves, both rising from end to end.

    All points of both curves are among them.
    """
    count = max(min(ENOUGH, FINE * max(len(a), len(b))), COARSE * max(len(a), len(b)))
    here, there = _samples(a, count), _samples(b, count)
    first, second = Curve.through(points_along(a, here)), Curve.through(points_along(b, there))
    size = size_of(first.points, second.points)
    i, j = align(first.points, second.points, work, size).T
    misfit = np.abs(first.points[i] - second.points[j]) ** 2 / size**2
    misfit += CORNER * (first.turns[i] - second.turns[j]) ** 2
    kept = _kept(i, j, misfit)
    return _placed(here, there, first, second, i[kept], j[kept])


def complex_points(vertices: Vertices) -> Points:
    """Vertices (n, 2) as points x + iy."""
    return np.ascontiguousarray(vertices, dtype=np.float64).view(np.complex128)[:, 0]


def points_along(ring: Points, places: Places) -> Points:
    """The points at places along a ring, or along an open curve; places may go round again."""
    edge = places.astype(np.intp)
    share = places - edge
    edge %= len(ring)
    way = ring[(edge + 1) % len(ring)] - ring[edge]
    return np.asarray(ring[edge] + share * way)


def stretch(ring: Points, start: float, end: float) -> tuple[Places, Points]:
    """The places of a stretch's ends and of the vertices in between, and the points there.

    The end is not the smaller number; where the stretch passes the ring's first vertex, it is
    beyond the count.
    """
    places = np.concatenate([[start], np.arange(np.floor(start) + 1, np.ceil(end)), [end]])
    return places, points_along(ring, places)


def outer_places(arc: Places, inner: Places) -> Places:
    """Places along an arc as places along its ring."""
    edge = np.minimum(inner.astype(np.intp), len(arc) - 2)
    share = inner - edge
    between = arc[edge] + share * (arc[edge + 1] - arc[edge])
    return np.asarray(np.where(share == 1, arc[edge + 1], between))


def size_of(a: Points, b: Points) -> float:
    """The size of two curves: how far their points are from their mean, in root mean square."""
    return float(np.sqrt(max(np.concatenate([a, b]).var(), TINY)))


def _samples(curve: Points, count: float) -> Places:
    """Places along an open curve: its points, and more where they are too far apart."""
    lengths = np.abs(np.diff(curve))
    wanted = np.ceil(lengths / max(lengths.sum(), TINY) * count - SAME)
    parts = np.maximum(wanted, 1).astype(np.intp)
    edge = np.repeat(np.arange(len(lengths)), parts)
    inside = np.arange(len(edge)) - (np.cumsum(parts) - parts)[edge]
    return np.append(edge + inside / parts[edge], len(lengths))


def _kept(i: Indices, j: Indices, misfit: Places) -> Indices:
    """Of each run of pairs that share a point, the one that fits best; so that no two share one."""
    onward = (np.diff(i, prepend=-1) > 0) & (np.diff(j, prepend=-1) > 0)
    run = np.cumsum(onward) - 1
    order = np.lexsort((misfit, run))
    kept = order[np.diff(run[order], prepend=-1) > 0]
    ends = np.array([0, len(i) - 1])
    return np.union1d(kept[(kept != 0) & (run[kept] > 0) & (run[kept] < run[-1])], ends)


def _placed(
    here: Places, there: Places, one: Curve, other: Curve, i: Indices, j: Indices
) -> tuple[Places, Places]:
    """Places of all vertices of both curves, in proportion between the pairs (i, j) kept."""
    sides = []
    for places, curve, pairs in ((here, one, i), (there, other, j)):
        lengths = np.maximum(curve.lengths, max(LEAST * curve.lengths.mean(), TINY))
        along = np.cumsum(lengths) - lengths[0]
        vertices = np.flatnonzero(places % 1 == 0)
        rank = np.interp(along[vertices], along[pairs], np.arange(len(pairs)))
        sides.append((places, along, vertices, along[pairs], rank))
    ranks = np.sort(np.concatenate([side[4] for side in sides]))
    ranks = ranks[np.diff(ranks, prepend=-1) > SAME]
    sought = []
    for places, along, vertices, pairs, rank in sides:
        found = np.interp(np.interp(ranks, np.arange(len(pairs)), pairs), along, places)
        own = np.searchsorted(ranks, rank - SAME)
        found[own] = places[vertices]
        sought.append(_rising(found, own))
    return sought[0], sought[1]


def _rising(places: Places, own: Indices) -> Places:
    """Places that rise strictly; on an edge where rounding left some that do not, in equal parts.

    ``own`` are those of the vertices, from first to last.
    """
    edge = np.zeros(len(places), dtype=np.intp)
    edge[own[1:]] = 1
    edge = np.cumsum(edge)
    share = places - edge
    wrong = (share < 0) | (share >= 1) | (np.diff(places, prepend=-1) <= TIE)
    wrong[-1] = False
    if not wrong.any():
        return places
    mended = np.isin(edge, edge[wrong])
    parts = np.bincount(edge)
    equal = edge + (np.arange(len(places)) - own[edge]) / parts[edge]
    return np.where(mended, equal, places)
