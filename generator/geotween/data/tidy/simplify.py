"""Simplification of all polygon sets of a scene at once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.tidy.linework import Ints, Linework, Mask, Shapes, linework, polygons, spans

# A chord whose arc strays less than this share of the tolerance is not refined by halves any more:
# all its vertices return. It bounds the rounds.
FINEST = 1 / 256


def simplify(sets: Sequence[Shapes], tolerance: float) -> list[Shapes]:
    """Polygon sets with fewer vertices, what they share simplified once and for all of them.

    Parameters
    ----------
    sets : one array of valid (Multi)Polygons without repeated points per step and layer. The
        interiors within a set are disjoint; sets may cross each other.
    tolerance : in the data's units; 0 gives the sets back.

    Returns
    -------
    The sets, parallel to the input. Every ring lies within the tolerance of what it was, and what
    it was within the tolerance of it (Hausdorff distance). Polygons are valid and have as many
    parts and holes as before; a valid coverage stays one. Vertices are some of those given, and
    what polygons of any sets have in common vertex for vertex, they have in common afterwards.
    Order of sets and polygons, start and direction of rings do not matter.

    Raises
    ------
    ValueError : for a tolerance that is negative or not finite.

    Notes
    -----
    Every arc of the joint linework is simplified by Douglas and Peucker's algorithm (1973). Where a
    polygon became invalid or a set no coverage any more, chords that passed over another vertex
    (it lies in the convex hull of the arc's run, Saalfeld's criterion of 1999) are simplified anew,
    from the original, to half of what the run strays from them. This ends, as the original
    offends nowhere. Of vertices equally far from a chord, as on a square grid, the first along the
    arc stays, which may be another one on a map that is turned. Cost: O(n log n) for n vertices;
    most of it goes into the checks, which GEOS makes quadratic for a polygon with many enclaves.
    """
    if not 0 <= tolerance < np.inf:
        raise ValueError(f"tolerance must be finite and not negative, but is {tolerance}")
    lines = linework(sets)
    shapes = lines.shapes.copy()
    if tolerance:
        arcs = np.stack([lines.arcs[:-1], lines.arcs[1:] - 1], axis=1)
        kept = _with_simplified(lines, ~lines.inner, arcs, np.full(len(arcs), tolerance))
        changed = lines.shapes_with(~kept)
        while changed.any():
            kept, changed = _until_valid(lines, kept, changed, shapes, tolerance)
            finer = _with_coverage(lines, kept, changed, shapes, tolerance)
            changed, kept = lines.shapes_with(finer & ~kept), finer
    return np.split(shapes, lines.sets[1:-1]) if len(sets) else []


def _chords(lines: Linework, kept: Mask) -> Ints:
    """First and last place (k, 2) in ``arc_path`` of each run that a straight line stands for."""
    at = np.flatnonzero(kept[lines.arc_path])
    # Arcs begin and end with a kept vertex, so no gap reaches from one to the next.
    gaps = np.diff(at) > 1
    return np.stack([at[:-1][gaps], at[1:][gaps]], axis=1)


def _runs(lines: Linework, chords: Ints) -> Shapes:
    """The original line of each chord; z is the vertex number, which tells it afterwards."""
    numbers = lines.arc_path[spans(chords[:, 0], chords[:, 1] + 1)]
    points = np.column_stack([lines.vertices[numbers], numbers])
    owner = np.repeat(np.arange(len(chords)), chords[:, 1] + 1 - chords[:, 0])
    return np.asarray(shapely.linestrings(points, indices=owner), dtype=object)


def _with_simplified(
    lines: Linework, kept: Mask, chords: Ints, tolerances: NDArray[np.float64]
) -> Mask:
    simplified = shapely.simplify(_runs(lines, chords), tolerances, preserve_topology=False)
    more = kept.copy()
    more[shapely.get_coordinates(simplified, include_z=True)[:, 2].astype(np.int64)] = True
    return more


def _refined(lines: Linework, kept: Mask, chords: Ints, tolerance: float) -> Mask:
    """More of the vertices along some chords, at least one for each."""
    ends = lines.vertices[lines.arc_path[chords]]
    strays = shapely.hausdorff_distance(_runs(lines, chords), shapely.linestrings(ends))
    fine = strays <= tolerance * FINEST
    finer = _with_simplified(lines, kept, chords[~fine], strays[~fine] / 2)
    finer[lines.arc_path[spans(chords[fine, 0], chords[fine, 1] + 1)]] = True
    return finer


def _along(lines: Linework, chords: Ints, vertices: Mask) -> Ints:
    """Those of the chords that stand for some of the vertices (v,)."""
    chosen: Ints = chords[vertices[lines.arc_path[chords[:, 0] + 1]]]
    return chosen


def _passing_over(lines: Linework, chords: Ints, points: NDArray[np.float64]) -> Ints:
    """Those of the chords that a point lies beside: in the hull of the run, and not their end."""
    tree = shapely.STRtree(np.asarray(shapely.points(points), dtype=object))
    runs = _runs(lines, chords)
    chord, point = tree.query(runs)
    ends = lines.vertices[lines.arc_path[chords[chord]]]
    foreign = (ends != points[point][:, None]).any(axis=2).all(axis=1)
    chord, point = chord[foreign], point[foreign]
    inside = shapely.intersects(shapely.convex_hull(runs[chord]), tree.geometries[point])
    passing: Ints = chords[np.unique(chord[inside])]
    return passing


def _until_valid(
    lines: Linework, kept: Mask, changed: Mask, shapes: Shapes, tolerance: float
) -> tuple[Mask, Mask]:
    """Refine until the changed shapes, rebuilt in ``shapes``, are valid; which were changed."""
    every = changed.copy()
    while changed.any():
        finer = _with_triangles(lines, kept, tolerance)
        changed |= lines.shapes_with(finer & ~kept)
        every |= changed
        kept = finer
        which = np.flatnonzero(changed)
        shapes[which] = polygons(lines, kept, which)
        broken = which[~shapely.is_valid(shapes[which])]
        chords = _chords(lines, kept)
        for shape in broken:
            own = _along(lines, chords, lines.of_shapes(np.array([shape])))
            culprits = _passing_over(lines, own, shapely.get_coordinates(shapes[shape]))
            finer = _refined(lines, finer, culprits if len(culprits) else own, tolerance)
        changed = lines.shapes_with(finer & ~kept)
        kept = finer
    return kept, every


def _with_triangles(lines: Linework, kept: Mask, tolerance: float) -> Mask:
    """Refine rings that collapsed until they have three vertices."""
    chords = _collapsed(lines, kept)
    while len(chords):
        kept = _refined(lines, kept, chords, tolerance)
        chords = _collapsed(lines, kept)
    return kept


def _collapsed(lines: Linework, kept: Mask) -> Ints:
    """The chords of the rings that keep fewer than three vertices."""
    few = lines.vertices_per_ring(kept) < 3
    vertices = np.zeros(len(kept), dtype=bool)
    vertices[lines.path[spans(lines.rings[:-1][few], lines.rings[1:][few])]] = True
    return _along(lines, _chords(lines, kept), vertices)


def _with_coverage(
    lines: Linework, kept: Mask, changed: Mask, shapes: Shapes, tolerance: float
) -> Mask:
    """Refine once where changed shapes make their set a worse coverage than it was."""
    finer = kept
    chords = _chords(lines, kept)
    for first, last in zip(lines.sets[:-1], lines.sets[1:], strict=True):
        touched = first + np.flatnonzero(changed[first:last])
        if last - first < 2 or not len(touched):
            continue
        # What did not change was looked at before, but for what lies where something did.
        tree = shapely.STRtree(shapes[first:last])
        near = first + np.unique(tree.query(shapes[touched])[1])
        edges, owner = _new_offences(lines.shapes[near], shapes[near], tolerance)
        if not len(edges):
            continue
        own = _along(lines, chords, lines.of_shapes(near))
        culprits = _passing_over(lines, own, shapely.get_coordinates(edges))
        if not len(culprits):
            culprits = _along(lines, chords, lines.of_shapes(near[np.unique(owner)]))
        finer = _refined(lines, finer, culprits, tolerance)
    return finer


def _new_offences(before: Shapes, after: Shapes, tolerance: float) -> tuple[Shapes, Ints]:
    """Edges that offend against a coverage, and did not within the tolerance before; with owner."""
    offending = shapely.coverage_invalid_edges(after)
    which = np.flatnonzero(~shapely.is_empty(offending))
    if not len(which):
        return offending[which], which
    near = np.unique(shapely.STRtree(before).query(before[which])[1])
    old = shapely.coverage_invalid_edges(before[near])[np.searchsorted(near, which)]
    lines, owner = shapely.get_parts(offending[which], return_index=True)
    points, line = shapely.get_coordinates(lines, return_index=True)
    inside = line[1:] == line[:-1]
    edges = shapely.linestrings(np.stack([points[:-1], points[1:]], axis=1)[inside])
    owner = owner[line[:-1][inside]]
    new = ~(shapely.distance(edges, old[owner]) <= tolerance)  # nowhere near what was nowhere
    return edges[new], which[owner[new]]
