"""The plane cut by all borders of a transition: its faces, who covers each, and what changes.

Every edge is there once, for the faces on both of its sides: what is told about an edge is told
to both, so that nothing that is made from this can gape or overlap.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.polygons import Identity, PolygonSet
from geotween.motion.front.noding import faces_between

NOTHING = -1  # no thing, no face, no polygon, no partner

# What the other side of an edge is for a region of change.
NONE, SOURCE, SINK, NEUTRAL, INNER = range(5)


Ints = NDArray[np.intp]
Floats = NDArray[np.float64]
Shapes = NDArray[np.object_]


@dataclass(frozen=True, eq=False)
class Plane:
    """The plane cut by all borders of both steps, their vertices where they were (``noding``).

    Attributes
    ----------
    points : (n, 2) distinct, in lexicographic order.
    edges : (m, 2) the start and the end vertex of each edge; each edge is there once.
    sides : (m, 2) the face to the left and to the right of each directed edge; NOTHING where no
        polygon is, at neither end.
    faces : (f,) polygons, outer rings counter-clockwise, holes clockwise; all their coordinates
        are ``points``, to the bit.
    """

    points: Floats
    edges: Ints
    sides: Ints
    faces: Shapes

    @property
    def between(self) -> NDArray[np.bool_]:
        """Which edges (m,) have a face on both sides."""
        return np.asarray((self.sides != NOTHING).all(axis=1))

    @property
    def lengths(self) -> Floats:
        """The length of each edge (m,)."""
        ways = self.points[self.edges[:, 1]] - self.points[self.edges[:, 0]]
        return np.asarray(np.hypot(*ways.T))


@dataclass(frozen=True)
class Thing:
    """Who something is at both ends; None where it begins, or ends, in this transition."""

    origin: Identity | None
    target: Identity | None


@dataclass(frozen=True, eq=False)
class Change:
    """Which thing covers each face of the plane before and after a transition.

    Attributes
    ----------
    plane : the faces and their edges.
    things : what bears one identity from end to end.
    before, after : (f,) the thing that covers each face at the origin and at the target, or
        NOTHING.
    region : (f,) the number of each face's region of change, -1 where nothing changes. A region
        is connected across edges and has one pair (before, after).
    roles : (m, 2) for the left and the right face of each edge: INNER where the other side is of
        the same region; SOURCE where the other side is ``after`` at both ends, SINK where it is
        ``before`` at both ends, NEUTRAL otherwise; NONE where the face does not change. What
        turns in place counts by its label: all that becomes s is a source for what s takes, all
        that was a is a sink for what a loses.

    A region between two things without a source hangs together with one that has it and the same
    ``after``: the front runs on into it.
    """

    plane: Plane
    things: tuple[Thing, ...]
    before: Ints
    after: Ints
    region: Ints
    roles: NDArray[np.uint8]


def cut(origin: PolygonSet, target: PolygonSet) -> tuple[Plane, Ints]:
    """The faces into which the borders of two sets part the plane, and who covers each.

    Returns
    -------
    plane
        The faces that some polygon covers at one end at least.
    cover
        (2, f): the polygon of the origin and of the target that covers each face, or NOTHING.
        Where several of one set do it is the last one: it is drawn on top.

    Raises
    ------
    ArithmeticError
        Where the borders cannot be cut with each other.

    Notes
    -----
    Cost n log n for n vertices and crossings.
    """
    polygons = np.concatenate([origin.polygons, target.polygons])
    if not len(polygons):
        empty = np.empty((0, 2), dtype=np.intp)
        return Plane(np.empty((0, 2)), empty, empty, np.empty(0, object)), empty.T
    faces, holder, face = faces_between(polygons)
    cover = np.full((2, len(faces)), NOTHING, dtype=np.intp)
    of_target = (holder >= len(origin)).astype(np.intp)
    np.maximum.at(cover, (of_target, face), holder - of_target * len(origin))
    covered = (cover != NOTHING).any(axis=0)
    return _numbered(faces[covered]), cover[:, covered]


def _numbered(faces: Shapes) -> Plane:
    """Faces as a plane: the same coordinates are one point, both sides of an edge one edge."""
    rings, owner = shapely.get_rings(faces, return_index=True)
    coordinates, ring = shapely.get_coordinates(rings, return_index=True)
    known, number = np.unique(coordinates.view(np.complex128), return_inverse=True)
    number = number.reshape(-1)
    start = np.flatnonzero(ring[1:] == ring[:-1])
    one, other = number[start], number[start + 1]
    low, high = np.minimum(one, other), np.maximum(one, other)
    distinct, edge = np.unique(low * len(known) + high, return_inverse=True)
    sides = np.full((len(distinct), 2), NOTHING, dtype=np.intp)
    sides[edge.reshape(-1), (one > other).astype(np.intp)] = owner[ring[start]]
    edges = np.column_stack(np.divmod(distinct, len(known)))
    return Plane(known.view(np.float64).reshape(-1, 2), edges, sides, faces)
