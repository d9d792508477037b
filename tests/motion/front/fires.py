"""Seeded fires whose arrival times are known: perimeters at any time, and the truth between two.

A fire spreads over rough country: by Dijkstra's way on a grid whose cells burn at speeds made from
smooth noise of several sizes, faster with the wind; some country does not burn at all.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from contourpy import FillType, contour_generator
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

Floats = NDArray[np.float64]

# The moves of a fire from cell to cell: to the sixteen nearest in as many directions.
MOVES = [
    (i, j) for i in range(-2, 3) for j in range(-2, 3) if np.gcd(i, j) == 1 and (i, j) > (0, 0)
]

# How much the logarithm of the speed varies, for noise of each size (share of the grid's width).
ROUGHNESS = ((0.15, 0.55), (0.05, 0.45), (0.015, 0.3))

ROCK = 0.04  # the share of the country that does not burn


@dataclass(frozen=True, eq=False)
class Fire:
    """When each point of a grid of cells of size 1 burns."""

    arrival: Floats

    def perimeter(self, time: float) -> shapely.Geometry:
        """What has burnt by a time, as a valid (Multi)Polygon."""
        lines = contour_generator(z=self.arrival, fill_type=FillType.OuterOffset)
        polygons = [
            shapely.Polygon(rings[0], rings[1:])
            for points, offsets in zip(*lines.filled(-1.0, time), strict=True)
            for rings in [np.split(points, offsets[1:-1])]
        ]
        return shapely.make_valid(shapely.union_all(polygons))

    def when_burnt(self, share: float) -> float:
        """The time at which a share of the country has burnt."""
        return float(np.quantile(self.arrival, share))


def fire(seed: int, size: int = 160) -> Fire:
    """A fire from the middle of a country of ``size`` by ``size`` cells."""
    random = np.random.default_rng(seed)
    speed = np.zeros((size, size))
    for width, much in ROUGHNESS:
        speed += much * _noise(random, size, width)
    rock = _noise(random, size, 0.03)
    rock -= 9 * np.exp(
        -((np.indices((size, size)) - size // 2) ** 2).sum(axis=0) / (size / 20) ** 2
    )
    speed = np.where(rock > np.quantile(rock, 1 - ROCK), 0.02, np.exp(speed))
    angle, wind = random.uniform(0, 2 * np.pi), random.uniform(0.0, 0.5)
    number = np.arange(size * size).reshape(size, size)
    rows, columns, times = [], [], []
    for i, j in MOVES:
        here = np.s_[max(0, -i) : size - max(0, i), max(0, -j) : size - max(0, j)]
        there = np.s_[max(0, i) : size + min(0, i), max(0, j) : size + min(0, j)]
        length = np.hypot(i, j)
        pace = (1 / speed[here] + 1 / speed[there]) / 2
        along = (j * np.cos(angle) + i * np.sin(angle)) / length
        for way, from_, to in ((1, here, there), (-1, there, here)):
            rows.append(number[from_].ravel())
            columns.append(number[to].ravel())
            times.append((length * pace * (1 - way * wind * along)).ravel())
    graph = csr_array(
        (np.concatenate(times), (np.concatenate(rows), np.concatenate(columns))),
        shape=(size * size,) * 2,
    )
    start = number[size // 2, size // 2]
    return Fire(gaussian_filter(dijkstra(graph, indices=start).reshape(size, size), 0.7))


def pair(
    seed: int, size: int = 160, halfway: str = "area"
) -> tuple[shapely.Geometry, shapely.Geometry, shapely.Geometry]:
    """Perimeters at two times, clear of the country's edge, and the truth half-way between.

    The first has 0.4 to 0.8 of the area of the second. Half-way is when half of the area between
    has burnt, or half of the ``time`` has passed.
    """
    burning = fire(seed, size)
    random = np.random.default_rng([seed, 1])
    rim = np.concatenate([burning.arrival[[0, -1]].ravel(), burning.arrival[:, [0, -1]].ravel()])
    most = float((burning.arrival < 0.98 * rim.min()).mean())
    last = min(most, random.uniform(0.2, 0.5))
    first = last * random.uniform(0.4, 0.8)
    begin, end = (burning.when_burnt(share) for share in (first, last))
    middle = burning.when_burnt((first + last) / 2) if halfway == "area" else (begin + end) / 2
    return burning.perimeter(begin), burning.perimeter(end), burning.perimeter(middle)


def signed_distance(shape: shapely.Geometry, places: Floats) -> Floats:
    """How far places (n, 2) are from the boundary of a shape, negative within it."""
    shapely.prepare(shape)
    line = shape.boundary
    shapely.prepare(line)
    away = shapely.distance(line, shapely.points(places))
    return np.asarray(np.where(shapely.contains_xy(shape, *places.T), -away, away))


def likeness(one: NDArray[np.bool_], other: NDArray[np.bool_]) -> float:
    """The intersection of two shapes over their union, both sampled at the same places."""
    return float((one & other).sum() / (one | other).sum())


def _noise(random: np.random.Generator, size: int, width: float) -> Floats:
    """Smooth noise of variance 1."""
    noise = gaussian_filter(random.normal(size=(size, size)), width * size, mode="wrap")
    return np.asarray((noise - noise.mean()) / noise.std())
