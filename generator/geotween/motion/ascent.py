"""Climb within polygons to a point that no point around is farther from the boundary than.

Seen from p, each edge of the boundary lies behind a line. As far as the lines is as far as the
edges at least, so the point farthest from the lines, the optimum of a linear program in x, y and
the distance, is no less deep than p: the next p. (Convex regions among obstacles are found by such
lines in IRIS, Deits and Tedrake 2015.)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Points = NDArray[np.complex128]  # x + iy
Numbers = NDArray[np.intp]

# All lengths are in sizes of the polygon, whose vertices lie no farther than 1 from 0.

# A round that gains less, or goes on by less along a ridge, is at its end; a line that is missed by
# less is kept. Shares of a basis below the last are rounding.
TOP, MISSED, TINY = 1e-11, 1e-13, 1e-9

# Three or four rounds of each kind climb to a top, some ten along curved ridges; a program
# exchanges three or four lines. More than these are never made.
ROUNDS, EXCHANGES = 200, 60

# Farther than this from where it starts no point of a polygon lies.
BEYOND = 2.0


@dataclass(frozen=True, eq=False)
class Edges:
    """The edges of polygons, ``starts`` to ``stops``: k's are ``offsets[k]:offsets[k + 1]``."""

    starts: Points
    stops: Points
    offsets: Numbers


@dataclass(frozen=True, eq=False)
class _Lines:
    """Lines seen from points: unit ways from them, their distances, and whose they are, sorted."""

    ways: Points
    distances: Floats
    owner: Numbers

    def nearest(self, distances: Floats) -> Numbers:
        """The place of the least of some distances, for each point that has lines."""
        first = np.flatnonzero(np.append(True, self.owner[1:] != self.owner[:-1]))
        counts = np.diff(np.append(first, len(self.owner)))
        least = np.repeat(np.minimum.reduceat(distances, first), counts)
        places = np.flatnonzero(distances == least)
        mine = self.owner[places]
        return np.asarray(places[np.append(True, mine[1:] != mine[:-1])])

    def of(self, which: NDArray[np.bool_]) -> _Lines:
        """Those of some of the points, which are counted anew."""
        mine = which[self.owner]
        number = np.cumsum(which) - 1
        return _Lines(self.ways[mine], self.distances[mine], number[self.owner[mine]])


def climb(edges: Edges, owner: Numbers, points: Points, slope: Floats) -> tuple[Points, Floats]:
    """The tops above points (n,) inside the polygons ``owner`` (n,), and how deep they are.

    Where the top is a ridge that falls towards 0 by no more than ``slope`` (n,), its point nearest
    to 0 is taken. Cost: the edges of a polygon for each point, times a small number.
    """
    points, depths = points.copy(), np.zeros(len(points))
    rested = np.zeros(len(points), dtype=np.intp)
    for turn in range(ROUNDS):
        active = np.flatnonzero(rested < 2)
        if not len(active):
            break
        here = points[active]
        lines, depth = _in_front(edges, owner[active], here, along=bool(turn % 2))
        inward = -here / np.maximum(np.abs(here), TOP)
        step, reached = _optimum(lines, slope[active] * inward)
        square = np.abs(step) ** 2
        foot = -(here.conjugate() * step).real / np.where(square > 0, square, 1)
        share = np.where(reached > depth + TOP, 1.0, np.clip(foot, 0, 1))
        points[active] = here + share * step
        depths[active] = np.maximum(depth, (1 - share) * depth + share * reached)
        moved = (reached > depth + TOP) | ((share < 1) & (share * np.abs(step) > TOP))
        rested[active] = np.where(moved, 0, rested[active] + 1)
    return points, depths


def _in_front(edges: Edges, owner: Numbers, points: Points, along: bool) -> tuple[_Lines, Floats]:
    """The lines seen from points, without those behind others, and the points' depths (n,).

    A line goes through the nearest point of its edge, across the way to it; with ``along`` it is
    the edge's own where that leaves the point as deep as it is. Of the first kind those that touch
    are true, of the second those at which the next edge begins.
    """
    counts = np.diff(edges.offsets)[owner]
    mine = np.repeat(np.arange(len(points)), counts)
    edge = np.arange(len(mine)) - np.repeat(
        np.cumsum(counts) - counts - edges.offsets[owner], counts
    )
    start, stop = points[mine] - edges.starts[edge], points[mine] - edges.stops[edge]
    way = start - stop
    square = np.abs(way) ** 2
    share = (start * way.conjugate()).real / np.where(square > 0, square, 1)
    off = start - np.clip(share, 0, 1) * way
    distances = np.abs(off)
    ways = off / np.where(distances > 0, distances, 1)
    seen = _Lines(ways, distances, mine)
    depth = distances[seen.nearest(distances)]
    if along:
        normal = 1j * way / np.sqrt(np.where(square > 0, square, 1))
        side = (normal.conjugate() * start).real
        own = np.abs(side) >= depth[mine]
        ways, distances = (
            np.where(own, np.sign(side) * normal, ways),
            np.where(own, np.abs(side), distances),
        )
    kept = []
    left = np.arange(len(mine))
    while len(left):
        rest = _Lines(ways[left], distances[left], mine[left])
        nearest = left[rest.nearest(rest.distances)]
        kept.append(nearest)
        line = np.zeros(len(points), dtype=np.intp)
        line[mine[nearest]] = nearest
        line = line[mine[left]]
        across = ways[line].conjugate()
        least = np.minimum((across * start[left]).real, (across * stop[left]).real)
        left = left[(least < distances[line] - MISSED) & (left != line)]
    front = np.sort(np.concatenate(kept))
    return _Lines(ways[front], distances[front], mine[front]), depth


def _optimum(lines: _Lines, bent: Points) -> tuple[Points, Floats]:
    """The step from each point to the one farthest from its lines, and how far that is.

    Greatest is r + <bent, step>, where r <= distance + <way, step> for each line. Dual simplex
    method: three lines are a basis; the line most violated takes the place of the one whose
    multiplier would be the first to turn negative.
    """
    nearest = lines.nearest(lines.distances)
    step, far = np.zeros(len(nearest), dtype=np.complex128), lines.distances[nearest]
    # Row (u, v, -1) and bound b stand for u x + v y - r >= b. Two walls far off begin the basis.
    rows, bounds = np.zeros((len(nearest), 3, 3)), np.full((len(nearest), 3), -BEYOND)
    rows[:, 0], bounds[:, 0] = _row(lines.ways[nearest]), -far
    pull = lines.ways[nearest] + bent
    rows[:, 1, 0], rows[:, 2, 1] = np.where(pull.real > 0, -1, 1), np.where(pull.imag > 0, -1, 1)
    goal = np.column_stack([bent.real, bent.imag, np.ones(len(bent))])
    active = np.arange(len(nearest))
    for _ in range(EXCHANGES):
        x, y, r = np.linalg.solve(rows, bounds[..., None])[..., 0].T
        place = x + 1j * y
        slack = lines.distances + (lines.ways.conjugate() * place[lines.owner]).real
        slack -= r[lines.owner]
        worst = lines.nearest(slack)
        missed = slack[worst] < -MISSED
        step[active[~missed]], far[active[~missed]] = place[~missed], r[~missed]
        turned = rows.swapaxes(1, 2)
        coming = _row(lines.ways[worst])
        multipliers = np.linalg.solve(turned, -goal[active, :, None])[..., 0]
        shares = np.linalg.solve(turned, coming[..., None])[..., 0]
        positive = shares > TINY
        ratio = np.where(positive, multipliers / np.where(positive, shares, 1), np.inf)
        going = np.argmin(ratio, axis=1)
        every = np.arange(len(active))
        rows[every, going], bounds[every, going] = coming, -lines.distances[worst]
        left = missed & positive.any(axis=1)
        if not left.any():
            break
        active, rows, bounds, lines = active[left], rows[left], bounds[left], lines.of(left)
    return step, far


def _row(way: Points) -> Floats:
    return np.column_stack([way.real, way.imag, np.full(len(way), -1.0)])
