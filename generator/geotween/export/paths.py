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

# Moving vertices of a film are written in hundredths of a pixel at the moments between the ends of
# their ways: rounded like the ends, they would leave the line that a neighbour has there.
FINE = 0.01


def path_texts(shape: Shape, life: tuple[float, float] = (0.0, 1.0)) -> list[tuple[float, str]]:
    """The path at each key time of a shape whose tracks are there for a time; one if it is still.

    All of a shape's texts have the same sequence of commands, as SMIL demands.
    """
    times = {life[0]}
    if not all(track.still for track in shape.tracks):
        times |= {life[1], *(t for k in shape.tracks if not k.still for t in k.times)}
    unit = GRID if all(track.film is None for track in shape.tracks) else FINE
    lines = [(track, list(_lines(shape, track))) for track in shape.tracks]
    return [
        (t, "".join(_track_text(track, t, of_track, unit) for track, of_track in lines))
        for t in sorted(times)
        if life[0] <= t <= life[1]
    ]


def _track_text(
    track: GridTrack, t: float, lines: list[tuple[NDArray[np.intp], bool]], unit: float
) -> str:
    points = np.rint(track.at(t) * (GRID / unit)).astype(np.int64)
    return "".join(_text(points[line], closed, unit) for line, closed in lines)


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


def _text(points: NDArray[np.int64], closed: bool, unit: float) -> str:
    steps = np.diff(points, axis=0)
    start, way = _numbers(points[0], unit), _numbers(steps.ravel(), unit)
    return f"M{start}l{way}{'z' if closed else ''}"


def _numbers(values: Iterable[int], unit: float) -> str:
    """Steps of a unit as pixels; a minus sign separates, so that no space is needed before it."""
    joined = " ".join(_number(int(v), unit) for v in values)
    return joined.replace(" -", "-")


@lru_cache(maxsize=65536)
def _number(value: int, unit: float) -> str:
    text = f"{value / round(1 / unit):.2f}".rstrip("0").removesuffix(".")
    return text.replace("0.", ".", 1) if text.startswith(("0.", "-0.")) else text


def closed_path(tracks: Iterable[GridTrack]) -> str:
    """All rings of tracks that rest, as one path."""
    return "".join(
        _text(track.vertices[0, start:end], True, GRID)
        for track in tracks
        for start, end in zip(track.offsets[:-1], track.offsets[1:], strict=True)
    )
