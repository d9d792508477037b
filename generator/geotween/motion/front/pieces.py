"""Outlines: the directed pieces of every thing's boundary, each for the time that it lasts.

A piece runs between two nodes with its thing to the left. A node is a vertex of the arrivals, or
the point at which a front crosses an edge, which moves along it from end to end. Pieces lie

    across triangles, between the crossings of two edges
    along edges of which one side alone is the thing, between their ends and crossings
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geotween.motion.front.plane import NOTHING, Floats, Ints, Thing
from geotween.motion.tracks import SEAM_AT

if TYPE_CHECKING:
    from geotween.motion.front.levels import Arrivals

Flags = NDArray[np.bool_]

# Crossings that pass each other this near in time to an event of their edge do so at the event.
SAME_MOMENT = 1e-9


@dataclass(frozen=True, eq=False)
class Nodes:
    """Points that move on a straight line: from ``places[0]`` (q, 2) at ``lives[0]`` (q,) on.

    They arrive at ``places[1]`` at ``lives[1]``. Those that rest do so from 0 to 1.
    """

    places: Floats
    lives: Floats

    def at(self, node: Ints, t: Floats | float) -> Floats:
        """The places (k, 2) of some nodes at t, one moment for all or each; exact at both ends."""
        start, end = self.lives[:, node]
        share = ((t - start) / (end - start))[:, None]
        one, other = self.places[:, node]
        return np.asarray(np.where(share == 1, other, one + (other - one) * share))

    def only(self, kept: Ints) -> Nodes:
        """Some of the nodes, by number."""
        return Nodes(self.places[:, kept], self.lives[:, kept])


@dataclass(frozen=True, eq=False)
class Pieces:
    """Pieces of boundary, parallel (r,): whose they are, their nodes, and how long they last.

    ``seam`` says at which ends the other side is of the same polygon (see ``Track.seams``).
    """

    thing: Ints
    start: Ints
    end: Ints
    since: Floats
    until: Floats
    seam: NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class _Edges:
    """The edges with what lies on both sides.

    ``times`` (m, 2, 2) by side and end, where the side is a triangle that changes; ``labels``
    (m, 2, 2) by side, before and after; ``crossing`` (m, 2) the node at which a front crosses.
    """

    ends: Ints
    times: Floats
    labels: Ints
    crossing: Ints


def outlines(arrivals: Arrivals, things: tuple[Thing, ...]) -> tuple[Nodes, Pieces]:
    """The pieces of all things' boundaries.

    At any moment that is no event, the pieces of a thing that last then close to rings. Linear in
    the number of triangles and edges, but for one sort.

    Raises
    ------
    ArithmeticError
        Where the sides of an edge are not the triangles that have it.
    """
    edges, of_triangles = _edges_of(arrivals)
    seams = _Seams.of(things)
    found = [*_along(edges, seams), _across(arrivals, edges, of_triangles, seams)]
    columns = zip(
        *((p.thing, p.start, p.end, p.since, p.until, p.seam) for p in found), strict=True
    )
    return _nodes(arrivals, edges), _lasting(Pieces(*(np.concatenate(c) for c in columns)))


def _edges_of(arrivals: Arrivals) -> tuple[_Edges, Ints]:
    """The edges, and for each triangle (T, 3) twice the edge after each corner, plus its side."""
    count = len(arrivals.edges)
    times = np.zeros((count, 2, 2))
    labels = np.repeat(arrivals.still[:, :, None], 2, axis=2)
    of_triangles = np.zeros((len(arrivals.triangles), 3), dtype=np.intp)
    for side in (0, 1):
        edge = np.flatnonzero(arrivals.sides[:, side] >= 0)
        triangle = arrivals.sides[edge, side]
        one, other = arrivals.edges[edge].T if side == 0 else arrivals.edges[edge, ::-1].T
        corners = arrivals.triangles[triangle]
        corner = np.argmax(corners == one[:, None], axis=1)
        after = (corner + 1) % 3
        row = np.arange(len(edge))
        if not ((corners[row, corner] == one) & (corners[row, after] == other)).all():
            raise ArithmeticError("an edge of the arrivals is not its triangles'")
        of_triangles[triangle, corner] = 2 * edge + side
        found = np.stack([arrivals.times[triangle, corner], arrivals.times[triangle, after]])
        times[edge, side] = (found if side == 0 else found[::-1]).T
        labels[edge, side, 0] = arrivals.before[triangle]
        labels[edge, side, 1] = arrivals.after[triangle]
    times[labels[..., 0] == labels[..., 1]] = 0
    crossing = len(arrivals.points) + np.arange(2 * count).reshape(-1, 2)
    together = (times[:, 0] == times[:, 1]).all(axis=1)
    crossing[together, 1] = crossing[together, 0]
    return _Edges(arrivals.edges, times, labels, crossing), of_triangles


def _nodes(arrivals: Arrivals, edges: _Edges) -> Nodes:
    """Vertices, then two crossings for each edge: those that there are none of rest."""
    still = np.stack([arrivals.points, arrivals.points])
    ends = arrivals.points[edges.ends].transpose(1, 0, 2)[:, :, None].repeat(2, axis=2)
    times = edges.times.transpose(2, 0, 1)
    back = times[0] > times[1]
    ends = np.where(back[..., None], ends[::-1], ends).reshape(2, -1, 2)
    times = np.where(back, times[::-1], times).reshape(2, -1)
    times = np.where(times[0] == times[1], np.array([[0.0], [1.0]]), times)
    resting = np.array([[0.0], [1.0]]).repeat(len(arrivals.points), axis=1)
    return Nodes(np.concatenate([still, ends], axis=1), np.concatenate([resting, times], axis=1))


@dataclass(frozen=True, eq=False)
class _Seams:
    """The identities of things at both ends as numbers (2, k + 1): -1 for none, and at the end."""

    numbers: Ints

    @classmethod
    def of(cls, things: tuple[Thing, ...]) -> _Seams:
        names = [[thing.origin for thing in things], [thing.target for thing in things]]
        known: dict[object, int] = {None: NOTHING}
        numbers = [[known.setdefault(name, len(known)) for name in end] for end in names]
        return cls(np.array([[*end, NOTHING] for end in numbers], dtype=np.intp))

    def between(self, one: Ints, other: Ints) -> NDArray[np.uint8]:
        """At which ends two things are one polygon."""
        mine, theirs = self.numbers[:, one], self.numbers[:, other]
        same = (mine == theirs) & (mine != NOTHING)
        return np.asarray(same[0] * SEAM_AT[0] + same[1] * SEAM_AT[1], dtype=np.uint8)


def _along(edges: _Edges, seams: _Seams) -> list[Pieces]:
    """Pieces that lie on edges: where the two sides differ.

    The crossings of both sides cut an edge into up to three slots, in which each side is one thing.
    """
    edge, since, until = _spells(edges)
    middle = (since + until) / 2
    times, crossing = edges.times[edge], edges.crossing[edge]
    changed = times < middle[:, None, None]
    crossed = changed[..., 0] != changed[..., 1]
    length = np.where(crossed, times[..., 1] - times[..., 0], 1)
    share = np.where(crossed, (middle[:, None] - times[..., 0]) / length, 2)
    together = crossed.all(axis=1) & (crossing[:, 0] == crossing[:, 1])
    cuts = crossed.sum(axis=1) - together
    first = np.argmin(share, axis=1)
    row = np.arange(len(edge))
    # The slot from which on a side is what it is at the edge's end.
    turn = np.where(np.arange(2) == first[:, None], 1, 2)
    turn[together] = 1
    one, other = edges.ends[edge].T
    bounds = np.stack(
        [
            one,
            np.where(cuts > 0, crossing[row, first], other),
            np.where(cuts > 1, crossing[row, 1 - first], other),
            other,
        ]
    )
    slots = np.arange(3)[:, None, None]
    at_end = np.where(slots < turn, changed[..., 0], changed[..., 1]).astype(np.intp)
    labels = np.take_along_axis(edges.labels[edge][None], at_end[..., None], axis=3)[..., 0]
    there = np.arange(3)[:, None] <= cuts
    return [
        _on_side(labels[..., side], labels[..., 1 - side], there, bounds, since, until, seams, side)
        for side in (0, 1)
    ]


def _spells(edges: _Edges) -> tuple[Ints, Floats, Floats]:
    """Edges (k,) and the times between which nothing happens on them, since and until."""
    (a, b), (c, d) = edges.times.transpose(1, 2, 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        passing = (a * (d - c) - c * (b - a)) / ((d - c) - (b - a))
    events = np.stack([np.zeros_like(a), a, b, c, d, np.ones_like(a)])
    near = np.abs(events - passing).min(axis=0) < SAME_MOMENT
    apart = (a == b) | (c == d) | near | ~((passing > 0) & (passing < 1))
    moments = np.sort(np.vstack([events, np.where(apart, 0, passing)]), axis=0)
    which, edge = np.nonzero(moments[1:] > moments[:-1])
    return edge, moments[which, edge], moments[which + 1, edge]


def _on_side(
    mine: Ints,
    other: Ints,
    there: Flags,
    bounds: Ints,
    since: Floats,
    until: Floats,
    seams: _Seams,
    side: int,
) -> Pieces:
    """The pieces of the things on one side of edges; slots in a row that are alike are one."""
    seam = seams.between(mine, other)
    lies = there & (mine != other) & (mine != NOTHING)
    alike = lies[1:] & lies[:-1] & (mine[1:] == mine[:-1]) & (seam[1:] == seam[:-1])
    last = np.array([[1], [2], [3]]).repeat(mine.shape[1], axis=1)
    last[1] = np.where(alike[1], last[2], last[1])
    last[0] = np.where(alike[0], last[1], last[0])
    lies[1:] &= ~alike
    slot, row = np.nonzero(lies)
    ends = bounds[slot, row], bounds[last[slot, row], row]
    one, two = ends if side == 0 else ends[::-1]
    return Pieces(mine[slot, row], one, two, since[row], until[row], seam[slot, row])


def _across(arrivals: Arrivals, edges: _Edges, of_triangles: Ints, seams: _Seams) -> Pieces:
    """Pieces that cross triangles: what is ahead of a front has it the other way round."""
    times = np.sort(arrivals.times, axis=1)
    changing = (arrivals.before != arrivals.after)[:, None]
    triangle, which = np.nonzero((times[:, 1:] > times[:, :-1]) & changing)
    since, until = times[triangle, which], times[triangle, which + 1]
    changed = arrivals.times[triangle] < ((since + until) / 2)[:, None]
    following = np.roll(changed, -1, axis=1)
    crossing = edges.crossing.reshape(-1)[of_triangles[triangle]]
    row = np.arange(len(triangle))
    out = crossing[row, np.argmax(changed & ~following, axis=1)]
    back = crossing[row, np.argmax(~changed & following, axis=1)]
    before, after = arrivals.before[triangle], arrivals.after[triangle]
    seam = seams.between(before, after)
    two = [
        np.concatenate(pair)
        for pair in ((after, before), (out, back), (back, out), *[(x, x) for x in (since, until)])
    ]
    found = Pieces(two[0], two[1], two[2], two[3], two[4], np.concatenate([seam, seam]))
    return _only(found, np.flatnonzero(found.thing != NOTHING))


def _lasting(pieces: Pieces) -> Pieces:
    """Pieces that go on as they are, as one."""
    order = np.lexsort((pieces.since, pieces.seam, pieces.end, pieces.start, pieces.thing))
    p = _only(pieces, order)
    same = p.since[1:] == p.until[:-1]
    for column in (p.thing, p.start, p.end, p.seam):
        same &= column[1:] == column[:-1]
    new = np.flatnonzero(np.append(True, ~same)[: len(order)])
    last = np.append(new[1:], len(order)) - 1
    return Pieces(p.thing[new], p.start[new], p.end[new], p.since[new], p.until[last], p.seam[new])


def _only(p: Pieces, kept: Ints) -> Pieces:
    return Pieces(
        p.thing[kept], p.start[kept], p.end[kept], p.since[kept], p.until[kept], p.seam[kept]
    )
