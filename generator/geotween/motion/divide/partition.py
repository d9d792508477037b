"""Partitions: faces of a polygon given to owners, none left without, each owner's joined."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from geotween.data.polygons import RELATIVE_TOLERANCE
from geotween.data.problems import LEAST_SHARE
from geotween.motion.divide.faces import (
    Faces,
    Floats,
    Ints,
    Piece,
    Points,
    Shapes,
    array_of,
    holders,
    joined,
    largest_part,
    mean_width,
    together,
)
from geotween.motion.divide.hosts import filled
from geotween.motion.divide.noding import faces_between, rejoined
from geotween.motion.divide.outline import with_own_vertices
from geotween.motion.groups import connected as components

# A part below this share of the polygon's area is rounding, not a piece.
SLIVER = RELATIVE_TOLERANCE

# A part below this share of the polygon's area is a crumb: no piece of its own beside others.
CRUMB = 1e-4

# A face narrower than this share of the polygon's width, both on average, is a hair: rounding, or
# borders drawn twice. It does not connect what it touches, and is no piece.
HAIR = 1e-4

# Faces whose common edge is shorter than this, in extents, meet in a point only.
PINCH = 1e-11

NOBODY = -1

# Places (f, 2) in, the number of the owner of each out.
Labels = Callable[[Points], Ints]


@dataclass(frozen=True)
class Mend:
    """What had to be mended for the cell of one correspondent, and the share of area it moved."""

    kind: str
    cell: int
    share: float = 0.0


def partition(
    polygon: Polygon,
    lines: Shapes,
    label: Labels,
    aims: Sequence[BaseGeometry],
    connected: bool = True,
) -> tuple[list[Piece], list[Mend]]:
    """One piece of a polygon for each aim, cut along lines, and what had to be mended.

    Parameters
    ----------
    lines
        What cuts the polygon into faces; what does not, changes nothing.
    label
        Says whose a face is, by a place in it: a number of ``aims``.
    aims
        Where the pieces belong: a cell without a face is cut from the piece nearest to its aim.
    connected
        Each piece is one polygon: the largest part stays, each other one goes to the neighbour
        with the longest common seam. Otherwise crumbs only go there.

    Raises
    ------
    ArithmeticError
        Where the polygon is too small to be divided.

    Notes
    -----
    Cost: n log n for n vertices and crossings, and again for all empty cells together; a cut of
    its own for each of these.
    """
    faces = faces_between(polygon, lines)
    labels = label(faces.places)
    labels[mean_width(faces.polygons) < HAIR * mean_width(polygon)] += len(aims)
    return of_faces(polygon, faces, labels, aims, connected)


def of_faces(
    polygon: Polygon,
    faces: Faces,
    labels: Ints,
    aims: Sequence[BaseGeometry],
    connected: bool = True,
) -> tuple[list[Piece], list[Mend]]:
    """``partition`` where the faces and their labels are known.

    A label of ``len(aims)`` and more is that of a hair: it counts from there.
    """
    owner, lost = _owners(polygon, faces, labels, len(aims), connected)
    pieces = _joined(faces, owner, len(aims), connected)
    mends = [Mend("cell in parts", k, share) for k, share in enumerate(lost) if share > LEAST_SHARE]
    empty = [k for k, piece in enumerate(pieces) if piece is None]
    if empty:
        lines = shapely.boundary([piece for piece in pieces if piece is not None])
        whole, cuts = filled(pieces, aims, polygon.area)
        noded = rejoined(polygon, faces.polygons)
        faces = faces_between(noded, np.concatenate([lines, *cuts]))
        labels = holders(array_of(whole), faces.places)
        owner, _ = _owners(polygon, faces, labels, len(aims), connected)
        pieces = _joined(faces, owner, len(aims), connected)
    found = [piece for piece in pieces if piece is not None]
    if len(found) < len(aims):
        raise ArithmeticError("the polygon is too small to be divided among its correspondents")
    mends += [Mend("empty cell", k, found[k].area / polygon.area) for k in empty]
    found = with_own_vertices(polygon, found)
    return list(shapely.orient_polygons(array_of(found))), mends


def _owners(
    polygon: Polygon, faces: Faces, labels: Ints, count: int, connected: bool
) -> tuple[Ints, list[float]]:
    """Who each face (f,) goes to; and the share of area (count,) that each label's parts lost.

    A part is what hangs together of the faces with one label; a hair is one of its own.
    """
    seams, area = faces.seams, polygon.area
    passable = seams.lengths > PINCH * np.ptp(shapely.get_coordinates(polygon), axis=0).max()
    pairs, lengths = np.column_stack([seams.left, seams.right])[passable], seams.lengths[passable]
    alike = (labels[pairs[:, 0]] == labels[pairs[:, 1]]) & (labels[pairs[:, 0]] < count)
    part = components(pairs[alike], len(labels))
    size = np.bincount(part, faces.areas).astype(np.float64)
    label = np.empty(len(size), dtype=np.intp)
    label[part] = labels % count
    hair = np.zeros(len(size), dtype=bool)
    hair[part] = labels >= count

    owner = np.full(len(size), NOBODY)
    order = np.lexsort((-size, hair, label))
    first = order[np.append(True, label[order[1:]] != label[order[:-1]])]
    solid = (size[first] > SLIVER * area) & ~hair[first]
    stays = first[solid] if solid.any() else first
    owner[stays] = label[stays]
    if not connected:
        large = size > CRUMB * area
        owner[large] = label[large]
    owner = _given_away(owner, part[pairs], lengths, size, count)
    gone = (owner != label) & (size > SLIVER * area)
    lost = np.bincount(label[gone], size[gone] / area, minlength=count)
    return owner[part], lost.tolist()


def _given_away(owner: Ints, pairs: Ints, lengths: Floats, size: Floats, count: int) -> Ints:
    """Owners, with each part that has none given to the one with the longest common seam."""
    owner = owner.copy()
    part, other = np.concatenate([pairs, pairs[:, ::-1]]).T
    lengths = np.concatenate([lengths, lengths])
    while (owner == NOBODY).any():
        meets = (owner[part] == NOBODY) & (owner[other] != NOBODY)
        if not meets.any():  # a sliver that shares no whole edge with anything
            owner[owner == NOBODY] = owner[np.argmax(size)]
            break
        keys, number = np.unique(part[meets] * count + owner[other[meets]], return_inverse=True)
        total = np.bincount(number.reshape(-1), lengths[meets])
        open_, candidate = np.divmod(keys, count)
        order = np.lexsort((-total, open_))
        best = order[np.append(True, open_[order[1:]] != open_[order[:-1]])]
        owner[open_[best]] = candidate[best]
    return owner


def _joined(faces: Faces, owner: Ints, count: int, connected: bool) -> list[Piece | None]:
    """What each owns, None where it owns nothing; without what roundings part from it."""
    whole = largest_part if connected else together
    order = np.argsort(owner, kind="stable")
    bounds = np.searchsorted(owner[order], np.arange(count + 1))
    groups = [order[first:last] for first, last in pairwise(bounds)]
    return [
        whole(shapely.get_parts(joined(faces.polygons[group]))) if len(group) else None
        for group in groups
    ]
