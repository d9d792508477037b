"""What is wrong with arrivals: the contract that a film is made from, looked at in full."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import shapely

from geotween.motion.front.exact import turns
from geotween.motion.front.meshes import TICKS
from geotween.motion.front.plane import NOTHING, Change, Ints

if TYPE_CHECKING:
    from geotween.motion.front.levels import Arrivals

# By how much, as a share of all that changes, the area of what goes from one thing to another may
# be off: rounding of points put on edges.
AREA_ERROR = 1e-9


def flaws(arrivals: Arrivals, change: Change) -> list[str]:
    """What is wrong with some arrivals of a change, in words; empty if nothing is.

    Looked at are the triangles' orientation, exactly, and area, for each pair of things; times;
    the edges, of which each has on both sides what the triangles say; and that the triangles'
    own outline is the edges of the plane beside what changes. O(n log n).
    """
    return [
        flaw
        for flaw in (
            _times(arrivals),
            _orientation(arrivals),
            _areas(arrivals, change),
            _sides(arrivals),
            _closed(arrivals),
            _ends(arrivals, change),
        )
        if flaw
    ]


def _times(arrivals: Arrivals) -> str:
    ticks = arrivals.times * TICKS
    wrong = ~((ticks >= 0) & (ticks <= TICKS) & (ticks == np.rint(ticks)))
    return f"{wrong.sum()} times are no key times" if wrong.any() else ""


def _orientation(arrivals: Arrivals) -> str:
    wrong = (turns(arrivals.points, arrivals.triangles) <= 0).sum()
    return f"{wrong} triangles are flat or turned over" if wrong else ""


def _areas(arrivals: Arrivals, change: Change) -> str:
    changing = change.region != NOTHING
    real = shapely.area(change.plane.faces)
    found = turns(arrivals.points, arrivals.triangles) / 2
    size = len(change.things) + 1
    wanted = np.bincount(
        (change.before * size + change.after)[changing] + size + 1, real[changing], (size + 1) ** 2
    )
    there = np.bincount(arrivals.before * size + arrivals.after + size + 1, found, (size + 1) ** 2)
    rounding = np.finfo(float).eps * np.abs(change.plane.points).max(initial=0.0)
    allowed = AREA_ERROR * real[changing].sum() + 8 * rounding * change.plane.lengths.sum()
    wrong = (np.abs(wanted - there) > allowed).sum()
    return f"what goes over between {wrong} pairs of things has another area" if wrong else ""


def _sides(arrivals: Arrivals) -> str:
    """Each side of each triangle is an edge, once, with the triangle on its side."""
    size = len(arrivals.points)
    triangles = arrivals.triangles
    number = np.repeat(np.arange(len(triangles)), 3)
    wanted = np.column_stack(
        [number, triangles.ravel() * size + np.roll(triangles, -1, axis=1).ravel()]
    )
    left, right = (arrivals.sides[:, i] != NOTHING for i in (0, 1))
    there = np.concatenate(
        [
            np.column_stack([arrivals.sides[left, 0], arrivals.edges[left] @ [size, 1]]),
            np.column_stack([arrivals.sides[right, 1], arrivals.edges[right, ::-1] @ [size, 1]]),
        ]
    )
    same = len(wanted) == len(there) and bool((_sorted(wanted) == _sorted(there)).all())
    low, high = np.sort(arrivals.edges, axis=1).T
    twice = len(low) - len(np.unique(low * size + high))
    if twice:
        return f"{twice} edges are there twice"
    return "" if same else "edges do not have the triangles on their sides"


def _closed(arrivals: Arrivals) -> str:
    """Before and after, the edges between different things close: every thing has an outline."""
    wrong = 0
    for labels in (arrivals.before, arrivals.after):
        beside = np.append(labels, NOTHING)[arrivals.sides]
        beside = np.where(arrivals.sides == NOTHING, arrivals.still, beside)
        border = beside[:, 0] != beside[:, 1]
        balance = [
            (beside[border, side] * len(arrivals.points) + ends, sign)
            for side, ways in ((0, (1, -1)), (1, (-1, 1)))
            for ends, sign in zip(arrivals.edges[border].T, ways, strict=True)
        ]
        code = np.concatenate([keys for keys, _ in balance])
        sign = np.concatenate([np.full(len(keys), sign) for keys, sign in balance])
        code, sign = code[code >= 0], sign[code >= 0]
        _, place = np.unique(code, return_inverse=True)
        wrong += int((np.bincount(place.reshape(-1), sign) != 0).sum())
    return f"outlines have {wrong} open ends" if wrong else ""


def _ends(arrivals: Arrivals, change: Change) -> str:
    """The outlines of all things have the area of their faces, before and after."""
    faces = shapely.area(change.plane.faces)
    count = len(change.things) + 1
    origin = change.plane.points.mean(axis=0) if len(change.plane.points) else np.zeros(2)
    points = arrivals.points - origin
    rounding = np.finfo(float).eps * np.abs(change.plane.points).max(initial=0.0)
    allowed = AREA_ERROR * faces.sum() + 8 * rounding * change.plane.lengths.sum()
    wrong = 0
    for labels, cover in ((arrivals.before, change.before), (arrivals.after, change.after)):
        beside = np.append(labels, NOTHING)[arrivals.sides]
        beside = np.where(arrivals.sides == NOTHING, arrivals.still, beside)
        start, end = points[arrivals.edges].transpose(1, 0, 2)
        swept = (start[:, 0] * end[:, 1] - start[:, 1] * end[:, 0]) / 2
        found = np.bincount(beside[:, 0] + 1, swept, count)
        found -= np.bincount(beside[:, 1] + 1, swept, count)
        wanted = np.bincount(cover + 1, faces, count)
        wrong += int((np.abs(found - wanted)[1:] > allowed).sum())
    return f"{wrong} things do not have the area of their faces" if wrong else ""


def _sorted(rows: Ints) -> Ints:
    return rows[np.lexsort(rows.T)]


__all__ = ["flaws"]
