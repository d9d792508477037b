"""The choice between the two motions: what changes in place is swept, what travels is morphed.

It is made for each cluster: groups of corresponding polygons, and what borders on them. Two areas
are compared. Sweeping costs the area that changes hands, once: what one group loses and another
one of the cluster gains counts for both of them together. Travelling costs the way of each group's
centroid times its width, and the area that changes where the target is laid on the origin.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.polygons import PolygonSet
from geotween.motion.correspond import Correspondence, Pairs
from geotween.motion.groups import Groups, Numbers, grouped
from geotween.motion.techniques import FRONT, MORPH, Techniques

# What shares less than this part of the smaller area with itself at the other end is elsewhere, and
# its way, however far, costs nothing: it cannot have changed in place. So it is for clusters: tiles
# that change places within their tiling would travel across it.
APART = 0.1

Chosen = NDArray[np.bool_]


def swept_groups(related: Correspondence, groups: Groups, techniques: Techniques) -> Chosen:
    """Which groups (g,) move as fronts: by the method and its exceptions, else by cost."""
    method = techniques.method
    if method == "paper" or (method != "auto" and not techniques.exceptions):
        return np.full(groups.count, method == FRONT)
    clusters = _clusters(related, groups)
    named = _named(related, groups, techniques)
    swept, travelled = _costs(related, groups, clusters)
    cheaper = swept <= travelled
    by = {"auto": cheaper, FRONT: np.full_like(cheaper, True), MORPH: np.full_like(cheaper, False)}
    chosen = by[method]
    for name, choice in by.items():
        mine = np.isin(np.arange(groups.count), clusters[named == name])
        chosen = np.where(mine, choice, chosen)
    return np.asarray(chosen[clusters], dtype=bool)


def _named(related: Correspondence, groups: Groups, techniques: Techniques) -> NDArray[np.object_]:
    """The method that an exception names for a polygon of each group; empty where none does."""
    named = np.full(groups.count, "", dtype=object)
    for end, numbers in ((related.origin, groups.of_origin), (related.target, groups.of_target)):
        for identity, group in zip(end.identities, numbers.tolist(), strict=True):
            method = techniques.named(identity)
            if method:
                named[group] = method
    return named


def _clusters(related: Correspondence, groups: Groups) -> Numbers:
    """The cluster (g,) of each group.

    Polygons of one end that have a border in common join, and those that follow each other in one
    place.
    """
    count = len(related.origin)
    further = np.concatenate(
        [
            _neighbours(related.origin),
            _neighbours(related.target) + count,
            _followers(related.origin, related.target) + np.array([0, count]),
        ]
    )
    joined = grouped(related, further)
    clusters = np.empty(groups.count, dtype=np.intp)
    clusters[groups.of_origin] = joined.of_origin
    clusters[groups.of_target] = joined.of_target
    return clusters


def _neighbours(polygons: PolygonSet) -> Pairs:
    """Pairs (k, 2) of polygons of a set whose borders have more than points in common."""
    one, other = shapely.STRtree(polygons.polygons).query(polygons.polygons, predicate="intersects")
    apart = one < other
    one, other = one[apart], other[apart]
    lines: Any = shapely.boundary(polygons.polygons)
    shared = shapely.get_dimensions(shapely.intersection(lines[one], lines[other])) > 0
    return np.asarray(np.column_stack([one, other])[shared])


def _followers(origin: PolygonSet, target: PolygonSet) -> Pairs:
    """Pairs (k, 2) of an origin and a target polygon that have area in common."""
    one, other = shapely.STRtree(target.polygons).query(origin.polygons, predicate="intersects")
    inside = shapely.relate_pattern(origin.polygons[one], target.polygons[other], "T********")
    return np.asarray(np.column_stack([one, other])[inside])


def _costs(
    related: Correspondence, groups: Groups, clusters: Numbers
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """What each cluster costs (g,) if it is swept, and if it travels, in square units."""
    here, there, changed = _ends(related, groups.of_origin, groups.of_target, groups.count)
    centres = [
        shapely.get_coordinates(shapely.centroid(np.where(shapely.is_empty(one), other, one)))
        for one, other in ((here, there), (there, here))
    ]
    ways = centres[1] - centres[0]
    left = shapely.area(shapely.symmetric_difference(_shifted(here, ways), there))
    widths = np.sqrt((shapely.area(here) + shapely.area(there)) / 2)
    whole, wholes, outside = _ends(
        related, clusters[groups.of_origin], clusters[groups.of_target], groups.count
    )
    areas = shapely.area(whole), shapely.area(wholes)
    apart = (areas[0] + areas[1] - outside) / 2 < APART * np.minimum(*areas)
    way = np.where(apart[clusters], 0, np.hypot(*ways.T))
    changing = np.bincount(clusters, changed, groups.count)
    travelled = np.bincount(clusters, left + way * widths, groups.count)
    return (changing + outside) / 2, np.asarray(travelled, dtype=np.float64)


def _ends(
    related: Correspondence, of_origin: Numbers, of_target: Numbers, count: int
) -> tuple[NDArray[np.object_], NDArray[np.object_], NDArray[np.float64]]:
    """The area of each group at both ends, and how much of it is in one of them only, all (g,)."""
    here = _united(related.origin, of_origin, count)
    there = _united(related.target, of_target, count)
    return here, there, shapely.area(shapely.symmetric_difference(here, there))


def _united(polygons: PolygonSet, numbers: Numbers, count: int) -> NDArray[np.object_]:
    """The area (g,) of each group's polygons."""
    found = np.full(count, shapely.Polygon(), dtype=object)
    order = np.argsort(numbers, kind="stable")
    firsts = np.flatnonzero(np.append(True, np.diff(numbers[order]) > 0)) if len(order) else order
    for part in np.split(order, firsts[1:]):
        if len(part):
            found[numbers[part[0]]] = shapely.union_all(polygons.polygons[part])
    return found


def _shifted(areas: NDArray[np.object_], ways: NDArray[np.float64]) -> NDArray[np.object_]:
    points, owner = shapely.get_coordinates(areas, return_index=True)
    return np.asarray(shapely.set_coordinates(areas.copy(), points + ways[owner]))
