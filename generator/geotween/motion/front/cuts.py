"""Level sets: where a field's triangles are cut, and into which bands.

Marching triangles: a level runs straight through a triangle, between the places where it crosses
two edges. At a pivot, where all levels end, it begins at the corner.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geotween.motion.front.meshes import Flags, Mesh, Rim, Spans
from geotween.motion.front.plane import Floats, Ints

# More levels than a region may have: the number of an edge times this, plus a level, is one number.
LEVELS = 64


@dataclass(frozen=True, eq=False)
class Cuts:
    """The lines between bands, and the bands along the rim.

    A node is where lines end: a vertex of the mesh, or where a level crosses one of its edges.

    Attributes
    ----------
    vertices : (v, 2) the vertices between which a node lies; the same one twice for a vertex.
    share : (v,) how far from the first to the second.
    level, region : (v,) whose level it is on.
    on_rim : (v,) whether it lies on a rim, but not at a vertex.
    lines : (s, 2) the nodes at which a line begins and ends.
    bands : (s, 2) the band to its left and to its right.
    part_key, part_start, part_band : (q,) what the rim consists of: its ``key``, the share of the
        plane's edge from which on ..., and the band; sorted.
    """

    vertices: Ints
    share: Floats
    level: Ints
    region: Ints
    on_rim: Flags
    lines: Ints
    bands: Ints
    part_key: Ints
    part_start: Floats
    part_band: Ints


def cut_levels(mesh: Mesh, rim: Rim, spans: Spans) -> Cuts:
    """Cut the regions that have several bands, at whole band coordinates."""
    band = np.full(mesh.times.shape, np.nan)
    chosen = np.flatnonzero(spans.counts[mesh.region] > 1)
    band[chosen] = spans.band(mesh.times[chosen], mesh.region[chosen, None])
    through, between = _through(mesh, spans, band, chosen), _between(mesh, spans, band, chosen)
    crossings, part_key, part_start, part_band = _along_rim(mesh, rim, spans, band)
    lines = np.concatenate([through[0], between[0]])

    # Places are (triangle, corner, other corner, level); the corner twice for a vertex.
    places = np.concatenate([lines.reshape(-1, 4), crossings])
    triangle, one, two, level = places.T
    at_vertex = one == two
    corner = np.where((one + 1) % 3 == two, one, two)
    number, is_rim = (of[triangle, corner] for of in mesh.numbered)
    vertices = np.column_stack([mesh.triangles[triangle, one], mesh.triangles[triangle, two]])
    code = np.where(at_vertex, vertices[:, 0], len(mesh.points) + number * LEVELS + level)
    _, first, node = np.unique(code, return_index=True, return_inverse=True)
    triangle, one, two, level = places[first].T
    # Both sides of an edge reckon from the same end.
    turned = vertices[first, 0] > vertices[first, 1]
    one, two = np.where(turned, two, one), np.where(turned, one, two)
    low, high = band[triangle, one], band[triangle, two]
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.where(at_vertex[first], 0.0, (level - low) / (high - low))
    return Cuts(
        np.column_stack([mesh.triangles[triangle, one], mesh.triangles[triangle, two]]),
        share,
        level,
        mesh.region[triangle],
        (is_rim & ~at_vertex)[first],
        node[: 2 * len(lines)].reshape(-1, 2),
        np.concatenate([through[1], between[1]]),
        part_key,
        part_start,
        part_band,
    )


def _through(mesh: Mesh, spans: Spans, band: Floats, chosen: Ints) -> tuple[Ints, Ints]:
    """Lines through the inside of triangles, as places (s, 2, 4), and the bands beside them."""
    order = np.argsort(band[chosen], axis=1, kind="stable")  # a pivot comes last
    low, middle, high = np.take_along_axis(band[chosen], order, axis=1).T
    pivot = np.isnan(high)
    top = np.where(pivot, middle, high)
    first = np.floor(low).astype(np.intp) + 1
    count = np.maximum(np.ceil(top).astype(np.intp) - first, 0)
    row = np.repeat(np.arange(len(chosen)), count)
    level = first[row] + np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
    a, b, c = order[row].T
    even = (b - a) % 3 == 1
    pivot, middle = pivot[row], middle[row]

    # The long side from a to c (with a pivot: from a to b), then the other end.
    triangle = chosen[row]
    far = np.where(pivot, b, c)
    start = np.column_stack([triangle, a, far, level])
    one = np.where(pivot, c, np.where(level < middle, a, b))
    two = np.where(pivot, c, np.where(level > middle, c, b))
    end = np.column_stack([triangle, one, two, level])
    # From the end to the start the lower band is to the left if a, b, c turn to the left; from a
    # pivot it is to the right.
    left = even != pivot
    below = spans.base[mesh.region[triangle]] + level - 1
    return np.stack([end, start], axis=1), np.column_stack([below + ~left, below + left])


def _between(mesh: Mesh, spans: Spans, band: Floats, chosen: Ints) -> tuple[Ints, Ints]:
    """Lines along edges of the mesh, whose triangles are in different bands."""
    number, is_rim = (of[chosen] for of in mesh.numbered)
    row, corner = np.nonzero(_flat(band[chosen]) & ~is_rim)
    order = np.argsort(number[row, corner], kind="stable")
    triangle, corner = chosen[row[order]], corner[order]
    label = _beside(mesh, spans, band, triangle, corner).reshape(-1, 2)
    differ = label[:, 0] != label[:, 1]
    # The two sides of an edge follow each other.
    triangle, corner, label = triangle[::2][differ], corner[::2][differ], label[differ]
    other = (corner + 1) % 3
    level = np.rint(np.fmax(band[triangle, corner], band[triangle, other])).astype(np.intp)
    places = [np.column_stack([triangle, at, at, level]) for at in (corner, other)]
    return np.stack(places, axis=1), label


def _flat(band: Floats) -> Flags:
    """Whether the edges (T, 3) from each corner to the next lie on a level."""
    follow = np.roll(band, -1, axis=1)
    one, other = np.where(np.isnan(band), follow, band), np.where(np.isnan(follow), band, follow)
    return np.asarray((one == other) & (one == np.rint(one)))


def _beside(mesh: Mesh, spans: Spans, band: Floats, triangle: Ints, corner: Ints) -> Ints:
    """The bands of triangles at their flat edges: above or below, as the third corner is."""
    other, third = (corner + 1) % 3, band[triangle, (corner + 2) % 3]
    level = np.fmax(band[triangle, corner], band[triangle, other])
    region = mesh.region[triangle]
    flat = np.isnan(third) | (third == level)
    exact = np.nanmean(mesh.times[triangle[flat]], axis=1)
    start, span = spans.first[region[flat]], (spans.last - spans.first)[region[flat]]
    third[flat] = (exact - start) / span * spans.counts[region[flat]]
    found = np.where(third < level, level - 1, level).astype(np.intp)
    return np.asarray(spans.base[region] + np.clip(found, 0, spans.counts[region] - 1))


def _along_rim(mesh: Mesh, rim: Rim, spans: Spans, band: Floats) -> tuple[Ints, Ints, Floats, Ints]:
    """Places where levels cross the rim (c, 4), and what it consists of: keys, starts, bands."""
    chosen = np.flatnonzero(spans.counts[mesh.region[rim.triangle]] > 1)
    triangle, corner = rim.triangle[chosen], rim.corner[chosen]
    other = (corner + 1) % 3
    one, two = band[triangle, corner], band[triangle, other]
    one, two = np.where(np.isnan(one), two, one), np.where(np.isnan(two), one, two)
    backward = rim.shares[chosen, 0] > rim.shares[chosen, 1]
    shares = np.sort(rim.shares[chosen], axis=1)
    begin, end = np.where(backward, two, one), np.where(backward, one, two)

    # The parts of an edge, from the smaller share to the larger, begin at its crossings.
    first = np.floor(np.fmin(one, two)) + 1
    count = np.maximum(np.ceil(np.fmax(one, two)) - first, 0).astype(np.intp)
    row = np.repeat(np.arange(len(chosen)), count + 1)
    step = np.arange(len(row)) - np.repeat(np.cumsum(count + 1) - count - 1, count + 1)
    rising = end[row] > begin[row]
    level = np.where(rising, first[row] + step - 1, first[row] + count[row] - step)
    with np.errstate(invalid="ignore", divide="ignore"):
        away = np.where(step > 0, (level - begin[row]) / (end[row] - begin[row]), 0)
    start = shares[row, 0] + away * (shares[row, 1] - shares[row, 0])
    region = mesh.region[triangle[row]]
    lowest = np.where(step > 0, level - ~rising, np.floor(begin[row]) - _falls(begin, end)[row])
    found = spans.base[region] + np.clip(lowest, 0, spans.counts[region] - 1).astype(np.intp)
    flat = _flat(band[triangle])[np.arange(len(chosen)), corner][row]
    found[flat] = _beside(mesh, spans, band, triangle[row[flat]], corner[row[flat]])

    crossing = step > 0
    places = [triangle[row], corner[row], other[row], level.astype(np.intp)]
    key = rim.key[chosen][row]
    order = np.lexsort([start, key])
    return np.column_stack(places)[crossing], key[order], start[order], found[order]


def _falls(begin: Floats, end: Floats) -> Flags:
    """Whether a part that begins on a level runs down from it."""
    return np.asarray((begin == np.floor(begin)) & (end < begin))
