"""The experiments' polygons: made by seeded code, of the kinds that the paper's figures have."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.affinity import rotate, translate
from shapely.geometry import Polygon

Random = np.random.Generator
Floats = NDArray[np.float64]
Polygons = list[Polygon]
Transition = tuple[Polygons, Polygons]

RADIUS = 10.0  # of a blob, in units of the drawings
BAYS = 4
# Islands and parts keep this share of their Voronoi cell's inner radius, so that water remains.
SHORE = 0.9
STEP, STRAY = 0.14, 0.02  # of shores: from vertex to vertex, and how far these stray, in radii
CELLS = 90  # along each side of a hotspots' density


def rough(random: Random, radius: float, count: int = 48, height: float = 0.12) -> Polygon:
    """A rough outline about (0, 0): five waves, and vertices that stray."""
    angle = (np.arange(count) + random.uniform(-0.3, 0.3, count)) / count * 2 * np.pi
    waves = np.arange(2, 7)
    phase, tall = random.uniform(0, 2 * np.pi, 5), random.uniform(0.3, 1, 5) / waves
    lift = 2 * height * np.sin(np.outer(angle, waves) + phase) @ tall
    distance = radius * np.exp(lift + random.uniform(-0.02, 0.02, count))
    return Polygon(distance[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]))


def concave(random: Random, bays: int = BAYS) -> Polygon:
    """A rough blob with bays that reach far into it."""
    land = rough(random, RADIUS, 72)
    turn = random.uniform(0, 2 * np.pi)
    for k in range(bays):
        angle = turn + 2 * np.pi * (k + random.uniform(-0.2, 0.2)) / bays
        deep, wide = random.uniform([0.3, 0.06], [0.5, 0.12]) * RADIUS
        way = np.array([np.cos(angle), np.sin(angle)])
        side = wide * np.array([-way[1], way[0]])
        mouth = [(1.3 * RADIUS * way + k * side).tolist() for k in (-2.5, 2.5)]
        bay = Polygon(
            [(deep * way - 0.4 * side).tolist(), (deep * way + side).tolist(), *mouth[::-1]]
        )
        land = largest(land.difference(_shaken(random, bay)))
    return land


def parts(random: Random, land: Polygon, count: int) -> Polygons:
    """What becomes of land that comes apart: its cells about spread places, rough and smaller."""
    cells = shapely.voronoi_polygons(
        shapely.MultiPoint(spread(random, land, count)), extend_to=land
    )
    found = []
    for cell in shapely.intersection(shapely.get_parts(cells), land):
        shore = shapely.buffer(cell, -random.uniform(0.04, 0.08) * RADIUS, join_style="mitre")
        found.append(_shaken(random, largest(shore)))
    return found


def islands(random: Random, land: Polygon, count: int) -> Polygons:
    """Rough islands, one about each of some places in the land; some reach beyond it."""
    places = spread(random, land, count)
    gaps = np.hypot(*(places[:, None] - places[None]).T) + np.diag(np.full(count, np.inf))
    room = np.minimum(gaps.min(axis=1) / 2, 0.45 * RADIUS)
    sizes = SHORE * room * random.uniform(0.7, 0.95, count)
    return [
        translate(rough(random, size, 28), *place)
        for size, place in zip(sizes.tolist(), places.tolist(), strict=True)
    ]


def spread(random: Random, land: Polygon, count: int) -> Floats:
    """Places (count, 2) in the land, each the farthest from those before it among a few."""
    low_x, low_y, high_x, high_y = land.bounds
    tries = random.uniform([low_x, low_y], [high_x, high_y], (400, 2))
    tries = tries[shapely.contains_xy(land.buffer(-0.03 * RADIUS), *tries.T)]
    chosen = [0]
    for _ in range(count - 1):
        distance = np.hypot(*(tries[:, None] - tries[chosen][None]).T).min(axis=0)
        distance *= random.uniform(0.7, 1, len(tries))
        chosen.append(int(distance.argmax()))
    return tries[chosen]


def one_to_four(seed: int) -> Transition:
    """A concave blob that comes apart into four."""
    random = np.random.default_rng([1, seed])
    land = concave(random)
    return [land], parts(random, land, 4)


def archipelago(seed: int) -> Transition:
    """A blob that becomes nine islands."""
    random = np.random.default_rng([2, seed])
    land = concave(random, 2)
    return [land], islands(random, land, 9)


def drifted(seed: int) -> Transition:
    """A blob whose parts have moved on: what is common is small."""
    random = np.random.default_rng([3, seed])
    land = concave(random)
    way = random.uniform(0.15, 0.3) * RADIUS
    angle = random.uniform(0, 2 * np.pi)
    moved = [
        translate(part, way * np.cos(angle), way * np.sin(angle))
        for part in parts(random, land, int(random.integers(3, 6)))
    ]
    return [land], moved


def many_to_many(seed: int) -> Transition:
    """Two sets of rough polygons that overlap across each other."""
    random = np.random.default_rng([4, seed])
    land = concave(random, 2)
    turned = rotate(land, random.uniform(10, 25), (0, 0))
    return parts(random, land, 4), parts(random, turned, 5)


def hotspots(seed: int) -> Transition:
    """Where incidents are dense in two periods: contours of a few bumps that drift."""
    from contourpy import FillType, contour_generator

    random = np.random.default_rng([5, seed])
    x, y = np.meshgrid(*[np.linspace(-1.6, 1.6, CELLS) * RADIUS] * 2)
    places = random.uniform(-0.9, 0.9, (7, 2)) * RADIUS
    sizes, weights = random.uniform(0.18, 0.4, 7) * RADIUS, random.uniform(0.6, 1.3, 7)
    found = []
    for _ in range(2):
        density = sum(
            weight * np.exp(-((x - a) ** 2 + (y - b) ** 2) / 2 / size**2)
            for weight, (a, b), size in zip(weights, places, sizes, strict=True)
        )
        contours = contour_generator(x, y, density, fill_type=FillType.OuterOffset)
        found.append(
            [
                shapely.simplify(Polygon(rings[0], rings[1:]), 0.01 * RADIUS)
                for points, offsets in zip(*contours.filled(0.55, np.inf), strict=True)
                for rings in [np.split(points, offsets[1:-1])]
            ]
        )
        places = places + random.normal(0, 0.22, places.shape) * RADIUS
        weights = weights * random.uniform(0.7, 1.3, 7)
    return found[0], found[1]


def blob_to_bays(random: Random) -> Transition:
    return [rough(random, RADIUS, 40)], [concave(random)]


def combs(random: Random) -> Transition:
    return [_comb(random, 5)], [rotate(_comb(random, 7), 25, "centroid")]


def crescents(random: Random) -> Transition:
    moon = rough(random, RADIUS, 60, 0.03).difference(
        translate(rough(random, 0.8 * RADIUS, 50, 0.03), 0.55 * RADIUS)
    )
    return [largest(moon)], [rotate(largest(moon), 100, (0, 0))]


def lakes(random: Random) -> Transition:
    """Land with lakes: one that grows, one that closes, two that open."""
    ends = []
    for places in ([(-4.0, 1.0, 2.0), (3.5, -3.0, 1.5)], [(-3.0, 1.5, 3.0), (2.5, 4.5, 1.4)]):
        land: shapely.Geometry = rough(random, RADIUS, 48)
        for x, y, size in places:
            land = shapely.difference(land, translate(rough(random, size, 20), x, y))
        ends.append([largest(land)])
    return ends[0], ends[1]


def fire(random: Random) -> Transition:
    """A rough perimeter that grows on one side, around ground that does not burn."""
    burnt = rough(random, 0.55 * RADIUS, 60)
    head = translate(rough(random, 0.65 * RADIUS, 60), 0.5 * RADIUS, 0.25 * RADIUS)
    rock = translate(rough(random, 0.16 * RADIUS, 20), 0.72 * RADIUS, 0.5 * RADIUS)
    return [burnt], [largest(burnt.union(head).difference(rock.difference(burnt)))]


def coast(random: Random) -> Transition:
    """Land in which a bay has silted up and another one has been cut."""
    land = rough(random, RADIUS, 90)
    bays = [
        _shaken(random, Polygon([(x - 1, -1), (x + 1, -2), (x + 3, 12), (x - 3, 12)]))
        for x in (-3.5, 3.5)
    ]
    return [largest(land.difference(bays[0]))], [largest(land.difference(bays[1]))]


def storm(random: Random) -> Transition:
    """A shape that travels by three quarters of its width, and hardly changes."""
    cloud = rough(random, 0.5 * RADIUS, 40)
    return [cloud], [translate(rotate(cloud, 15), 0.8 * RADIUS, 0.35 * RADIUS)]


def kinds(random: Random) -> Mapping[str, Transition]:
    """The five kinds of Kim and Cova (2007): how polygons at two times may be each other."""
    land, larger = rough(random, 0.6 * RADIUS), rough(random, 0.85 * RADIUS)
    halves = parts(random, larger, 3)
    return {
        "one to one": ([land], [larger]),
        "one to many": ([larger], halves),
        "many to one": (halves, [larger]),
        "none to one": ([], [land]),
        "one to none": ([land], []),
    }


FAMILIES: Mapping[str, Callable[[int], Transition]] = {
    "one to four": cache(one_to_four),
    "archipelago": cache(archipelago),
    "drifted": cache(drifted),
    "many to many": cache(many_to_many),
    "hotspots": cache(hotspots),
}

PAIRS: Mapping[str, Callable[[Random], Transition]] = {
    "blob, bays": blob_to_bays, "combs": combs, "crescents": crescents, "lakes": lakes,
}  # fmt: skip
IN_PLACE: Mapping[str, Callable[[Random], Transition]] = {
    "fire": fire, "coast": coast, "storm": storm,
}  # fmt: skip


def _comb(random: Random, teeth: int) -> Polygon:
    width = 1.8 * RADIUS / teeth
    places = [(0.0, -0.3 * RADIUS)]
    for k in range(teeth):
        left, top = k * width, random.uniform(0.4, 1.1) * RADIUS
        places += [(left, top), (left + 0.55 * width, top)]
        places += [(left + 0.55 * width, 0.0), (left + width, 0.0)]
    return Polygon([*places, (teeth * width, -0.3 * RADIUS)])


def _shaken(random: Random, shape: Polygon) -> Polygon:
    """A polygon whose edges are parted and strayed, as a shore's are."""
    places = shapely.get_coordinates(shapely.segmentize(shape.exterior, STEP * RADIUS))[:-1]
    return largest(
        shapely.make_valid(Polygon(places + random.normal(0, STRAY * RADIUS, places.shape)))
    )


def largest(shape: shapely.Geometry) -> Polygon:
    """The largest part of a shape."""
    found = shapely.get_parts(shape)
    best: Polygon = found[np.argmax(shapely.area(found))]
    return best
