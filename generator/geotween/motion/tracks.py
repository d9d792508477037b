"""Tracks: regions that move, as arrays; and frames: the regions at one moment."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon

from geotween.data.polygons import Identity, Key
from geotween.data.tidy.repair import made_valid
from geotween.motion.rings import Offsets, Vertices, to_polygons

SEAM_AT_ORIGIN, SEAM_AT_TARGET = 1, 2
SEAM_AT = (SEAM_AT_ORIGIN, SEAM_AT_TARGET)  # by the end of the transition, 0 or 1


@dataclass(frozen=True, eq=False)
class Film:
    """What some tracks share: vertices that move on a straight line through several of them.

    ``lives`` (2, q) are the times between which each of them does so.
    """

    lives: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Track:
    """One moving region, for the whole of the transition or for a part of it.

    ``times`` (K,) rise, after easing, from 0 or more to 1 or less; ``vertices`` (K, n, 2), in the
    data's units, move on straight lines in between. ``offsets`` (r + 1,) part them into rings, the
    outer one first. ``seams`` (n,) has SEAM_AT_ORIGIN and SEAM_AT_TARGET set where the edge from a
    vertex to the next is a seam at that end. ``ends`` are the identities at both ends, the same one
    twice for a birth or a death. ``nodes`` (n,) are the numbers of the vertices in a ``film``.
    """

    identity: Identity
    ends: tuple[Identity, Identity]
    layer: str
    times: NDArray[np.float64]
    vertices: NDArray[np.float64]
    offsets: Offsets
    seams: NDArray[np.uint8]
    film: Film | None = None
    nodes: NDArray[np.int32] | None = None

    @property
    def key(self) -> Key:
        return self.identity.key

    @property
    def class_(self) -> str | None:
        return self.identity.class_

    @property
    def life(self) -> tuple[float, float]:
        """Since when it is there, and until when."""
        return float(self.times[0]), float(self.times[-1])

    def is_there(self, t: float) -> bool:
        """Whether it is drawn at t: where it gives way to others, they are."""
        start, end = self.life
        return start <= t < end or t == end == 1

    def at(self, t: float) -> Vertices:
        """The vertices (n, 2) at t, a time at which it is there; exact at key times."""
        after = int(np.clip(np.searchsorted(self.times, t), 1, len(self.times) - 1))
        start, end = self.times[after - 1 : after + 1]
        if t == end:
            return np.asarray(self.vertices[after])
        one, other = self.vertices[after - 1 : after + 1]
        return np.asarray(one + (other - one) * ((t - start) / (end - start)))


@dataclass(frozen=True, eq=False)
class Frame:
    """The regions drawn at one moment; the lists are parallel."""

    polygons: list[Polygon]
    keys: list[Key]
    layers: list[str]


def frame(tracks: Sequence[Track], t: float) -> Frame:
    """The regions of some tracks at t in [0, 1], after easing; those without area are left out.

    Raises
    ------
    ValueError
        Where t is outside [0, 1].
    """
    found = drawn(tracks, t)
    return Frame(
        [polygon for polygon, _ in found],
        [track.key for _, track in found],
        [track.layer for _, track in found],
    )


def drawn(tracks: Sequence[Track], t: float) -> list[tuple[Polygon, Track]]:
    """The regions of some tracks at t in [0, 1], as in a frame, each with the track it is of.

    Raises
    ------
    ValueError
        Where t is outside [0, 1].
    """
    if not 0 <= t <= 1:
        raise ValueError(f"t runs from 0 to 1, not {t}")
    tracks = [track for track in tracks if track.is_there(t)]
    if not tracks:
        return []
    vertices = np.concatenate([track.at(t) for track in tracks])
    lengths = np.concatenate([np.diff(track.offsets) for track in tracks])
    offsets = np.concatenate([[0], np.cumsum(lengths)])
    owner = np.repeat(np.arange(len(tracks)), [len(track.offsets) - 1 for track in tracks])
    return [
        (polygon, track)
        for whole, track in zip(to_polygons(vertices, offsets, owner), tracks, strict=True)
        for polygon in _parts(whole, track, t)
    ]


def _parts(polygon: Polygon | None, track: Track, t: float) -> list[Polygon]:
    """A polygon, or none; at a moment when parts of a film touch, those that have area."""
    if polygon is None:
        return []
    if track.film is None or t not in track.life or polygon.is_valid:
        return [polygon]
    parts = shapely.orient_polygons(shapely.get_parts(made_valid(polygon)), exterior_cw=False)
    return [part for part in parts if part.area > 0]
