"""Boundaries that touch in one moving vertex all the time: whether they pass each other there.

No events tell. But vertices that move alike are one vertex, and a vertex whose quadratic vanishes
lies on its edge; there the order of directions tells:

         A /
    ______/           A and B touch at v: no direction of one
          v______     points into the sector of the other
          |
        B |
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geotween.motion.contacts import ROUNDING, Runs, at_times, between, cross, dot, quadratic, value
from geotween.motion.moving import Flags, Floats, Moving, Numbers

# Where in the time between key times directions at a point are put in order: not half-way.
ODD = 0.4772


@dataclass(frozen=True, eq=False)
class Passages:
    """Two boundaries that pass through one moving vertex, ``apex`` (k,), all the time.

    ``ways`` (4, k) are the vertices that they lead to: after and before the apex on the first,
    after and before it on the second. Their interiors lie to the left. ``corner`` (k,) is the
    first's corner, ``other`` (k,) the second's, or the edge on which the apex lies.
    ``on_edge`` (k,) tells those: they pass each other only while the apex is within the edge.
    """

    apex: Numbers
    ways: Numbers
    corner: Numbers
    other: Numbers
    on_edge: Flags


def passages(moving: Moving, corner: Numbers, edge: Numbers) -> Passages:
    """All corners that share a moving vertex, by twos, and given corners that lie on edges."""
    order = np.argsort(moving.vertex, kind="stable")
    ones, others = [corner[:0]], [corner[:0]]
    for step in range(1, len(order)):
        same = moving.vertex[order[step:]] == moving.vertex[order[:-step]]
        if not same.any():
            break
        ones.append(order[:-step][same])
        others.append(order[step:][same])
    one, other = np.concatenate(ones), np.concatenate(others)
    on_edge = np.repeat([False, True], [len(one), len(edge)])
    after, before = moving.following, moving.before
    own = np.equal(*moving.track[moving.ring[np.stack([one, other])]])
    back = _inward(moving, one[own], other[own])[np.stack([one, other])]
    back[:, own] = before[np.stack([one, other])[:, own]]
    ways = np.stack(
        [
            np.concatenate([after[one], after[corner]]),
            np.concatenate([back[0], before[corner]]),
            np.concatenate([after[other], after[edge]]),
            np.concatenate([back[1], edge]),
        ]
    )
    first, second = np.concatenate([one, corner]), np.concatenate([other, edge])
    return Passages(moving.vertex[first], moving.vertex[ways], first, second, on_edge)


def _inward(moving: Moving, one: Numbers, other: Numbers) -> Numbers:
    """For each corner (n,) the one from which the boundary comes that is next to the left.

    That is the corner before it, but where two corners of a polygon share a moving vertex, as a
    hole that touches the rim does: what lies between them there belongs to neither.
    """
    back = moving.before.copy()
    corner = np.unique(np.concatenate([one, other]))
    if not len(corner):
        return back
    places = moving.at(ODD)[moving.vertex]
    ways = [places[to[corner]] - places[corner] for to in (moving.following, moving.before)]
    out, in_ = (np.arctan2(way[:, 1], way[:, 0]) for way in ways)
    at = moving.vertex[corner] * len(moving.track) + moving.track[moving.ring[corner]]
    leaving, coming = sectors(at, out, at, in_)
    back[corner[leaving]] = moving.before[corner[coming]]
    return back


def sectors(
    leaving: Numbers, out: Floats, coming: Numbers, back: Floats
) -> tuple[Numbers, Numbers]:
    """What leaves and what comes in along the same sector of a polygon, at some places each.

    A sector lies to the left of what leaves, up to the next one counter-clockwise that comes in.
    ``leaving`` and ``coming`` (k,) are places; each is there as often among both. ``out`` and
    ``back`` (k,) are the angles of what leaves, and of the way back to where what comes in is from.
    """
    one, other = np.lexsort((out, leaving)), np.lexsort((back, coming))
    first = np.flatnonzero(np.append(True, leaving[one][1:] != leaving[one][:-1]))
    counts = np.diff(np.append(first, len(one)))
    group = np.repeat(np.arange(len(first)), counts)
    earlier = back[other] < out[one][first][group]
    shift = np.add.reduceat(earlier.astype(np.intp), first)
    rank = np.arange(len(one)) - first[group]
    return one, other[first[group] + (rank + shift[group]) % counts[group]]


def overlapping(moving: Moving, found: Passages) -> tuple[Runs, Runs, int]:
    """When boundaries that touch throughout pass each other; when they touch; number of looks.

    Two polygons may not have a direction in common; the boundary of one polygon may not lead into
    itself. Directions closer than the tolerance, at the end of the shorter one, are the same.
    """
    apex, ways = found.apex, [moving.ways(found.apex, way) for way in found.ways]
    window = np.ones((2, 3, len(apex)))
    for k, (way, back) in enumerate(((2, 3), (3, 2))):
        edge = moving.ways(found.ways[back], found.ways[way])
        inside = quadratic(dot, edge, moving.ways(found.ways[back], apex))
        window[k] = np.where(found.on_edge, inside, window[k])
    sides = [quadratic(cross, ways[i], ways[j]) for i in range(4) for j in range(i)]
    times, moments = between(np.stack([*sides, *window]))
    touching = (value(window[0], moments) > 0) & (value(window[1], moments) > 0)
    track = moving.track[moving.ring]
    same = (track[found.corner] == track[found.other])[:, None]
    wrong = _pass([at_times(way, moments) for way in ways], same, moving.tolerance)
    wrong &= np.diff(times) > ROUNDING
    deep = np.ones_like(touching)
    return Runs.of(touching & wrong, deep, times), Runs.of(touching, deep, times), moments.size


def _pass(ways: list[Floats], same: Flags, tolerance: float) -> Flags:
    """Whether two boundaries pass each other where they meet; of one polygon where ``same``."""
    lengths = [np.hypot(way[..., 0], way[..., 1]) for way in ways]
    sign = np.zeros((4, 4, *lengths[0].shape), dtype=np.int8)
    equal = np.zeros((4, 4, *lengths[0].shape), dtype=bool)
    for i in range(4):
        for j in range(i):
            product, limit = cross(ways[i], ways[j]), tolerance * np.maximum(lengths[i], lengths[j])
            clear = np.abs(product) > limit
            sign[i, j] = np.where(clear, np.sign(product), 0)
            sign[j, i] = -sign[i, j]
            equal[i, j] = equal[j, i] = ~clear & (dot(ways[i], ways[j]) > 0)

    def inside(x: int, start: int, stop: int) -> tuple[Flags, Flags]:
        rising = (
            (sign[start, x] > 0).astype(np.int8) + (sign[x, stop] > 0) + (sign[stop, start] > 0)
        )
        off = ~equal[x, start] & ~equal[x, stop]
        return off & (rising >= 2), off & (rising < 2)

    inner = [inside(0, 2, 3), inside(1, 2, 3), inside(2, 0, 1), inside(3, 0, 1)]
    some_in, some_out = (np.any(flags, axis=0) for flags in zip(*inner, strict=True))
    alike = equal[0, 2] & equal[1, 3]
    known = ~equal[0, 1] & ~equal[2, 3]  # a sector between equal directions is none, or all
    return np.asarray((np.where(same, some_in & some_out, some_in) | alike) & known)
