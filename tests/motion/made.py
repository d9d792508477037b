"""Seeded transitions of many kinds: each function makes an origin and a target, both valid."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import contourpy
import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.affinity import rotate
from shapely.geometry import Polygon, box
from shapely.geometry.base import BaseGeometry

from geotween.data.polygons import Feature, PolygonSet, polygon_set
from geotween.motion.techniques import Techniques, resolve

Random = np.random.Generator
Floats = NDArray[np.float64]
Polygons = list[Polygon]
Transition = tuple[Polygons, Polygons]

CELLS = 200  # along each side of the field whose contours are fires


def stars(random: Random) -> Transition:
    """One rough star-shaped outline to another, of other vertices."""
    return [_star(random)], [_star(random, 1.0, *random.uniform(-0.5, 0.5, 2))]


def combs(random: Random) -> Transition:
    """A comb to one of other teeth, somewhat turned."""
    turn = float(random.uniform(-40, 40))
    return [_comb(random)], [rotate(_comb(random), turn, "centroid")]


def coasts(random: Random) -> Transition:
    """Land with a rough coast, in which a bay has moved; all else is common to both."""
    count = int(random.integers(20, 200))
    x = np.linspace(0, 10, count)
    y = 5 + np.interp(x, np.linspace(0, 10, 9), random.uniform(-0.5, 0.5, 9))
    y += random.uniform(-0.15, 0.15, count) * 20 / count
    land = Polygon([(10, 0), (0, 0), *np.column_stack([x, y]).tolist()][::-1])
    bays = [_bay(random, x) for x in random.uniform([2, 5.5], [4.5, 8])]
    return [_largest(land.difference(bays[0]))], [_largest(land.difference(bays[1]))]


def bordering(random: Random) -> Transition:
    """A grid of cells that are the same ones at both ends; their inner corners move."""
    count = int(random.integers(2, 6))
    corners = np.stack(np.meshgrid(*[np.arange(count + 1.0)] * 2, indexing="ij"), axis=-1)
    return _stirred(corners, random), _stirred(corners, random)


def fires(random: Random) -> Transition:
    """A rough perimeter to the one it grows to on one side; some 1,300 vertices in all."""
    x, y = np.meshgrid(*[np.linspace(-2, 2, CELLS)] * 2)
    field = 1 - np.hypot(x, y) + 0.5 * _rough(random, 0.62)
    wind = random.uniform(0, 2 * np.pi)
    ahead = np.clip(x * np.cos(wind) + y * np.sin(wind) + 0.5 * _rough(random, 0.5), 0, None)
    return [_contour(x, y, field)], [_contour(x, y, field + 0.3 * ahead)]


def _star(random: Random, size: float = 1.0, x: float = 0.0, y: float = 0.0) -> Polygon:
    count = int(random.integers(8, 60))
    angle = (np.arange(count) + random.uniform(-0.4, 0.4, count)) / count * 2 * np.pi
    return _polar(angle, size * random.uniform(0.5, 1.0, count), x, y)


def _smooth(random: Random, size: float, x: float = 0.0, y: float = 0.0) -> Polygon:
    """An outline of three lobes or so."""
    angle = np.linspace(0, 2 * np.pi, int(random.integers(12, 50)), endpoint=False)
    height, phase = random.uniform(0, [[0.12], [2 * np.pi]], (2, 3))
    waves = np.cos(np.outer(angle, [2, 3, 4]) + phase) @ height
    return _polar(angle, size * (1 + waves), x, y)


def _polar(angle: Floats, radius: Floats, x: float = 0.0, y: float = 0.0) -> Polygon:
    return Polygon(np.column_stack([x + radius * np.cos(angle), y + radius * np.sin(angle)]))


def _comb(random: Random) -> Polygon:
    teeth = int(random.integers(3, 10))
    left = np.arange(teeth) + random.uniform(0.1, 0.3, teeth)
    right = left + random.uniform(0.3, 0.6, teeth)
    top, bottom = random.uniform(2, 6, teeth), np.ones(teeth)
    edge = np.stack([left, bottom, left, top, right, top, right, bottom], axis=1).reshape(-1, 2)
    scale = np.array([8 / teeth, 1])
    return Polygon(np.vstack([[[0, 0], [0, 1]], edge, [[teeth, 1], [teeth, 0]]]) * scale)


def _spiral(random: Random) -> Polygons:
    """A band of some windings."""
    turns, count = random.uniform(0.8, 2.5), int(random.integers(20, 80))
    angle = np.linspace(0, 2 * np.pi * turns, count)
    middle, half = 1 + angle / (2 * np.pi), random.uniform(0.15, 0.35)
    angle = np.concatenate([angle, angle[::-1]]) + random.uniform(0, 1)
    return [_polar(angle, np.concatenate([middle + half, (middle - half)[::-1]]))]


def _crescent(random: Random) -> Polygons:
    """A moon that opens anywhere within a quarter turn."""
    disc = shapely.Point(0, 0).buffer(1, quad_segs=int(random.integers(4, 20)))
    bite = shapely.Point(random.uniform(0.3, 0.8), 0).buffer(random.uniform(0.6, 0.95))
    return [rotate(_largest(disc.difference(bite)), float(random.uniform(0, 90)), (0, 0))]


def _bay(random: Random, x: float) -> Polygon:
    deep, wide = random.uniform([1.5, 0.5], [4, 1.5])
    return Polygon([(x - wide / 2, 9), (x - wide, deep), (x + wide, deep), (x + wide / 2, 9)])


def _holed(random: Random) -> Polygons:
    """A smooth outline with lakes, anywhere in it."""
    shell = _smooth(random, 4.0)
    places = random.uniform(-2, 2, (int(random.integers(1, 5)), 2))
    lakes = [_smooth(random, random.uniform(0.2, 0.8), *place) for place in places]
    return [_largest(shell.difference(shapely.union_all(lakes)))]


def _nested(random: Random) -> Polygons:
    """An island in a lake, in which lies another lake."""
    sizes = np.array([4, 2.6, 1.6, 0.8]) * random.uniform(0.85, 1.15, 4)
    sea, lake, land, pond = (_smooth(random, size) for size in sizes)
    lake = lake.intersection(sea.buffer(-0.2))
    land = land.intersection(lake.buffer(-0.2))
    pond = pond.intersection(land.buffer(-0.2))
    return [sea.difference(lake), land.difference(pond)]


def _tiling(random: Random) -> Polygons:
    """A square in convex cells, whose keys nobody knows."""
    square, seeds = box(0, 0, 10, 10), random.uniform(0, 10, (int(random.integers(2, 9)), 2))
    cells = shapely.voronoi_polygons(shapely.MultiPoint(seeds), extend_to=square)
    return list(shapely.intersection(shapely.get_parts(cells), square))


def _stirred(corners: Floats, random: Random) -> Polygons:
    c = corners.copy()
    c[1:-1, 1:-1] += random.uniform(-0.4, 0.4, c[1:-1, 1:-1].shape)
    quads = np.stack([c[:-1, :-1], c[1:, :-1], c[1:, 1:], c[:-1, 1:]], axis=2).reshape(-1, 4, 2)
    return list(shapely.polygons(quads))


def _islands(random: Random) -> Polygons:
    """Rough islands apart from each other, and in other places each time."""
    places = random.uniform(0, 10, (int(random.integers(2, 8)), 2))
    area = shapely.union_all([_star(random, random.uniform(0.7, 2.5), *p) for p in places])
    return [part for part in shapely.get_parts(area) if part.area > 1e-3]


def _rough(random: Random, fade: float) -> Floats:
    """Noise from -1 to 1, or so: grids of 4, 8, 16 ... cells, each fainter than the one before."""
    found = np.zeros((CELLS, CELLS))
    for level in range(2, 8):
        grid, at = random.uniform(-1, 1, (2**level + 1,) * 2), np.linspace(0, 2**level, CELLS)
        rows = np.array([np.interp(at, np.arange(len(grid)), row) for row in grid])
        columns = np.array([np.interp(at, np.arange(len(grid)), column) for column in rows.T])
        found += fade ** (level - 1) * columns
    return found


def _contour(x: Floats, y: Floats, field: Floats) -> Polygon:
    """The outer ring of the largest region where a field is positive."""
    lines = contourpy.contour_generator(x, y, field).lines(0.0)
    return max((Polygon(line) for line in lines if len(line) > 3), key=lambda ring: ring.area)


def _largest(area: BaseGeometry) -> Polygon:
    parts = shapely.get_parts(area)
    return parts[np.argmax(shapely.area(parts))]


def _twice(make: Callable[[Random], Polygons]) -> Callable[[Random], Transition]:
    return lambda random: (make(random), make(random))


FAMILIES: Mapping[str, Callable[[Random], Transition]] = {
    "stars": stars, "combs": combs, "spirals": _twice(_spiral), "crescents": _twice(_crescent),
    "coasts": coasts, "fires": fires, "holed": _twice(_holed), "nested": _twice(_nested),
    "archipelagos": _twice(_islands), "tilings": _twice(_tiling), "bordering": bordering,
}  # fmt: skip

# Where the polygons of both ends are the same things in order; elsewhere none has a key.
KEYED = frozenset({"bordering"})


def made(family: str, seed: int) -> tuple[PolygonSet, PolygonSet]:
    """A transition of a family; the same for the same seed."""
    keyed = family in KEYED
    origin, target = (
        polygon_set(Feature(p, key=k if keyed else None) for k, p in enumerate(polygons))
        for polygons in FAMILIES[family](np.random.default_rng(seed))
    )
    return origin, target


def techniques(family: str, matching: str | None = None) -> Techniques:
    """The default ones, by key where there are keys; or those of a morph by one matching."""
    method = "morph" if matching else "auto"
    return resolve(method, "key" if family in KEYED else None, matching=matching)
