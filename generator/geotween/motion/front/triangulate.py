"""Triangles of bands: constrained Delaunay, through points inside where a sweep begins or ends."""

from __future__ import annotations

import numpy as np
import shapely
from shapely.geometry import Polygon

from geotween.motion.front.exact import turns
from geotween.motion.front.meshes import Flags
from geotween.motion.front.outline import numbers_of
from geotween.motion.front.plane import NOTHING, Floats, Ints, Shapes

# A point inside is a hole of this share of its clearance until the rest is triangulated, a point
# again then.
HOLE = 1e-3

# Triangles without area are flipped away in at most so many rounds.
ROUNDS = 8


def triangulated(faces: Shapes, points: Floats, inside: Ints) -> tuple[Ints, Ints, Flags]:
    """Triangles of faces whose corners are points, to the bit.

    Parameters
    ----------
    faces : (f,) polygons.
    points : (p, 2)
    inside : (k, 2) faces, and points within them that are to be corners too.

    Returns
    -------
    triangles : (T, 3), counter-clockwise.
    face : (T,) the face that each is of, ascending.
    sound : (f,) whether a face's triangles have area, all of them, and cover it.
    """
    holed, holes = _with_holes(faces, points, inside)
    every = np.concatenate([points, holes.reshape(-1, 2)])
    parts, face = shapely.get_parts(_delaunay(holed), return_index=True)
    corners = shapely.get_coordinates(parts).reshape(-1, 4, 2)[:, :3]
    same = np.concatenate([np.arange(len(points)), np.repeat(inside[:, 1], 3)])
    triangles = same[numbers_of(every, corners.reshape(-1, 2)).reshape(-1, 3)]
    real = (triangles != np.roll(triangles, -1, axis=1)).all(axis=1)
    triangles, face = triangles[real], face[real]
    turn = turns(points, triangles)
    triangles[turn < 0] = triangles[turn < 0][:, ::-1]
    flat = np.flatnonzero(turn == 0)
    if len(flat):
        _flip(points, triangles, face, flat)
    triangles, face = _with_fans(faces, points, inside, triangles, face)
    return triangles, face, _sound(faces, points, triangles, face)


def twins(triangles: Ints, group: Ints) -> Ints:
    """The edge (T, 3) on the other side of each from a corner to the next, in the same group.

    Edges are numbered 3 * triangle + corner; NOTHING where there is none.
    """
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    size = int(triangles.max(initial=0)) + 1
    code = np.minimum(start, end) * size + np.maximum(start, end)
    order = np.lexsort([code, np.repeat(group, 3)])
    near = (np.diff(code[order]) == 0) & (np.diff(group[order // 3]) == 0)
    near &= (start[order[1:]] == end[order[:-1]]) & (end[order[1:]] == start[order[:-1]])
    found = np.full(len(start), NOTHING, dtype=np.intp)
    first, second = order[:-1][near], order[1:][near]
    found[first], found[second] = second, first
    return found.reshape(-1, 3)


def _with_holes(faces: Shapes, points: Floats, inside: Ints) -> tuple[Shapes, Floats]:
    holed, holes = faces.copy(), np.empty((len(inside), 3, 2))
    for i, (face, point) in enumerate(inside.tolist()):
        clear = shapely.distance(holed[face].boundary, shapely.points(points[point]))
        angle = np.arange(3) * (2 * np.pi / 3)
        ways = np.column_stack([np.cos(angle), np.sin(angle)])
        holes[i] = points[point] + HOLE * clear * ways
        holed[face] = Polygon(holed[face].exterior, [*holed[face].interiors, holes[i]])
    return holed, holes


def _delaunay(faces: Shapes) -> Shapes:
    """Constrained Delaunay triangles of each face; none of one that cannot be triangulated."""
    try:
        return np.asarray(shapely.constrained_delaunay_triangles(faces), dtype=object)
    except shapely.GEOSException:
        if len(faces) == 1:
            return np.array([shapely.GeometryCollection()], dtype=object)
    half = len(faces) // 2
    return np.concatenate([_delaunay(faces[:half]), _delaunay(faces[half:])])


def _flip(points: Floats, triangles: Ints, face: Ints, flat: Ints) -> None:
    """Give flat triangles area, in place: flip the side that the third corner lies on."""
    for _ in range(ROUNDS):
        other_side = twins(triangles, face)
        left = []
        for one in flat.tolist():
            corners = points[triangles[one]]
            sides = np.hypot(*(np.roll(corners, -1, axis=0) - corners).T)
            side = int(np.argmax(sides))
            twin = int(other_side[one, side])
            if twin == NOTHING or twin // 3 in left:
                left.append(one)
                continue
            other, back = divmod(twin, 3)
            a, b, c = np.roll(triangles[one], -side)
            d = triangles[other, (back + 2) % 3]
            triangles[one], triangles[other] = (a, d, c), (d, b, c)
            other_side = twins(triangles, face)
            left += [i for i in (one, other) if turns(points, triangles[[i]])[0] <= 0]
        flat = np.array(left, dtype=np.intp)
        if not len(flat):
            return


def _with_fans(
    faces: Shapes, points: Floats, inside: Ints, triangles: Ints, face: Ints
) -> tuple[Ints, Ints]:
    """Triangles in which faces that a point inside sees all of are fans around it.

    What begins there grows without changing its shape.
    """
    kept = np.ones(len(triangles), dtype=bool)
    parts, owners = [], []
    alone = np.bincount(inside[:, 0], minlength=len(faces)) == 1
    for number, point in inside.tolist():
        if not alone[number] or len(faces[number].interiors):
            continue
        ring = numbers_of(points, shapely.get_coordinates(faces[number].exterior)[:-1])
        fan = np.column_stack([np.full_like(ring, point), ring, np.roll(ring, -1)])
        if (turns(points, fan) > 0).all():
            kept[face == number] = False
            parts.append(fan)
            owners.append(np.full(len(fan), number))
    owner = np.concatenate([face[kept], *owners]).astype(np.intp)
    order = np.argsort(owner, kind="stable")
    return np.concatenate([triangles[kept], *parts]).astype(np.intp)[order], owner[order]


def _sound(faces: Shapes, points: Floats, triangles: Ints, face: Ints) -> Flags:
    """Whether all triangles of a face have area and leave its own edges alone without a twin."""
    sound = np.ones(len(faces), dtype=bool)
    sound[face[turns(points, triangles) <= 0]] = False
    rings, owner = shapely.get_rings(faces, return_index=True)
    coordinates, ring = shapely.get_coordinates(rings, return_index=True)
    number = numbers_of(points, coordinates)
    first = np.flatnonzero(ring[1:] == ring[:-1])
    open_, corner = np.nonzero(twins(triangles, face) == NOTHING)
    mine = np.stack([face[open_], triangles[open_, corner], triangles[open_, (corner + 1) % 3]])
    wanted = np.stack([owner[ring[first]], number[first], number[first + 1]])
    both, count = np.unique(np.concatenate([mine, wanted], axis=1), axis=1, return_counts=True)
    sound[both[0, count != 2]] = False
    return sound
