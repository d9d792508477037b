"""Straight cuts: what an empty cell gets of the piece nearest to it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from geotween.data.polygons import RELATIVE_TOLERANCE
from geotween.motion.divide.faces import Bools, Faces, Points, Shapes, joined, largest_part
from geotween.motion.divide.noding import faces_between
from geotween.motion.groups import connected

# A part below this share of a piece is passed over where a larger one can be cut off.
TINY = 1e-2

# How far a cut goes beyond both of its ends, so that noding meets the outline for sure: in extents,
# and in its own lengths at most.
BEYOND, FURTHER = 4e-7, 1e-2


@dataclass(frozen=True, eq=False)
class Cut:
    """A piece cut in two, both connected, by straight lines."""

    won: Polygon
    left: Polygon
    lines: Shapes


def cut_off(piece: Polygon, aim: BaseGeometry, *, corner: bool) -> Cut | None:
    """Cut off the part of a piece that is nearest to what is aimed at; None where that fails.

    A ``corner`` reaches half-way from the point nearest to the aim to the centroid. Otherwise the
    cut goes through the centroid, across the longer axis: halves, more or less. Some of a piece
    lies on either side of any line through its centroid.
    """
    reach = np.ptp(shapely.get_coordinates(piece), axis=0).max()
    inner = shapely.get_coordinates(piece.centroid)[0]
    near = shapely.get_coordinates(shapely.shortest_line(piece, aim))[0]
    inward = inner - near
    if corner and np.hypot(*inward) > RELATIVE_TOLERANCE * reach:
        found = _along(piece, (inner + near) / 2, inward, near)
        if found:
            return found
    sides = np.diff(shapely.get_coordinates(shapely.oriented_envelope(piece))[:3], axis=0)
    axis = sides[np.argmax(np.hypot(*sides.T))]
    return _along(piece, inner, axis if axis @ inward >= 0 else -axis, near)


def _along(piece: Polygon, middle: Points, inward: Points, near: Points) -> Cut | None:
    """The cut through a point across a direction; the part on the near side is won."""
    lines = _chords(piece, middle, inward)
    faces = faces_between(piece, lines)
    there = np.flatnonzero((faces.places - middle) @ inward < 0)
    if not len(there) or len(there) == len(faces.areas):
        return None
    gaps = shapely.distance(faces.polygons[there], shapely.Point(near))
    tiny = faces.areas[there] < TINY * piece.area
    won = there[np.lexsort((-faces.areas[there], gaps, tiny))[0]]
    keeps = _largest_without(faces, int(won))
    taken, left = (
        largest_part(shapely.get_parts(joined(faces.polygons[of]))) for of in (~keeps, keeps)
    )
    return Cut(taken, left, lines)


def _largest_without(faces: Faces, one: int) -> Bools:
    """Which faces (f,) are in the largest connected part that is left without one of them."""
    seams = faces.seams
    apart = (seams.left != one) & (seams.right != one)
    pairs = np.column_stack([seams.left, seams.right])[apart]
    part = connected(pairs, len(faces.areas))
    sizes = np.bincount(part, faces.areas)
    sizes[part[one]] = -1
    return np.asarray(part == sizes.argmax())


def _chords(piece: Polygon, middle: Points, inward: Points) -> Shapes:
    """Where a line through a point, across a direction, lies in a piece."""
    reach = np.ptp(shapely.get_coordinates(piece), axis=0).max()
    along = np.array([-inward[1], inward[0]]) * reach / np.hypot(*inward)
    crossing = shapely.intersection(LineString([middle - 4 * along, middle + 4 * along]), piece)
    chords = [c for c in shapely.get_parts(crossing) if isinstance(c, LineString)]
    ends = shapely.get_coordinates(chords).reshape(-1, 2, 2)
    way = ends[:, 1] - ends[:, 0]
    further = np.minimum(BEYOND * reach / np.hypot(*way.T), FURTHER)[:, None] * way
    ends[:, 0] -= further
    ends[:, 1] += further
    return np.asarray(shapely.linestrings(ends), dtype=object)
