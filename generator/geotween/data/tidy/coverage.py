"""Coverages: sets of polygons that tile, their faults along common borders, and their mending."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.polygons import RELATIVE_TOLERANCE, Feature, extent, name_of
from geotween.data.problems import Problem, Severity
from geotween.data.tidy.gaps import gaps
from geotween.data.tidy.nodes import edges_of, noded
from geotween.data.tidy.overlaps import crossing_grid

# Two polygons that run along each other for this part of the shorter boundary have a border in
# common; by chance polygons meet at points, or along a piece of a straight edge.
COMMON_BORDER = 0.02

# Borders nearer than this share of the extent are meant to be one: a tenth of what a map shows,
# and narrower than the inlets and rivers that data leave open on purpose.
NARROW = 1e-5

# Snapping by about the width of a polygon can leave edges crossed, which one more pass mends.
PASSES = 2

# Pairs of polygons looked at together for a common border; the first find settles it.
BATCH = 256

Geometries = NDArray[np.object_]
Ints = NDArray[np.int64]
Floats = NDArray[np.float64]


def looks_like_coverage(geometries: Geometries, *, gap_width: float = 0.0) -> bool:
    """Whether polygons share borders at all: two run along each other on opposite sides of a line.

    They do where it is ``COMMON_BORDER`` of the shorter of their boundaries, vertex by vertex or
    nearer than ``gap_width`` (in the data's units), at least ``NARROW``. ``geometries`` is an
    object array (n,) of valid (Multi)Polygons. Polygons that lie over each other have no border in
    common.
    """
    if len(geometries) < 2:
        return False
    pairs, common = _matched(geometries)
    lengths = shapely.length(geometries)
    if (common >= COMMON_BORDER * lengths[pairs].min(axis=1)).any():
        return True
    narrow = max(gap_width, NARROW * extent(shapely.total_bounds(geometries)))
    near = shapely.STRtree(geometries).query(geometries, predicate="dwithin", distance=narrow).T
    near = near[near[:, 0] < near[:, 1]]
    return any(
        _beside(geometries[batch.T], narrow)
        for batch in np.array_split(near, range(BATCH, len(near), BATCH))
    )


def coverage_faults(
    geometries: Geometries, *, gap_width: float = 0.0, step: str = ""
) -> list[Problem]:
    """Gaps and overlaps along the common borders of polygons; none where they are no coverage.

    Borders nearer than ``NARROW`` of the extent are a note, as are overlaps no deeper than that
    and vertices that one side lacks; a deeper overlap is a warning. These problems (kind
    ``coverage``) have the length of the edges at fault as their measure. Wider gaps, narrower than
    ``gap_width`` (in the data's units), are a note with their area.

    Notes
    -----
    The edges are those of JTS/GEOS CoverageValidator; O(n log n) in the vertices.
    """
    if not looks_like_coverage(geometries, gap_width=gap_width):
        return []
    narrow = NARROW * extent(shapely.total_bounds(geometries))
    edges = shapely.coverage_invalid_edges(geometries, gap_width=narrow)
    at_fault = np.flatnonzero(~shapely.is_empty(edges))
    deep = _run_inside(edges[at_fault], at_fault, geometries, narrow)
    lengths = shapely.length(edges[at_fault])
    problems = []
    words: tuple[tuple[Severity, NDArray[np.bool_], str], ...] = (
        ("warning", deep, "common borders overlap"),
        ("note", ~deep, "common borders are not the same on both sides"),
    )
    for severity, chosen, message in words:
        if chosen.any():
            problems.append(
                Problem(
                    "coverage", severity, f"{message}, at {_polygons(int(chosen.sum()))}",
                    (step,) if step else (), "", float(lengths[chosen].sum()),
                    "map units of border", "map: {clean: true} mends it",
                )
            )  # fmt: skip
    return problems + _gaps_told(geometries, narrow, gap_width, step)


def clean_coverage(
    features: Sequence[Feature], *, gap_width: float, snapping: float, step: str = ""
) -> tuple[list[Feature], list[Problem]]:
    """Features without overlaps and narrow gaps, whose common borders have the same vertices.

    A gap with polygons all around it goes to one of them. So does one that is open at the coast
    where it is a strip (``gaps``): a short one or a bay stays, as data leave inlets open on
    purpose. A feature that fits already keeps its geometry.

    Parameters
    ----------
    features
        Valid geometries.
    gap_width, snapping
        Gaps narrower than the one are closed, vertices nearer than the other become one, in the
        data's units; at least ``RELATIVE_TOLERANCE`` of the extent is snapped.
    step
        The step's label, for the problems.

    Returns
    -------
    features, problems
        A note with the area that changed hands, where some did, and a warning for every feature
        that vanished (kind ``cleaned``).

    Raises
    ------
    RuntimeError
        Where shapely is older than 2.2 or GEOS than 3.14.

    Notes
    -----
    JTS/GEOS CoverageCleaner; O(n log n) in the vertices.
    """
    clean = getattr(shapely, "coverage_clean", None)
    if clean is None or shapely.geos_version < (3, 14):
        message = "cleaning a coverage needs shapely 2.2 with GEOS 3.14: pip install 'shapely>=2.2'"
        raise RuntimeError(message)
    if not features:
        return [], []
    given = np.array([f.geometry for f in features], dtype=object)
    # Without any snapping GEOS 3.14 loses polygons at a vertex that one side lacks.
    snapping = max(snapping, RELATIVE_TOLERANCE * extent(shapely.total_bounds(given)))
    cleaned = _fitted(clean, given, gap_width, snapping)
    cleaned = _without_strips(cleaned, gap_width) if gap_width > 0 else cleaned
    changed = ~shapely.equals_exact(given, cleaned, normalize=True)
    before, after = given[changed], cleaned[changed]
    grid = crossing_grid(given) if len(before) else 0.0
    moved = shapely.area(shapely.symmetric_difference(before, after, grid_size=grid))
    moved = moved[moved > snapping * shapely.length(before)]
    problems = []
    if len(moved):
        message = f"{_polygons(len(moved))} fitted to their neighbours"
        unit, steps = "square map units changed", (step,) if step else ()
        problems.append(Problem("cleaned", "note", message, steps, "", float(moved.sum()), unit))
    kept = []
    for index, feature in enumerate(features):
        if cleaned[index].is_empty:
            message = "its neighbours cover all of it; it was left out"
            problems.append(Problem("cleaned", "warning", message, steps, name_of(feature, index)))
        else:
            kept.append(replace(feature, geometry=cleaned[index]) if changed[index] else feature)
    return kept, problems


def _fitted(
    clean: Callable[..., Geometries], geometries: Geometries, gap_width: float, snapping: float
) -> Geometries:
    for _ in range(PASSES):
        geometries = clean(geometries, gap_width=gap_width, snapping_distance=snapping)
        if shapely.coverage_is_valid(geometries):
            break
    return geometries


def _without_strips(geometries: Geometries, width: float) -> Geometries:
    """A valid coverage with its open gaps each given to the polygon that borders it most."""
    strips, takers = gaps(geometries, width, closed=False)
    if not len(strips):
        return geometries
    filled = geometries.copy()
    for strip, taker in zip(strips, takers, strict=True):
        filled[taker] = shapely.union(filled[taker], strip)
    # At the mouths a neighbour lacks the strip's last corner.
    beside = shapely.STRtree(geometries).query(strips, predicate="dwithin", distance=width)[1]
    near = np.unique(np.append(beside, takers))
    filled[near] = noded(filled[near])
    return filled if shapely.coverage_is_valid(filled[near]) else geometries


def _gaps_told(geometries: Geometries, narrow: float, gap_width: float, step: str) -> list[Problem]:
    if gap_width <= narrow:
        return []
    strips, _ = gaps(geometries, gap_width)
    strips = strips[2 * shapely.area(strips) > narrow * shapely.length(strips)]
    if not len(strips):
        return []
    count = "a narrow gap" if len(strips) == 1 else f"{len(strips)} narrow gaps"
    message = f"{count} between neighbours"
    area, hint = float(shapely.area(strips).sum()), "map: {clean: true} closes what it can"
    steps = (step,) if step else ()
    return [Problem("coverage", "note", message, steps, "", area, "square map units", hint)]


def _beside(pairs: Geometries, narrow: float) -> bool:
    """Whether polygons of one of the pairs (2, n) run along each other, neither over the other."""
    shorter = shapely.length(pairs).min(axis=0)
    apart = shapely.area(shapely.intersection(*pairs)) <= narrow * shorter
    line, other = shapely.boundary(pairs[:, apart])
    strips = shapely.buffer(line, narrow, quad_segs=1)
    common = shapely.length(shapely.intersection(strips, other))
    return bool((common >= COMMON_BORDER * shorter[apart]).any())


def _matched(geometries: Geometries) -> tuple[Ints, Floats]:
    """Pairs (n, 2) of polygons with edges in common, and how long those are together (n,).

    Of an edge in common one polygon lies left and the other right.
    """
    owners, edges, mates = edges_of(geometries)
    pairs = np.sort(np.column_stack([owners[:-1], owners[1:]])[mates[1:]], axis=1)
    lengths = np.hypot(*(edges[1:, 1] - edges[1:, 0])[mates[1:]].T)
    foreign = pairs[:, 0] != pairs[:, 1]
    unique, place = np.unique(pairs[foreign], axis=0, return_inverse=True)
    return unique, np.bincount(place.ravel(), lengths[foreign], len(unique)).astype(np.float64)


def _run_inside(
    edges: Geometries, owners: Ints, geometries: Geometries, depth: float
) -> NDArray[np.bool_]:
    """Which edges run within another polygon, farther than ``depth`` from its boundary."""
    edge, other = shapely.STRtree(geometries).query(edges)
    foreign = owners[edge] != other
    edge, other = edge[foreign], other[foreign]
    common = shapely.intersection(edges[edge], geometries[other])
    lines, pair = shapely.get_parts(common, return_index=True)
    points, line = shapely.get_coordinates(lines, return_index=True)
    inner = (points[1:] + points[:-1])[line[1:] == line[:-1]] / 2
    places = shapely.points(np.concatenate([points, inner]))
    pair = pair[np.concatenate([line, line[1:][line[1:] == line[:-1]]])]
    boundaries = shapely.boundary(geometries)
    shapely.prepare(boundaries)
    deep = ~shapely.dwithin(boundaries[other[pair]], places, depth)
    found: NDArray[np.bool_] = np.isin(np.arange(len(edges)), edge[pair[deep]])
    return found


def _polygons(count: int) -> str:
    return "1 polygon" if count == 1 else f"{count} polygons"
