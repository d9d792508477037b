"""Correspondence: which origin polygons have to do with which target polygons.

origin  A B      A meets C and D, B meets D:      pairs  A-C  A-D  B-D
target  C D      a double list, read from either side

Every technique gives the same pairs, turned round, where time runs backwards, and does not
depend on the order of the polygons or on units.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.polygons import RELATIVE_TOLERANCE, PolygonSet, bounds_of, extent

# Polygons overlap where they share this part of the smaller one's area. Slivers, which borders
# drawn twice leave, are a border's error over a polygon's width: some 1e-5 to 1e-3. What changes
# in place shares a quarter and more.
SHARE = 1e-2

# A polygon that overlaps nothing by so much keeps its best overlap down to this part: a strip of
# a tenth of a pixel along a polygon that is a hundred wide. What is left is a sliver.
LEAST_SHARE = 1e-3

# The cost of one thing becoming another, in squares of length: of the way between the centroids,
# and of the difference in radius between discs of their areas. With equal weights it is the mean
# squared way of a disc's outline; but things that travel keep their size better than their place.
WAY_WEIGHT = 1.0
SIZE_WEIGHT = 4.0

Pairs = NDArray[np.intp]
Chosen = NDArray[np.bool_]  # of some pairs
Numbers = NDArray[np.float64]
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
    origin: PolygonSet,
    target: PolygonSet,
    technique: str = "intersects",
    radius: float | None = None,
) -> Correspondence:
    """Relate two sets by one of TECHNIQUES; ``radius`` is for ``within``, in the data's units.

    Raises
    ------
    ValueError
        For what ``check_technique`` refuses.
    """
    check_technique(technique, radius)
    relate = TECHNIQUES[technique] if radius is None else partial(within, radius=radius)
    pairs = relate(origin, target)
    return Correspondence(origin, target, pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))])


def check_technique(technique: str, radius: float | None = None) -> None:
    """Refuse a technique and a radius that do not go together.

    Raises
    ------
    ValueError
        For an unknown technique, a radius without ``within`` or ``within`` without one, and a
        radius that is negative or not finite.
    """
    if technique not in TECHNIQUES:
        names = ", ".join(sorted(TECHNIQUES))
        raise ValueError(f"unknown correspondence {technique!r}; expected one of {names}")
    if technique == "within" and radius is None:
        raise ValueError("correspondence within needs a radius")
    if technique != "within" and radius is not None:
        raise ValueError(f"correspondence {technique} takes no radius; within does")
    if radius is not None and not 0 <= radius < math.inf:
        raise ValueError(f"a radius is a finite number from 0 upwards, not {radius:g}")


def intersects(origin: PolygonSet, target: PolygonSet) -> Pairs:
    """Pairs of polygons that share at least a point: the paper's rule. Cost n log n plus pairs."""
    return shapely.STRtree(target.polygons).query(origin.polygons, predicate="intersects").T


def overlap(origin: PolygonSet, target: PolygonSet) -> Pairs:
    """Pairs that share at least SHARE of the smaller one's area, and of lonely ones their best.

    A polygon without such a pair keeps those with which it shares most area, from LEAST_SHARE
    on: one, but for ties. Cost n log n plus the intersections of those that meet.
    """
    return _by_area(origin, target, intersects(origin, target))


def same_key(origin: PolygonSet, target: PolygonSet) -> Pairs:
    """Pairs of the same key: identity instead of place.

    Among the parts of one key those correspond that intersect; where none do, each with each.
    Polygons without a key correspond among themselves iff they intersect.
    """
    meeting = intersects(origin, target)
    here, there = _key_numbers(origin, target)
    meeting = meeting[here[meeting[:, 0]] == there[meeting[:, 1]]]
    return np.concatenate([meeting, _unsettled(here, there, meeting)])


def key_then_overlap(origin: PolygonSet, target: PolygonSet) -> Pairs:
    """Keys where both sets have them, else overlap.

    Two polygons whose keys live on, each in the other set, correspond only if the keys are the
    same; their parts do by overlap, and where none overlap, each with each. What has no key, or
    one that the other set lacks, corresponds to what it overlaps: a part that leaves a country
    comes from that country, though the country's key lives on.
    """
    meeting = intersects(origin, target)
    here, there = _key_numbers(origin, target)
    shared = np.intersect1d(here[here >= 0], there[there >= 0])
    lives_here, lives_there = np.isin(here, shared), np.isin(there, shared)
    i, j = meeting.T
    allowed = (here[i] == there[j]) | ~lives_here[i] | ~lives_there[j]
    pairs = _by_area(origin, target, meeting[allowed])
    alike = pairs[here[pairs[:, 0]] == there[pairs[:, 1]]]
    return np.concatenate([pairs, _unsettled(here, there, alike)])


def within(origin: PolygonSet, target: PolygonSet, radius: float = 0.0) -> Pairs:
    """Pairs of things that travel: at most ``radius`` apart, and one to one as far as may be.

    Of all ways to give as many polygons as possible a partner of their own, the one of least
    cost (see WAY_WEIGHT). One that is left over joins the polygon with which it shares most area,
    from LEAST_SHARE on; else it is born or dies. Distances are between outlines, 0 where polygons
    meet. Needs scipy. Cost n log n plus the pairs in reach, and a sparse assignment among them:
    shortest augmenting paths after Jonker and Volgenant (1987), at worst cubic.
    """
    reach = radius + RELATIVE_TOLERANCE * extent(bounds_of([origin, target]))
    tree = shapely.STRtree(target.polygons)
    pairs = tree.query(origin.polygons, predicate="dwithin", distance=reach).T
    if not len(pairs):
        return pairs
    kept = _assigned(origin, target, pairs)
    return pairs[
        kept | _best_of_lonely(origin, target, pairs, _shared(origin, target, pairs), kept)
    ]


TECHNIQUES: Mapping[str, Technique] = {
    "intersects": intersects,
    "overlap": overlap,
    "within": within,
    "key": same_key,
    "auto": key_then_overlap,
}


def _by_area(origin: PolygonSet, target: PolygonSet, pairs: Pairs) -> Pairs:
    shared = _shared(origin, target, pairs)
    kept = _at_least(SHARE, origin, target, pairs, shared)
    return pairs[kept | _best_of_lonely(origin, target, pairs, shared, kept)]


def _shared(origin: PolygonSet, target: PolygonSet, pairs: Pairs) -> Numbers:
    """The area that the two of each pair have in common, (m,)."""
    ones, others = origin.polygons[pairs[:, 0]], target.polygons[pairs[:, 1]]
    return np.asarray(shapely.area(shapely.intersection(ones, others)))


def _at_least(
    share: float, origin: PolygonSet, target: PolygonSet, pairs: Pairs, shared: Numbers
) -> Chosen:
    areas, others = shapely.area(origin.polygons), shapely.area(target.polygons)
    smaller = np.minimum(areas[pairs[:, 0]], others[pairs[:, 1]])
    return np.asarray((shared > 0) & (shared >= share * smaller))


def _best_of_lonely(
    origin: PolygonSet, target: PolygonSet, pairs: Pairs, shared: Numbers, kept: Chosen
) -> Chosen:
    """Of polygons that no kept pair has, on either side, the pairs that share most area."""
    enough = _at_least(LEAST_SHARE, origin, target, pairs, shared)
    chosen = np.zeros(len(pairs), dtype=bool)
    for side, count in enumerate((len(origin), len(target))):
        lonely = np.ones(count, dtype=bool)
        lonely[pairs[kept, side]] = False
        most = np.zeros(count)
        np.maximum.at(most, pairs[enough, side], shared[enough])
        # Equally good ones are all kept: nothing about the pair prefers one of them.
        best = shared >= most[pairs[:, side]] * (1 - RELATIVE_TOLERANCE)
        chosen |= enough & best & lonely[pairs[:, side]]
    return chosen


def _assigned(origin: PolygonSet, target: PolygonSet, pairs: Pairs) -> Chosen:
    """Which pairs a one-to-one assignment takes: as many as can be, at the least sum of costs."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import min_weight_full_bipartite_matching

    box = bounds_of([origin, target])
    here, there = _places(origin, box), _places(target, box)
    cost = _costs(here[pairs[:, 0]], there[pairs[:, 1]])

    # Equal costs fall by place, not by the order of the polygons or the direction of time.
    order, other_order = np.lexsort(here.T), np.lexsort(there.T)
    rows, columns = np.argsort(order)[pairs[:, 0]], np.argsort(other_order)[pairs[:, 1]]
    count, others = len(origin), len(target)
    if there[other_order].tolist() < here[order].tolist():
        rows, columns, count, others = columns, rows, others, count

    # Each row has a column of its own that stands for nobody and costs more than any detour.
    # Weights from 1 upwards: a sparse matrix would take a 0 for no pair.
    weights = np.concatenate([1 + cost, np.full(count, 2.0 + min(count, others))])
    nobody = np.arange(count)
    at = (np.concatenate([rows, nobody]), np.concatenate([columns, others + nobody]))
    matrix = coo_array((weights, at), shape=(count, others + count)).tocsr()
    taken = np.empty(count, dtype=np.intp)
    found, partners = min_weight_full_bipartite_matching(matrix)
    taken[found] = partners
    return np.asarray(taken[rows] == columns)


def _places(polygons: PolygonSet, box: Numbers) -> Numbers:
    """Centroid and radius of a disc of the same area, (n, 3), in extents of ``box``, rounded."""
    centroids = shapely.get_coordinates(shapely.centroid(polygons.polygons)) - box[:2]
    radii = np.sqrt(shapely.area(polygons.polygons) / np.pi)
    places = np.column_stack([centroids, radii]) / extent(box)
    return np.round(places / RELATIVE_TOLERANCE) * RELATIVE_TOLERANCE


def _costs(here: Numbers, there: Numbers) -> Numbers:
    """The costs (m,) of places (m, 3) becoming others, from 0 to 1 for the dearest."""
    costs = (here - there) ** 2 @ [WAY_WEIGHT, WAY_WEIGHT, SIZE_WEIGHT]
    return np.asarray(costs / max(costs.max(), RELATIVE_TOLERANCE**2))


def _unsettled(here: NDArray[np.intp], there: NDArray[np.intp], settled: Pairs) -> Pairs:
    """Each with each of the same number, for numbers from 0 on that no settled pair has."""
    rows = np.flatnonzero((here >= 0) & ~np.isin(here, here[settled[:, 0]]))
    order = np.argsort(there, kind="stable")
    first = np.searchsorted(there[order], here[rows], side="left")
    counts = np.searchsorted(there[order], here[rows], side="right") - first
    within_row = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    columns = order[np.repeat(first, counts) + within_row]
    return np.column_stack([np.repeat(rows, counts), columns])


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
