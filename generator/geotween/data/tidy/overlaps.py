"""Overlaps: polygons of a step that share area are made disjoint, by a rule and not unsaid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon, Polygon

from geotween.data.polygons import RELATIVE_TOLERANCE, Feature, extent, name_of
from geotween.data.problems import Problem, Severity

# Two polygons that share more than this part of the smaller one's area lie on each other on
# purpose (nested levels, wind fields, parts of one fire); less is a border that was drawn twice.
OVERLAPPING = 0.01

# Levels of one thing lie in each other: they share more than this part of the smaller one.
NESTED = 0.5

# An overlap that is narrower than this share of a pixel everywhere cannot be seen.
VISIBLE = 0.5

MERGED = (
    "overlapping features without a key were joined",
    "features without a key that overlap become one; give them keys to keep them apart",
)
CUT = (
    "overlapping features were cut apart",
    "of two features that overlap, the smaller keeps what they share",
)
LEVELS = "levels of one thing stay whole where the column that tells them apart is named: class: {}"

Geometries = NDArray[np.object_]
Ints = NDArray[np.int64]
Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Pairs:
    """Features that overlap: their indices in the set (n, 2), first < second, and areas (n,)."""

    indices: Ints
    shared: Floats
    share: Floats  # of the smaller one's area
    common: Geometries  # what they share

    def where(self, chosen: NDArray[np.bool_]) -> Pairs:
        return Pairs(
            self.indices[chosen], self.shared[chosen], self.share[chosen], self.common[chosen]
        )


def separate(
    features: Sequence[Feature], *, step: str = "", pixel: float = 0.0, columns: Sequence[str] = ()
) -> tuple[list[Feature], list[Problem]]:
    """Features that share no area, and what was changed for it.

    Features without a key, of the same class, become one where they share more than
    ``OVERLAPPING`` of the smaller; it keeps the name and the position of the first. Of all others
    the smaller keeps what they share (of two that are equally large the later one), and the larger
    loses it. Overlaps thinner than ``RELATIVE_TOLERANCE`` of the extent are noise and stay. Where
    features are cut, both sides of the cut have the same vertices, and so have the neighbours that
    touch it. A feature that need not change comes back with the very geometry it had.

    Parameters
    ----------
    features
        Valid geometries, in any units.
    step
        The step's label, for the problems.
    pixel
        The length of a pixel, in the data's units.
    columns
        Attributes that may tell levels apart, for the hint where features without a class nest.

    Returns
    -------
    features, problems
        One problem (kind ``overlap``) each for all merges and for all cuts of the step, with the
        area shared, and one for every feature of which nothing is left. A note where every overlap
        is narrower than ``VISIBLE`` of a pixel, else a warning.

    Notes
    -----
    Overlaps are found from the edges that do not fit a coverage (JTS/GEOS CoverageValidator):
    around every region that is covered twice such an edge exists, and what lies within the region
    is reached from one overlapping pair to the next. O(n log n) in the vertices where few
    features overlap. Those that do are cut along their common arrangement of lines.
    """
    geometries = np.array([f.geometry for f in features], dtype=object)
    if not len(geometries):
        return [], []
    thinnest = RELATIVE_TOLERANCE * extent(shapely.total_bounds(geometries))
    tree = shapely.STRtree(geometries)
    pairs = overlapping(geometries, tree)
    if not len(pairs.indices):
        return list(features), []

    one_area = _same_area(features)[pairs.indices]
    merged = (one_area[:, 0] == one_area[:, 1]) & (one_area[:, 0] >= 0)
    groups = _connected(pairs.indices[merged & (pairs.share > OVERLAPPING)], len(features))
    merged = groups[pairs.indices[:, 0]] == groups[pairs.indices[:, 1]]
    involved = _with_neighbours(pairs.indices, geometries, tree)
    areas = _arranged(geometries[involved], groups[involved], thinnest)

    steps = (step,) if step else ()
    names = [name_of(f, index) for index, f in enumerate(features)]
    problems = []
    for chosen, (what, hint) in ((pairs.where(merged), MERGED), (pairs.where(~merged), CUT)):
        levels = _levels(chosen, features, columns)
        hint = f"{hint}; {LEVELS.format(levels)}" if levels else hint
        problems += _told(chosen, what, hint, names, steps, VISIBLE * pixel)
    kept = []
    for index, feature in enumerate(features):
        if groups[index] != index:
            continue  # it lives on in the first of its group
        area = areas.get(index, feature.geometry)
        if area.is_empty:
            message = "smaller polygons cover all of it; it was left out"
            problems.append(Problem("overlap", "warning", message, steps, names[index]))
        elif shapely.equals_exact(area, feature.geometry, normalize=True):
            kept.append(feature)
        else:
            kept.append(replace(feature, geometry=area))
    return kept, problems


def crossing_grid(geometries: Geometries) -> float:
    """The cells of a grid on which lines are crossed, in the data's units: some 16 roundings.

    Without it GEOS errs where polygons differ by nothing but rounding. A power of two keeps whole
    numbers whole.
    """
    farthest = np.abs(shapely.total_bounds(geometries)).max()
    return float(2.0 ** (np.ceil(np.log2(farthest)) - 48))


def overlapping(geometries: Geometries, tree: shapely.STRtree) -> Pairs:
    """All pairs of valid geometries that share more than noise; ``tree`` holds the geometries."""
    thinnest = RELATIVE_TOLERANCE * extent(shapely.total_bounds(geometries))
    grid = crossing_grid(geometries)
    invalid = ~shapely.is_empty(shapely.coverage_invalid_edges(geometries))
    seen = np.zeros(len(geometries), dtype=bool)
    found = [np.empty((0, 2), dtype=np.int64)]
    commons = [np.empty(0, dtype=object)]
    front = np.flatnonzero(invalid)
    while len(front):
        mine, others = tree.query(geometries[front])
        mine = front[mine]
        # A pair is measured once: not with itself, nor from its other end too.
        new = ~seen[others] & (mine != others) & ~(np.isin(others, front) & (others < mine))
        pairs = np.sort(np.column_stack([mine[new], others[new]]), axis=1)
        seen[front] = True
        one, other = geometries[pairs.T]
        common = shapely.intersection(one, other, grid_size=grid)
        real = ~_noise(common, thinnest)
        found.append(pairs[real])
        commons.append(common[real])
        front = np.setdiff1d(pairs[real], np.flatnonzero(seen))
    indices, common = np.concatenate(found), np.concatenate(commons)
    order = np.lexsort(indices.T[::-1])
    indices, common = indices[order], common[order]
    shared, smaller = shapely.area(common), shapely.area(geometries)[indices].min(axis=1)
    return Pairs(indices, shared, shared / smaller, common)


def _same_area(features: Sequence[Feature]) -> Ints:
    """A number per class for features without a key, which are one where they overlap; else -1."""
    numbers: dict[str | None, int] = {}
    return np.array(
        [numbers.setdefault(f.class_, len(numbers)) if f.key is None else -1 for f in features]
    )


def _connected(pairs: Ints, count: int) -> Ints:
    """For each of ``count`` features the first of the group that the pairs make it part of."""
    first = np.arange(count)
    changed = True
    while changed:
        before = first.copy()
        lowest = first[pairs].min(axis=1)
        for side in pairs.T:
            np.minimum.at(first, side, lowest)
        first = first[first]
        changed = bool((first != before).any())
    return first


def _with_neighbours(pairs: Ints, geometries: Geometries, tree: shapely.STRtree) -> Ints:
    """What overlaps, and what touches that: a cut may put a vertex on a border of theirs."""
    overlapping = np.unique(pairs)
    return np.unique(tree.query(geometries[overlapping], predicate="intersects")[1])


def _arranged(
    geometries: Geometries, groups: Ints, thinnest: float
) -> dict[int, Polygon | MultiPolygon]:
    """What each group keeps: faces of the arrangement of all lines, each for its smallest group."""
    grid = crossing_grid(geometries)
    lines = shapely.union_all(shapely.boundary(geometries), grid_size=grid)
    faces = shapely.get_parts(shapely.polygonize([lines]))
    face, group = _covered(faces, geometries, groups)
    sizes = np.bincount(group, weights=shapely.area(faces[face])).astype(np.float64)
    order = np.argsort(_ranks(sizes)[group], kind="stable")
    held, first = np.unique(face[order], return_index=True)
    winner = group[order][first]
    numbers = np.unique(groups)
    kept = np.empty(len(numbers), dtype=object)
    for place, index in enumerate(numbers):
        mine = faces[held[winner == index]]
        whole = shapely.coverage_union_all(mine) if not _noise(mine, thinnest).all() else None
        parts = shapely.get_parts(whole)
        left = parts[~_noise(parts, thinnest)]
        single = len(left) == 1 and isinstance(geometries[groups == index][0], Polygon)
        kept[place] = left[0] if single else MultiPolygon(list(left))
    kept = shapely.transform(kept, partial(_off_grid, shapely.get_coordinates(geometries), grid))
    return dict(zip(numbers.tolist(), kept, strict=True))


def _off_grid(original: Floats, grid: float, points: Floats) -> Floats:
    """Points on the grid, moved to the first vertex of the data in their cell where it has one."""
    cells = shapely.get_coordinates(shapely.set_precision(shapely.points(original), grid))
    known, first = np.unique(_as_numbers(cells), return_index=True)
    wanted = _as_numbers(points)
    at = np.searchsorted(known, wanted).clip(max=len(known) - 1)
    return np.where((known[at] == wanted)[:, None], original[first[at]], points)


def _as_numbers(points: Floats) -> NDArray[np.complex128]:
    """Points as one number each, to sort and find them by x, then y."""
    return points[:, 0] + 1j * points[:, 1]


def _noise(polygons: Geometries, thinnest: float) -> NDArray[np.bool_]:
    thin: NDArray[np.bool_] = shapely.area(polygons) <= thinnest * shapely.length(polygons) / 2
    return thin


def _covered(faces: Geometries, geometries: Geometries, groups: Ints) -> tuple[Ints, Ints]:
    """Which groups cover each face: indices of faces, and the groups, each pair once."""
    inside = shapely.get_coordinates(shapely.point_on_surface(faces))
    shapely.prepare(geometries)
    face, member = shapely.STRtree(geometries).query(shapely.points(inside))
    covers = shapely.contains_xy(geometries[member], *inside[face].T)
    face, group = np.unique([face[covers], groups[member[covers]]], axis=1)
    return face, group


def _ranks(sizes: Floats) -> Ints:
    """The order in which groups keep what they share: smaller ones first, of equals the later."""
    order = np.argsort(sizes, kind="stable")
    # Equal but for rounding, or the outcome would turn with the map.
    larger = np.diff(sizes[order], prepend=0.0) > RELATIVE_TOLERANCE * sizes[order]
    tier = np.empty(len(sizes), dtype=np.int64)
    tier[order] = larger.cumsum()
    ranks = np.empty(len(sizes), dtype=np.int64)
    ranks[np.lexsort([-np.arange(len(sizes)), tier])] = np.arange(len(sizes))
    return ranks


def _levels(pairs: Pairs, features: Sequence[Feature], columns: Sequence[str]) -> str:
    """The columns by which all features without a class differ that lie in each other."""
    nested = pairs.indices[pairs.share > NESTED].tolist()
    both = [(features[one], features[other]) for one, other in nested]
    if not both or any(f.class_ is not None for pair in both for f in pair):
        return ""
    apart = [
        column
        for column in columns
        if all(one.attributes.get(column) != other.attributes.get(column) for one, other in both)
    ]
    return " (or ".join([", ".join(part) for part in (apart[:1], apart[1:]) if part]) + (
        ")" if len(apart) > 1 else ""
    )


def _told(
    pairs: Pairs, what: str, hint: str, names: Sequence[str], steps: tuple[str, ...], least: float
) -> list[Problem]:
    if not len(pairs.indices):
        return []
    one, other = (names[i] for i in pairs.indices[pairs.shared.argmax()])
    most = f"{one} and {other}" if len(pairs.indices) == 1 else f"most of all {one} and {other}"
    count = "1 pair" if len(pairs.indices) == 1 else f"{len(pairs.indices)} pairs"
    severity: Severity = "warning" if _any_wider(pairs.common, least) else "note"
    area = float(pairs.shared.sum())
    message = f"{count} of {what}: {most}"
    return [Problem("overlap", severity, message, steps, "", area, "square map units", hint)]


def _any_wider(polygons: Geometries, width: float) -> bool:
    """Whether some polygon has a place as wide as a width."""
    # The mean width of a strip, its area by half its outline, is exceeded somewhere.
    if (shapely.area(polygons) >= width * shapely.length(polygons) / 2).any():
        return True
    return bool((~shapely.is_empty(shapely.buffer(polygons, -width / 2))).any())
