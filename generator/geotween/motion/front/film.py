"""The film: from arrivals to tracks, each for as long as the rings of its polygon stay the same."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from geotween.motion.front.pieces import Flags, Nodes, outlines
from geotween.motion.front.plane import Floats, Ints, Thing
from geotween.motion.front.walk import Bounds, bounds_of, offsets_of, ranges
from geotween.motion.rings import next_vertex
from geotween.motion.tracks import Film, Track

if TYPE_CHECKING:
    from geotween.motion.front.levels import Arrivals


# Rings smaller than this, as a share of the largest, may be the wrong way round by rounding.
SLIVER = 1e-12


def tracks_of(arrivals: Arrivals, things: tuple[Thing, ...], layer: str) -> tuple[Track, ...]:
    """The tracks of some things whose areas change place by place.

    Parameters
    ----------
    arrivals
        Which thing is where, and when each place goes over to another one.
    things
        What ``arrivals`` names by number.
    layer
        The layer of the tracks.

    Returns
    -------
    Tracks in the order of their things. At each moment those of one thing are disjoint polygons
    that cover where it is then, those of all things the whole, but for the rounding of vertices.
    What never changes is one track over [0, 1], with its own vertices. A vertex that two tracks
    share, beside or after each other, has one number in their ``film``.

    Raises
    ------
    ArithmeticError
        Where the arrivals do not fit together.

    Notes
    -----
    Cost: n log n for n triangles and edges, and linear in the vertices of all tracks.
    """
    if not len(arrivals.edges):
        return ()
    nodes, pieces = outlines(arrivals, things)
    bounds = bounds_of(nodes, pieces)
    if not len(bounds.thing):
        return ()
    used, number = np.unique(bounds.node, return_inverse=True)
    bounds = replace(bounds, node=number.reshape(-1))
    return _tracks(nodes.only(used), bounds, things, layer)


def _tracks(
    nodes: Nodes, bounds: Bounds, things: tuple[Thing, ...], layer: str
) -> tuple[Track, ...]:
    film = Film(nodes.lives)
    parts = _parts(nodes, bounds)
    corner = ranges(bounds.offsets[parts.rings], bounds.offsets[parts.rings + 1])
    node, seam = bounds.node[corner], bounds.seam[corner]
    rings = offsets_of(np.diff(bounds.offsets)[parts.rings])
    ends = rings[parts.offsets]
    moments = [moment.repeat(np.diff(ends)) for moment in (parts.since, parts.until)]
    places = np.stack([nodes.at(node, t) for t in moments])
    numbers = node.astype(np.int32)
    times = np.stack([parts.since, parts.until], axis=1)
    named = [(t.origin or t.target, t.target or t.origin) for t in things]
    tracks = []
    for k, (first, last) in enumerate(pairwise(parts.offsets.tolist())):
        one, other = named[parts.thing[k]]
        assert one is not None
        assert other is not None
        mine = slice(rings[first], rings[last])
        offsets = rings[first : last + 1] - rings[first]
        tracks.append(
            Track(
                one, (one, other), layer, times[k], places[:, mine], offsets, seam[mine],
                film, numbers[mine],
            )
        )  # fmt: skip
    return tuple(tracks)


@dataclass(frozen=True, eq=False)
class _Parts:
    """Polygons for a while: part p is ``rings[offsets[p]:offsets[p + 1]]``, the outer one first."""

    thing: Ints
    since: Floats
    until: Floats
    rings: Ints
    offsets: Ints


def _parts(nodes: Nodes, bounds: Bounds) -> _Parts:
    """Each outer ring with its holes, anew whenever a hole comes or goes."""
    middle = (bounds.since + bounds.until) / 2
    areas = _areas(nodes, bounds, np.arange(len(middle)), middle)
    shells, holes = np.flatnonzero(areas > 0), np.flatnonzero(areas <= 0)
    shell, hole, since, until = _held(nodes, bounds, shells, holes)
    if (-areas[np.setdiff1d(holes, hole)] > SLIVER * np.abs(areas).max()).any():
        raise ArithmeticError("a hole of the arrivals is in nothing")
    whose = np.concatenate([shells, shells, shell, shell])
    moments = np.concatenate([bounds.since[shells], bounds.until[shells], since, until])
    cells = np.unique(np.stack([whose, moments]), axis=1, return_inverse=True)
    (of, moments), place = cells[0], cells[1].reshape(-1)
    low, high = place[2 * len(shells) :].reshape(2, -1)
    there = np.flatnonzero(of[1:] == of[:-1])
    of = of.astype(np.intp)
    rings = np.concatenate([of[there], np.repeat(hole, high - low)])
    cell = np.concatenate([there, ranges(low, high)])
    order = np.lexsort((rings, np.arange(len(rings)) >= len(there), cell))
    offsets = np.append(np.searchsorted(cell[order], there), len(cell))
    return _Parts(
        bounds.thing[of[there]], moments[there], moments[there + 1], rings[order], offsets
    )


def _held(
    nodes: Nodes, bounds: Bounds, shells: Ints, holes: Ints
) -> tuple[Ints, Ints, Floats, Floats]:
    """Which outer ring holds which hole, since when and until when, all (k,)."""
    shell, hole = _near(nodes, bounds, shells, holes)
    since = np.maximum(bounds.since[hole], bounds.since[shell])
    until = np.minimum(bounds.until[hole], bounds.until[shell])
    inside = _inside(nodes, bounds, shell, hole, (since + until) / 2)
    shell, hole, since, until = (column[inside] for column in (shell, hole, since, until))
    # On an island in a lake of the same thing both outer rings hold it: the inner one counts.
    every = np.stack([np.tile(hole, 2), np.concatenate([since, until])])
    moments, place = np.unique(every, axis=1, return_inverse=True)
    low, high = place.reshape(2, -1)
    cell, pair = ranges(low, high), np.repeat(np.arange(len(low)), high - low)
    middle = (moments[1, cell] + moments[1, cell + 1]) / 2 if len(cell) else np.empty(0)
    several = np.flatnonzero(np.bincount(cell)[cell] > 1)
    area = np.zeros(len(cell))
    area[several] = _areas(nodes, bounds, shell[pair[several]], middle[several])
    order = np.lexsort((area, cell))
    first = order[np.append(True, np.diff(cell[order]) > 0)[: len(order)]]
    cell, pair = cell[first], pair[first]
    return shell[pair], hole[pair], moments[1, cell], moments[1, cell + 1]


def _near(nodes: Nodes, bounds: Bounds, shells: Ints, holes: Ints) -> tuple[Ints, Ints]:
    """Pairs of an outer ring and a hole of one thing, at one time, whose ways come near."""
    if not len(holes):
        return holes, holes
    places = nodes.places[:, bounds.node]
    low = np.minimum.reduceat(places.min(axis=0), bounds.offsets[:-1])
    high = np.maximum.reduceat(places.max(axis=0), bounds.offsets[:-1])
    boxes: Any = shapely.box(*low.T, *high.T)
    one, other = shapely.STRtree(boxes[shells]).query(boxes[holes])
    hole, shell = holes[one], shells[other]
    near = bounds.thing[hole] == bounds.thing[shell]
    near &= bounds.since[hole] < bounds.until[shell]
    near &= bounds.since[shell] < bounds.until[hole]
    return shell[near], hole[near]


def _inside(nodes: Nodes, bounds: Bounds, shell: Ints, hole: Ints, t: Floats) -> Flags:
    """Whether the middle of each hole's longest edge lies inside an outer ring, at one t each."""
    wanted, which = np.unique(np.stack([shell, t]), axis=1, return_inverse=True)
    places, offsets = _corners(nodes, bounds, wanted[0].astype(np.intp), wanted[1])
    polygons: Any = shapely.polygons(
        shapely.linearrings(
            places, indices=np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))
        )
    )
    places, offsets = _corners(nodes, bounds, hole, t)
    after = places[next_vertex(offsets)]
    length = np.hypot(*(after - places).T)
    owner = np.repeat(np.arange(len(hole)), np.diff(offsets))
    longest = np.lexsort((-length, owner))[offsets[:-1]]
    x, y = ((places + after) / 2)[longest].T
    return np.asarray(shapely.contains_xy(polygons[which.reshape(-1)], x, y))


def _areas(nodes: Nodes, bounds: Bounds, ring: Ints, t: Floats) -> Floats:
    """The signed areas (k,) of rings, at one moment each."""
    if not len(ring):
        return np.empty(0)
    places, offsets = _corners(nodes, bounds, ring, t)
    x, y = (places - places[offsets[:-1]].repeat(np.diff(offsets), axis=0)).T
    after = next_vertex(offsets)
    return np.asarray(np.add.reduceat(x * y[after] - x[after] * y, offsets[:-1]) / 2)


def _corners(nodes: Nodes, bounds: Bounds, ring: Ints, t: Floats) -> tuple[Floats, Ints]:
    """The corners (n, 2) of rings (k,), at one moment each, and their offsets."""
    low, high = bounds.offsets[ring], bounds.offsets[ring + 1]
    corner = ranges(low, high)
    return nodes.at(bounds.node[corner], t.repeat(high - low)), offsets_of(high - low)
