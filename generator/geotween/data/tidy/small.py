"""Islands and holes too small to matter, left out without tearing a gap."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from shapely.geometry import Polygon

from geotween.data.tidy.linework import Ints, Mask, Shapes


def drop_small(sets: Sequence[Shapes], area: float) -> tuple[list[Shapes], list[int], list[float]]:
    """Polygon sets without the islands and holes smaller than an area, in square units.

    A small polygon stays where it borders on another of its set: without it there would be a gap.
    A small hole is filled only where nothing that stays lies in it. A shape that loses all its
    parts becomes an empty MultiPolygon. Also returns, per set, how many polygons were dropped (not
    counting holes that were filled) and their area.
    """
    results = [_dropped(np.asarray(shapes, dtype=object), area) for shapes in sets]
    return [r[0] for r in results], [r[1] for r in results], [r[2] for r in results]


def _dropped(shapes: Shapes, area: float) -> tuple[Shapes, int, float]:
    parts, owner = shapely.get_parts(shapes, return_index=True)
    areas = shapely.area(parts)
    tree = shapely.STRtree(parts)
    small = np.flatnonzero(areas < area)
    drop = np.zeros(len(parts), dtype=bool)
    drop[np.setdiff1d(small, _bordering(tree, small))] = True

    rings, part = shapely.get_rings(parts, return_index=True)
    areas_within = shapely.area(shapely.polygons(rings))
    hole = np.append(False, part[1:] == part[:-1])[: len(part)]
    fill = hole & (areas_within < area) & ~drop[part]
    fill[fill] = ~_occupied(tree, rings[fill], ~drop)
    for index in np.unique(part[fill]):
        outer, *holes = rings[(part == index) & ~fill]
        parts[index] = Polygon(outer, holes)

    result = shapes.copy()
    for index in np.unique(owner[np.union1d(np.flatnonzero(drop), part[fill])]):
        stays = parts[(owner == index) & ~drop]
        single = len(stays) and shapes[index].geom_type == "Polygon"
        result[index] = stays[0] if single else shapely.multipolygons(stays)
    return result, int(drop.sum()), float(areas[drop].sum())


def _bordering(tree: shapely.STRtree, which: Ints) -> Ints:
    """Those of some polygons of a tree that share a line, or an area, with another one."""
    one, other = tree.query(tree.geometries[which], predicate="intersects")
    one = which[one]
    one, other = one[one != other], other[one != other]
    relations = shapely.relate(tree.geometries[one], tree.geometries[other])
    # Dimensions of interior with interior, and of boundary with boundary.
    bordering: Ints = one[[r[0] == "2" or r[4] == "1" for r in relations]]
    return bordering


def _occupied(tree: shapely.STRtree, rings: Shapes, staying: Mask) -> Mask:
    """In which rings lies some polygon of a tree that stays."""
    disks = np.asarray(shapely.polygons(rings), dtype=object)
    ring, polygon = tree.query(disks, predicate="intersects")
    ring, polygon = ring[staying[polygon]], polygon[staying[polygon]]
    inside = shapely.relate_pattern(disks[ring], tree.geometries[polygon], "2********")
    occupied = np.zeros(len(rings), dtype=bool)
    occupied[ring[inside]] = True
    return occupied
