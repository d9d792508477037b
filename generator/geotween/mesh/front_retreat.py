"""Back-tracking: about poor triangles delete those around, and let the front advance again."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geotween.mesh.fill import twins
from geotween.mesh.front_advance import Front
from geotween.mesh.front_tree import FrontTree
from geotween.mesh.smoothing import ENOUGH, Bools, Floats, Ints, improved, signed_quality

POOR = 0.8  # quality below which a triangle is worth another try
RINGS = 2  # of neighbours that are deleted with it
ROUNDS = 2  # of flips and smoothing in what was made anew


def retreated(points: Floats, triangles: Ints, tree: FrontTree, fixed: int) -> tuple[Floats, Ints]:
    """Points (n, 2) and triangles (m, 3), made anew about poor ones, where that is better.

    A triangle with more than one corner on the boundary, among the ``fixed`` first points, is poor
    by the boundary's own shape most often: it is deleted only if it lies near another one. What is
    deleted falls into cavities; each is kept as it was unless its triangles get better.

    Notes
    -----
    Cost: that of advancing through what is deleted.
    """
    poor = _shortfall(points, triangles) > 0
    deleted = poor & ((triangles < fixed).sum(axis=1) <= 1)
    for _ in range(RINGS):
        reached = np.zeros(len(points), dtype=bool)
        reached[triangles[deleted]] = True
        deleted = reached[triangles].any(axis=1)
    if not deleted.any():
        return points, triangles
    kept, old = triangles[~deleted], triangles[deleted]
    cavity = _cavities(old)
    moved, new, owner = _advanced(points, old, cavity, tree)
    free = _inner(len(moved), kept, new, fixed)
    moved, new = improved(moved, new, free, owner, ROUNDS)

    before = np.bincount(cavity, _shortfall(points, old))
    after = np.bincount(owner, _shortfall(moved, new), len(before))
    better = after < before
    old = old[~better[cavity]]
    moved[old] = points[old]
    return moved, np.concatenate([kept, old, new[better[owner]]])


def _shortfall(points: Floats, triangles: Ints) -> Floats:
    """What each triangle lacks to be a good one, (m,); 0 for good ones."""
    quality = signed_quality(*points[triangles].transpose(1, 0, 2))
    return np.where(quality < POOR, ENOUGH - quality, 0.0)


def _cavities(triangles: Ints) -> Ints:
    """A number for each triangle (m,): the same for those that hang together by their sides."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    count = len(triangles)
    pairs, _ = twins(triangles, np.zeros(count, dtype=np.intp))
    graph = coo_matrix((np.ones(len(pairs)), (pairs // 3).T), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1])


def _advanced(
    points: Floats, old: Ints, cavity: Ints, tree: FrontTree
) -> tuple[Floats, Ints, Ints]:
    """Points and new ones, new triangles in the place of old ones, and the cavity of each."""
    front = Front(points, tree)
    owner: list[int] = []
    order = np.argsort(cavity, kind="stable")
    parts = np.split(old[order], np.flatnonzero(np.diff(cavity[order])) + 1)
    for number, part in enumerate(parts):
        for a, b, c in part.tolist():
            front.add(a, b)
            front.add(b, c)
            front.add(c, a)
        front.advance()
        owner += [number] * (len(front.triangles) - len(owner))
    return (
        np.column_stack([front.x, front.y]),
        np.array(front.triangles, dtype=np.intp),
        np.array(owner, dtype=np.intp),
    )


def _inner(count: int, kept: Ints, new: Ints, fixed: int) -> Bools:
    """Which points only new triangles have; not those of the boundary, which come first."""
    inner: NDArray[np.bool_] = np.zeros(count, dtype=bool)
    inner[new] = True
    inner[kept] = False
    inner[:fixed] = False
    return inner
