"""Division: cut polygons until each piece has exactly one partner (Algorithm 1 of the paper).

A meets C and D, B meets D      A becomes Ac | Ad, D becomes Da | Db, so that the
pairs are  Ac-C  Ad-Da  B-Db: the paper's SPL
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon

from geotween.data.polygons import PolygonSet
from geotween.data.problems import Problem
from geotween.motion.correspond import Correspondence
from geotween.motion.divide.faces import Piece, array_of
from geotween.motion.divide.meshed import advancing_front, quadtree
from geotween.motion.divide.partition import Mend
from geotween.motion.divide.territory import territory as by_territory
from geotween.motion.divide.voronoi import voronoi as by_voronoi
from geotween.motion.innermost import innermost

NOBODY = -1  # the index of a partner that does not exist: a birth's origin, a death's target

# A polygon and its correspondents in; one piece for each of them, in their order, out.
Technique = Callable[[Polygon, Sequence[Polygon]], tuple[list[Piece], list[Mend]]]

TECHNIQUES: Mapping[str, Technique] = {
    "territory": by_territory,
    "voronoi": by_voronoi,
    "advancing-front": advancing_front,
    "quadtree": quadtree,
}

_MENDS = {
    "coincident seeds": "two Voronoi seeds coincided; the later took its next-nearest vertex",
    "cell in parts": "parts of a piece went to the neighbour with the longest common seam",
    "empty cell": "nothing was nearest to a correspondent; its piece was cut from a neighbour's",
}


@dataclass(frozen=True, eq=False)
class Division:
    """The SPL: pairs of pieces, one to one.

    ``origin_pieces`` and ``target_pieces`` are object arrays of shape (m,) that hold a Polygon,
    or the Point that a polygon without a partner grows from or shrinks to. ``indices``, (m, 2),
    says of which polygons they are pieces; NOBODY stands for none.
    """

    origin: PolygonSet
    target: PolygonSet
    origin_pieces: NDArray[np.object_]
    target_pieces: NDArray[np.object_]
    indices: NDArray[np.intp]
    problems: tuple[Problem, ...]


def divide(
    correspondence: Correspondence, technique: str = "territory", births: str = "innermost"
) -> Division:
    """Cut every polygon that has several correspondents; pair the pieces.

    Births come after the pairs, deaths after the births. ``births`` is a name of ``BIRTHS``.
    """
    origin, target = correspondence.origin, correspondence.target
    of_origin, of_target = correspondence.of_origin(), correspondence.of_target()
    cut = TECHNIQUES[technique]
    origin_pieces, problems = _cut_all(origin, target, of_origin, cut)
    target_pieces, more = _cut_all(target, origin, of_target, cut)

    # Pieces come sorted by (own index, partner's index); the pairs are sorted by origin, target.
    pairs = correspondence.pairs
    by_target = np.lexsort((pairs[:, 0], pairs[:, 1]))
    paired = np.empty(len(pairs), dtype=object)
    paired[by_target] = target_pieces

    born = np.flatnonzero([not len(partners) for partners in of_target])
    dead = np.flatnonzero([not len(partners) for partners in of_origin])
    point_of = BIRTHS[births]
    return Division(
        origin,
        target,
        np.concatenate([origin_pieces, point_of(target.polygons[born]), origin.polygons[dead]]),
        np.concatenate([paired, target.polygons[born], point_of(origin.polygons[dead])]),
        np.concatenate(
            [
                pairs,
                np.column_stack([np.full(len(born), NOBODY), born]),
                np.column_stack([dead, np.full(len(dead), NOBODY)]),
            ]
        ),
        tuple(problems + more),
    )


def _innermost(polygons: NDArray[np.object_]) -> NDArray[np.object_]:
    return np.asarray(shapely.points(innermost(polygons)), dtype=object)


def _centroids(polygons: NDArray[np.object_]) -> NDArray[np.object_]:
    """The centroids, or the innermost points where those lie outside."""
    points = np.asarray(shapely.centroid(polygons), dtype=object)
    outside = ~np.asarray(shapely.contains(polygons, points), dtype=bool)
    points[outside] = _innermost(polygons[outside])
    return points


# Where polygons without a partner come from and go to, (n,) for (n,).
BIRTHS: Mapping[str, Callable[[NDArray[np.object_]], NDArray[np.object_]]] = {
    "innermost": _innermost,
    "centroid": _centroids,
}


def _cut_all(
    own: PolygonSet, others: PolygonSet, partners: list[NDArray[np.intp]], cut: Technique
) -> tuple[NDArray[np.object_], list[Problem]]:
    """The pieces of all polygons that have partners, in order, and the mends as problems."""
    pieces: list[Piece] = []
    problems: list[Problem] = []
    for polygon, identity, mates in zip(own.polygons, own.identities, partners, strict=True):
        if len(mates) < 2:
            pieces += [polygon] * len(mates)
            continue
        cells, mends = cut(polygon, list(others.polygons[mates]))
        pieces += cells
        for mend in mends:
            piece = f"{identity.called} for {others.identities[mates[mend.cell]].called}"
            problems.append(
                Problem(mend.kind, "note", _MENDS[mend.kind], (), piece, mend.share, "of the area")
            )
    return array_of(pieces), problems
