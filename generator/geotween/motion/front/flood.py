"""No islands: from every node of a mesh a way leads down to where fronts set out, never rising."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]
Flags = NDArray[np.bool_]


def filled(values: Floats, sides: Ints, roots: Flags, step: float) -> Floats:
    """Values (n,) raised as little as it takes to have no hollow but at the roots.

    Afterwards a way leads from each node, along sides, to a root, on which values fall by ``step``
    at least from node to node. Nodes that no way joins to a root stay as they are.

    Parameters
    ----------
    values
        Between 0 and 1.
    sides
        (m, 2) nodes, in any order, repeated or not.
    roots
        (n,) nodes that may lie lowest.

    Notes
    -----
    Priority flood (Barnes, Lehman and Mulla, 2014): a node lies as high as the highest on the
    lowest way to it. Such ways run in a minimum spanning tree, along which the highest so far is
    found by doubling. O(n log n).
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import breadth_first_order, minimum_spanning_tree

    count = len(values)
    key = np.unique(sides.min(axis=1) * count + sides.max(axis=1))
    low, high = np.divmod(key[key // count != key % count], count)
    root = np.flatnonzero(roots)
    # No weight is 0, which would be no side; the root of roots is nearest.
    weights = np.concatenate([1 + np.maximum(values[low], values[high]), np.full(len(root), 0.5)])
    rows = np.concatenate([low, np.full(len(root), count)])
    columns = np.concatenate([high, root])
    graph = csr_array((weights, (rows, columns)), shape=(count + 1, count + 1))
    tree = minimum_spanning_tree(graph)
    _, parent = breadth_first_order(tree, count, directed=False)
    parent = np.where(parent < 0, count, parent).astype(np.intp)
    reached = np.append(parent[:-1] != count, True)
    reached[root] = True

    depth = np.append(np.ones(count, dtype=np.intp), 0)
    ahead = parent.copy()
    while (ahead != count).any():
        depth, ahead = depth + depth[ahead], ahead[ahead]
    level = np.append(values, -np.inf) - step * depth
    ahead = parent.copy()
    while (ahead != count).any():
        level, ahead = np.maximum(level, level[ahead]), ahead[ahead]
    return np.where(reached[:-1], (level + step * depth)[:-1], values)
