"""Arrivals made by hand or by chance, and where each of their things is at a moment."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geotween.data.polygons import Identity
from geotween.motion.front.levels import Arrivals
from geotween.motion.front.plane import NOTHING, Thing

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles that tile an area, and the thing on each of them before and after; some rest."""

    points: Floats
    triangles: NDArray[np.intp]
    times: Floats
    before: NDArray[np.intp]
    after: NDArray[np.intp]

    @classmethod
    def of(
        cls,
        points: ArrayLike,
        triangles: Sequence[Sequence[int]],
        times: ArrayLike,
        before: ArrayLike,
        after: ArrayLike,
    ) -> Mesh:
        return cls(
            np.array(points, dtype=float),
            np.array(triangles, dtype=np.intp),
            np.array(times, dtype=float),
            np.array(before, dtype=np.intp),
            np.array(after, dtype=np.intp),
        )

    def arrivals(self) -> Arrivals:
        """What changes as triangles, what rests as borders."""
        changing = self.before != self.after
        number = np.where(changing, np.cumsum(changing) - 1, NOTHING)
        still = np.where(changing, NOTHING, self.before)
        sides = {
            (corners[i], corners[(i + 1) % 3]): triangle
            for triangle, corners in enumerate(self.triangles.tolist())
            for i in range(3)
        }
        rows = []
        for (one, other), left in sides.items():
            right = sides.get((other, one))
            if right is not None and one > other:
                continue
            across = (NOTHING, NOTHING) if right is None else (number[right], still[right])
            if number[left] != NOTHING or across[0] != NOTHING or still[left] != across[1]:
                rows.append((one, other, number[left], across[0], still[left], across[1]))
        table = np.array(rows, dtype=np.intp).reshape(-1, 6)
        return Arrivals(
            self.points,
            self.triangles[changing],
            self.times[changing],
            self.before[changing],
            self.after[changing],
            table[:, :2],
            table[:, 2:4],
            table[:, 4:],
        )

    def areas(self, t: float) -> Floats:
        """The area of each thing at t: of the parts of triangles that are before, and after."""
        a, b, c = self.points[self.triangles].transpose(1, 0, 2)
        whole = np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2
        low, middle, high = np.sort(self.times, axis=1).T
        with np.errstate(divide="ignore", invalid="ignore"):
            risen = (t - low) ** 2 / ((high - low) * (middle - low))
            left = (high - t) ** 2 / ((high - low) * (high - middle))
        share = np.where(t <= low, 0, np.where(t <= middle, risen, 1 - left))
        share = np.where(t >= high, 1, share)
        found = np.zeros(self.count + 1)
        np.add.at(found, self.before, whole * (1 - share))
        np.add.at(found, self.after, whole * share)
        return found[:-1]

    def thing_at(self, shares: Floats, t: float) -> tuple[Floats, NDArray[np.intp]]:
        """Places (T, 2) with barycentric shares (T, 3), one in each triangle, and who is there."""
        places = np.einsum("tk,tkx->tx", shares, self.points[self.triangles])
        when = (shares * self.times).sum(axis=1)
        return places, np.where(when < t, self.after, self.before)

    @property
    def count(self) -> int:
        """How many things there are."""
        return int(max(self.before.max(), self.after.max())) + 1


def things(count: int) -> tuple[Thing, ...]:
    """Things that live on, by the names of their numbers."""
    return tuple(Thing(named(str(k)), named(str(k))) for k in range(count))


def named(key: str) -> Identity:
    return Identity(key, keyed=True)


def by_chance(seed: int, points: int, labels: int, levels: int, smooth: bool) -> Mesh:
    """A Delaunay triangulation with times and things by chance.

    Where it is smooth a point has one time, else every corner of every triangle has its own.
    """
    from scipy.spatial import Delaunay

    rng = np.random.default_rng(seed)
    places = rng.random((points, 2))
    triangles = Delaunay(places).simplices.astype(np.intp)
    a, b, c = places[triangles].transpose(1, 0, 2)
    clockwise = (b - a)[:, 0] * (c - a)[:, 1] < (b - a)[:, 1] * (c - a)[:, 0]
    triangles[clockwise] = triangles[clockwise, ::-1]
    of_points = rng.integers(0, levels + 1, points)
    of_corners = rng.integers(0, levels + 1, triangles.shape)
    times = (of_points[triangles] if smooth else of_corners) / levels
    before, after = rng.integers(NOTHING, labels, (2, len(triangles)))
    still = (np.ptp(times, axis=1) == 0) | (rng.random(len(triangles)) < 0.4)
    return Mesh(places, triangles, times, before, np.where(still, before, after))
