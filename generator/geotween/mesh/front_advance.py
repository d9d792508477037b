"""The front of a triangulation that advances from a polygon's boundary into what is still open."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from fractions import Fraction
from heapq import heappop, heappush
from math import hypot, sqrt

import numpy as np
from numpy.typing import NDArray

from geotween.mesh.front_tree import FrontTree, Side

# Shewchuk's bound, rounded up: a larger determinant, as a share of its terms, has its sign right.
DOUBT = 3.4e-16

# The sides of an ideal triangle, in lengths of its base: sizes change towards the wanted ones as
# fast as quality stays above 0.8.
SHORTEST, LONGEST = 0.7, 1.5

# An edge longer than this, in wanted sizes, is eager: it advances before short ones take its room.
EAGER = 1.5

REACH = 0.85  # a vertex this near an ideal apex, in sides, is taken instead of it
FAIR = 0.6  # the quality that such a vertex has to give
# Where new apexes are tried, in ideal heights, and how far from the front, in sides, they must be.
TRIES = ((1.0, 0.7), (0.8, 0.7), (0.6, 0.7), (0.45, 0.7))
EAGER_TRIES = ((1.0, 0.7), (0.8, 0.7))


class Front:
    """Edges that bound what is still open, at their left, and the triangles made so far.

    Whether a triangle is valid is decided exactly: signs of areas that rounding leaves in doubt
    are computed with fractions. So what is open stays a valid region, whose every edge sees a
    vertex: the front closes, whatever the triangles look like.

    Attributes
    ----------
    x, y : the coordinates of points; new ones are appended.
    triangles : made so far, anticlockwise, by the numbers of their corners.
    """

    def __init__(self, points: NDArray[np.float64], tree: FrontTree) -> None:
        self.x: list[float] = points[:, 0].tolist()
        self.y: list[float] = points[:, 1].tolist()
        self.triangles: list[tuple[int, int, int]] = []
        self._tree = tree
        self._sides: dict[Side, list[int]] = {}
        self._waiting: list[tuple[float, int, int]] = []

    def add(self, a: int, b: int) -> None:
        """Make an edge part of the front, or close it where the front has its other side."""
        if (b, a) in self._sides:
            self._remove(b, a)
            return
        x, y = self.x, self.y
        leaves = self._tree.along(x[a], y[a], x[b], y[b])
        self._sides[a, b] = leaves
        for leaf in leaves:
            self._tree.members[leaf][a, b] = None
        length = hypot(x[b] - x[a], y[b] - y[a])
        wanted = self._tree.size((x[a] + x[b]) / 2, (y[a] + y[b]) / 2)
        heappush(self._waiting, (-length if length > EAGER * wanted else length, a, b))

    def advance(self) -> None:
        """Make triangles, until nothing is open: on long eager edges first, then on short ones."""
        while self._waiting:
            rank, a, b = heappop(self._waiting)
            if (a, b) not in self._sides:
                continue
            c = self._apex(a, b, eager=rank < 0)
            if c is None:
                heappush(self._waiting, (-rank, a, b))
                continue
            self.triangles.append((a, b, c))
            self._remove(a, b)
            self.add(a, c)
            self.add(c, b)

    def _remove(self, a: int, b: int) -> None:
        for leaf in self._sides.pop((a, b)):
            del self._tree.members[leaf][a, b]

    def _apex(self, a: int, b: int, *, eager: bool) -> int | None:
        """The third corner of the triangle on an edge, new or not; an eager edge may find none."""
        x, y = self.x, self.y
        dx, dy = x[b] - x[a], y[b] - y[a]
        base = hypot(dx, dy)
        mx, my = x[a] + dx / 2, y[a] + dy / 2
        side = min(max(self._tree.size(mx, my), SHORTEST * base), LONGEST * base)
        share = sqrt(side * side - base * base / 4) / base
        reach = REACH * side
        px, py = mx - dy * share, my + dx * share
        near = self._tree.near(
            min(x[a], x[b], px - reach),
            min(y[a], y[b], py - reach),
            max(x[a], x[b], px + reach),
            max(y[a], y[b], py + reach),
        )
        if not eager:
            for c in self._ranked(a, b, near, (px, py, reach), FAIR):
                if self._fits(a, b, c, (x[c], y[c]), near):
                    return c
        for height, room in EAGER_TRIES if eager else TRIES:
            place = mx - dy * share * height, my + dx * share * height
            if self._roomy(place, room * side, near, (a, b)) and self._fits(a, b, -1, place, near):
                x.append(place[0])
                y.append(place[1])
                return len(x) - 1
        return None if eager else self._any(a, b, (mx, my, 2 * max(side, base)))

    def _any(self, a: int, b: int, disc: tuple[float, float, float]) -> int:
        """The best corner that fits on an edge, in the first disc that has one."""
        x, y = self.x, self.y
        mx, my, reach = disc
        while True:
            near = self._tree.near(mx - reach, my - reach, mx + reach, my + reach)
            for c in self._ranked(a, b, near, (mx, my, reach), 0.0):
                if self._fits(a, b, c, (x[c], y[c]), near):
                    return c
            if reach > self._tree.diagonal:
                raise ValueError("the edges of the front do not bound a valid region")
            reach *= 2

    def _ranked(
        self, a: int, b: int, near: Iterable[Side], disc: tuple[float, float, float], least: float
    ) -> Iterator[int]:
        """Ends of edges, in a disc and left of ab, by the quality of their triangles with ab."""
        x, y = self.x, self.y
        ax, ay, bx, by = x[a], y[a], x[b], y[b]
        dx, dy = bx - ax, by - ay
        base = hypot(dx, dy)
        px, py, reach = disc
        found = []
        for c in {end: None for side in near for end in side}:
            cx, cy = x[c], y[c]
            if c in (a, b) or hypot(cx - px, cy - py) > reach:
                continue
            area = max(dx * (cy - ay) - dy * (cx - ax), 0.0)
            one, other = hypot(cx - ax, cy - ay), hypot(cx - bx, cy - by)
            value = 4 * (area / (base + one + other)) * (area / (base * one * other))
            if value >= least:
                found.append((-value, c))
        found.sort()
        return (c for _, c in found)

    def _roomy(
        self, place: tuple[float, float], room: float, near: Iterable[Side], own: Side
    ) -> bool:
        """Whether the front keeps a distance from a place, but for one edge of it."""
        x, y = self.x, self.y
        px, py = place
        for side in near:
            sx, sy = x[side[0]], y[side[0]]
            ex, ey = x[side[1]] - sx, y[side[1]] - sy
            wx, wy = px - sx, py - sy
            along = wx * ex + wy * ey
            if along > 0:
                whole = ex * ex + ey * ey
                share = along / whole if along < whole else 1.0
                wx -= share * ex
                wy -= share * ey
            if wx * wx + wy * wy < room * room and side != own:
                return False
        return True

    def _fits(
        self, a: int, b: int, c: int, apex: tuple[float, float], near: Iterable[Side]
    ) -> bool:
        """Whether no edge of the front meets the open triangle abc, and none of its ends its rim.

        ``near`` has the edges that may; c is -1 for a new point.
        """
        x, y = self.x, self.y
        ax, ay, bx, by = x[a], y[a], x[b], y[b]
        cx, cy = apex
        if orientation(ax, ay, bx, by, cx, cy) <= 0:
            return False
        west, east = min(ax, bx, cx), max(ax, bx, cx)
        south, north = min(ay, by, cy), max(ay, by, cy)
        sides = {a: (0, 1, 0), b: (0, 0, 1), c: (1, 0, 0)}  # of ab, bc and ca, that a point is on
        for p, q in near:
            px, py, qx, qy = x[p], y[p], x[q], y[q]
            if (
                (px < west and qx < west)
                or (px > east and qx > east)
                or (py < south and qy < south)
                or (py > north and qy > north)
            ):
                continue
            for end, ex, ey in ((p, px, py), (q, qx, qy)):
                if end not in sides:
                    sides[end] = (
                        orientation(ax, ay, bx, by, ex, ey),
                        orientation(bx, by, cx, cy, ex, ey),
                        orientation(cx, cy, ax, ay, ex, ey),
                    )
                    if min(sides[end]) >= 0:
                        return False
            # Convex shapes are apart where a side of one of them parts them.
            (p0, p1, p2), (q0, q1, q2) = sides[p], sides[q]
            if (p0 <= 0 and q0 <= 0) or (p1 <= 0 and q1 <= 0) or (p2 <= 0 and q2 <= 0):
                continue
            corners = (
                0 if a in (p, q) else orientation(px, py, qx, qy, ax, ay),
                0 if b in (p, q) else orientation(px, py, qx, qy, bx, by),
                0 if c in (p, q) else orientation(px, py, qx, qy, cx, cy),
            )
            if min(corners) < 0 < max(corners):
                return False
        return True


def orientation(ax: float, ay: float, bx: float, by: float, cx: float, cy: float) -> int:
    """1, 0 or -1 where three places turn left, lie on a line, or turn right; exact.

    Notes
    -----
    Doubles with Shewchuk's bound on their error (1997, Adaptive precision floating-point
    arithmetic and fast robust geometric predicates), and fractions where they leave it in doubt.
    """
    one, other = (bx - ax) * (cy - ay), (by - ay) * (cx - ax)
    area = one - other
    if abs(area) <= DOUBT * (abs(one) + abs(other)):
        u, v = Fraction(ax), Fraction(ay)
        exact = (Fraction(bx) - u) * (Fraction(cy) - v) - (Fraction(by) - v) * (Fraction(cx) - u)
        return (exact > 0) - (exact < 0)
    return 1 if area > 0 else -1
