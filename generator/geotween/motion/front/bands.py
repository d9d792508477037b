"""Bands: what is swept between two levels, as polygons, simplified so that levels never cross."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely

from geotween.motion.front.meshes import Flags, Spans
from geotween.motion.front.outline import numbers_of
from geotween.motion.front.plane import NOTHING, Floats, Ints, Shapes
from geotween.motion.front.skeleton import Skeleton

# Where straightened lines meet, lesser parts of the tolerance are tried, none in the end.
PARTS = np.array([1.0, 0.25, 0.0625, 0.0])

# Lines leave a point in one direction if the angle between them is no larger: rounding.
FLAT = 1e-9


def bands_of(skeleton: Skeleton) -> tuple[Shapes, Ints, Ints]:
    """The polygons (f,) between the skeleton's lines, and the band that each belongs to, sorted.

    Returns also bands whose polygons do not have all of their lines: these cross each other.
    """
    drawn = np.flatnonzero(skeleton.bands[:, 0] != skeleton.bands[:, 1])
    edges, bands = skeleton.edges[drawn], skeleton.bands[drawn]
    lines = np.asarray(shapely.linestrings(skeleton.points[edges]), dtype=object)
    faces = shapely.get_parts(shapely.polygonize(lines))
    faces = np.asarray(shapely.orient_polygons(faces, exterior_cw=False), dtype=object)
    rings, face = shapely.get_rings(faces, return_index=True)
    corners, ring = shapely.get_coordinates(rings, return_index=True)
    number = numbers_of(skeleton.points, corners)
    first = np.flatnonzero(ring[1:] == ring[:-1])
    size = len(skeleton.points)
    code = np.concatenate([edges @ [size, 1], edges[:, ::-1] @ [size, 1]])
    order = np.argsort(code, kind="stable")
    place = np.searchsorted(code, number[first] * size + number[first + 1], sorter=order)
    beside = bands.T.ravel()[order[place]]
    face = face[ring[first]]
    band = np.full(len(faces), NOTHING, dtype=np.intp)
    band[face] = beside
    right = beside == band[face]
    size = int(bands.max(initial=0)) + 2
    broken = np.bincount(bands.ravel() + 1, minlength=size)
    broken -= np.bincount(beside[right] + 1, minlength=size)
    order = np.argsort(band, kind="stable")
    order = order[band[order] != NOTHING]
    return faces[order], band[order], np.flatnonzero(broken[1:])


def simplified(skeleton: Skeleton, spans: Spans, tolerances: Floats) -> Skeleton:
    """The skeleton with fewer points on levels: off by a region's tolerance (R,) at most.

    Ends of levels and all else stay where they are (Douglas and Peucker). Where a line then meets
    another it is straightened less. O(n log n).
    """
    inner = np.flatnonzero(skeleton.lines == NOTHING)
    if not len(inner):
        return skeleton
    outer = np.flatnonzero(skeleton.lines != NOTHING)
    numbers, chain, bands = _chains(skeleton, inner)
    first = np.flatnonzero(np.diff(chain, prepend=-1))
    last = np.append(first[1:], len(chain)) - 1
    kept = np.zeros(len(chain), dtype=bool)
    kept[first] = kept[last] = True
    several = np.append(spans.counts > 1, False)[np.append(spans.region, NOTHING)]
    rims = skeleton.edges[outer[several[skeleton.bands[outer]].any(axis=1)]]
    tolerance = tolerances[spans.region[bands[:, 0]]]
    places, tried = skeleton.points[numbers], np.zeros(len(chain), dtype=np.intp)
    while len(first):
        kept[_needed(places, first, last, PARTS[tried[first]] * tolerance[chain[first]])] = True
        for one, other in zip(first.tolist(), last.tolist(), strict=True):
            tried[one:other] = tried[one] + 1
        first, last = _meeting(skeleton.points, numbers, chain, kept, rims)
    start = np.flatnonzero(kept)
    start, end = start[:-1], start[1:]
    whole = chain[start] == chain[end]
    edges = np.column_stack([numbers[start], numbers[end]])[whole]
    return replace(
        skeleton,
        edges=np.concatenate([skeleton.edges[outer], edges]),
        bands=np.concatenate([skeleton.bands[outer], bands[chain[start[whole]]]]),
        lines=np.append(skeleton.lines[outer], np.full(len(edges), NOTHING)),
    )


def _chains(skeleton: Skeleton, inner: Ints) -> tuple[Ints, Ints, Ints]:
    """Lines between bands, joined where one leads to the next.

    Returns the points (n,) of all chains, the chain that each is in, and the bands (c, 2) beside
    each chain. Chains end on edges of the plane, and where a level meets itself.
    """
    edges, bands = skeleton.edges[inner], skeleton.bands[inner]
    back = bands[:, 0] > bands[:, 1]
    edges = np.where(back[:, None], edges[:, ::-1], edges)
    fixed = skeleton.levels == NOTHING
    fixed[np.bincount(edges.ravel(), minlength=len(fixed)) != 2] = True
    follow = np.full(len(fixed), NOTHING, dtype=np.intp)
    follow[edges[:, 0]] = np.arange(len(edges))
    following = np.where(fixed[edges[:, 1]], NOTHING, follow[edges[:, 1]]).tolist()
    starts, ends = edges.T.tolist()
    heads = np.flatnonzero(fixed[edges[:, 0]]).tolist()
    seen = [False] * len(starts)
    numbers: list[int] = []
    sizes, first = [], []
    for head in (*heads, *range(len(starts))):
        if seen[head]:
            continue
        before, at = len(numbers), head
        numbers.append(starts[head])
        while at != NOTHING and not seen[at]:
            seen[at] = True
            numbers.append(ends[at])
            at = following[at]
        first.append(head)
        sizes.append(len(numbers) - before)
    chain = np.repeat(np.arange(len(sizes)), sizes)
    return np.array(numbers, dtype=np.intp), chain, np.sort(bands[first], axis=1)


def _needed(places: Floats, first: Ints, last: Ints, tolerance: Floats) -> Ints:
    """The points that stretches of chains, from first to last (k,), need at a tolerance (k,)."""
    size = last - first + 1
    row = np.repeat(np.arange(len(first)), size)
    at = first[row] + np.arange(len(row)) - np.repeat(np.cumsum(size) - size, size)
    # The third coordinate is carried along, and tells which points are left.
    drawn = shapely.linestrings(np.column_stack([places[at], at]), indices=row)
    lines = np.asarray(drawn, dtype=object)
    fewer = np.asarray(shapely.simplify(lines, tolerance, preserve_topology=False), dtype=object)
    fewer[tolerance <= 0] = lines[tolerance <= 0]
    return shapely.get_coordinates(fewer, include_z=True)[:, 2].astype(np.intp)


def _meeting(
    points: Floats, numbers: Ints, chain: Ints, kept: Flags, rims: Ints
) -> tuple[Ints, Ints]:
    """Straightened stretches, first and last point, that meet another line but at their ends."""
    start = np.flatnonzero(kept)
    start, end = start[:-1], start[1:]
    whole = chain[start] == chain[end]
    start, end = start[whole], end[whole]
    edges = np.concatenate([np.column_stack([numbers[start], numbers[end]]), rims])
    lines = np.asarray(shapely.linestrings(points[edges]), dtype=object)
    straightened = end - start > 1
    asked = np.flatnonzero(straightened)
    one, other = shapely.STRtree(lines).query(lines[asked], predicate="intersects")
    one = asked[one]
    same = edges[one][:, :, None] == edges[other][:, None, :]
    apart = ~same.any(axis=(1, 2)) | _folded(points, edges[one], edges[other], same)
    meeting = np.zeros(len(edges), dtype=bool)
    meeting[one[apart]] = meeting[other[apart]] = True

    # Two lines between the same points, or one from a point to itself, have nothing between them.
    low, high = np.sort(edges, axis=1).T
    _, place, count = np.unique(low * len(points) + high, return_inverse=True, return_counts=True)
    meeting |= (count[place.reshape(-1)] > 1) | (low == high)
    bad = meeting[: len(start)] & straightened
    return start[bad], end[bad]


def _folded(points: Floats, one: Ints, other: Ints, same: Flags) -> Flags:
    """Whether edges (k, 2) that have one end in common leave it in one direction."""
    row = np.arange(len(one))
    ways = []
    for edges, axis in ((one, 2), (other, 1)):
        common = same.any(axis=axis).argmax(axis=1)
        ways.append(points[edges[row, 1 - common]] - points[edges[row, common]])
    (ax, ay), (bx, by) = (way.T for way in ways)
    along, across = ax * bx + ay * by, ax * by - ay * bx
    thin = (along > 0) & (np.abs(across) <= FLAT * along)
    return np.asarray(thin & (same.sum(axis=(1, 2)) == 1))
