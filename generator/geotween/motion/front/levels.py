"""Level sets of a field as a coarse, exactly valid triangulation: what a film is made of."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from geotween.motion.front.coarse import Coarse, coarse
from geotween.motion.front.counts import counted
from geotween.motion.front.evenness import set_right
from geotween.motion.front.flaws import flaws
from geotween.motion.front.meshes import mesh_of, spans_of
from geotween.motion.front.plane import NOTHING, Change, Floats, Ints
from geotween.motion.front.triangulate import twins

if TYPE_CHECKING:
    from geotween.motion.front.field import Field

# By how many tolerances levels are simplified: less, where that breaks a triangulation.
SIMPLIFIED = np.array([1.0, 0.25, 0.0])


@dataclass(frozen=True, eq=False)
class Arrivals:
    """When each place changes, in few triangles: linear on each.

    Where the time at a place is less than t the thing there is ``after``, else it is ``before``.

    Attributes
    ----------
    points : (p, 2) those of the plane first.
    triangles : (T, 3) counter-clockwise, with area; they tile the regions of change.
    times : (T, 3) of the corners, multiples of 1/1024 from 0 to 1. Across an edge they may differ.
    before, after : (T,) things.
    edges : (m, 2) the edges of all triangles, each once, and the borders between things that do
        not change.
    sides : (m, 2) the triangle to the left and to the right, NOTHING where none is.
    still : (m, 2) where that side has no triangle, the thing there, or NOTHING.
    """

    points: Floats
    triangles: Ints
    times: Floats
    before: Ints
    after: Ints
    edges: Ints
    sides: Ints
    still: Ints


def levels(change: Change, field: Field, tolerance: float) -> Arrivals:
    """Few triangles whose corners lie on level sets of a field.

    Parameters
    ----------
    tolerance
        What nobody sees, in the data's units: half a pixel.

    Raises
    ------
    ArithmeticError
        Where a region of change cannot be triangulated, as its outline crosses itself.

    Notes
    -----
    A region is parted into up to 32 bands by level sets at equal times. A band is triangulated
    between its simplified levels, so that a straight line leads from each level to the next. All
    points on edges of the plane are there for both sides. O(n log n) for n triangles of the field.
    """
    mesh = mesh_of(change, field)
    spans = spans_of(change, mesh)
    spans = counted(change, mesh, spans, tolerance)
    tries = np.zeros(len(spans.counts), dtype=np.intp)
    while True:
        found = coarse(change, mesh, spans, tolerance * SIMPLIFIED[tries])
        if not found.unsound.any():
            return _arrivals(change, set_right(change, found))
        last = found.unsound & (tries == len(SIMPLIFIED) - 1)
        hopeless = int((last & (spans.counts == 1)).sum())
        if hopeless:
            raise ArithmeticError(f"{hopeless} regions of change could not be triangulated")
        spans = replace(spans, counts=np.where(last, 1, spans.counts))
        tries = np.minimum(tries + found.unsound, len(SIMPLIFIED) - 1)


def _arrivals(change: Change, found: Coarse) -> Arrivals:
    face = np.zeros(len(found.unsound), dtype=np.intp)
    changing = np.flatnonzero(change.region != NOTHING)
    face[change.region[changing]] = changing
    faces = face[found.region]
    edges, sides, still = _edges(change, found)
    used = np.ones(len(found.points), dtype=bool)
    used[found.skeleton.plain :] = False
    used[edges] = True
    number = np.cumsum(used) - 1
    return Arrivals(
        found.points[used],
        number[found.triangles],
        found.times,
        change.before[faces],
        change.after[faces],
        number[edges],
        sides,
        still,
    )


def _edges(change: Change, found: Coarse) -> tuple[Ints, Ints, Ints]:
    """Every edge of the triangles once, and the borders between things that do not change."""
    triangles, skeleton = found.triangles, found.skeleton
    other = twins(triangles, np.zeros(len(triangles), dtype=np.intp))
    side = np.arange(triangles.size).reshape(-1, 3)
    row, corner = np.nonzero((other == NOTHING) | (side < other))
    edges = np.column_stack([triangles[row, corner], triangles[row, (corner + 1) % 3]])
    beyond = other[row, corner]
    sides = np.column_stack([row, np.where(beyond == NOTHING, NOTHING, beyond // 3)])
    still = np.full(edges.shape, NOTHING, dtype=np.intp)

    # What does not change lies beyond edges of the plane, in the same direction or the other one.
    on = np.flatnonzero(skeleton.lines != NOTHING)
    parts = skeleton.edges[on]
    faces = change.plane.sides[skeleton.lines[on]]
    resting = np.append(change.region == NOTHING, True)[faces]
    thing = np.where(resting, np.append(change.before, NOTHING)[faces], NOTHING)
    size = len(found.points)
    code = np.concatenate([parts @ [size, 1], parts[:, ::-1] @ [size, 1]])
    right = np.concatenate([thing[:, 1], thing[:, 0]])
    order = np.argsort(code, kind="stable")
    alone = sides[:, 1] == NOTHING
    place = np.searchsorted(code, edges[alone] @ [size, 1], sorter=order).clip(max=len(code) - 1)
    still[alone, 1] = right[order[place]]

    border = resting.all(axis=1) & (thing[:, 0] != thing[:, 1])
    none = np.full((int(border.sum()), 2), NOTHING, dtype=np.intp)
    return (
        np.concatenate([edges, parts[border]]),
        np.concatenate([sides, none]),
        np.concatenate([still, thing[border]]),
    )


__all__ = ["Arrivals", "flaws", "levels"]
