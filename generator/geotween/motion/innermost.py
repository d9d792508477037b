"""The innermost point of a polygon: the one farthest from its boundary.

1. Each polygon is laid into a frame of its own: its centroid at 0, its farthest vertex at 1.
2. Cells that may hold a point as deep as one already known are parted until they are small.
3. From the deepest of neighbouring cells, linear programs climb to the top, exactly; where the
   way leads on at the same depth, towards the centroid (``climb.py``).
4. Of tops that are equally deep the one nearest to the centroid is taken.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.motion.ascent import Edges, climb

Floats = NDArray[np.float64]
Points = NDArray[np.complex128]  # x + iy
Numbers = NDArray[np.intp]
Objects = NDArray[np.object_]

# Depths are equal that differ by less than this share of the depth, and distances by less than
# this share of the size: what was turned, or rounded to a grid, is not equal to the bit.
EQUAL = 1e-6

# Rounding: vertices whose distances from the centroid differ by less, relative to it, are equally
# far, and a polygon that misses less of its hull is convex.
ROUNDING = 1e-9

# At first cells are half as wide as the box, or this share of its length if that is more. They are
# parted until their half side is this share of the depth; once to know how deep the deepest is, and
# once to find what is as deep. A polygon with more cells than ``MANY`` has them parted no more.
COARSE, FINE = 1 / 32, (0.1, 0.005)
MANY = 3000

# How near to the greatest depth the one known at first is: that saves cells, and no more.
KNOWN = 0.01

# So many polygons are treated at once, for the memory's sake.
BATCH = 1000


def innermost(polygons: Objects) -> Floats:
    """The point of each polygon that is farthest from its boundary.

    It turns, is reflected and grows with the polygon. Where several points are equally far, the
    one nearest to the centroid is taken; where a symmetric shape leaves several, the one nearest to
    its first vertex.

    Parameters
    ----------
    polygons
        Valid polygons in planar coordinates, shape (n,).

    Returns
    -------
    Points (n, 2) within the polygons. None is farther from the boundary by more than 1e-6; tops
    nearer to each other than 1% of that may be taken for one.

    Cells are searched as by polylabel (Agafonkin 2016), for all polygons at once. Cost: the
    vertices of a polygon times its cells, of which slender ones have more.
    """
    batches = range(0, len(polygons), BATCH)
    parts = [_innermost(polygons[start : start + BATCH]) for start in batches]
    return np.concatenate([np.empty((0, 2)), *parts])


def _innermost(polygons: Objects) -> Floats:
    centres = _complex(shapely.get_coordinates(shapely.centroid(polygons)))
    ways = _farthest(polygons, centres)
    laid = _laid(polygons, centres, ways)
    area, edges = _Area.of(laid), _edges_of(laid)
    first = _climbed(area, edges, FINE[0])
    last = _climbed(area.with_known(first), edges, FINE[1])
    owner = np.concatenate([first.owner, last.owner])
    order = np.argsort(owner, kind="stable")
    tops = np.concatenate([first.places, last.places])[order]
    depths = np.concatenate([first.depths, last.depths])[order]
    best = _best(owner[order], tops, depths, _first_vertices(laid))
    return _pairs(centres + ways * tops[best])


@dataclass(frozen=True, eq=False)
class _Tops:
    """Tops of polygons: whose they are, where, and how deep; (n,) each."""

    owner: Numbers
    places: Points
    depths: Floats


def _climbed(area: _Area, edges: Edges, fine: float) -> _Tops:
    owner, starts = _starts(area, fine)
    return _Tops(owner, *climb(edges, owner, starts, EQUAL * area.known[owner]))


def _farthest(polygons: Objects, centres: Points) -> Points:
    """The ways from the centroids to the vertices farthest from them."""
    points, owner = shapely.get_coordinates(polygons, return_index=True)
    ways = _complex(points) - centres[owner]
    far = np.abs(ways)
    most = np.maximum.reduceat(far, np.searchsorted(owner, np.arange(len(polygons))))
    places = np.flatnonzero(far >= (1 - ROUNDING) * most[owner])
    return np.asarray(ways[places[np.unique(owner[places], return_index=True)[1]]])


def _laid(polygons: Objects, centres: Points, ways: Points) -> Objects:
    points, owner = shapely.get_coordinates(polygons, return_index=True)
    laid = (_complex(points) - centres[owner]) / ways[owner]
    return np.asarray(shapely.set_coordinates(polygons.copy(), _pairs(laid)))


def _first_vertices(polygons: Objects) -> Points:
    rings = shapely.get_exterior_ring(polygons)
    return _complex(shapely.get_coordinates(shapely.get_point(rings, 0)))


def _edges_of(polygons: Objects) -> Edges:
    rings, owner = shapely.get_rings(polygons, return_index=True)
    points, ring = shapely.get_coordinates(rings, return_index=True)
    first = np.flatnonzero(ring[1:] == ring[:-1])
    vertices = _complex(points)
    counts = np.bincount(owner[ring[first]], minlength=len(polygons))
    return Edges(vertices[first], vertices[first + 1], np.concatenate([[0], np.cumsum(counts)]))


@dataclass(frozen=True, eq=False)
class _Area:
    """Polygons, their boundaries, which are convex, and a depth that some point of each has."""

    polygons: Objects
    borders: Objects
    convex: NDArray[np.bool_]
    known: Floats

    @classmethod
    def of(cls, polygons: Objects) -> _Area:
        shapely.prepare(polygons)
        borders = shapely.boundary(polygons)
        # Some point is as deep as the area divided by the boundary's length.
        known = shapely.area(polygons) / shapely.length(borders)
        convex = shapely.area(shapely.convex_hull(polygons)) <= (1 + ROUNDING) * shapely.area(
            polygons
        )
        circles = shapely.maximum_inscribed_circle(polygons[~convex], KNOWN * known[~convex])
        known[~convex] = shapely.length(circles)
        return cls(polygons, borders, convex, known)

    def with_known(self, tops: _Tops) -> _Area:
        """The same, when some tops are known; others are as deep that are all but so."""
        known = self.known.copy()
        np.maximum.at(known, tops.owner, (1 - EQUAL) * tops.depths)
        return replace(self, known=known)

    def depth(self, owner: Numbers, points: Points) -> Floats:
        """How far points lie from the boundary of a polygon; negative outside."""
        x, y = points.real, points.imag
        far = shapely.distance(self.borders[owner], shapely.points(x, y))
        return np.where(shapely.contains_xy(self.polygons[owner], x, y), far, -far)


@dataclass(frozen=True, eq=False)
class _Cells:
    """Squares: whose they are, column and row in that polygon's grid, and half a side."""

    owner: Numbers
    grid: Points  # the lower left corner of the polygon's grid
    column: Numbers
    row: Numbers
    half: Floats

    @property
    def middle(self) -> Points:
        return self.grid + (2 * self.column + 1 + 1j * (2 * self.row + 1)) * self.half

    def chosen(self, which: NDArray[np.bool_]) -> _Cells:
        return _Cells(*(getattr(self, name)[which] for name in self.__dataclass_fields__))

    def parted(self) -> _Cells:
        """The four quarters of each."""
        four = _Cells(*(np.repeat(getattr(self, name), 4) for name in self.__dataclass_fields__))
        right, up = np.tile([[0, 1, 0, 1], [0, 0, 1, 1]], len(self.owner))
        return replace(
            four, column=2 * four.column + right, row=2 * four.row + up, half=four.half / 2
        )


def _grid(area: _Area) -> _Cells:
    """The cells at first: they cover the polygons' boxes."""
    boxes = shapely.bounds(area.polygons)
    size = boxes[:, 2:] - boxes[:, :2]
    side = np.maximum(size.min(axis=1) / 2, size.max(axis=1) * COARSE)
    shape = np.ceil(size / side[:, None]).astype(np.intp)
    columns, rows = shape.T
    counts = columns * rows
    owner = np.repeat(np.arange(len(boxes)), counts)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    return _Cells(
        owner,
        _complex((boxes[:, :2] + boxes[:, 2:]) / 2 - side[:, None] * shape / 2)[owner],
        number % columns[owner],
        number // columns[owner],
        side[owner] / 2,
    )


def _starts(area: _Area, fine: float) -> tuple[Numbers, Points]:
    """Points to climb from, at least one a polygon, and whose they are."""
    # What is convex has one top, to be reached from anywhere.
    owners = [np.flatnonzero(area.convex)]
    points = [np.zeros(len(owners[0]), dtype=np.complex128)]
    cells = _grid(area)
    cells = cells.chosen(~area.convex[cells.owner])
    while len(cells.owner):
        depth = area.depth(cells.owner, cells.middle)
        held = depth + np.sqrt(2) * cells.half >= area.known[cells.owner]
        cells, depth = cells.chosen(held), depth[held]
        small = cells.half <= fine * area.known[cells.owner]
        small |= (np.bincount(cells.owner) > MANY)[cells.owner]
        done = cells.chosen(small)
        peak = _peaks(done, depth[small])
        owners.append(done.owner[peak])
        points.append(done.middle[peak])
        cells = cells.chosen(~small).parted()
    return np.concatenate(owners), np.concatenate(points)


def _peaks(cells: _Cells, depth: Floats) -> NDArray[np.bool_]:
    """Which cells are deeper than the eight around them; of equally deep ones, those further in."""
    rank = np.empty(len(depth), dtype=np.intp)
    rank[np.lexsort((-np.abs(cells.middle), depth))] = np.arange(len(depth))
    wide = int(cells.column.max(initial=0)) + 3
    high = int(cells.row.max(initial=0)) + 3
    code = (cells.owner * high + cells.row + 1) * wide + cells.column + 1
    order = np.argsort(code)
    peak = depth > 0
    for step in (-wide - 1, -wide, -wide + 1, -1, 1, wide - 1, wide, wide + 1):
        place = np.searchsorted(code, code + step, sorter=order)
        other = order[np.minimum(place, len(code) - 1)] if len(code) else place
        peak &= (code[other] != code + step) | (rank[other] < rank)
    return peak


def _best(owner: Numbers, tops: Points, depths: Floats, first: Points) -> Numbers:
    """The place of each polygon's best top; the last rule is for what is symmetric to its first."""
    places = np.arange(len(owner))
    for badness, slack in (
        (-depths, EQUAL * depths),
        (np.abs(tops), np.full(len(tops), EQUAL)),
        (np.abs(tops - first[owner]), np.full(len(tops), EQUAL)),
        (-tops.imag, np.full(len(tops), EQUAL)),
    ):
        mine = owner[places]
        least = np.minimum.reduceat(badness[places], np.unique(mine, return_index=True)[1])
        places = places[badness[places] <= least[mine] + slack[places]]
    return np.asarray(places[np.unique(owner[places], return_index=True)[1]])


def _complex(points: Floats) -> Points:
    return np.ascontiguousarray(points).view(np.complex128)[:, 0]


def _pairs(points: Points) -> Floats:
    return np.column_stack([points.real, points.imag])
