"""How rough seams are: their turning, beside the least that any seam of the same ends has."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from geotween.motion.divide.faces import Faces, Piece

Floats = NDArray[np.float64]
Lines = NDArray[np.object_]

# Places within this share of the extent beyond a region are in it: ends lie on its outline.
TOLERANCE = 1e-6

# Seams turn as they are drawn: what lies within half a pixel of a thousand is not seen.
DRAWN = 1 / 2000


@dataclass(frozen=True)
class Turning:
    """The turning of some seams together, and the least possible, in full turns.

    ``turns`` is what is seen, ``every`` all of it.
    """

    seams: int
    turns: float
    least: float
    every: float

    def __add__(self, other: Turning) -> Turning:
        return Turning(
            self.seams + other.seams,
            self.turns + other.turns,
            self.least + other.least,
            self.every + other.every,
        )

    @property
    def over(self) -> float:
        """What each seam turns beyond the least, on average, in degrees."""
        return 360 * (self.turns - self.least) / self.seams if self.seams else 0.0


def seams_of(pieces: Sequence[Piece]) -> Lines:
    """The seams of a partition, lines that end where three pieces or more meet, or at the rim."""
    parts = shapely.get_parts(np.array(list(pieces), dtype=object))
    edges: Any = shapely.linestrings(Faces(parts).seams.ends)
    if not len(edges):
        return np.empty(0, dtype=object)
    return shapely.get_parts(shapely.line_merge(shapely.multilinestrings(edges)))


def turning(line: BaseGeometry) -> float:
    """The sum of the angles, whichever way, by which a line turns; in full turns."""
    places = shapely.get_coordinates(line)
    steps = np.diff(places, axis=0)
    steps = steps[np.hypot(*steps.T) > 0]
    if (places[0] == places[-1]).all():
        steps = np.vstack([steps, steps[:1]])
    way = steps[:, 0] + 1j * steps[:, 1]
    return float(np.abs(np.angle(way[1:] * way[:-1].conj())).sum() / (2 * np.pi))


def compared(polygon: Polygon, pieces: Sequence[Piece]) -> Turning:
    """The turning of a division's seams; the least is that of the shortest way in the polygon.

    A shortest way turns only where the rim makes it turn. The ends of a seam are given; of one
    without ends the least is a full turn. Cost: k² for k corners at which a way may turn.
    """
    lines = seams_of(pieces)
    extent = float(np.ptp(np.array(polygon.bounds).reshape(2, 2), axis=0).max())
    ends = np.array([shapely.get_coordinates(line)[[0, -1]] for line in lines]).reshape(-1, 2, 2)
    rings = (ends[:, 0] == ends[:, 1]).all(axis=1)
    least = np.where(rings, 1.0, _ways(polygon, ends))
    drawn = shapely.simplify(lines, DRAWN * extent)
    turns, every = (sum(map(turning, some)) for some in (drawn, lines))
    return Turning(len(lines), turns, float(least.sum()), every)


def _ways(region: Polygon, ends: Floats) -> Floats:
    """The turning of the shortest ways (m,) in a region between pairs of places (m, 2, 2)."""
    from scipy.sparse.csgraph import dijkstra

    extent = float(np.ptp(np.array(region.bounds).reshape(2, 2), axis=0).max())
    places = np.vstack([ends.reshape(-1, 2), _corners(region)])
    room = shapely.buffer(region, TOLERANCE * extent, join_style="mitre")
    shapely.prepare(room)
    one, other = np.triu_indices(len(places), 1)
    lines: Any = shapely.linestrings(np.stack([places[one], places[other]], axis=1))
    seen = shapely.covers(room, lines)
    graph = np.zeros((len(places),) * 2)
    graph[one[seen], other[seen]] = np.hypot(*(places[one[seen]] - places[other[seen]]).T)
    _, before = dijkstra(
        graph, directed=False, indices=np.arange(0, 2 * len(ends), 2), return_predecessors=True
    )
    found = []
    for k, row in enumerate(before):
        way = [2 * k + 1]
        while row[way[-1]] >= 0:
            way.append(row[way[-1]])
        found.append(turning(LineString(places[way])) if len(way) > 2 else 0.0)
    return np.array(found)


def _corners(region: BaseGeometry) -> Floats:
    """Where a shortest way may turn: the corners (k, 2) that point into a region."""
    found = []
    for ring in shapely.get_rings(shapely.orient_polygons(region)):
        places = shapely.get_coordinates(ring)[:-1]
        way = places - np.roll(places, 1, axis=0)
        after = np.roll(way, -1, axis=0)
        found.append(places[way[:, 0] * after[:, 1] < way[:, 1] * after[:, 0]])
    return np.concatenate(found) if found else np.empty((0, 2))
