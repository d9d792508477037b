"""Five ways to divide a polygon, side by side: the product's four, and one that was rejected."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields
from unittest.mock import patch

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPoint, Polygon

import geotween
from docs.draw.experiments.seams import Turning, compared
from docs.draw.experiments.shapes import Transition
from geotween.motion import divide
from geotween.motion.divide.faces import Piece
from geotween.motion.divide.partition import Mend, partition
from geotween.motion.measure import measure
from geotween.motion.morph import Morph

Floats = NDArray[np.float64]

TERRITORY, VORONOI, CENTROIDS = "territory", "voronoi", "centroid seeds"
MESHED = ("advancing-front", "quadtree")
NAMES = (TERRITORY, VORONOI, *MESHED, CENTROIDS)
FRAMES = 41  # that motions are measured in

# Seams thinned so far, as a share of the extent: 4 px of 1000, to see what their vertices do.
THIN = 4e-3


@dataclass(frozen=True)
class Figures:
    """What is told of a division and of the motion that follows from it; 0 is best.

    ``given_away`` is the share of what a polygon and its correspondent have in common that is
    not in the pieces of both; ``lost``, ``overlap``, ``invalid`` and ``area`` are measured in
    frames; ``roughness`` is in degrees for each seam, as drawn; ``proved`` is 1 or 0.
    """

    overlap: float
    given_away: float
    lost: float
    roughness: float
    invalid: float
    area: float
    proved: float


LOSSES = ("overlap", "given_away", "lost", "roughness")  # in which territory is to be ahead


def centroid_seeds(
    polygon: Polygon, correspondents: Sequence[Piece], connected: bool = True
) -> tuple[list[Piece], list[Mend]]:
    """Voronoi cells of the correspondents' centroids, which the paper tried and rejected."""
    aims = np.asarray(shapely.centroid(list(correspondents)), dtype=object)
    seeds = shapely.get_coordinates(aims)

    def nearest(places: Floats) -> NDArray[np.intp]:
        return np.asarray(((places[:, None] - seeds[None]) ** 2).sum(axis=2).argmin(axis=1))

    around = shapely.box(*shapely.total_bounds([polygon, *aims])).buffer(polygon.length)
    edges = shapely.voronoi_polygons(MultiPoint(seeds), extend_to=around, only_edges=True)
    return partition(polygon, shapely.get_parts(edges), nearest, list(aims), connected)


def thinned(
    polygon: Polygon, correspondents: Sequence[Polygon], connected: bool = True
) -> tuple[list[Piece], list[Mend]]:
    """Territory, its seams with fewer vertices; to find the cause of a loss."""
    pieces, mends = divide.TECHNIQUES[TERRITORY](polygon, correspondents)
    extent = max(polygon.bounds[2] - polygon.bounds[0], polygon.bounds[3] - polygon.bounds[1])
    found = shapely.coverage_simplify(pieces, THIN * extent, simplify_boundary=False)
    return list(shapely.orient_polygons(found)), mends


THINNED = "territory, thinned"
OWN: Mapping[str, divide.Technique] = {CENTROIDS: centroid_seeds, THINNED: thinned}


@contextmanager
def own_divisions() -> Iterator[None]:
    """While it lasts, ``OWN`` are divisions as the product's are."""
    with patch.dict(divide.TECHNIQUES, OWN):
        yield


def technique(name: str) -> Callable[[Polygon, Sequence[Polygon]], list[Piece]]:
    """A division by name, as a function of a polygon and its correspondents."""
    own = OWN.get(name)
    if own:
        return lambda polygon, correspondents: own(polygon, correspondents)[0]
    return lambda polygon, correspondents: geotween.divide(polygon, correspondents, name)


def moved(transition: Transition, division: str, matching: str) -> Morph:
    """A morph by a division and a matching, with nothing else tried."""
    with own_divisions():
        return geotween.morph(*transition, "morph", division=division, matching=matching)


def figures(motion: Morph) -> Figures:
    """The figures of a motion of one layer."""
    division = motion.layers[0].division
    seen = measure(motion.tracks, division.origin, division.target, FRAMES)
    return Figures(
        seen.overlap,
        given_away(division),
        seen.lost,
        seams(division).over,
        seen.invalid_time,
        seen.area_mean,
        float(motion.certificate.valid),
    )


def given_away(division: divide.Division) -> float:
    """The share of what corresponding polygons have in common that their pieces have not."""
    paired = (division.indices >= 0).all(axis=1)
    one, other = division.indices[paired].T
    common = shapely.intersection(division.origin.polygons[one], division.target.polygons[other])
    pieces = division.origin_pieces[paired], division.target_pieces[paired]
    kept = shapely.intersection(shapely.intersection(common, pieces[0]), pieces[1])
    whole = float(shapely.area(common).sum())
    return max(0.0, 1 - float(shapely.area(kept).sum()) / whole) if whole else 0.0


def seams(division: divide.Division) -> Turning:
    """The turning of all seams of both ends, as they are drawn."""
    found = Turning(0, 0.0, 0.0, 0.0)
    sides = (
        (division.origin.polygons, division.origin_pieces, division.indices[:, 0]),
        (division.target.polygons, division.target_pieces, division.indices[:, 1]),
    )
    for polygons, pieces, owner in sides:
        for number in np.flatnonzero(np.bincount(owner[owner >= 0]) > 1):
            found += compared(polygons[number], list(pieces[owner == number]))
    return found


def mean(found: Sequence[Figures]) -> Figures:
    """The mean of each figure."""
    return Figures(
        *(float(np.mean([getattr(f, one.name) for f in found])) for one in fields(Figures))
    )
