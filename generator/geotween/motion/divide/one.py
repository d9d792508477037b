"""The division of one polygon, as Python code asks for it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from shapely.geometry import MultiPolygon, Polygon

from geotween.motion.divide.faces import Piece
from geotween.motion.divide.meshed import advancing_front, quadtree
from geotween.motion.divide.territory import territory
from geotween.motion.divide.voronoi import voronoi

MESHED = {"advancing-front": advancing_front, "quadtree": quadtree}
Weights = Sequence[float] | str | None
NAMES = ("territory", "voronoi", *MESHED)


def divide(
    polygon: Polygon,
    correspondents: Sequence[Polygon | MultiPolygon],
    technique: str = "territory",
    connected: bool = True,
    *,
    weights: Weights = None,
    smooth: bool = False,
) -> list[Piece]:
    """Cut a polygon into as many pieces as it has correspondents.

    Parameters
    ----------
    polygon
        A valid polygon in planar coordinates; it may have holes.
    correspondents
        Valid polygons in the same coordinates. They may touch, overlap, coincide or lie outside.
    technique
        ``territory``: what a correspondent covers is its own, the rest goes to the nearest.
        ``voronoi``: the cells of each correspondent's vertex nearest to the polygon's centroid.
        ``advancing-front``, ``quadtree``: a triangle mesh of the polygon, whose triangles go to
        the correspondent that has the largest share of them, else to the nearest.
    connected
        Each piece is one polygon: parts that lie apart go to the neighbour with the longest
        common seam. Otherwise a piece may be a MultiPolygon, and crumbs only go there.
    weights
        Of ``territory``: the pieces' areas are as these numbers, one for each correspondent, or
        as the correspondents' own areas (``"area"``); within some percent, before parts that lie
        apart are given away.
    smooth
        Of the meshes: the seams' zigzag is smoothed.

    Returns
    -------
    list
        One piece for each correspondent, in their order: together they are the polygon, none is
        empty, no two overlap, and both sides of a seam have the same vertices, to the bit.

    Raises
    ------
    ValueError
        For an unknown technique, options that it does not have, no correspondents, weights that
        are not positive numbers, and for geometries that are empty, invalid or not finite.
    TypeError
        For anything but polygons.
    ArithmeticError
        Where a polygon is too small, for its coordinates, to be divided so often.
    """
    if technique not in NAMES:
        raise ValueError(f"unknown technique {technique!r}; expected one of {', '.join(NAMES)}")
    if weights is not None and technique != "territory":
        raise ValueError(f"technique {technique} takes no weights; territory does")
    if smooth and technique not in MESHED:
        raise ValueError(f"technique {technique} has no smooth; {' and '.join(MESHED)} have")
    _check([polygon], "the polygon", Polygon)
    _check(correspondents, "a correspondent", Polygon | MultiPolygon)
    if not len(correspondents):
        raise ValueError("a polygon is divided among one correspondent at least")
    numbers = _numbers(weights, correspondents)
    if len(correspondents) == 1:
        return [polygon]
    if technique in MESHED:
        return MESHED[technique](polygon, correspondents, connected, smooth)[0]
    if technique == "voronoi":
        return voronoi(polygon, correspondents, connected)[0]
    return territory(polygon, correspondents, connected, numbers)[0]


def _check(shapes: Sequence[Piece], what: str, kind: Any) -> None:
    for shape in shapes:
        if not isinstance(shape, kind):
            raise TypeError(f"{what} is a {type(shape).__name__}, not a polygon")
        if shape.is_empty or not np.isfinite(shapely.get_coordinates(shape)).all():
            raise ValueError(f"{what} is empty or has coordinates that are not finite")
        if not shape.is_valid:
            raise ValueError(f"{what} is not valid: {shapely.is_valid_reason(shape)}")


def _numbers(weights: Weights, correspondents: Sequence[Piece]) -> list[float] | None:
    if weights is None:
        return None
    if isinstance(weights, str):
        if weights != "area":
            raise ValueError(f'weights are numbers or "area", not {weights!r}')
        return [float(shape.area) for shape in correspondents]
    numbers = [float(number) for number in weights]
    if len(numbers) != len(correspondents):
        raise ValueError(f"{len(numbers)} weights for {len(correspondents)} correspondents")
    if not all(0 < number < np.inf for number in numbers):
        raise ValueError("weights are finite numbers above 0")
    return numbers
