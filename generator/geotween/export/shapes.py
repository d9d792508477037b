"""Shapes: the paths of a span, and their places in the drawing."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

from geotween.export.page_grid import GridTrack
from geotween.export.paint import Paint

Kind = Literal["backing", "region", "border", "seam", "ghost"]
DRAWN_IN_ORDER: tuple[Kind, ...] = ("backing", "region", "border", "seam", "ghost")

# The share of a transition in which the stroke of a seam appears, and in which it goes.
SEAM_FADE = 0.05


@dataclass(frozen=True)
class Group:
    """Paths that share an opacity, at the start and at the end of a span."""

    layer: str
    opacity: tuple[float, float]


@dataclass(frozen=True)
class Slot:
    """The place of a path in the drawing: the same in every span in which it is used."""

    group: Group
    kind: Kind
    key: str
    number: int = 0
    code: int = 0


@dataclass(frozen=True, eq=False)
class Shape:
    """A path in a span: its tracks, and its paint at the span's start and end.

    ``slot.code`` says which seams a path of kind ``seam`` draws. ``show`` limits it to a part of
    the span, in shares of its duration.
    """

    slot: Slot
    tracks: tuple[GridTrack, ...]
    paints: tuple[Paint, Paint]
    show: tuple[float, float] | None = None

    @property
    def still(self) -> bool:
        """Whether nothing moves, comes or goes."""
        return all(track.still and track.life == (0.0, 1.0) for track in self.tracks)

    def parts(self) -> list[tuple[tuple[float, float], tuple[GridTrack, ...]]]:
        """The tracks that are there, since when and until when, after easing; in order of time."""
        moments = sorted({moment for track in self.tracks for moment in track.life})
        found = [
            ((start, end), tuple(t for t in self.tracks if t.life[0] <= start and end <= t.life[1]))
            for start, end in pairwise(moments)
        ]
        return [(life, tracks) for life, tracks in found if tracks]
