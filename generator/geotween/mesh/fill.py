"""Fill polygons with triangles: a lattice well inside, constrained Delaunay between it and the rim.

Polygons keep their vertices to the bit, and get no other ones on their boundary: neighbours that
share an edge share it in the mesh.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.polygons import Shapes
from geotween.mesh.mesh import Mesh

# Lattice points stay this far from the boundary, in spacings. No point of a lattice triangle is
# farther than 0.578 from all its corners, so that none reaches the boundary.
CLEARANCE = 0.6

# Polygons narrower than this on average, in spacings, get no lattice: it would hardly have a
# triangle, and a long sliver aslant has a large box to look for one in.
NARROW = 0.5

# A triangle lower than this share of its longest side is flat: rounding, not shape.
FLAT = 1e-12

# So many flat triangles in a row are flipped one after the other.
FLIPS = 20

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Filling(Mesh):
    """A mesh of several polygons; its points are distinct, in lexicographic order.

    ``owner`` (m,) is the polygon that each triangle is of, ascending.
    """

    owner: Ints


def fill(polygons: Shapes, spacing: Floats) -> Filling:
    """A mesh of valid polygons (n,), with a lattice of the spacing (n,) of each.

    Notes
    -----
    Between lattice and boundary the triangles are GEOS's constrained Delaunay ones (Davis, JTS:
    clipped ears, then flips). Cost: n log n for n points, unless a polygon is very long for its
    vertices.
    """
    lattice, inside = _lattice(polygons, spacing)
    rest = polygons.copy()
    for owner, cells in zip(*_by_owner(lattice, inside), strict=True):
        rest[owner] = shapely.difference(rest[owner], shapely.coverage_union_all(cells))
    between = shapely.constrained_delaunay_triangles(rest)
    parts, owners = shapely.get_parts(between, return_index=True)
    owner = np.concatenate([inside, owners])
    corners = np.concatenate([_corners(parts), lattice])[
        np.argsort(np.concatenate([owners, inside]), kind="stable")
    ]
    owner = np.sort(owner, kind="stable")
    known, number = np.unique(corners.reshape(-1, 2).view(np.complex128), return_inverse=True)
    points = known.view(np.float64).reshape(-1, 2)
    triangles = number.reshape(-1, 3).astype(np.intp)
    clockwise = doubled_areas(points, triangles) < 0
    triangles[clockwise] = triangles[clockwise][:, ::-1]
    return Filling(points, flipped(points, triangles, owner), owner)


def doubled_areas(points: Floats, triangles: Ints) -> Floats:
    """Twice the signed area of each triangle (T,)."""
    start, one, other = points[triangles].transpose(1, 0, 2)
    (ax, ay), (bx, by) = (one - start).T, (other - start).T
    return np.asarray(ax * by - ay * bx)


def twins(triangles: Ints, owner: Ints) -> tuple[Ints, Ints]:
    """Sides that two triangles have in common: pairs (k, 2), and which are of one owner (k,).

    Side number 3 t + i runs from corner i of triangle t to the next one.
    """
    start, end = triangles.reshape(-1), np.roll(triangles, -1, axis=1).reshape(-1)
    key = np.minimum(start, end) * (triangles.max(initial=0) + 1) + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    same = np.flatnonzero(key[order[1:]] == key[order[:-1]])
    pairs = np.column_stack([order[same], order[same + 1]])
    return pairs, owner[pairs[:, 0] // 3] == owner[pairs[:, 1] // 3]


def _corners(parts: Shapes) -> Floats:
    return shapely.get_coordinates(parts).reshape(-1, 4, 2)[:, :3]


def _by_owner(lattice: Floats, inside: Ints) -> tuple[Ints, list[Shapes]]:
    """The owners of lattice triangles (ascending), and the triangles of each as polygons."""
    owners, firsts = np.unique(inside, return_index=True)
    cells = shapely.polygons(np.concatenate([lattice, lattice[:, :1]], axis=1))
    return owners, np.split(np.asarray(cells, dtype=object), firsts[1:]) if len(owners) else []


def _lattice(polygons: Shapes, spacing: Floats) -> tuple[Floats, Ints]:
    """Equilateral triangles (k, 3, 2) well inside the polygons, and the polygon of each (k,).

    The lattice of a polygon is centred on its box.
    """
    with np.errstate(invalid="ignore"):
        width = 2 * shapely.area(polygons) / shapely.length(polygons)
    which = np.flatnonzero(width > NARROW * spacing)
    step = np.column_stack([spacing, spacing * 3**0.5 / 2])[which]
    low, high = np.split(shapely.bounds(polygons[which]), 2, axis=1)
    # One column and one row more than fit, so that the neighbours of a point have their numbers.
    counts = (np.ceil((high - low) / step) + 1).astype(np.intp)
    origin = (low + high) / 2 - (counts - 1) / 2 * step
    sizes = counts.prod(axis=1)
    mine = np.repeat(np.arange(len(which)), sizes)
    first = np.cumsum(sizes) - sizes
    row, column = np.divmod(np.arange(len(mine)) - first[mine], counts[mine, 0])
    odd = row % 2
    points = origin[mine] + np.column_stack([column + odd / 2 - 0.25, row]) * step[mine]

    owner = which[mine]
    shapely.prepare(polygons)
    boundaries = shapely.boundary(polygons)
    shapely.prepare(boundaries)
    good = np.zeros(len(mine), dtype=bool)
    near = np.flatnonzero(shapely.contains_xy(polygons[owner], *points.T))
    reach: Any = CLEARANCE * spacing[owner[near]]
    good[near] = ~shapely.dwithin(boundaries[owner[near]], shapely.points(points[near]), reach)

    room = (column < counts[mine, 0] - 1) & (row < counts[mine, 1] - 1)
    place = np.flatnonzero(room)
    odd, above = odd[place], place + counts[mine[place], 0]
    upward = np.column_stack([place, place + 1, above + odd])
    downward = np.column_stack([place + 1 - odd, above + 1, above])
    found = np.concatenate([upward, downward])
    found = found[good[found].all(axis=1)]
    found = found[np.argsort(found[:, 0], kind="stable")]
    return points[found], owner[found[:, 0]]


def flipped(points: Floats, triangles: Ints, owner: Ints) -> Ints:
    """Triangles, of which flat ones have their longest side flipped, where that helps."""
    triangles = triangles.copy()
    for _ in range(FLIPS):
        corners = points[triangles]
        lengths = ((np.roll(corners, -1, axis=1) - corners) ** 2).sum(axis=2)
        flat = np.flatnonzero(doubled_areas(points, triangles) <= FLAT * lengths.max(axis=1))
        if not len(flat):
            break
        pairs, same = twins(triangles, owner)
        pairs = np.concatenate([pairs[same], pairs[same][:, ::-1]])
        pairs = pairs[np.isin(pairs[:, 0], 3 * flat + lengths[flat].argmax(axis=1))]
        (one, other), (side, mate) = (pairs // 3).T, (pairs % 3).T
        a, b, c = (triangles[one, side - k] for k in (3, 2, 1))
        d = triangles[other, mate - 1]
        new = np.stack([np.column_stack([a, d, c]), np.column_stack([d, b, c])])
        good = (np.stack([doubled_areas(points, part) for part in new]) > 0).all(axis=0)
        # A triangle takes part in one flip at a time.
        first = np.full(len(triangles), len(pairs))
        number = np.arange(len(pairs))
        np.minimum.at(first, pairs[good] // 3, number[good, None])
        good &= (first[one] == number) & (first[other] == number)
        if not good.any():
            break
        triangles[one[good]], triangles[other[good]] = new[:, good]
    return triangles
