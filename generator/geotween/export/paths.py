"""Path data: tracks on the grid as the text of a ``d`` attribute."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from geotween.export.page_grid import GRID, GridTrack
from geotween.export.shapes import Shape
from geotween.motion.rings import Offsets, next_vertex

# Moving vertices of a film are written in hundredths of a pixel at the moments between the ends of
# their ways: rounded like the ends, they would leave the line that a neighbour has there.
FINE = 0.01


Line = tuple[NDArray[np.intp], bool]  # the numbers of its vertices, and whether it closes


def path_texts(shape: Shape, life: tuple[float, float] = (0.0, 1.0)) -> list[tuple[float, str]]:
    """The path at each key time of a shape whose tracks are there for a time; one if it is still.

    All of a shape's texts have the same sequence of commands, as SMIL demands.
    """
    times = {life[0]}
    if not all(track.still for track in shape.tracks):
        times |= {life[1], *(t for k in shape.tracks if not k.still for t in k.times)}
    unit = GRID if all(track.film is None for track in shape.tracks) else FINE
    lines = _lines_of(shape, shape.tracks)
    return [
        (t, _text(_points([track.at(t) for track in shape.tracks], unit), lines, unit))
        for t in sorted(times)
        if life[0] <= t <= life[1]
    ]


def path_at(shape: Shape, t: float) -> str:
    """The path of a shape at t, after easing, of those tracks that are there then."""
    there = [k for k in shape.tracks if k.life[0] <= t < k.life[1] or t == k.life[1] == 1]
    points = _points([track.between(t) for track in there], FINE)
    return _text(points, _lines_of(shape, there), FINE)


def _points(places: Sequence[NDArray[np.float64]], unit: float) -> NDArray[np.int64]:
    """Places of several tracks, in steps of GRID, as steps of a unit (n, 2)."""
    every = np.concatenate([np.empty((0, 2)), *places])
    return np.rint(every * (GRID / unit)).astype(np.int64)


def _lines_of(shape: Shape, tracks: Iterable[GridTrack]) -> list[Line]:
    """The lines that a shape draws of some tracks, whose vertices are numbered together."""
    lines, first = list[Line](), 0
    for track in tracks:
        lines += [(first + line, closed) for line, closed in _lines(shape, track)]
        first += track.vertices.shape[1]
    return lines


def _lines(shape: Shape, track: GridTrack) -> Iterator[Line]:
    """The vertex numbers of each line that a shape draws of a track, and whether it closes."""
    if shape.slot.kind == "border":
        yield from runs(track.seams == 0, track.offsets)
    elif shape.slot.kind == "seam":
        yield from runs(track.seams == shape.slot.code, track.offsets)
    else:
        for start, end in zip(track.offsets[:-1], track.offsets[1:], strict=True):
            yield np.arange(start, end), True


def runs(chosen: NDArray[np.bool_], offsets: Offsets) -> Iterator[Line]:
    """Lines along the chosen edges (edge k runs from vertex k to the next of its ring).

    A run goes on across its ring's last vertex; a ring chosen as a whole is one closed line.
    """
    following = next_vertex(offsets)
    for start, end in pairwise(offsets):
        ring = chosen[start:end]
        if ring.all():
            yield np.arange(start, end), True
            continue
        firsts = np.flatnonzero(ring & ~np.roll(ring, 1))
        lasts = np.flatnonzero(ring & ~np.roll(ring, -1))
        if len(lasts) and lasts[0] < firsts[0]:
            lasts = np.roll(lasts, -1)
        size = end - start
        for first, last in zip(firsts, lasts, strict=True):
            edges = start + (first + np.arange((last - first) % size + 1)) % size
            yield np.append(edges, following[edges[-1]]), False


def _text(points: NDArray[np.int64], lines: Sequence[Line], unit: float) -> str:
    """Lines through some of the points (n, 2), each as its start and the steps from there."""
    if not lines:
        return ""
    chosen = points[np.concatenate([line for line, _ in lines])]
    ends = np.cumsum([len(line) for line, _ in lines])
    starts = np.append(0, ends[:-1])
    steps = np.diff(chosen, axis=0, prepend=0)
    steps[starts] = chosen[starts]
    number = _numbers(unit)
    told = [number[value] for value in steps.ravel().tolist()]
    for start, end, (_, closed) in zip(starts.tolist(), ends.tolist(), lines, strict=True):
        told[2 * start] = f"M{told[2 * start].lstrip()}"
        told[2 * start + 1] += "l"
        if end - start > 1:
            told[2 * start + 2] = told[2 * start + 2].lstrip()
        if closed:
            told[2 * end - 1] += "z"
    return "".join(told)


class _Numbers(dict[int, str]):
    """Steps of a unit as pixels, after a space; a minus sign separates, and needs none."""

    def __init__(self, unit: float) -> None:
        self.parts = round(1 / unit)

    def __missing__(self, value: int) -> str:
        text = f"{value / self.parts:.2f}".rstrip("0").removesuffix(".")
        text = text.replace("0.", ".", 1) if text.startswith(("0.", "-0.")) else text
        self[value] = text if text.startswith("-") else f" {text}"
        return self[value]


_numbers = cache(_Numbers)  # they have no more entries than a map has places in a row


def closed_path(tracks: Iterable[GridTrack]) -> str:
    """All rings of tracks that rest, as one path."""
    points, lines, first = [np.empty((0, 2), dtype=np.int64)], list[Line](), 0
    for track in tracks:
        points.append(track.vertices[0])
        rings = pairwise((first + track.offsets).tolist())
        lines += [(np.arange(start, end), True) for start, end in rings]
        first += len(track.vertices[0])
    return _text(np.concatenate(points), lines, GRID)
