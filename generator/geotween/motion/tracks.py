"""Tracks: regions that move, as arrays; and frames: the regions at one moment."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import Polygon

from geotween.data.polygons import Identity, Key
from geotween.motion.rings import Offsets, Vertices, to_polygons

SEAM_AT_ORIGIN, SEAM_AT_TARGET = 1, 2
SEAM_AT = (SEAM_AT_ORIGIN, SEAM_AT_TARGET)  # by the end of the transition, 0 or 1


@dataclass(frozen=True, eq=False)
class Track:
    """One moving region.

    ``times`` (K,) rise from 0 to 1, after easing; ``vertices`` (K, n, 2), in the data's units,
    move on straight lines in between. ``offsets`` (r + 1,) part them into rings, the outer one
    first. ``seams`` (n,) has SEAM_AT_ORIGIN and SEAM_AT_TARGET set where the edge from a vertex
    to the next is a seam at that end. ``ends`` are the identities at both ends, the same one
    twice for a birth or a death.
    """

    identity: Identity
    ends: tuple[Identity, Identity]
    layer: str
    times: NDArray[np.float64]
    vertices: NDArray[np.float64]
    offsets: Offsets
    seams: NDArray[np.uint8]

    @property
    def key(self) -> Key:
        return self.identity.key

    @property
    def class_(self) -> str | None:
        return self.identity.class_

    def at(self, t: float) -> Vertices:
        """The vertices (n, 2) at t in [0, 1]; exact at key times."""
        after = int(np.clip(np.searchsorted(self.times, t), 1, len(self.times) - 1))
        start, end = self.times[after - 1 : after + 1]
        share = (t - start) / (end - start)
        moved = self.vertices[after - 1] * (1 - share) + self.vertices[after] * share
        return np.asarray(moved)


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
    if not 0 <= t <= 1:
        raise ValueError(f"t runs from 0 to 1, not {t}")
    if not tracks:
        return Frame([], [], [])
    vertices = np.concatenate([track.at(t) for track in tracks])
    lengths = np.concatenate([np.diff(track.offsets) for track in tracks])
    offsets = np.concatenate([[0], np.cumsum(lengths)])
    owner = np.repeat(np.arange(len(tracks)), [len(track.offsets) - 1 for track in tracks])
    drawn = [
        (polygon, track)
        for polygon, track in zip(to_polygons(vertices, offsets, owner), tracks, strict=True)
        if polygon is not None
    ]
    return Frame(
        [polygon for polygon, _ in drawn],
        [track.key for _, track in drawn],
        [track.layer for _, track in drawn],
    )
