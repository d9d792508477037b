"""Path data: tracks on the grid as the text of a ``d`` attribute."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from geotween.export.page_grid import GRID, GridTrack
from geotween.export.shapes import Shape
from geotween.motion.rings import Offsets, next_vertex

_PER_PIXEL = round(1 / GRID)


def path_texts(shape: Shape) -> list[tuple[float, str]]:
    """The path at each key time of a shape; one entry if it is still.

    All of a shape's texts have the same sequence of commands, as SMIL demands.
    """
    times = sorted({t for track in shape.tracks for t in track.times} | {0.0})
    lines = [(track, list(_lines(shape, track))) for track in shape.tracks]
    return [(t, "".join(_track_text(_at(track, t), of_track) for track, of_track in lines))
            for t in times]  # fmt: skip


def _track_text(points: NDArray[np.int64], lines: list[tuple[NDArray[np.intp], bool]]) -> str:
    return "".join(_text(points[line], closed) for line, closed in lines)


def _at(track: GridTrack, t: float) -> NDArray[np.int64]:
    """Grid positions at a key time of any track of the shape."""
    if track.still:
        return np.asarray(track.vertices[0])
    if t in track.times:
        return np.asarray(track.vertices[track.times.index(t)])
    flat = track.vertices.reshape(len(track.times), -1)
    values = [np.interp(t, track.times, column) for column in flat.T]
    return np.rint(np.reshape(values, (-1, 2))).astype(np.int64)


def _lines(shape: Shape, track: GridTrack) -> Iterator[tuple[NDArray[np.intp], bool]]:
    """The vertex numbers of each line that a shape draws of a track, and whether it closes."""
    if shape.slot.kind == "border":
        yield from runs(track.seams == 0, track.offsets)
    elif shape.slot.kind == "seam":
        yield from runs(track.seams == shape.slot.code, track.offsets)
    else:
        for start, end in zip(track.offsets[:-1], track.offsets[1:], strict=True):
            yield np.arange(start, end), True


def runs(chosen: NDArray[np.bool_], offsets: Offsets) -> Iterator[tuple[NDArray[np.intp], bool]]:
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


def _text(points: NDArray[np.int64], closed: bool) -> str:
    steps = np.diff(points, axis=0)
    return f"M{_numbers(points[0])}l{_numbers(steps.ravel())}{'z' if closed else ''}"


def _numbers(values: Iterable[int]) -> str:
    """Grid steps as pixels; a minus sign separates, so that no space is needed before it."""
    joined = " ".join(_number(int(v)) for v in values)
    return joined.replace(" -", "-")


@lru_cache(maxsize=65536)
def _number(value: int) -> str:
    text = f"{value / _PER_PIXEL:.1f}".removesuffix(".0")
    return text.replace("0.", ".", 1) if text.startswith(("0.", "-0.")) else text


def closed_path(tracks: Iterable[GridTrack]) -> str:
    """All rings of tracks that rest, as one path."""
    return "".join(
        _text(track.vertices[0, start:end], True)
        for track in tracks
        for start, end in zip(track.offsets[:-1], track.offsets[1:], strict=True)
    )
