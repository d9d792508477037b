"""Harmonic functions on triangle meshes: between given values as smooth as can be."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

# Sides across from obtuse corners on both sides have negative weights, and with these a value may
# lie beyond all given ones: weights are at least so much.
LEAST_WEIGHT = 1e-3


def harmonic(points: Floats, triangles: Ints, nodes: Ints, given: Floats) -> Floats:
    """Values (n,) at all nodes from those given: NaN where they are asked for.

    Parameters
    ----------
    points, triangles, nodes
        Triangles (T, 3) of points (k, 2), and the nodes (T, 3) of their corners.
    given
        (n,) a node that no side joins to a given value gets 0.

    Notes
    -----
    The cotangent Laplacian (Pinkall and Polthier, 1993), with positive weights. Values stay
    between the given ones, and nothing flows across borders. Some n^1.5 for n nodes in a row.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components
    from scipy.sparse.linalg import spsolve

    count = len(given)
    known = ~np.isnan(given)
    start, end = np.roll(nodes, -1, axis=1), np.roll(nodes, -2, axis=1)
    weight = np.maximum(_cotangents(points, triangles), LEAST_WEIGHT)
    # Where all is given nothing is to be solved for.
    asked = ~(known[start] & known[end])
    one, other, weight = start[asked], end[asked], weight[asked]
    rows, columns = np.concatenate([one, other]), np.concatenate([other, one])
    flow = csr_array((np.tile(weight, 2), (rows, columns)), shape=(count, count))
    _, group = connected_components(flow, directed=False)
    reached = np.bincount(group, known)[group] > 0
    free = np.flatnonzero(~known & reached)
    values = np.where(known, given, 0.0)
    if not len(free):
        return values
    # Rows of equal weight: scales of coordinates do not matter.
    rate = np.asarray(flow.sum(axis=1)).reshape(-1)[free]
    matrix = csr_array((rate, (np.arange(len(free)),) * 2)) - flow[free][:, free]
    values[free] = spsolve(matrix.tocsc(), (flow[free] @ values), permc_spec="MMD_AT_PLUS_A")
    return values


def _cotangents(points: Floats, triangles: Ints) -> Floats:
    """The cotangent (T, 3) of the angle at each corner."""
    corner = points[triangles]
    one, other = np.roll(corner, -1, axis=1) - corner, np.roll(corner, -2, axis=1) - corner
    doubled = np.abs(one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0])
    return np.asarray((one * other).sum(axis=2) / np.maximum(doubled, np.finfo(float).tiny))
