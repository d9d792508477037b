"""The walk along directed pieces of boundary: which rings there are, and from when to when.

What lasts equally long and has no other way to go is strung together first, so that the walk,
which is done anew between each two moments at which something near changes, has few steps:

    pieces --strings--> few pieces --rounds--> rings of each interval --lasting--> rings

A ring goes through no node twice: where a thing touches itself at a point, rings part.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from geotween.motion.front.pieces import Nodes, Pieces
from geotween.motion.front.plane import Floats, Ints
from geotween.motion.groups import connected
from geotween.motion.passages import sectors

Ring = tuple[int, ...]  # the numbers of its strings


@dataclass(frozen=True, eq=False)
class Bounds:
    """Rings in the order of their things: ring r has the corners ``offsets[r]`` to the next.

    ``thing``, ``since`` and ``until`` are (r,); ``node`` and ``seam`` (n,) are of each corner and
    of the edge after it. The thing lies to the left.
    """

    thing: Ints
    since: Floats
    until: Floats
    offsets: Ints
    node: Ints
    seam: NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class _Strings:
    """Pieces in a row: string s has the pieces ``rows[offsets[s]:offsets[s + 1]]``.

    ``start`` and ``end`` (s,) are places, a node of one thing each.
    """

    rows: Ints
    offsets: Ints
    start: Ints
    end: Ints
    since: Floats
    until: Floats


def bounds_of(nodes: Nodes, pieces: Pieces) -> Bounds:
    """The rings that some pieces make, each for as long as it stays the same.

    Raises
    ------
    ArithmeticError
        Where the pieces do not close.

    Notes
    -----
    At a point where a ring could go on in several ways it stays along the same part of its thing.
    Cost: n log n for n pieces, and linear in the steps of the walk: strings, each as often as
    something happens in its part of the outline.
    """
    strings = _strings(pieces)
    moments, cell, string = _cells(strings)
    following = _following(nodes, pieces, strings, moments, cell, string)
    rings, first, last = _lasting(_rounds(following, cell, strings.start[string], string))
    chosen = np.fromiter(chain.from_iterable(rings), dtype=np.intp)
    rows = strings.rows[ranges(strings.offsets[chosen], strings.offsets[chosen + 1])]
    ends = offsets_of(np.diff(strings.offsets)[chosen])
    offsets = ends[offsets_of([len(ring) for ring in rings])]
    return Bounds(
        pieces.thing[rows[offsets[:-1]]],
        moments[1, np.array(first, dtype=np.intp)],
        moments[1, np.array(last, dtype=np.intp) + 1],
        offsets,
        pieces.start[rows],
        pieces.seam[rows],
    )


def offsets_of(counts: Sequence[int] | Ints) -> Ints:
    return np.concatenate([[0], np.cumsum(counts)]).astype(np.intp)


def ranges(low: Ints, high: Ints) -> Ints:
    """All numbers from each low up to its high, in a row."""
    counts = high - low
    before = np.cumsum(counts) - counts
    return np.asarray(np.arange(counts.sum()) + np.repeat(low - before, counts))


def _strings(pieces: Pieces) -> _Strings:
    """Pieces strung together at places where just one ends and one starts, at any time."""
    count = len(pieces.thing)
    width = int(max(pieces.start.max(initial=0), pieces.end.max(initial=0))) + 1
    both = np.concatenate([pieces.start, pieces.end]) + np.tile(pieces.thing, 2) * width
    place = np.unique(both, return_inverse=True)[1].reshape(2, -1)
    leaving, coming = (np.bincount(side, minlength=place.max(initial=0) + 1) for side in place)
    leaves = np.zeros(len(leaving), dtype=np.intp)
    leaves[place[0]] = np.arange(count)
    onward = leaves[place[1]]
    plain = (leaving[place[1]] == 1) & (coming[place[1]] == 1)
    plain &= (pieces.since[onward] == pieces.since) & (pieces.until[onward] == pieces.until)
    following = np.where(plain, onward, -1)
    first = np.ones(count, dtype=bool)
    first[onward[plain]] = False
    walked = list(_paths(following.tolist(), np.flatnonzero(first).tolist()))
    rows = np.array([row for path in walked for row in path], dtype=np.intp)
    offsets = offsets_of([len(path) for path in walked])
    head, tail = rows[offsets[:-1]], rows[offsets[1:] - 1]
    since, until = pieces.since[head], pieces.until[head]
    return _Strings(rows, offsets, place[0, head], place[1, tail], since, until)


def _paths(following: list[int], firsts: Sequence[int]) -> Iterator[list[int]]:
    """The paths from given elements to where nothing follows, then the rest, which are rings."""
    seen = [False] * len(following)
    for first in (*firsts, *range(len(following))):
        path = []
        k = first
        while k >= 0 and not seen[k]:
            seen[k] = True
            path.append(k)
            k = following[k]
        if path:
            yield path


def _cells(strings: _Strings) -> tuple[Floats, Ints, Ints]:
    """The moments (2, k) at which something happens, by component of the outlines and in time.

    Cell c lasts from moment c to the next; ``cell`` and ``string`` (m,) tell which strings are
    there in which cells.
    """
    count = len(strings.start)
    ends = np.column_stack([strings.start, strings.end])
    component = connected(ends, int(ends.max(initial=-1)) + 1)[strings.start]
    every = np.stack([np.tile(component, 2), np.concatenate([strings.since, strings.until])])
    moments, place = np.unique(every, axis=1, return_inverse=True)
    first, last = place.reshape(2, -1)
    string = np.repeat(np.arange(count), last - first)
    cell = ranges(first, last)
    order = np.lexsort((string, cell))
    return moments, cell[order], string[order]


def _following(
    nodes: Nodes,
    pieces: Pieces,
    strings: _Strings,
    moments: Floats,
    cell: Ints,
    string: Ints,
) -> Ints:
    """For each string in a cell the one that follows there (m,)."""
    width = int(strings.start.max(initial=0)) + 1
    starts, ends = (cell * width + at[string] for at in (strings.start, strings.end))
    order = np.argsort(starts, kind="stable")
    known = starts[order]
    if not np.array_equal(np.sort(ends), known):
        raise ArithmeticError("the outlines of the arrivals do not close")
    low, high = (np.searchsorted(known, ends, side=side) for side in ("left", "right"))
    following = order[low]
    coming = np.flatnonzero(high - low > 1)
    if len(coming):
        leaving = np.flatnonzero(np.isin(starts, ends[coming]))
        at = (moments[1, :-1] + moments[1, 1:]) / 2
        head = strings.rows[strings.offsets[string[leaving]]]
        tail = strings.rows[strings.offsets[string[coming] + 1] - 1]
        out = _angle(nodes, pieces.start[head], pieces.end[head], at[cell[leaving]])
        back = _angle(nodes, pieces.end[tail], pieces.start[tail], at[cell[coming]])
        one, other = sectors(starts[leaving], out, ends[coming], back)
        following[coming[other]] = leaving[one]
    return following


def _angle(nodes: Nodes, start: Ints, end: Ints, t: Floats) -> Floats:
    """The directions (k,) from nodes to others, at one moment each."""
    way = nodes.at(end, t) - nodes.at(start, t)
    return np.arctan2(way[:, 1], way[:, 0])


def _rounds(following: Ints, cell: Ints, start: Ints, string: Ints) -> Iterator[tuple[int, Ring]]:
    """The rings of each cell, as strings; the least one comes first."""
    cells, starts, strings = cell.tolist(), start.tolist(), string.tolist()
    for path in _paths(following.tolist(), ()):
        for ring in _parted(path, [starts[k] for k in path]):
            names = [strings[k] for k in ring]
            least = names.index(min(names))
            yield cells[ring[0]], tuple(names[least:] + names[:least])


def _parted(path: list[int], places: list[int]) -> Iterator[list[int]]:
    """A closed path in rings that go through no place twice."""
    if len(set(places)) == len(places):
        yield path
        return
    ring: list[int] = []
    open_: dict[int, int] = {}
    for k, place in zip(path, places, strict=True):
        if place in open_:
            done = ring[open_[place] :]
            ring = ring[: open_[place]]
            open_ = {at: rank for at, rank in open_.items() if rank < len(ring)}
            yield done
        open_[place] = len(ring)
        ring.append(k)
    yield ring


def _lasting(rounds: Iterator[tuple[int, Ring]]) -> tuple[list[Ring], list[int], list[int]]:
    """Rings, and the first and the last cell of each; cells come in order."""
    rings: list[Ring] = []
    first: list[int] = []
    last: list[int] = []
    known: dict[Ring, int] = {}
    for cell, ring in rounds:
        number = known.get(ring)
        if number is not None and last[number] == cell - 1:
            last[number] = cell
            continue
        known[ring] = len(rings)
        rings.append(ring)
        first.append(cell)
        last.append(cell)
    return rings, first, last
