"""Pins: the runs of boundary that two rings have in common, which matching leaves in place.

a──b──c──d──e      bcd is common to both, although c is a vertex of one ring only: b and d
x──b─────d──y      match, c gets a partner on the edge bd, and none of them moves.
"""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.polygons import RELATIVE_TOLERANCE
from geotween.motion.rings import Vertices

# Runs that are not in the same cyclic order in both rings cannot all be pinned. The chain kept is
# the longest of those through one of this many longest runs; each costs a look at all runs.
CHAINS_TRIED = 8


@dataclass(frozen=True, eq=False)
class Pins:
    """Places (p,) that two rings share, in cyclic order in both.

    ``here`` and ``there`` are ring parameters, k + s for s of the way along edge k; ``common``
    says whether the boundary from one place to the next is common, too.
    """

    here: NDArray[np.float64]
    there: NDArray[np.float64]
    common: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Runs:
    """Runs as intervals of node numbers in both of two rings; an end may lie beyond the count.

    ``nodes`` are the counts of nodes of both rings; ``start`` and ``size`` are (r, 2), size in
    edges; ``length`` (r,) is in the data's units.
    """

    nodes: NDArray[np.intp]
    start: NDArray[np.intp]
    size: NDArray[np.intp]
    length: NDArray[np.float64]


def common_runs(one: Vertices, other: Vertices) -> Pins:
    """The runs of boundary common to two open rings that run the same way round.

    Boundary is compared as a place, not by its vertices: a straight edge is common although only
    one ring has vertices on it. Points where two rings only touch or cross are no run. Runs that
    are not in the same order in both rings are reduced to the longest chain that is.

    Cost: n log n for n vertices, as long as the order is the same.
    """
    contacts = _contacts(one, other)
    if len(contacts) < 2:
        return _no_pins()
    nodes_here = np.union1d(np.arange(len(one)), contacts[:, 0])
    nodes_there = np.union1d(np.arange(len(other)), contacts[:, 1])
    nodes = np.array([len(nodes_here), len(nodes_there)])
    number = np.column_stack(
        [np.searchsorted(nodes_here, contacts[:, 0]), np.searchsorted(nodes_there, contacts[:, 1])]
    )
    codes = number[:, 0] * nodes[1] + number[:, 1]
    order = np.argsort(codes)
    number, codes, contacts = number[order], codes[order], contacts[order]
    after = (number + 1) % nodes
    following = np.searchsorted(codes, after[:, 0] * nodes[1] + after[:, 1]) % len(codes)
    linked = (number[following] == after).all(axis=1)
    if not linked.any():
        return _no_pins()
    if linked.all() and len(contacts) == nodes[0] == nodes[1]:
        return Pins(contacts[:, 0], contacts[:, 1], linked)
    chains = _chains(following, linked)
    if not chains:
        return _no_pins()
    runs = Runs(
        nodes,
        np.array([number[chain[0]] for chain in chains]),
        np.array([len(chain) - 1 for chain in chains])[:, None].repeat(2, axis=1),
        np.array([_length(one, contacts[chain, 0]) for chain in chains]),
    )
    kept = [chains[k] for k in consistent(runs)]
    members = np.concatenate(kept)
    ends = np.cumsum([len(chain) for chain in kept]) - 1
    common = np.ones(len(members), dtype=bool)
    common[ends] = False
    return Pins(contacts[members, 0], contacts[members, 1], common)


def _no_pins() -> Pins:
    return Pins(np.empty(0), np.empty(0), np.empty(0, dtype=bool))


def _contacts(one: Vertices, other: Vertices) -> NDArray[np.float64]:
    """Places (c, 2) where a vertex of one ring lies on the other, as parameters of both."""
    both = np.concatenate([one, other])
    tolerance = RELATIVE_TOLERANCE * float(np.ptp(both, axis=0).max())
    vertex, place = _on_edges(other, one, tolerance)
    corner, spot = _on_edges(one, other, tolerance)
    found = np.concatenate([np.column_stack([place, vertex]), np.column_stack([corner, spot])])
    return np.unique(found, axis=0)


def _on_edges(
    points: Vertices, ring: Vertices, tolerance: float
) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Which points lie on a ring, and where; whole parameters where they lie at its vertices."""
    low, high = ring.min(axis=0) - tolerance, ring.max(axis=0) + tolerance
    near = np.flatnonzero(((points >= low) & (points <= high)).all(axis=1))
    ends = np.roll(ring, -1, axis=0)
    edges: Any = shapely.linestrings(np.stack([ring, ends], axis=1))
    candidates: Any = shapely.points(points[near])
    hit, edge = shapely.STRtree(edges).query(candidates, "dwithin", distance=tolerance)
    point = near[hit]
    way, off = ends[edge] - ring[edge], points[point] - ring[edge]
    square = (way**2).sum(axis=1)
    share = np.clip((way * off).sum(axis=1) / np.where(square > 0, square, 1), 0, 1)
    at_start = np.hypot(*off.T) <= tolerance
    at_end = np.hypot(*(points[point] - ends[edge]).T) <= tolerance
    share = np.where(at_start, 0, np.where(at_end, 1, share))
    return point, (edge + share) % len(ring)


def _chains(following: NDArray[np.intp], linked: NDArray[np.bool_]) -> list[NDArray[np.intp]]:
    """Contacts that follow one another along common edges, one array a run."""
    begins = linked.copy()
    begins[following[linked]] = False
    chains = []
    step, more = following.tolist(), linked.tolist()
    for first in np.flatnonzero(begins).tolist():
        chain = [first]
        while more[chain[-1]]:
            chain.append(step[chain[-1]])
        chains.append(np.array(chain))
    return chains


def _length(ring: Vertices, places: NDArray[np.float64]) -> float:
    edge = places.astype(np.intp)
    ways = np.roll(ring, -1, axis=0) - ring
    points = ring[edge] + (places - edge)[:, None] * ways[edge]
    return float(np.hypot(*np.diff(points, axis=0).T).sum())


def consistent(runs: Runs) -> list[int]:
    """The runs of the longest chain that has the same cyclic order in both rings, in order."""
    order = np.argsort(runs.start[:, 0], kind="stable")
    start, size = runs.start[order], runs.size[order]
    gaps = (np.roll(start, -1, axis=0) - start - size) % runs.nodes
    if (gaps > 0).all() and ((gaps + size).sum(axis=0) == runs.nodes).all():
        return [int(k) for k in order]
    longest = np.argsort(-runs.length, kind="stable")[:CHAINS_TRIED]
    chains = [_chain_through(runs, int(base)) for base in longest]
    return max(chains, key=lambda chain: float(runs.length[chain].sum()))


def _chain_through(runs: Runs, base: int) -> list[int]:
    """The longest chain through one run: a heaviest rising sequence, in n log n."""
    end_of_base = runs.start[base] + runs.size[base]
    start = (runs.start - end_of_base) % runs.nodes  # nodes after the run's end
    end = start + runs.size
    fits = ((start > 0) & (end < runs.nodes - runs.size[base])).all(axis=1)
    inner = np.flatnonzero(fits)
    by_start, by_end = inner[np.argsort(start[inner, 0])], inner[np.argsort(end[inner, 0])].tolist()
    # Ends in the other ring and the heaviest chain up to there; both rise.
    reach: list[int] = []
    weight: list[float] = []
    last: list[int] = []
    total: dict[int, float] = {}
    before: dict[int, int] = {}
    entered = 0
    for run in by_start.tolist():
        while entered < len(by_end) and end[by_end[entered], 0] < start[run, 0]:
            done = by_end[entered]
            entered += 1
            at = bisect_left(reach, int(end[done, 1]))
            if at and weight[at - 1] >= total[done]:
                continue
            stop = at
            while stop < len(reach) and weight[stop] <= total[done]:
                stop += 1
            reach[at:stop] = [int(end[done, 1])]
            weight[at:stop], last[at:stop] = [total[done]], [done]
        at = bisect_left(reach, int(start[run, 1]))
        total[run] = float(runs.length[run]) + (weight[at - 1] if at else 0.0)
        before[run] = last[at - 1] if at else base
    if not total:
        return [base]
    chain = [max(total, key=total.__getitem__)]
    while chain[-1] != base:
        chain.append(before[chain[-1]])
    return chain[::-1]
