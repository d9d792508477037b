"""From the data's coordinates to the page's grid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from geotween.data.frame import pixels_per_unit
from geotween.data.polygons import PolygonSet, bounds_of
from geotween.motion.rings import next_vertex, rings_of
from geotween.motion.tracks import Film, Track
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


def packed(places: NDArray[np.int64]) -> NDArray[np.int64]:
    """Places (..., 2) on the grid as one number each."""
    return np.asarray((places[..., 0] << 32) + places[..., 1])


@dataclass(frozen=True, eq=False)
class GridFilm:
    """Moving vertices that tracks share, on the page's grid.

    From ``places[0]`` (q, 2) at ``lives[0]`` (q,) each goes straight to ``places[1]`` at
    ``lives[1]``. Those that rest do so from 0 to 1, and no two are the same.
    """

    places: NDArray[np.int64]
    lives: NDArray[np.float64]

    @cached_property
    def still(self) -> NDArray[np.bool_]:
        """Which vertices (q,) rest."""
        return np.asarray((self.places[0] == self.places[1]).all(axis=1))

    @cached_property
    def lines(self) -> NDArray[np.int64]:
        """Both ends (2, q) of the way of each vertex as one number each, the lesser one first."""
        return np.sort(packed(self.places), axis=0)

    def at(self, nodes: NDArray[np.int32], t: float) -> NDArray[np.float64]:
        """The places (n, 2) of some vertices at t, in steps of GRID and parts of them."""
        start, end = self.lives[:, nodes]
        one, other = self.places[:, nodes]
        return np.asarray(one + (other - one) * ((t - start) / (end - start))[:, None])


@dataclass(frozen=True, eq=False)
class GridTrack:
    """A track on the page's grid: ``vertices`` (K, n, 2) in steps of GRID; K is 1 if it rests.

    It is there for its ``life``, from when on and until when. ``nodes`` (n,) are the numbers of
    its vertices in a ``film``, by which they move then; ``vertices`` is where they are rounded to.
    """

    times: tuple[float, ...]
    vertices: NDArray[np.int64]
    offsets: NDArray[np.intp]
    seams: NDArray[np.uint8]
    life: tuple[float, float] = (0.0, 1.0)
    film: GridFilm | None = None
    nodes: NDArray[np.int32] | None = None

    @property
    def still(self) -> bool:
        return len(self.times) == 1

    def at(self, t: float) -> NDArray[np.float64]:
        """The vertices (n, 2) at t, in steps of GRID; those without a film are rounded to it."""
        places = self.between(t)
        return places if self.film is not None else np.rint(places)

    def between(self, t: float) -> NDArray[np.float64]:
        """The vertices (n, 2) at t, in steps of GRID and parts of them."""
        if self.film is not None and self.nodes is not None:
            return self.film.at(self.nodes, t)
        if self.still:
            return np.asarray(self.vertices[0], dtype=np.float64)
        k = int(np.clip(np.searchsorted(self.times, t, side="right"), 1, len(self.times) - 1))
        before, after = self.times[k - 1 : k + 1]
        share = min(max((t - before) / (after - before), 0.0), 1.0) if after > before else 1.0
        one, other = self.vertices[k - 1], self.vertices[k]
        return np.asarray(one + (other - one) * share, dtype=np.float64)


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


def on_grid(tracks: Sequence[Track], page: Page) -> list[GridTrack]:
    """The tracks of a motion on the page's grid.

    Vertices of one film are rounded where their straight ways begin and end, not where tracks do:
    what touches goes on touching.
    """
    together: dict[Film, list[Track]] = {}
    for track in tracks:
        if track.film is not None:
            together.setdefault(track.film, []).append(track)
    films = {film: _film_on_grid(film, shared, page) for film, shared in together.items()}
    return [
        moving(track, page) if track.film is None else _filmed(track, *films[track.film], page)
        for track in tracks
    ]


def moving(track: Track, page: Page) -> GridTrack:
    """A track with vertices of its own on the page's grid."""
    vertices = page.grid(track.vertices)
    times = tuple(float(t) for t in track.times)
    if (vertices == vertices[:1]).all():
        times, vertices = (0.0,), vertices[:1]
    return _tidy(GridTrack(times, vertices, track.offsets, track.seams, track.life))


def _film_on_grid(
    film: Film, tracks: Sequence[Track], page: Page
) -> tuple[GridFilm, NDArray[np.int32]]:
    """The moving vertices of a film, and for each of the film's its number among them."""
    nodes = np.concatenate([track.nodes for track in tracks if track.nodes is not None])
    counts = [track.vertices.shape[1] for track in tracks]
    ends = []
    for end, way in ((0, -1), (-1, 1)):
        times = np.repeat([track.times[end] for track in tracks], counts)
        order = np.argsort(way * times, kind="stable")  # of those assigned the last one stays
        seen, place = np.zeros(film.lives.shape[1]), np.zeros((film.lives.shape[1], 2))
        seen[nodes[order]] = times[order]
        place[nodes[order]] = np.concatenate([t.vertices[end] for t in tracks])[order]
        ends.append((seen, place))
    (start, one), (stop, other) = ends
    speed = (other - one) / np.where(stop > start, stop - start, 1)[:, None]
    places = np.stack(
        [
            page.grid(one + speed * (film.lives[0] - start)[:, None]),
            page.grid(other + speed * (film.lives[1] - stop)[:, None]),
        ]
    )
    still = (places[0] == places[1]).all(axis=1)
    lives = np.where(still, np.array([[0.0], [1.0]]), film.lives)
    rows = np.concatenate([*places.transpose(0, 2, 1), lives])
    distinct, number = np.unique(rows, axis=1, return_inverse=True)
    found = GridFilm(
        distinct[:4].reshape(2, 2, -1).transpose(0, 2, 1).astype(np.int64), distinct[4:]
    )
    return found, number.reshape(-1).astype(np.int32)


def _filmed(track: Track, film: GridFilm, number: NDArray[np.int32], page: Page) -> GridTrack:
    nodes = number[track.nodes]
    if track.life == (0.0, 1.0) and film.still[nodes].all():
        vertices = film.places[:1, nodes]
        return _tidy(GridTrack((0.0,), vertices, track.offsets, track.seams))
    vertices = np.stack([film.at(nodes, t) for t in track.life])
    rounded = np.rint(vertices).astype(np.int64)
    found = GridTrack(track.life, rounded, track.offsets, track.seams, track.life, film, nodes)
    if film.still[nodes].all():
        found = replace(found, times=track.life[:1], vertices=rounded[:1])
    return _tidy(found)


def _tidy(track: GridTrack) -> GridTrack:
    """Without vertices that the grid cannot tell from the next one, and rings left without area."""
    if not track.vertices.shape[1]:
        return track
    after = next_vertex(track.offsets)
    if track.nodes is None:
        keep = (track.vertices != track.vertices[:, after]).any(axis=(0, 2))
    else:
        keep = track.nodes != track.nodes[after]
    counts = np.add.reduceat(keep, track.offsets[:-1])
    keep &= np.repeat(counts >= 3, np.diff(track.offsets))
    counts = counts[counts >= 3]
    return replace(
        track,
        vertices=track.vertices[:, keep],
        offsets=np.concatenate([[0], np.cumsum(counts)]).astype(np.intp),
        seams=track.seams[keep],
        nodes=None if track.nodes is None else track.nodes[keep],
    )
