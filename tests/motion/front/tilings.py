"""Seeded tilings of a square whose tiles have keys, what becomes of them, and looks at frames."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import count
from typing import TypeVar

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from geotween.data.polygons import Feature, Identity, PolygonSet, polygon_set
from geotween.motion import looks
from geotween.motion.looks import rebuilt
from geotween.motion.tracks import Track

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Objects = NDArray[np.object_]
Transition = tuple[PolygonSet, PolygonSet]
Ends = tuple[Identity, Identity]
Geometry = BaseGeometry
Name = TypeVar("Name", bound=Hashable)

SIZE = 100.0
SQUARE = shapely.box(0, 0, SIZE, SIZE)

# An enclave is its host's cell in small: so much of its width.
ENCLAVE = 0.45

# Parts nearer than this share of the width of a shape touch.
TOUCH = 1e-7


def moving(seed: int, number: int, step: float = 0.3) -> Transition:
    """Voronoi cells whose seeds move by ``step`` of the mean width of a cell, or so."""
    return keyed(seed, number, kinds=(), step=step, share=1.0)


def keyed(
    seed: int,
    number: int,
    kinds: Iterable[str] | None = None,
    step: float = 0.3,
    share: float = 0.3,
) -> Transition:
    """Voronoi cells that change hands; a share of their seeds moves, too.

    Each of ``kinds``, by default all of ``KINDS``, happens to a tenth of the cells, or to two.
    """
    random = np.random.default_rng(seed)
    here = random.uniform(0, SIZE, (number, 2))
    way = random.normal(0, step * SIZE / np.sqrt(number), (number, 2))
    there = np.where(random.random((number, 1)) < share, here + way, here)
    there = np.clip(there, 1e-3 * SIZE, (1 - 1e-3) * SIZE)
    owners = _Owners.of(number)
    pairs = iter(_neighbours(random, here))
    for kind in KINDS if kinds is None else kinds:
        for _, pair in zip(range(max(number // 20, 1)), pairs, strict=False):
            KINDS[kind](owners, *pair)
    return _owned(here, owners.before, owners.within[0]), _owned(
        there, owners.after, owners.within[1]
    )


def cells(seeds: Floats) -> Objects:
    """The Voronoi cells (n,) of seeds (n, 2) in the square; neighbours share vertices exactly."""
    edges = shapely.voronoi_polygons(
        shapely.multipoints(seeds), extend_to=SQUARE.buffer(SIZE), only_edges=True
    )
    lines = shapely.get_parts(shapely.union_all(np.array([edges, SQUARE.boundary])))
    faces = shapely.get_parts(shapely.polygonize(lines))
    place, face = shapely.STRtree(faces).query(shapely.points(seeds), predicate="within")
    assert np.array_equal(place, np.arange(len(seeds)))
    return np.asarray(faces[face])


@dataclass(frozen=True)
class _Owners:
    """Whose each cell is at both ends, and whose the enclave within it is, by cell."""

    before: list[int]
    after: list[int]
    new: Iterable[int]
    within: tuple[dict[int, int], dict[int, int]] = field(default_factory=lambda: ({}, {}))

    @classmethod
    def of(cls, number: int) -> _Owners:
        return cls(list(range(number)), list(range(number)), count(number))

    def named(self) -> int:
        """A name that nobody has yet."""
        return next(iter(self.new))


def _breaks_up(owners: _Owners, one: int, other: int) -> None:
    owners.before[one] = owners.before[other] = owners.named()


def _joins(owners: _Owners, one: int, other: int) -> None:
    owners.after[one] = owners.after[other] = owners.named()


def _parts(owners: _Owners, one: int, other: int) -> None:
    """The other one was a part of the first, which lives on."""
    owners.before[other] = one


def _annexed(owners: _Owners, one: int, other: int) -> None:
    owners.after[other] = one


def _swaps(owners: _Owners, one: int, other: int) -> None:
    owners.after[one], owners.after[other] = other, one


def _loses_enclave(owners: _Owners, one: int, other: int) -> None:
    owners.within[0][other] = one


def _gains_enclave(owners: _Owners, one: int, other: int) -> None:
    owners.within[1][other] = one


KINDS: Mapping[str, Callable[[_Owners, int, int], None]] = {
    "breaks up": _breaks_up, "joins": _joins, "parts": _parts, "annexed": _annexed,
    "swaps": _swaps, "loses enclave": _loses_enclave, "gains enclave": _gains_enclave,
}  # fmt: skip


def _neighbours(random: np.random.Generator, seeds: Floats) -> list[tuple[int, int]]:
    """Pairs of neighbours, by chance, so many that no more can be; no cell is in two."""
    from scipy.spatial import Delaunay

    corners = Delaunay(seeds).simplices
    edges = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
    free = np.ones(len(seeds), dtype=bool)
    found = []
    for one, other in random.permutation(edges).tolist():
        if free[one] and free[other]:
            free[[one, other]] = False
            found.append((one, other))
    return found


def _owned(seeds: Floats, owners: Sequence[int], within: Mapping[int, int]) -> PolygonSet:
    """The tiles of cells that one owns together."""
    faces = cells(seeds)
    theirs: dict[int, list[shapely.Polygon]] = {}
    for cell, owner in enumerate(owners):
        face = faces[cell]
        if cell in within:
            middle = np.array(face.centroid.coords[0])
            ring = middle + ENCLAVE * (shapely.get_coordinates(face) - middle)
            theirs.setdefault(within[cell], []).append(shapely.Polygon(ring))
            face = shapely.Polygon(face.exterior, [ring])
        theirs.setdefault(owner, []).append(face)
    return polygon_set(
        Feature(united, key=f"k{owner}")
        for owner, parts in sorted(theirs.items())
        for united in [shapely.coverage_union_all(parts)]
        if isinstance(united, shapely.Polygon | shapely.MultiPolygon)
    )


# Looks at frames.


def polygons_at(tracks: Sequence[Track], t: float) -> tuple[Objects, list[Ends]]:
    """The polygons (n,) drawn at t, and whose they are at both ends; invalid ones are mended."""
    there = [track for track in tracks if track.is_there(t)]
    return rebuilt(looks.polygons_at(there, t)), [track.ends for track in there]


def regions_at(tracks: Sequence[Track], t: float) -> dict[Ends, Geometry]:
    """Where each thing of a motion is at t, by whose it is at both ends."""
    polygons, names = polygons_at(tracks, t)
    return _united(polygons, names)


def territories_at(tracks: Sequence[Track], t: float, end: int) -> dict[Identity, Geometry]:
    """Where at t all is that is of one owner at an end, 0 or 1."""
    polygons, names = polygons_at(tracks, t)
    return _united(polygons, [ends[end] for ends in names])


def _united(polygons: Objects, names: Sequence[Name]) -> dict[Name, Geometry]:
    places: dict[Name, list[int]] = {}
    for place, name in enumerate(names):
        places.setdefault(name, []).append(place)
    return {name: shapely.union_all(polygons[mine]) for name, mine in places.items()}


def twice_and_bare(polygons: Objects, area: float) -> tuple[float, float]:
    """What polygons cover twice, and what of an area they leave bare, as shares of the area."""
    covered = shapely.area(shapely.union_all(polygons))
    twice = shapely.area(polygons).sum() - covered
    return max(0.0, twice / area), max(0.0, (area - covered) / area)


def retreat(now: Geometry, then: Geometry, end: Geometry) -> float:
    """The area that a shape leaves though it is in the end, or enters though it is not."""
    left = shapely.intersection(shapely.difference(now, then), end)
    entered = shapely.difference(shapely.difference(then, now), end)
    return float(shapely.area(left) + shapely.area(entered))


def islands(now: Geometry, root: Geometry, other: Geometry) -> list[float]:
    """The areas of the parts of a shape that do not hang together with its root.

    The root is where it was at first, or will be at last: islands are ahead of a front, or left
    behind it. A part has area in common with the root, or lies in a part of the other end that
    has none: it is born, or ends, on its own. Parts that touch in a point are one.
    """
    if shapely.get_num_geometries(now) < 2:
        return []
    reach = TOUCH * np.ptp(np.reshape(shapely.bounds(now), (2, 2)), axis=0).max()
    parts = shapely.get_parts(shapely.buffer(now, reach, quad_segs=1))
    of_its_own = shapely.get_parts(other)
    of_its_own = of_its_own[~_meet(of_its_own, root)]
    explained = shapely.union_all([root, *of_its_own])
    lone = parts[~_meet(shapely.buffer(parts, -2 * reach), explained)]
    return [area for area in shapely.area(shapely.buffer(lone, -2 * reach)).tolist() if area > 0]


def beyond(one: Geometry, other: Geometry) -> float:
    """The area of a shape outside another one; either of GEOS's overlays may fail, not both."""
    return min((one - other).area, (one | other).area - other.area)


def unlikeness(
    one: Sequence[Track],
    other: Sequence[Track],
    times: Iterable[tuple[float, float]],
    back: Floats | None = None,
) -> tuple[float, float]:
    """How much things differ at some times: area in one of them only, and areas; as shares."""
    elsewhere, off = 0.0, 0.0
    for t, u in times:
        here = {(ends[0].key, ends[1].key): shape for ends, shape in regions_at(one, t).items()}
        there = {(ends[0].key, ends[1].key): shape for ends, shape in regions_at(other, u).items()}
        assert here.keys() == there.keys()
        whole = sum(shape.area for shape in here.values())
        shapes = [
            (shape, there[name])
            if back is None
            else (shape, shapely.transform(there[name], lambda points: points @ back).buffer(0))
            for name, shape in here.items()
        ]
        elsewhere = max(elsewhere, sum((a ^ b).area for a, b in shapes) / whole)
        off = max(off, sum(abs(a.area - b.area) for a, b in shapes) / whole)
    return elsewhere, off


def _meet(parts: Objects, whole: Geometry) -> NDArray[np.bool_]:
    """Which of some parts have area in common with a shape."""
    return np.asarray(shapely.relate_pattern(parts, whole, "T********"))
