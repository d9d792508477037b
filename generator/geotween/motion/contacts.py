"""Contacts of moving edges: who comes near whom, when edges cross, and what touches throughout.

Vertices move on straight lines between two key times. So vertex v passes the line through
c and d where the cross product of two linearly moving vectors is 0: a quadratic in time,

    side(t) = (d - c)(t) x (v - c)(t)        > 0 where v lies left of c -> d

Edges ab and cd cross while a and b lie on different sides of cd, and c and d on different sides
of ab. The roots of these four quadratics are the events of the pair; between two of them nothing
changes, and one look there tells.
What touches throughout has no events; see passages.py.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from geotween.motion.moving import Flags, Floats, Moving, Numbers

# Pairs of edges looked at in one go: arrays of some 100 numbers a pair stay below 100 MB.
CHUNK = 100_000

# A root this far outside of the time between key times, as a share of it, lies at its end.
ROUNDING = 1e-9


def cross(a: Floats, b: Floats) -> Floats:
    """The cross product of vectors (..., 2)."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def dot(a: Floats, b: Floats) -> Floats:
    """The scalar product of vectors (..., 2)."""
    return np.asarray(a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1])


def quadratic(product: Callable[[Floats, Floats], Floats], a: Floats, b: Floats) -> Floats:
    """A product of linearly moving vectors (2, k, 2), by its Bernstein coefficients (3, k)."""
    middle = (product(a[0], b[1]) + product(a[1], b[0])) / 2
    return np.stack([product(a[0], b[0]), middle, product(a[1], b[1])])


def value(q: Floats, t: Floats) -> Floats:
    """The values (k, s) of quadratics (3, k) at times (k, s)."""
    s = 1 - t
    return np.asarray((q[0, :, None] * s + 2 * q[1, :, None] * t) * s + q[2, :, None] * t * t)


def turns(q: Floats) -> Floats:
    """The roots and the extremum (k, 3) of quadratics (3, k); 0 for those outside of [0, 1].

    The roots by the stable formula: z = -(h + sign(h) sqrt(h² - ac)), z / a and c / z.
    """
    a, h, c = q[0] - 2 * q[1] + q[2], q[1] - q[0], q[0]
    z = -(h + np.copysign(np.sqrt(np.maximum(q[1] * q[1] - q[0] * q[2], 0)), h))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        found = np.stack([z / a, c / z, -h / a], axis=1)
    return np.where((found > -ROUNDING) & (found < 1 + ROUNDING), found.clip(0, 1), 0.0)


def between(quadratics: Floats) -> tuple[Floats, Floats]:
    """All events (k, s + 1) of k times several quadratics (j, 3, k), and moments (k, s) between.

    Between two events every quadratic is monotone and keeps its sign. So at the moment half-way
    it has at least a quarter of the most that it reaches.
    """
    count = quadratics.shape[2]
    times = np.sort(
        np.concatenate(
            [np.zeros((count, 1)), *(turns(q) for q in quadratics), np.ones((count, 1))], axis=1
        ),
        axis=1,
    )
    return times, (times[:, 1:] + times[:, :-1]) / 2


@dataclass(frozen=True, eq=False)
class Runs:
    """Intervals of time, ``start`` to ``end`` (k,), each in ``row`` (k,) of what was looked at.

    ``deep`` (k,) is True where a contact gets deeper than the tolerance.
    """

    row: Numbers
    start: Floats
    end: Floats
    deep: Flags

    @classmethod
    def of(cls, mask: Flags, deep: Flags, times: Floats) -> Runs:
        """The runs of True in the rows of a mask (k, s), between times (k, s + 1)."""
        mask = mask & (times[:, 1:] > times[:, :-1])
        padded = np.pad(mask, ((0, 0), (1, 1)))
        row, first = np.nonzero(padded[:, 1:] & ~padded[:, :-1])
        _, last = np.nonzero(padded[:, :-1] & ~padded[:, 1:])
        total = np.pad(np.cumsum(mask & deep, axis=1), ((0, 0), (1, 0)))
        return cls(row, times[row, first], times[row, last], total[row, last] > total[row, first])


@dataclass(frozen=True, eq=False)
class Crossings:
    """When edges ``one`` and ``other`` (k,) cross; and what lies on an edge throughout.

    ``corner`` and ``edge`` (c,): a corner whose vertex moves along the edge's line. ``touches``
    are corner, edge (both (d,)) and t at which a corner of the same ring touches an edge, or
    begins to cross it.
    """

    one: Numbers
    other: Numbers
    runs: Runs
    corner: Numbers
    edge: Numbers
    touches: tuple[Numbers, Numbers, Floats]
    events: int
    looks: int


def crossings(moving: Moving, one: Numbers, other: Numbers) -> Iterator[Crossings]:
    """Look at pairs of edges, chunk by chunk; proper crossings only, touching has runs of none."""
    for start in range(0, len(one), CHUNK):
        yield _crossings(moving, one[start : start + CHUNK], other[start : start + CHUNK])


def _crossings(moving: Moving, one: Numbers, other: Numbers) -> Crossings:
    pairs = _Pairs.of(moving, one, other)
    kept = np.flatnonzero(~pairs.apart(moving.tolerance))
    pairs = _Pairs.of(moving, one[kept], other[kept])
    flat = pairs.flat(moving.tolerance)
    times, moments = between(pairs.sides)
    crossing, depth = pairs.look(moments)
    free = ~np.any(pairs.shared, axis=0)
    runs = Runs.of(crossing & free[:, None], depth > moving.tolerance, times)
    # Along an edge throughout, the sign is rounding; the order of directions tells there.
    told = ~runs.deep & np.any(flat, axis=0)[runs.row]
    runs = Runs(runs.row[~told], runs.start[~told], runs.end[~told], runs.deep[~told])
    contact = np.unique((pairs.corners * len(moving.vertex) + pairs.edges)[flat])
    return Crossings(
        pairs.one[runs.row],
        pairs.other[runs.row],
        runs,
        contact // len(moving.vertex),
        contact % len(moving.vertex),
        pairs.touches(~pairs.shared & ~flat),
        int(((times > 0) & (times < 1)).sum()),
        moments.size,
    )


@dataclass(frozen=True, eq=False)
class _Pairs:
    """Pairs of edges and, for each of their four ends, its side of the other edge.

    ``corners``, ``edges`` and ``shared`` (4, k): an end, the other edge, and whether the end is
    one of that edge's; ``sides`` (4, 3, k) are quadratics, ``ways`` (2, 2, k, 2) the two edges.
    """

    moving: Moving
    one: Numbers
    other: Numbers
    corners: Numbers
    edges: Numbers
    shared: Flags
    sides: Floats
    ways: Floats

    @classmethod
    def of(cls, moving: Moving, one: Numbers, other: Numbers) -> _Pairs:
        following = moving.following
        corners = np.stack([one, following[one], other, following[other]])
        edges = np.stack([other, other, one, one])
        a, b, c, d = moving.vertex[corners]
        ways = np.stack([moving.ways(a, b), moving.ways(c, d)])
        sides = np.stack(
            [
                quadratic(cross, ways[1], moving.ways(c, a)),
                quadratic(cross, ways[1], moving.ways(c, b)),
                quadratic(cross, ways[0], moving.ways(a, c)),
                quadratic(cross, ways[0], moving.ways(a, d)),
            ]
        )
        shared = np.stack([(a == c) | (a == d), (b == c) | (b == d)])
        shared = np.concatenate([shared, [(c == a) | (c == b), (d == a) | (d == b)]])
        return cls(moving, one, other, corners, edges, shared, sides, ways)

    def lengths(self) -> Floats:
        """The largest length (4, k) of each end's other edge; lengths are convex in time."""
        longest = np.hypot(self.ways[..., 0], self.ways[..., 1]).max(axis=1)
        return np.asarray(longest[[1, 1, 0, 0]])

    def apart(self, tolerance: float) -> Flags:
        """Where both ends of an edge stay on one side of the other: nothing can happen (k,).

        Of two edges that share an end it is the other end that matters.
        """
        least = tolerance * self.lengths()[:, None]
        left: Flags = np.asarray((self.sides > least).all(axis=1))
        right: Flags = np.asarray((self.sides < -least).all(axis=1))
        aside = np.any((left[::2] & left[1::2]) | (right[::2] & right[1::2]), axis=0)
        sharing = np.any(self.shared, axis=0) & np.any(left | right, axis=0)
        return np.asarray(aside | sharing | np.all(self.shared, axis=0))

    def flat(self, tolerance: float) -> Flags:
        """Ends (4, k) that stay on the line of the other edge, and are not its own ends."""
        near = np.abs(self.sides).max(axis=1) <= tolerance * self.lengths()
        return np.asarray(near & ~self.shared)

    def look(self, moments: Floats) -> tuple[Flags, Floats]:
        """Whether they cross at some moments (k, s), and how deep.

        The depth is the least way by which an end must move for it to cross no longer.
        """
        a, b, c, d = (value(side, moments) for side in self.sides)
        one, other = (np.hypot(*np.moveaxis(at_times(way, moments), -1, 0)) for way in self.ways)
        reach = np.minimum(np.abs(a), np.abs(b)) * one, np.minimum(np.abs(c), np.abs(d)) * other
        depth = np.minimum(*reach) / np.maximum(one * other, np.finfo(float).tiny)
        return ((a > 0) != (b > 0)) & ((c > 0) != (d > 0)), depth

    def touches(self, wanted: Flags) -> tuple[Numbers, Numbers, Floats]:
        """Corners, edges and moments where a corner meets an edge of its own ring."""
        which, pair = np.nonzero(
            wanted & (self.moving.ring[self.one] == self.moving.ring[self.other])
        )
        corner, edge, side = (
            self.corners[which, pair],
            self.edges[which, pair],
            self.sides[which, :, pair],
        )
        moments = turns(side.T)
        on = lies_on(self.moving, corner, edge, moments)
        row, column = np.nonzero(on)
        return corner[row], edge[row], moments[row, column]


def at_times(way: Floats, t: Floats) -> Floats:
    """Linearly moving vectors (2, k, 2) at times (k, s): (k, s, 2)."""
    share = t[..., None]
    return np.asarray(way[0, :, None] * (1 - share) + way[1, :, None] * share)


def lies_on(moving: Moving, corner: Numbers, edge: Numbers, t: Floats) -> Flags:
    """Whether corners (k,) lie on edges (k,), ends included, at times (k, s)."""
    v, c, d = moving.vertex[[corner, edge, moving.following[edge]]]
    way, reach = at_times(moving.ways(c, d), t), at_times(moving.ways(c, v), t)
    length = np.hypot(way[..., 0], way[..., 1])
    slack = moving.tolerance * length
    along = dot(way, reach)
    on = (np.abs(cross(way, reach)) <= slack) & (along >= -slack) & (along <= length**2 + slack)
    collapsed = np.hypot(reach[..., 0], reach[..., 1]) <= moving.tolerance
    return np.asarray(np.where(length > moving.tolerance, on, collapsed))
