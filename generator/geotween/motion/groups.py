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
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    count, others = len(related.origin), len(related.target)
    rows, columns = related.pairs[:, 0], related.pairs[:, 1] + count
    if further is not None:
        rows = np.concatenate([rows, further[:, 0]])
        columns = np.concatenate([columns, further[:, 1]])
    graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(count + others,) * 2)
    numbers = connected_components(graph, directed=False)[1].astype(np.intp)
    return Groups(numbers[:count], numbers[count:])


def only(related: Correspondence, groups: Groups, chosen: NDArray[np.bool_]) -> Correspondence:
    """The part of a correspondence that is in chosen groups (g,)."""
    origin, target = chosen[groups.of_origin], chosen[groups.of_target]
    kept = related.pairs[origin[related.pairs[:, 0]]] if len(related.pairs) else related.pairs
    places = np.column_stack(
        [(np.cumsum(of) - 1)[kept[:, k]] for k, of in ((0, origin), (1, target))]
    )
    return Correspondence(related.origin.chosen(origin), related.target.chosen(target), places)
