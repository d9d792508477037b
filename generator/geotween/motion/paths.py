"""Paths: the ways on which matched vertices travel from end to end.

``straight``   each vertex for itself, as in the paper
``rigid``      a piece turns as a whole; what else changes is straight in the turning frame
``intrinsic``  edges change their lengths and directions, and vertices follow: a spiral unrolls

Pieces that touch each other at an end would part if each turned for itself. They turn as one.
Nothing turns of which an edge stays where it is: common boundary does not move.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.polygons import RELATIVE_TOLERANCE
from geotween.motion.groups import connected
from geotween.motion.intrinsic import intrinsic
from geotween.motion.rigid import Ends, Floats, best_turn
from geotween.motion.rings import MatchedPiece, Offsets, next_vertex

Numbers = NDArray[np.intp]

# A path is laid through at most so many straight lines. Half a turn of a shape that fills a page of
# 1,000 pixels needs 35 to stay within half a pixel.
MOST_STEPS = 64

TOUCHING = "it touches others, and they turn as one"
OPEN = "its outline does not close on the way"


@dataclass(frozen=True, eq=False)
class Path:
    """The way of a piece: ``places`` (K, n, 2) at key times (K,), straight in between.

    ``gave_way`` says why another technique than the one asked for was taken; mostly empty.
    """

    times: Floats
    places: Floats
    gave_way: str = ""


Group = Sequence[MatchedPiece]
Technique = Callable[[Group, float], list[Path]]


def travel(vertices: Ends, offsets: Offsets, technique: str, tolerance: float) -> Path:
    """The way of one piece on its own; see ``travel_all``."""
    piece = MatchedPiece(vertices, offsets, np.zeros(vertices.shape[1], dtype=np.uint8))
    return TECHNIQUES[technique]([piece], tolerance)[0]


def travel_all(
    pieces: Sequence[MatchedPiece], groups: Numbers, technique: str, tolerance: float
) -> list[Path]:
    """The ways of matched pieces.

    Parameters
    ----------
    pieces
        Matched vertices, the outer ring counter-clockwise and first, holes clockwise.
    groups
        The group (m,) of each piece; those of a group move as one (see ``touching``).
    technique
        ``straight``, ``rigid`` or ``intrinsic``. The last is for pieces that touch no other and
        whose outline closes at every moment; else it gives way to ``rigid``.
    tolerance
        How far straight lines between key times may be from the path, in the data's units. What
        needs more than MOST_STEPS of them gets so many, and is farther off.

    Returns
    -------
    A path for each piece. Both ends are exact. Vertices that are equal at both ends and of one
    group are equal to the bit throughout. The way back is the same to some 1e-15 of the extent,
    but for half a turn: that is counter-clockwise both ways.
    """
    found: dict[int, Path] = {}
    order = np.argsort(groups, kind="stable")
    for members in np.split(order, np.flatnonzero(np.diff(groups[order])) + 1):
        paths = TECHNIQUES[technique]([pieces[k] for k in members], tolerance)
        found.update(zip(members.tolist(), paths, strict=True))
    return [found[k] for k in range(len(pieces))]


def touching(pieces: Sequence[MatchedPiece], tolerance: float) -> Numbers:
    """The groups (m,) of pieces whose borders touch at either end, one with the next.

    ``tolerance`` is in the data's units. A piece that is a point at an end has no border there.
    Cost: n log n for n vertices.
    """
    if not pieces:
        return np.empty(0, dtype=np.intp)
    pairs = [np.empty((2, 0), dtype=np.intp)]
    for end in (0, 1):
        rings, owner = _borders(pieces, end)
        one, other = shapely.STRtree(rings).query(rings, "dwithin", distance=tolerance)
        pairs.append(np.stack([owner[one], owner[other]]))
    return connected(np.concatenate(pairs, axis=1).T, len(pieces))


def _straight(group: Group, tolerance: float) -> list[Path]:
    return [Path(np.array([0.0, 1.0]), piece.vertices) for piece in group]


def _rigid(group: Group, tolerance: float) -> list[Path]:
    outlines = [_outline(piece) for piece in group if _lasts(piece)]
    turn = None if not outlines or any(map(_rests, group)) else best_turn(outlines)
    if turn is None:
        return _straight(group, tolerance)
    steps = max(turn.steps(piece.vertices, tolerance) for piece in group)
    times = np.linspace(0, 1, int(np.clip(np.ceil(steps), 1, MOST_STEPS)) + 1)
    return [Path(times, turn.at(piece.vertices, times)) for piece in group]


def _intrinsic(group: Group, tolerance: float) -> list[Path]:
    if any(map(_rests, group)) or not any(map(_lasts, group)):
        return _straight(group, tolerance)
    times = np.linspace(0, 1, MOST_STEPS + 1)
    piece = group[0]
    alone = len(group) == 1 and not _rings_touch(piece)
    places = intrinsic(piece.vertices, piece.offsets, times) if alone else None
    if places is None:
        why = OPEN if alone else TOUCHING
        return [Path(path.times, path.places, why) for path in _rigid(group, tolerance)]
    kept = _key_times(times, places, 0, MOST_STEPS, tolerance)
    return [Path(times[kept], places[kept])]


TECHNIQUES: Mapping[str, Technique] = {
    "straight": _straight,
    "rigid": _rigid,
    "intrinsic": _intrinsic,
}


def _key_times(times: Floats, places: Floats, first: int, last: int, tolerance: float) -> list[int]:
    """The moments to keep of many: an interval is halved until straight lines are near enough."""
    inner = slice(first + 1, last)
    share = ((times[inner] - times[first]) / (times[last] - times[first]))[:, None, None]
    off = places[inner] - (1 - share) * places[first] - share * places[last]
    if np.hypot(off[..., 0], off[..., 1]).max(initial=0) <= tolerance:
        return [first, last]
    middle = (first + last) // 2
    before = _key_times(times, places, first, middle, tolerance)
    return before[:-1] + _key_times(times, places, middle, last, tolerance)


def _outline(piece: MatchedPiece) -> tuple[Ends, Offsets]:
    count = piece.offsets[1]
    return piece.vertices[:, :count], piece.offsets[:2]


def _lasts(piece: MatchedPiece) -> bool:
    """Whether a piece is more than a point at both ends."""
    return bool(np.ptp(piece.vertices, axis=1).any(axis=1).all())


def _rests(piece: MatchedPiece) -> bool:
    """Whether an edge of a piece stays where it is."""
    least = RELATIVE_TOLERANCE * float(np.ptp(piece.vertices, axis=(0, 1)).max())
    stays = (np.abs(piece.vertices[1] - piece.vertices[0]) <= least).all(axis=1)
    following = next_vertex(piece.offsets)
    ways = np.abs(piece.vertices[0, following] - piece.vertices[0]).max(axis=1)
    return bool((stays & stays[following] & (ways > least)).any())


def _rings_touch(piece: MatchedPiece) -> bool:
    """Whether rings of a piece have a vertex in common at an end."""
    if len(piece.offsets) < 3:
        return False
    ring = np.repeat(np.arange(len(piece.offsets) - 1), np.diff(piece.offsets))
    for places in piece.vertices:
        rows = np.unique(np.column_stack([places, ring]), axis=0)
        if len(np.unique(rows[:, :2], axis=0)) < len(rows):
            return True
    return False


def _borders(pieces: Sequence[MatchedPiece], end: int) -> tuple[NDArray[np.object_], Numbers]:
    """The rings of pieces at an end that are more than a point, and the piece of each."""
    counts = [np.diff(piece.offsets) for piece in pieces]
    owner = np.repeat(np.arange(len(pieces)), [len(rings) for rings in counts])
    places = np.concatenate([piece.vertices[end] for piece in pieces])
    ring = np.repeat(np.arange(len(owner)), np.concatenate(counts))
    starts = np.flatnonzero(np.diff(ring, prepend=-1))
    spread = np.maximum.reduceat(places, starts) - np.minimum.reduceat(places, starts)
    there = np.asarray(spread.any(axis=1))
    kept = there[ring]
    number = np.cumsum(there) - 1
    rings: Any = shapely.linearrings(places[kept], indices=number[ring[kept]])
    return rings, owner[there]
