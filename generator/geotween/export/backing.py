"""Backings: paths behind regions of one fill that touch, which close the hairline between them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

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
    def fills(self) -> tuple[str, str]:
        return self.paints[0].fill, self.paints[1].fill

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
            if one.group != other.group or one.fills[end] != other.fills[end]:
                continue
            if one.fills[end] == "none":
                continue
            if one.fills == other.fills:
                paints = (one.paints[0].filled_only(), one.paints[1].filled_only())
                show = None
            else:
                paint = one.paints[end].filled_only()
                paints = (paint, paint)
                show = (1 - SEAM_FADE, 1.0) if end else (0.0, SEAM_FADE)
            contacts.setdefault((one.group, *paints, show), set()).update((i, j))
    for i, j in _contacts_between(bundles):
        paints = (bundles[i].paints[0].filled_only(), bundles[i].paints[1].filled_only())
        contacts.setdefault((bundles[i].group, *paints, None), set()).update((i, j))
    shapes = []
    for number, ((group, start, end_paint, show), touching) in enumerate(contacts.items()):
        tracks = tuple(track for i in sorted(touching) for track in bundles[i].tracks)
        slot = Slot(group, "backing", "", number)
        shapes.append(Shape(slot, tracks, (start, end_paint), show))
    return shapes


def _contacts_between(bundles: list[Bundle]) -> list[tuple[int, int]]:
    """Pairs of bundles of one group and fill, without a stroke, that a border of a film parts.

    At any time: what moves on one line, or between the same vertices, is one border.
    """
    bare = [i for i, b in enumerate(bundles) if not b.stroked and set(b.fills) != {"none"}]
    tracks = [(i, track) for i in bare for track in bundles[i].tracks if track.film is not None]
    films = {track.film: k for k, (_, track) in enumerate(tracks)}
    rows = [np.empty((0, 4), dtype=np.int64)]
    for i, track in tracks:
        borders = _borders(track)
        film = np.full(len(borders), films[track.film])
        rows.append(np.column_stack([borders, film, np.full(len(borders), i)]))
    every = np.unique(np.concatenate(rows), axis=0)
    pairs: set[tuple[int, int]] = set()
    for step in range(1, len(every)):
        same = (every[step:, :-1] == every[:-step, :-1]).all(axis=1)
        if not same.any():
            break
        both = np.column_stack([every[:-step, -1], every[step:, -1]])[same]
        pairs.update((i, j) for i, j in both.tolist())
    return [
        (i, j)
        for i, j in sorted(pairs)
        if bundles[i].group == bundles[j].group and bundles[i].fills == bundles[j].fills
    ]


def _borders(track: GridTrack) -> NDArray[np.int64]:
    """For each edge (n, 2) of a film's track what it has in common with the edge beside it.

    The ends of the line that it lies on throughout, else its vertices, as numbers less than 0.
    """
    assert track.film is not None
    assert track.nodes is not None
    nodes = np.stack([track.nodes, track.nodes[next_vertex(track.offsets)]]).astype(np.int64)
    ends = track.film.lines[:, nodes]
    still = ends[0] == ends[1]
    line = np.where(still[0], ends[:, 1], ends[:, 0])
    along = (ends == line[:, None]).all(axis=0)
    along |= still & (ends[:1] == line[:, None]).any(axis=0)
    resting = still.all(axis=0)
    line = np.where(resting, np.sort(ends[0], axis=0), line)
    return np.where(resting | along.all(axis=0), line, -1 - np.sort(nodes, axis=0)).T


def _contacts(bundles: list[Bundle], end: int) -> list[tuple[int, int]]:
    """Pairs of bundles that run along each other at one end of the span, with no stroke there.

    Edges meet where they lie on one line, but for the rounding, and overlap by more than that.
    """
    if len(bundles) < 2:
        return []
    starts, stops = ([np.empty((0, 2), dtype=np.int64)] for _ in range(2))
    owners = [np.empty(0, dtype=np.intp)]
    for number, bundle in enumerate(bundles):
        for track in bundle.tracks:
            if track.life[end] != end:
                continue
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
