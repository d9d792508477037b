"""Groups: the polygons of both ends that hang together by correspondence.

origin  A B   C      A meets D and E, B meets E:      one group  A B D E,
target   D E   F     C meets F, G is born             and  C F,  and  G
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geotween.motion.correspond import Correspondence, Pairs

Numbers = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Groups:
    """The number of the group of each origin polygon, and of each target polygon."""

    of_origin: Numbers
    of_target: Numbers

    @property
    def count(self) -> int:
        return int(max(self.of_origin.max(initial=-1), self.of_target.max(initial=-1))) + 1

    def of_pairs(self, indices: Pairs) -> Numbers:
        """The groups (m,) of pairs of polygons; -1 stands for no polygon."""
        origins, targets = (np.append(of, -1) for of in (self.of_origin, self.of_target))
        return np.asarray(np.maximum(origins[indices[:, 0]], targets[indices[:, 1]]))


def grouped(related: Correspondence, further: Pairs | None = None) -> Groups:
    """The connected groups of a correspondence.

    ``further`` (k, 2) are pairs that hang together, too, in numbers that count the target's
    polygons after the origin's.
    """
    count, others = len(related.origin), len(related.target)
    pairs = related.pairs + np.array([0, count])
    if further is not None:
        pairs = np.concatenate([pairs, further])
    numbers = connected(pairs, count + others)
    return Groups(numbers[:count], numbers[count:])


def only(related: Correspondence, groups: Groups, chosen: NDArray[np.bool_]) -> Correspondence:
    """The part of a correspondence that is in chosen groups (g,)."""
    origin, target = chosen[groups.of_origin], chosen[groups.of_target]
    kept = related.pairs[origin[related.pairs[:, 0]]] if len(related.pairs) else related.pairs
    places = np.column_stack(
        [(np.cumsum(of) - 1)[kept[:, k]] for k, of in ((0, origin), (1, target))]
    )
    return Correspondence(related.origin.chosen(origin), related.target.chosen(target), places)


def connected(pairs: Pairs, count: int) -> Numbers:
    """For each of ``count`` nodes the number of its component, for pairs (k, 2) of nodes."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(pairs), dtype=bool), tuple(pairs.T)), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.intp)
