"""Smooth seams: the zigzag of a mesh taken out of a partition, which stays one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from geotween.motion.divide.faces import (
    Bools,
    Faces,
    Ints,
    Piece,
    Points,
    Shapes,
    array_of,
    as_numbers,
)
from geotween.motion.divide.noding import faces_between, rejoined
from geotween.motion.divide.partition import of_faces

# How often each vertex goes half-way to the middle of its neighbours: a zigzag from edge to edge
# is gone after one, bends over some four edges and more stay.
ROUNDS = 4


def smoothed(
    polygon: Polygon,
    pieces: Sequence[Piece],
    aims: Sequence[BaseGeometry],
    connected: bool = True,
) -> list[Piece]:
    """A partition with smoother seams; where seams meet each other or the outline they rest.

    The binomial filter, repeated. Where a smooth seam would leave the polygon or cross another
    one, what is cut off goes where most of it was, or to the neighbour. Cost: n log n.
    """
    lines = _smooth(_seams(pieces), polygon)
    if not len(lines):
        return list(pieces)
    whole = rejoined(polygon, shapely.get_parts(array_of(pieces)))
    faces = faces_between(whole, lines)
    labels = _most_of(faces.polygons, array_of(pieces))
    found, mends = of_faces(polygon, faces, labels, aims, connected)
    # Rather a jagged seam than a piece that had to be cut anew.
    return list(pieces) if any(mend.kind == "empty cell" for mend in mends) else found


def _seams(pieces: Sequence[Piece]) -> Shapes:
    """The seams of a partition as lines that end where more than two of their edges meet."""
    edges: Any = shapely.linestrings(Faces(shapely.get_parts(array_of(pieces))).seams.ends)
    return shapely.get_parts(shapely.line_merge(shapely.multilinestrings(edges)))


def _smooth(lines: Shapes, polygon: Polygon) -> Shapes:
    """Lines of which all vertices but their ends, and those on the polygon's outline, move."""
    if not len(lines):
        return lines
    points, line = shapely.get_coordinates(lines, return_index=True)
    first = np.append(True, line[1:] != line[:-1])
    last = np.append(first[1:], True)
    before, after = np.arange(len(points)) - 1, np.arange(len(points)) + 1
    closed = (points[first] == points[last]).all(axis=1)
    # The first and the last vertex of a closed line are one, whose neighbours are the next ones.
    starts, ends = np.flatnonzero(first)[closed], np.flatnonzero(last)[closed]
    before[starts], after[ends] = ends - 1, starts + 1
    rests = first | last
    rests[starts], rests[ends] = False, False
    rests |= _on_outline(points, polygon) | _elsewhere_too(points, rests)
    moves = np.flatnonzero(~rests)
    for _ in range(ROUNDS):
        middle = (points[before[moves]] + points[after[moves]]) / 2
        points[moves] = (points[moves] + middle) / 2
    return np.asarray(shapely.linestrings(points, indices=line), dtype=object)


def _on_outline(points: Points, polygon: Polygon) -> Bools:
    shapely.prepare(polygon)
    return ~np.asarray(shapely.contains_properly(polygon, shapely.points(points)), dtype=bool)


def _elsewhere_too(points: Points, ends: Bools) -> Bools:
    """Which points are the end of some line."""
    return np.asarray(np.isin(as_numbers(points), as_numbers(points[ends])))


def _most_of(faces: Shapes, pieces: Shapes) -> Ints:
    """The piece (f,) that most of each face was in."""
    face, piece = shapely.STRtree(pieces).query(faces, predicate="intersects")
    shared = shapely.area(shapely.intersection(faces[face], pieces[piece]))
    found = np.zeros(len(faces), dtype=np.intp)
    order = np.lexsort((-piece, shared))
    found[face[order]] = piece[order]
    return found
