"""From the data's coordinates to the page's grid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from geotween.data.frame import pixels_per_unit
from geotween.data.polygons import PolygonSet, bounds_of
from geotween.motion.rings import next_vertex, rings_of
from geotween.motion.tracks import Track
from geotween.scene.model import Map

# Pixels between two places that a path can name. Rounding moves a vertex by 0.071 px at most.
GRID = 0.1


@dataclass(frozen=True, eq=False)
class Page:
    """The map's size in px, and the way there from the data: px = data * scale + shift."""

    width: float
    height: float
    scale: NDArray[np.float64]
    shift: NDArray[np.float64]

    def pixels(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        return points * self.scale + self.shift

    def grid(self, points: NDArray[np.float64]) -> NDArray[np.int64]:
        """Points in whole steps of GRID."""
        return np.rint(self.pixels(points) / GRID).astype(np.int64)


@dataclass(frozen=True, eq=False)
class GridTrack:
    """A track on the page's grid: ``vertices`` (K, n, 2) in steps of GRID; K is 1 if it rests."""

    times: tuple[float, ...]
    vertices: NDArray[np.int64]
    offsets: NDArray[np.intp]
    seams: NDArray[np.uint8]

    @property
    def still(self) -> bool:
        return len(self.times) == 1


def fit_page(frame: Map, sets: Sequence[PolygonSet]) -> Page:
    """The page that holds all sets; the height follows from the data unless it is given."""
    box = bounds_of(sets)
    low, high = box[:2], box[2:]
    size = high - low
    scale = pixels_per_unit(frame, box)
    height = frame.height
    if height is None:
        height = float(np.ceil(size[1] * scale + 2 * frame.padding))
    direction = np.array([1.0, -1.0 if frame.y == "up" else 1.0])
    middle = np.array([frame.width, height]) / 2
    factor = scale * direction
    return Page(frame.width, height, factor, middle - factor * (low + high) / 2)


def resting(polygons: PolygonSet, page: Page) -> list[GridTrack]:
    """A still track for each polygon of a set; one smaller than the grid comes out empty."""
    rings = rings_of(polygons.polygons)
    points = page.grid(rings.vertices)
    tracks = []
    for i in range(len(polygons)):
        first, last = np.searchsorted(rings.polygon_of, [i, i + 1])
        offsets = rings.offsets[first : last + 1]
        vertices = points[None, offsets[0] : offsets[-1]]
        flags = np.zeros(vertices.shape[1], dtype=np.uint8)
        tracks.append(_tidy(GridTrack((0.0,), vertices, offsets - offsets[0], flags)))
    return tracks


def moving(track: Track, page: Page) -> GridTrack:
    """A track of the motion on the page's grid."""
    vertices = page.grid(track.vertices)
    times = tuple(float(t) for t in track.times)
    if (vertices == vertices[:1]).all():
        times, vertices = (0.0,), vertices[:1]
    return _tidy(GridTrack(times, vertices, track.offsets, track.seams))


def _tidy(track: GridTrack) -> GridTrack:
    """Without vertices that the grid cannot tell from the next one, and rings left without area."""
    if not track.vertices.shape[1]:
        return track
    following = track.vertices[:, next_vertex(track.offsets)]
    keep = (track.vertices != following).any(axis=(0, 2))
    counts = np.add.reduceat(keep, track.offsets[:-1])
    keep &= np.repeat(counts >= 3, np.diff(track.offsets))
    counts = counts[counts >= 3]
    return replace(
        track,
        vertices=track.vertices[:, keep],
        offsets=np.concatenate([[0], np.cumsum(counts)]).astype(np.intp),
        seams=track.seams[keep],
    )
