"""Tracks as the page's file tells them: places and vertices once, rings as runs of numbers.

    points   x, y of all places: first those, ``starts`` of them, that are first seen as starts
    ways     from which point to which a vertex goes: one number each, 5 * start + end
    jumps    what these two say is told here, as differences from the vertex before
    lives    when vertices that move do so, since and until as numbers of ``moments``, and how many
    tracks   rings of vertices

A start is 0 the one of the vertex before, 1 the point after it, 2 the first that no vertex had, 3
a jump; an end likewise, or 4 where the vertex rests. Lists hold differences, because small numbers
are short, and are written as numerals.py has it. A ring that is much like an earlier one says what
it has of that. Vertices that move each for itself are told with their track instead.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geotween.export.numerals import told
from geotween.export.page_grid import GridFilm, GridTrack, packed

Numbers = NDArray[np.int64]
Floats = NDArray[np.float64]

NOBODY = -1

# What a vertex's start and end say beyond 0 and 1, the ones of the vertex before and those after.
NEW, JUMP, REST = 2, 3, 4


@dataclass(frozen=True, eq=False)
class Coded:
    """What a page is told of tracks, as plain values, and the number of each track there."""

    shared: dict[str, Any]
    tracks: list[dict[str, Any]]
    numbers: dict[GridTrack, int]


def coded(tracks: Iterable[GridTrack]) -> Coded:
    """Tracks in the order in which they are shown; those that rest alike are told once.

    Cost: n log n for n vertices of all tracks.
    """
    names = {track: _name(track) for track in tracks}
    distinct: dict[object, GridTrack] = {}
    for track, name in names.items():
        distinct.setdefault(name, track)
    places = {name: place for place, name in enumerate(distinct)}
    shown = list(distinct.values())
    table = _table([track for track in shown if track.still or track.film is not None])
    moments = np.unique(
        [*table.lives.ravel().tolist(), *(t for track in shown for t in track.life)]
    )
    moving = np.searchsorted(moments, table.lives[:, table.ways[0] != table.ways[1]])
    ways, jumps = _ways(table)
    return Coded(
        {
            "points": told(differences(table.points)),
            "starts": int(table.new[0].sum()),
            "ways": told(ways),
            "jumps": told(jumps),
            "moments": moments.tolist(),
            "lives": told(_spells(moving)),
        },
        _tracks(shown, table, moments),
        {track: places[name] for track, name in names.items()},
    )


def _ways(table: _Table) -> tuple[Numbers, Numbers]:
    """A number (v,) for the way of each vertex, and what jumps (j,) are told beside them."""
    steps = np.diff(table.ways, axis=1, prepend=0)
    codes = np.where((steps == 0) | (steps == 1), steps, JUMP)
    codes[(codes == JUMP) & table.new] = NEW
    codes[1, table.ways[0] == table.ways[1]] = REST
    return 5 * codes[0] + codes[1], steps.T[codes.T == JUMP]


def differences(values: Sequence[int] | Numbers) -> list[int]:
    """The first value, and what each is more than the one before it; of rows, row by row."""
    found: list[int] = np.diff(values, axis=0, prepend=0).ravel().tolist() if len(values) else []
    return found


def _name(track: GridTrack) -> object:
    """The same for tracks that rest alike."""
    if track.film is not None or not track.still:
        return track
    arrays = (track.vertices, track.offsets, track.seams)
    return (track.life, *(array.tobytes() for array in arrays))


@dataclass(frozen=True, eq=False)
class _Table:
    """What tracks share: ``points`` (p, 2), and the vertices that go from one to another.

    ``ways`` (2, v) are points, ``new`` (2, v) where no vertex before had them, ``lives`` (2, v)
    times. ``sequences`` are the vertices of tracks.
    """

    points: Numbers
    ways: Numbers
    new: NDArray[np.bool_]
    lives: Floats
    sequences: dict[GridTrack, Numbers]


def _table(tracks: list[GridTrack]) -> _Table:
    """Points and vertices in the order in which they are first shown."""
    places, lives, sequences = _gathered(tracks)
    seen = np.zeros(places.shape[1], dtype=bool)
    fresh = []
    for sequence in sequences:
        new = sequence[~seen[sequence]]
        new = new[np.sort(np.unique(new, return_index=True)[1])]
        seen[new] = True
        fresh.append(new)
    order = np.concatenate([np.empty(0, dtype=np.int64), *fresh])
    number = np.full(places.shape[1], NOBODY)
    number[order] = np.arange(len(order))
    known, first, which = np.unique(
        packed(places[:, order]).T, return_index=True, return_inverse=True
    )
    # Those that are first seen as starts before the others: each of both follows a line.
    rank = np.empty(len(known), dtype=np.int64)
    rank[np.lexsort((first, first % 2))] = np.arange(len(known))
    ways = rank[which.reshape(-1, 2).T]
    points = np.empty((len(known), 2), dtype=np.int64)
    points[ways] = places[:, order]
    first_seen = np.zeros((len(order), 2), dtype=bool)
    first_seen.reshape(-1)[first] = True
    numbered = {k: number[sequence] for k, sequence in zip(tracks, sequences, strict=True)}
    return _Table(points, ways, first_seen.T, lives[:, order], numbered)


def _gathered(tracks: list[GridTrack]) -> tuple[Numbers, Floats, list[Numbers]]:
    """The vertices of all tracks: places (2, v, 2), lives (2, v), and which ones each track has.

    Those that rest at one place are the same.
    """
    places, lives, sequences = [np.empty((2, 0, 2), dtype=np.int64)], [np.empty((2, 0))], []
    firsts: dict[GridFilm | GridTrack, int] = {}
    count = 0
    for track in tracks:
        source = track.film or track
        if source not in firsts:
            firsts[source] = count
            places.append(track.film.places if track.film else track.vertices[[0, 0]])
            size = places[-1].shape[1]
            lives.append(track.film.lives if track.film else np.tile([[0.0], [1.0]], size))
            count += size
        nodes = np.arange(track.vertices.shape[1]) if track.nodes is None else track.nodes
        sequences.append(firsts[source] + nodes.astype(np.int64))
    every = np.concatenate(places, axis=1)
    still = np.flatnonzero((every[0] == every[1]).all(axis=1))
    first, same = np.unique(packed(every[0, still]), return_index=True, return_inverse=True)[1:]
    alike = np.arange(count)
    alike[still] = still[first[same]]
    return every, np.concatenate(lives, axis=1), [alike[sequence] for sequence in sequences]


def _spells(lives: Numbers) -> list[int]:
    """Lives (2, m) that repeat in a row, as differences from the ones before, and counts."""
    new = np.flatnonzero(np.append(True, (lives[:, 1:] != lives[:, :-1]).any(axis=0)))
    new = new[: lives.shape[1]]
    counts = np.diff(np.append(new, lives.shape[1]))
    found: list[int] = (
        np.vstack([np.diff(lives[:, new], axis=1, prepend=0), counts]).T.ravel().tolist()
    )
    return found


def _tracks(tracks: list[GridTrack], table: _Table, moments: Floats) -> list[dict[str, Any]]:
    last = np.full(table.ways.shape[1], NOBODY)  # the track in which each vertex has been last
    sequences: list[Numbers] = []
    unseen = 0
    found = []
    for place, track in enumerate(tracks):
        entry: dict[str, Any] = {"rings": np.diff(track.offsets).tolist()}
        if track.life != (0.0, 1.0):
            entry["life"] = np.searchsorted(moments, track.life).tolist()
        sequence = table.sequences.get(track, np.empty(0, dtype=np.int64))
        if track in table.sequences:
            base = _likeliest(last[sequence])
            written = script(sequence, sequence[:0], unseen)
            if base != NOBODY:
                copied = script(sequence, sequences[base], unseen)
                if len(copied) < len(written):
                    written = copied
                    entry["base"] = place - base
            entry["nodes"] = told(written)
            last[sequence] = place
            unseen = max(unseen, int(sequence.max(initial=NOBODY)) + 1)
        else:
            entry |= {"times": track.times, "places": _differences(track.vertices)}
        if track.seams.any():
            entry["seams"] = _lengths(track.seams)
        sequences.append(sequence)
        found.append(entry)
    return found


def _likeliest(tracks: Numbers) -> int:
    """The track that most vertices have been in."""
    values, counts = np.unique(tracks[tracks != NOBODY], return_counts=True)
    return int(values[np.argmax(counts)]) if len(values) else NOBODY


def script(sequence: Numbers, base: Numbers, unseen: int) -> list[int]:
    """How to write a sequence: by turns what to copy from another one, and runs of numbers.

    Both as pairs: how far to go on, and how many to take; less than 0 for a run that falls. Runs
    go on from ``unseen`` to begin with. Without a base all are runs.
    """
    if not len(sequence):
        return []
    order = np.argsort(base)
    known = np.append(base[order], NOBODY)
    nearest = np.searchsorted(known[:-1], sequence)
    copied = known[nearest] == sequence
    at = np.append(order, NOBODY)[nearest]
    step = np.diff(sequence, prepend=sequence[:1])
    in_copy = copied[1:] & copied[:-1] & (np.diff(at) == 1)
    in_run = ~copied[1:] & ~copied[:-1] & (np.abs(step[1:]) == 1)
    in_run[1:] &= ~in_run[:-1] | (step[2:] == step[1:-1])
    starts = np.flatnonzero(np.append(True, ~(in_copy | in_run)))
    counts = np.diff(np.append(starts, len(sequence)))
    found: list[int] = []
    cursor, following = 0, unseen
    to_copy = len(base) > 0
    for start, count in zip(starts.tolist(), counts.tolist(), strict=True):
        if len(base) and copied[start] != to_copy:
            found += [0, 0]
        to_copy = not copied[start]
        if copied[start]:
            found += [int(at[start]) - cursor, count]
            cursor = int(at[start]) + count
        else:
            run = count if count == 1 else count * int(step[start + 1])
            found += [int(sequence[start]) - following, run]
            following = int(sequence[start]) + run
    return found


def _lengths(values: NDArray[np.uint8]) -> list[int]:
    """Values in a row as pairs: a value, and how often it is repeated."""
    starts = np.flatnonzero(np.append(True, values[1:] != values[:-1]))
    counts = np.diff(np.append(starts, len(values)))
    pairs: list[int] = np.column_stack([values[starts], counts]).ravel().tolist()
    return pairs


def _differences(vertices: Numbers) -> list[str]:
    """Positions at the first key time, then displacements; both as differences along the rings."""
    moves = np.diff(vertices, axis=0, prepend=0)
    return [told(of) for of in np.diff(moves, axis=1, prepend=0)]
