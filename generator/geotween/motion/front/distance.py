"""Geodesic distances on triangle meshes, by the shortest ways along and across triangles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# Distances are done when none gets shorter by more than this share of the mesh's extent.
SETTLED = 1e-7

# Flatter corners than this (height over base) send no wave across the side before them.
FLAT = 1e-9


@dataclass(frozen=True, eq=False)
class Waves:
    """What waves need to know of triangles: for each corner the side across it, from start to end.

    Attributes
    ----------
    at, start, end : (3 T,) the corner's node and those at the ends of the side across it.
    base, x, y : (3 T,) the side's length, and where the corner lies along and off it.
    nodes : how many there are.
    """

    at: Ints
    start: Ints
    end: Ints
    base: Floats
    x: Floats
    y: Floats
    nodes: int


def waves(points: Floats, triangles: Ints, nodes: Ints, count: int) -> Waves:
    """Triangles (T, 3) of points (k, 2), whose corners are nodes (T, 3) out of ``count``.

    Distances are continuous across triangles that have nodes in common, wherever these lie.
    """
    at, start, end = (np.roll(triangles, -i, axis=1).reshape(-1) for i in range(3))
    side, arm = points[end] - points[start], points[at] - points[start]
    base = np.hypot(*side.T)
    safe = np.maximum(base, np.finfo(float).tiny)
    x = (side * arm).sum(axis=1) / safe
    y = np.abs(side[:, 0] * arm[:, 1] - side[:, 1] * arm[:, 0]) / safe
    corner, one, other = (np.roll(nodes, -i, axis=1).reshape(-1) for i in range(3))
    return Waves(corner, one, other, base, x, y, count)


def distances(waves: Waves, start: Floats) -> Floats:
    """The shortest way to each node (n,) from what is given: ``start`` (n,), infinite where open.

    Notes
    -----
    Dijkstra along sides, then Kimmel and Sethian's (1998) waves across triangles until nothing
    gets nearer, from the nodes that did only. The wave that reaches a corner across a side is
    linear on it and sets out from the best point of the side, its ends included: that holds for
    obtuse corners too. O(n log n), and about as many passes as triangles lie in a row.
    """
    found = _along_sides(waves, start)
    size = max(float(waves.base.max(initial=0.0)), float(found[np.isfinite(found)].max(initial=0)))
    fresh = np.isfinite(found)
    while fresh.any():
        which = np.flatnonzero(fresh[waves.start] | fresh[waves.end])
        which = which[np.isfinite(found[waves.start[which]] + found[waves.end[which]])]
        reached = np.full(waves.nodes, np.inf)
        np.minimum.at(reached, waves.at[which], _across(waves, which, found))
        fresh = reached < found - SETTLED * size
        found = np.where(fresh, reached, found)
    return found


def _along_sides(waves: Waves, start: Floats) -> Floats:
    """The shortest ways along sides."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import dijkstra

    # One more node, from which all ways set out; a side that two triangles have counts once.
    key = np.minimum(waves.start, waves.end) * waves.nodes + np.maximum(waves.start, waves.end)
    order = np.argsort(key, kind="stable")
    order = order[np.append(True, key[order[1:]] != key[order[:-1]])] if len(order) else order
    begins = np.flatnonzero(np.isfinite(start))
    lengths = np.concatenate([waves.base[order], start[begins]])
    rows = np.concatenate([waves.start[order], np.full(len(begins), waves.nodes)])
    columns = np.concatenate([waves.end[order], begins])
    # Sparse graphs take a zero for no edge.
    lengths = np.maximum(lengths, np.finfo(float).tiny)
    graph = csr_array((lengths, (rows, columns)), shape=(waves.nodes + 1, waves.nodes + 1))
    found: Floats = dijkstra(graph, directed=False, indices=np.array([waves.nodes]))[0, :-1]
    return np.minimum(found, start)


def _across(waves: Waves, which: Ints, found: Floats) -> Floats:
    """What reaches some corners across the side before them."""
    x, y, base = waves.x[which], waves.y[which], np.maximum(waves.base[which], 1e-300)
    from_, to = found[waves.start[which]], found[waves.end[which]]
    slope = np.clip((to - from_) / base, -1 + FLAT, 1 - FLAT)
    share = np.clip((x - y * slope / np.sqrt(1 - slope**2)) / base, 0.0, 1.0)
    return np.asarray(from_ + share * (to - from_) + np.hypot(x - share * base, y))
