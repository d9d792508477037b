"""Backings: paths behind regions of one fill that touch, which close the hairline between them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import shapely

from geotween.export.page_grid import GridTrack
from geotween.export.paint import Paint
from geotween.export.shapes import SEAM_FADE, Group, Shape, Slot
from geotween.motion.rings import next_vertex
from geotween.motion.tracks import SEAM_AT

# Steps of the grid by which two edges on one line may part when their ends are rounded.
ROUNDING = 1.5


@dataclass(eq=False)
class Bundle:
    """The tracks of a span that are one path: one key, one paint and opacity at each end."""

    group: Group
    key: str
    number: int
    paints: tuple[Paint, Paint]
    tracks: list[GridTrack] = field(default_factory=list)

    @property
    def stroked(self) -> bool:
        return any(paint.stroked for paint in self.paints)


def backings(bundles: list[Bundle]) -> list[Shape]:
    """Paths under bundles of one fill that touch without a stroke between them.

    Two paths that abut let the background through in a hairline; a path of both does not. Where
    the fills part on the way, it is there only while they are still, or already, the same.
    """
    contacts: dict[tuple[Group, Paint, Paint, tuple[float, float] | None], set[int]] = {}
    for end in (0, 1):
        for i, j in _contacts(bundles, end):
            one, other = bundles[i], bundles[j]
            fills = [(b.paints[0].fill, b.paints[1].fill) for b in (one, other)]
            if one.group != other.group or fills[0][end] != fills[1][end]:
                continue
            if fills[0][end] == "none":
                continue
            if fills[0] == fills[1]:
                paints = (one.paints[0].filled_only(), one.paints[1].filled_only())
                show = None
            else:
                paint = one.paints[end].filled_only()
                paints = (paint, paint)
                show = (1 - SEAM_FADE, 1.0) if end else (0.0, SEAM_FADE)
            contacts.setdefault((one.group, *paints, show), set()).update((i, j))
    shapes = []
    for number, ((group, start, end_paint, show), touching) in enumerate(contacts.items()):
        tracks = tuple(track for i in sorted(touching) for track in bundles[i].tracks)
        slot = Slot(group, "backing", "", number)
        shapes.append(Shape(slot, tracks, (start, end_paint), show))
    return shapes


def _contacts(bundles: list[Bundle], end: int) -> list[tuple[int, int]]:
    """Pairs of bundles that run along each other at one end of the span, with no stroke there.

    Edges meet where they lie on one line, but for the rounding, and overlap by more than that.
    """
    if len(bundles) < 2:
        return []
    starts, stops, owners = [], [], []
    for number, bundle in enumerate(bundles):
        for track in bundle.tracks:
            points = track.vertices[-end]  # the last key time at the end, the first at the start
            following = points[next_vertex(track.offsets)]
            bare = (points != following).any(axis=1)
            if bundle.paints[end].stroked:
                bare &= (track.seams & SEAM_AT[end]) > 0
            starts.append(points[bare])
            stops.append(following[bare])
            owners.append(np.full(int(bare.sum()), number))
    start, stop, owner = np.concatenate(starts), np.concatenate(stops), np.concatenate(owners)
    lines: Any = shapely.linestrings(np.stack([start, stop], axis=1).astype(float))
    one, other = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=ROUNDING)
    apart = owner[one] < owner[other]
    one, other = one[apart], other[apart]
    way = (stop - start)[one].astype(float)
    length = np.hypot(*way.T)
    way /= length[:, None]
    ends = np.stack([start[other] - start[one], stop[other] - start[one]], axis=1)
    along = np.sort((ends * way[:, None]).sum(axis=2), axis=1)
    aside = np.abs(ends[..., 0] * way[:, None, 1] - ends[..., 1] * way[:, None, 0]).max(axis=1)
    overlap = np.minimum(along[:, 1], length) - np.maximum(along[:, 0], 0)
    # The farther end of a longer edge may lie off by more, as the rounding turns its line.
    reach = np.maximum(1, (along[:, 1] - along[:, 0]) / length)
    touching = (aside <= ROUNDING * reach) & (overlap > 2 * ROUNDING)
    pairs = np.unique(np.column_stack([owner[one], owner[other]])[touching], axis=0)
    return [(int(i), int(j)) for i, j in pairs]
