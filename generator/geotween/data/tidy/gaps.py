"""Gaps: narrow strips that are left open between neighbours."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiLineString

from geotween.data.tidy.linework import Ints, Shapes
from geotween.data.tidy.nodes import edges_of

# An open strip is at least this many times as long as wide: what is shorter is a notch in the
# coast, the mouth of a river, a strait.
SLENDER = 50

# Coasts face each other across an open strip for at least this many widths.
SHORTEST = 5

# Coasts are looked at in points so far apart, in widths.
SAMPLE = 0.5

# Coasts of more points than this are not looked at: the width is no width of a page's pixels.
MOST = 1_000_000

# How near the points of two coasts are, in widths, across strips of up to a width, half and a
# quarter of it, and for how many widths at least they are so, as strips are slender.
FACING = ((1.1, SLENDER / 2), (0.6, SLENDER / 4), (0.4, SHORTEST))

# The discs that are rolled along the coast, in widths: a narrow strip may end in a wider notch.
DISCS = (1, 1 / 2, 1 / 4)

# A strip's mouth is at most this long, in diameters of the disc. At the mouth of a bay the disc
# touches both sides, and the mouth is half its outline, 1.57.
WIDEST_MOUTH = 1.2

# Of a strip between two polygons neither has more than this share of its sides.
ONE_SIDE = 0.75

# What counts as touching, in widths.
EPSILON = 1e-3

# A strip whose mean width is less than this, in diameters of the disc, is rounding.
HAIR = 0.01

# How far what is covered may be simplified, in diameters of the disc, to look for strips at all.
ROUGH = 1 / 16

Floats = NDArray[np.float64]


def gaps(geometries: Shapes, width: float, *, closed: bool = True) -> tuple[Shapes, Ints]:
    """Uncovered strips (k,) between polygons of a coverage, and for each who borders it most (k,).

    A strip is narrower than ``width`` and lies between two polygons or more: ``closed`` ones, all
    around which there are polygons, and those open at the coast. What lies within one polygon is a
    lake or an inlet of it, and what widens toward its mouth a bay.

    Notes
    -----
    Candidates for open strips are where points along the coasts of two polygons lie nearer than
    the width; there the closing of what is covered (a disc as wide rolled along it; mathematical
    morphology) gives the strips. O(n log n) in the vertices where candidates are few.
    """
    owners, edges, mates = edges_of(geometries)
    coast = ~mates
    coast[:-1] &= ~mates[1:]
    tree = shapely.STRtree(geometries)
    near = width * EPSILON
    regions = _narrows(owners[coast], edges[coast], width)
    strips = [_mouthed(region, tree, width) for region in regions]
    if closed:
        strips.append(_holes(edges[coast], tree, width))
    found = np.concatenate([np.empty(0, dtype=object), *strips])
    strip, polygon, side = _sides(found, tree, near)
    first = np.append(True, strip[1:] != strip[:-1])[: len(strip)]  # the longest side
    whole = np.bincount(strip, side, len(found))[strip[first]]
    between = side[first] <= ONE_SIDE * whole
    return found[strip[first][between]], polygon[first][between]


def _narrows(owners: Ints, edges: Floats, width: float) -> Shapes:
    """The regions in which coasts of two polygons are near each other for some way."""
    if not len(owners):
        return np.empty(0, dtype=object)
    order = np.argsort(owners, kind="stable")
    owners, edges = owners[order], edges[order]
    lengths = np.hypot(*(edges[:, 1] - edges[:, 0]).T)
    ends = np.cumsum(lengths)
    if ends[-1] > MOST * width * SAMPLE:
        return np.empty(0, dtype=object)
    along = np.arange(width * SAMPLE / 2, ends[-1], width * SAMPLE)
    edge = np.searchsorted(ends, along).clip(max=len(ends) - 1)
    rest = ((ends[edge] - along) / lengths[edge])[:, None]
    places = edges[edge, 1] + rest * (edges[edge, 0] - edges[edge, 1])
    points = np.asarray(shapely.points(places), dtype=object)
    farthest = FACING[0][0] * width
    one, other = shapely.STRtree(points).query(points, predicate="dwithin", distance=farthest)
    mine, theirs = owners[edge[one]], owners[edge[other]]
    apart = np.hypot(*(places[one] - places[other]).T) / width
    order = np.lexsort([apart, theirs, mine, one])
    order = order[(mine != theirs)[order]]
    names = np.column_stack([mine, theirs, one])[order]
    nearest = np.append(True, (names[1:] != names[:-1]).any(axis=1))[: len(names)]
    mine, theirs, one = names[nearest].T
    apart = apart[order][nearest]
    _, pair = np.unique(mine * (owners[-1] + 1) + theirs, return_inverse=True)
    chosen = np.zeros(len(points), dtype=bool)
    for reach, way in FACING:
        within = apart <= reach
        long = np.bincount(pair[within], minlength=len(pair)) * SAMPLE > way
        chosen[one[within & long[pair]]] = True
    around = shapely.union_all(shapely.buffer(points[chosen], 1.5 * width, quad_segs=1))
    return np.asarray(shapely.get_parts(around), dtype=object)


def _mouthed(region: Any, tree: shapely.STRtree, width: float) -> Shapes:
    """Strips in a region that end where the coasts part, at a mouth."""
    window = shapely.buffer(region, 2 * width, quad_segs=2)
    shapes = tree.geometries[tree.query(window, predicate="intersects")]
    covered = shapely.union_all(shapely.intersection(shapes, window))
    shapely.prepare(covered)
    # What reaches the window's rim is of its making.
    inner = shapely.buffer(region, width, quad_segs=2)
    found = np.empty(0, dtype=object)
    for disc in (width * share for share in DISCS):
        if not len(_slender(shapely.simplify(covered, disc * ROUGH), disc, slack=2)):
            continue  # as a look at few vertices tells
        strips = _slender(covered, disc)
        strips = strips[shapely.contains_properly(inner, strips)]
        strips = strips[~shapely.intersects(strips, shapely.union_all(found))]
        ended = [_ends_at_mouths(strip, covered, disc) for strip in strips]
        found = np.append(found, strips[np.array(ended, dtype=bool)])
        if len(strips) and all(ended):
            break
    return found


def _slender(covered: Any, disc: float, *, slack: float = 1.0) -> Shapes:
    """Strips where a disc that is rolled along what is covered does not fit, long and slender."""
    grown = shapely.buffer(covered, disc / 2, quad_segs=4)
    closed = shapely.buffer(grown, -(1 + EPSILON**2) * disc / 2, quad_segs=4)
    strips = np.asarray(shapely.get_parts(shapely.difference(closed, covered)), dtype=object)
    outline, area = slack * shapely.length(strips) / 2, shapely.area(strips)
    seen = (outline > SHORTEST * disc) & (area > HAIR * disc * outline)
    return strips[seen & (outline**2 > SLENDER * area)]


def _ends_at_mouths(strip: Any, covered: Any, disc: float) -> bool:
    """Whether a strip has a mouth, and ends at all of them before the disc is too wide for it."""
    rings = shapely.get_rings(strip)
    ends, ring = shapely.get_coordinates(rings, return_index=True)
    pieces = np.stack([ends[:-1], ends[1:]], axis=1)[ring[1:] == ring[:-1]]
    off = ~shapely.dwithin(covered, shapely.points(pieces.mean(axis=1)), EPSILON * disc)
    rim = shapely.line_merge(MultiLineString(list(pieces[off])))
    mouths = shapely.length(shapely.get_parts(rim))
    return bool(len(mouths) and (mouths <= WIDEST_MOUTH * disc).all())


def _holes(edges: Floats, tree: shapely.STRtree, width: float) -> Shapes:
    """Uncovered faces of some edges that are narrower than a width everywhere."""
    lines = np.asarray(shapely.linestrings(edges), dtype=object)
    faces = np.asarray(shapely.get_parts(shapely.polygonize(lines)), dtype=object)
    faces = faces[2 * shapely.area(faces) < width * shapely.length(faces)]
    faces = faces[shapely.is_empty(shapely.buffer(faces, -width / 2))]
    inside = shapely.point_on_surface(faces)
    covered = tree.query(inside, predicate="intersects")[0]
    return np.asarray(np.delete(faces, covered), dtype=object)


def _sides(strips: Shapes, tree: shapely.STRtree, near: float) -> tuple[Ints, Ints, Floats]:
    """Strips, polygons beside them and how long these are, the longest of each strip first."""
    wider = shapely.buffer(strips, near, quad_segs=1)
    strip, polygon = tree.query(wider, predicate="intersects")
    sides = shapely.area(shapely.intersection(wider[strip], tree.geometries[polygon])) / near
    order = np.lexsort([polygon, -sides, strip])
    return strip[order], polygon[order], sides[order]
