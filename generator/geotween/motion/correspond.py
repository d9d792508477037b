"""Correspondence: which origin polygons have to do with which target polygons.

origin  A B      A meets C and D, B meets D:      pairs  A-C  A-D  B-D
target  C D      a double list, read from either side
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.polygons import PolygonSet

Pairs = NDArray[np.intp]
Technique = Callable[[PolygonSet, PolygonSet], Pairs]


@dataclass(frozen=True, eq=False)
class Correspondence:
    """The many-to-many relation between two sets.

    ``pairs`` has shape (m, 2): the index of an origin polygon and that of a target polygon,
    sorted, each pair once.
    """

    origin: PolygonSet
    target: PolygonSet
    pairs: Pairs

    def of_origin(self) -> list[NDArray[np.intp]]:
        """The paper's CO: for each origin polygon the indices of its target polygons."""
        return _lists(self.pairs, len(self.origin))

    def of_target(self) -> list[NDArray[np.intp]]:
        """The paper's CT: for each target polygon the indices of its origin polygons."""
        return _lists(self.pairs[:, ::-1], len(self.target))


def correspond(
    origin: PolygonSet, target: PolygonSet, technique: str = "intersects"
) -> Correspondence:
    """Relate two sets by one of TECHNIQUES."""
    pairs = TECHNIQUES[technique](origin, target)
    return Correspondence(origin, target, pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))])


def intersects(origin: PolygonSet, target: PolygonSet) -> Pairs:
    """Pairs of polygons that share at least a point: the paper's rule. Cost n log n plus pairs."""
    if not len(origin) or not len(target):
        return np.empty((0, 2), dtype=np.intp)
    tree = shapely.STRtree(target.polygons)
    return tree.query(origin.polygons, predicate="intersects").T


def same_key(origin: PolygonSet, target: PolygonSet) -> Pairs:
    """Pairs of the same key: identity instead of place.

    Among the parts of one key those correspond that intersect; where none do, each with each.
    Polygons without a key correspond among themselves iff they intersect.
    """
    meeting = intersects(origin, target)
    here, there = _key_numbers(origin, target)
    meeting = meeting[here[meeting[:, 0]] == there[meeting[:, 1]]]
    settled = np.unique(here[meeting[:, 0]])
    rows, columns = np.nonzero((here[:, None] == there[None, :]) & (here[:, None] >= 0))
    apart = ~np.isin(here[rows], settled)
    return np.concatenate([meeting, np.column_stack([rows[apart], columns[apart]])])


TECHNIQUES: Mapping[str, Technique] = {"intersects": intersects, "key": same_key}


def _key_numbers(
    origin: PolygonSet, target: PolygonSet
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """A number for each polygon, equal where keys are; -1 for those without a key."""
    numbers: dict[object, int] = {}

    def number(polygons: PolygonSet) -> NDArray[np.intp]:
        return np.array(
            [
                numbers.setdefault(i.key, len(numbers)) if i.keyed else -1
                for i in polygons.identities
            ],
            dtype=np.intp,
        )

    return number(origin), number(target)


def _lists(pairs: Pairs, count: int) -> list[NDArray[np.intp]]:
    order = np.lexsort((pairs[:, 1], pairs[:, 0]))
    starts = np.searchsorted(pairs[order, 0], np.arange(1, count))
    return np.split(pairs[order, 1], starts) if count else []
