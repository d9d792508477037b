"""Polygons on the circle of longitudes: across the antimeridian, around a pole, cut for a map.

Longitudes and latitudes are in degrees, x and y of planar polygons; an edge is straight in them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon

TURN = 360.0

# Longitudes (degrees) lie on this grid, 25 nm at the equator: whole turns are added to them without
# rounding, and the middle of an edge is the same from both sides and on any turn.
GRID = 2.0**-42

# Longitudes this near (degrees, 0.1 mm) to 180° or a whole turn from it are at it: files written
# from radians miss it by rounding.
NEAR = 1e-9

# An edge (degrees of longitude) longer than this crosses the antimeridian, where another turn is
# counted from; a shorter one is as wide as it is written, such as a box from -100 to 100.
JUMP = 270.0

# The meridians (degrees) where data are cut, as data are that run from -180 or from 0.
SEAMS = (180.0, 360.0)


@dataclass(frozen=True, eq=False)
class Parts:
    """Polygons (m,) and for each the position (m,) of the feature that it is a part of."""

    polygons: NDArray[np.object_]
    owners: NDArray[np.intp]

    @property
    def bounds(self) -> NDArray[np.float64]:
        """West, south, east, north of each polygon: (m, 4), longitudes on the grid."""
        bounds = shapely.bounds(self.polygons).reshape(-1, 4)
        bounds[:, ::2] = on_grid(bounds[:, ::2])
        return bounds

    def with_changed(
        self, which: NDArray[np.intp], geometries: Sequence[object] | NDArray[np.object_]
    ) -> Parts:
        """With some of the polygons replaced, each by the polygons of a geometry."""
        if not len(which):
            return self
        changed = self.polygons.copy()
        changed[which] = geometries
        flat, first = shapely.get_parts(changed, return_index=True)  # of collections too
        flat, second = shapely.get_parts(flat, return_index=True)
        areas = shapely.get_dimensions(flat) == 2
        filled = areas & ~shapely.is_empty(flat)
        return Parts(flat[filled], self.owners[first[second]][filled])


def parts_of(geometries: NDArray[np.object_]) -> Parts:
    """The polygons of (Multi)Polygons (n,)."""
    polygons, owners = shapely.get_parts(geometries, return_index=True)
    filled = ~shapely.is_empty(polygons)
    return Parts(polygons[filled], owners[filled])


def finite(parts: Parts) -> tuple[Parts, NDArray[np.intp]]:
    """Polygons whose points are all at finite places, and the features that others belong to."""
    shown = np.isfinite(shapely.bounds(parts.polygons).reshape(-1, 4)).all(axis=1)
    return Parts(parts.polygons[shown], parts.owners[shown]), parts.owners[~shown]


def on_grid(longitudes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Longitudes on the grid of whole turns, and at ±180° where they are meant to be."""
    turns = np.rint(longitudes / TURN - 0.5) + 0.5
    meant = np.abs(longitudes - turns * TURN) < NEAR
    return np.asarray(np.where(meant, turns * TURN, np.rint(longitudes / GRID) * GRID))


def turned(polygons: NDArray[np.object_], turns: NDArray[np.float64]) -> NDArray[np.object_]:
    """Polygons (m,) moved east by whole turns (m,)."""
    points, index = shapely.get_coordinates(polygons, return_index=True)
    points[:, 0] = on_grid(points[:, 0]) + TURN * turns[index]
    return np.asarray(shapely.set_coordinates(polygons.copy(), points), dtype=object)


def unwrapped(parts: Parts) -> tuple[Parts, int]:
    """Polygons with continuous longitudes, and how many polygons had others.

    An edge longer than ``JUMP`` goes the short way round, whatever turn its ends are written in. A
    ring that closes only after a turn encloses the pole of its own hemisphere: it is led along a
    meridian to that pole and back, and spans 360°. An edge of exactly one turn is a real one at a
    pole, or where the ring is valid as it stands (a band around the globe); otherwise it crosses
    the antimeridian at a doubled point.

    Notes
    -----
    Done here and not by the library ``antimeridian``: that one rounds longitudes and the crossings,
    so that neighbours no longer share their borders, and reads another pole from a reversed ring.
    """
    rings, ring_parts = shapely.get_rings(parts.polygons, return_index=True)
    points, index = shapely.get_coordinates(rings, return_index=True)
    far = (np.abs(np.diff(points[:, 0])) > JUMP) & (index[1:] == index[:-1])
    which = np.unique(ring_parts[index[1:][far]])
    fixed = [_unwrapped(polygon) for polygon in parts.polygons[which]]
    changed = sum(new is not old for new, old in zip(fixed, parts.polygons[which], strict=True))
    return parts.with_changed(which, fixed), changed


def _unwrapped(polygon: Polygon) -> object:
    rings = [shapely.get_coordinates(ring) for ring in (polygon.exterior, *polygon.interiors)]
    new = [_unwrapped_ring(ring) for ring in rings]
    if all(after is before for before, after in zip(rings, new, strict=True)):
        return polygon
    shell, *holes = [Polygon(ring) for ring in new]
    if not holes:
        return shell
    # A hole may be written in another turn than its shell, or lie on both ends of a polar one.
    everywhere = [turned(np.array(holes), np.full(len(holes), k)) for k in (-1.0, 0.0, 1.0)]
    solid, *cut = shapely.make_valid(np.array([shell, *np.concatenate(everywhere)]))
    return solid.difference(shapely.union_all(cut))


def _unwrapped_ring(ring: NDArray[np.float64]) -> NDArray[np.float64]:
    """A closed ring (k, 2) with continuous longitudes: the same object if it had them already."""
    points = np.column_stack([on_grid(ring[:-1, 0]), ring[:-1, 1]])
    steps = np.roll(points[:, 0], -1) - points[:, 0]
    turns = np.where(np.abs(steps) > JUMP, -np.rint(steps / TURN), 0.0)
    whole = np.abs(steps) == TURN
    at_pole = (np.abs(ring[:-1, 1]) == 90) & (ring[:-1, 1] == ring[1:, 1])
    turns[whole & at_pole] = 0
    if not turns.any() or (not turns[~whole].any() and Polygon(ring).is_valid):
        return ring
    if not turns.sum():
        points[:, 0] += TURN * np.concatenate([[0.0], np.cumsum(turns[:-1])])
        return np.concatenate([points, points[:1]])
    return _closed_over_pole(points, turns)


def _closed_over_pole(
    points: NDArray[np.float64], turns: NDArray[np.float64]
) -> NDArray[np.float64]:
    """An open ring (k, 2) around a pole, its turns (k,) after each point, led to the pole and back.

    From the point nearest to the pole, so that the way there crosses nothing.
    """
    after = np.roll(points, -1, axis=0)
    east = after[:, 0] - points[:, 0] + TURN * turns
    latitude = (east * (points[:, 1] + after[:, 1])).sum() / east.sum()
    pole = 90.0 if latitude >= 0 else -90.0
    first = int(np.argmax(points[:, 1] * np.sign(pole)))
    points, turns = np.roll(points, -first, axis=0), np.roll(turns, -first)
    ring = np.concatenate([points, points[:1]])
    ring[:, 0] += TURN * np.concatenate([[0.0], np.cumsum(turns)])
    return np.concatenate([ring, [[ring[-1, 0], pole], [ring[0, 0], pole]], ring[:1]])


def joined(parts: Parts, cut: float | None) -> Parts:
    """With the parts of each feature joined that meet where the data were cut, not the map.

    Parts west of 180° (or 360°) and east of -180° (or 0°) of one feature become one polygon.
    """
    for seam in SEAMS:
        if cut is not None and (seam - cut) % TURN == 0:
            continue
        bounds = parts.bounds
        ends, starts = bounds[:, 2] == seam, bounds[:, 0] == seam - TURN
        west, east = ends & ~starts, starts & ~ends
        both = np.intersect1d(parts.owners[west], parts.owners[east])
        meeting = np.flatnonzero((west | east) & np.isin(parts.owners, both))
        if not len(meeting):
            continue
        pieces = turned(shapely.make_valid(parts.polygons[meeting]), east[meeting].astype(float))
        merged: list[object] = [Polygon()] * len(meeting)
        for owner in both:
            mine = np.flatnonzero(parts.owners[meeting] == owner)
            merged[mine[0]] = shapely.union_all(pieces[mine])
        parts = parts.with_changed(meeting, merged)
    return parts


def first_longitude(cut: float) -> float:
    """Where the longitudes of a map begin, in (-360, 0]: at its cut or at the turn before."""
    return float(on_grid(np.array(cut - TURN if cut > 0 else cut)))


def cut_at(parts: Parts, cut: float) -> Parts:
    """Polygons moved by whole turns onto a map, in two where they lie across its cut."""
    start = first_longitude(cut)
    bounds = parts.bounds
    turns = -np.floor((bounds[:, 0] - start) / TURN)
    moving = np.flatnonzero(turns)
    polygons = parts.polygons.copy()
    polygons[moving] = turned(polygons[moving], turns[moving])
    across = np.flatnonzero(bounds[:, 2] + TURN * turns > start + TURN)
    pieces = [
        _clipped(polygon, start, int(np.ceil((east - start) / TURN)))
        for polygon, east in zip(
            polygons[across], (bounds[:, 2] + TURN * turns)[across], strict=True
        )
    ]
    return Parts(polygons, parts.owners).with_changed(across, pieces)


def _clipped(polygon: Polygon, start: float, turns: int) -> object:
    """The pieces of a polygon in each of some turns, all moved to the first.

    Those of a polygon that spans a turn meet there, and become one.
    """
    low, high = polygon.bounds[1] - 1, polygon.bounds[3] + 1
    wests = [start + TURN * turn for turn in range(turns)]
    boxes = np.array([shapely.box(west, low, west + TURN, high) for west in wests], dtype=object)
    pieces = shapely.intersection(shapely.make_valid(np.full(turns, polygon)), boxes)
    return shapely.union_all(turned(pieces, -np.arange(turns, dtype=float)))


def with_equal_sides(parts: Parts) -> Parts:
    """Polygons that span a turn, with the same points on both of their outermost meridians.

    Where that is not so, it is cut elsewhere: both sides of a cut have the same points.
    """
    bounds = parts.bounds
    around = np.flatnonzero(bounds[:, 2] - bounds[:, 0] >= TURN)
    unequal = [i for i in around if not _equal_sides(parts.polygons[i], bounds[i])]
    cut = [_clipped(parts.polygons[i], bounds[i, 0] - TURN / 2, 2) for i in unequal]
    return parts.with_changed(np.array(unequal, dtype=np.intp), cut)


def _equal_sides(polygon: Polygon, bounds: NDArray[np.float64]) -> bool:
    points = shapely.get_coordinates(polygon)
    longitudes = on_grid(points[:, 0])
    west, east = (np.unique(points[longitudes == end, 1]) for end in bounds[::2])
    return bool(np.array_equal(west, east))


def widest_gap(parts: Parts) -> tuple[float, float]:
    """Middle (degrees in [-180, 180)) and width of the widest gap between polygons on the circle.

    Of equal ones the farthest from longitude 0; width 0 where there is none.
    """
    bounds = parts.bounds
    if not len(bounds):
        return -180.0, TURN
    width = bounds[:, 2] - bounds[:, 0]
    west = bounds[:, 0] % TURN
    order = np.argsort(west)
    west = np.append(west[order], west[order[0]] + TURN)
    east = np.maximum.accumulate(west[:-1] + width[order])
    east = np.maximum(east, east[-1] - TURN)  # the last may reach over the start of the circle
    gaps = np.maximum(west[1:] - east, 0)
    middles = (east + gaps / 2 + 180) % TURN - 180
    best = np.lexsort([-np.abs(middles), -gaps])[0]
    return float(middles[best]), float(gaps[best])
