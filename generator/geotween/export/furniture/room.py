"""Room for words: how well a text fits into a polygon, and which boxes overlap."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon

from geotween.export.page_grid import GRID, GridTrack, Page
from geotween.motion.innermost import innermost
from geotween.motion.rings import to_polygons

Floats: TypeAlias = NDArray[np.float64]
Box: TypeAlias = tuple[float, float, float, float]  # left, top, right, bottom in px

CLEAR = 3.0  # px between two texts


def roomiest(polygons: NDArray[np.object_], halves: Floats) -> Floats:
    """The place (m, 2) in each polygon where a text of half a size (m, 2) has most room.

    That is where the largest ellipse of the text's proportions lies: the innermost point of the
    polygon, pressed together so far that the ellipse is a circle.
    """
    widths = halves[:, 0] / halves[:, 1]
    found = innermost(_pressed(polygons, widths))
    return np.asarray(found * np.column_stack([widths, np.ones(len(widths))]))


def fits(polygons: NDArray[np.object_], places: Floats, halves: Floats) -> Floats:
    """How large an ellipse is free about each place, in sizes of the text's; 0 outside (m,)."""
    widths = halves[:, 0] / halves[:, 1]
    pressed = _pressed(polygons, widths)
    points = shapely.points(places / np.column_stack([widths, np.ones(len(widths))]))
    depth = shapely.distance(points, shapely.boundary(pressed))
    return np.asarray(np.where(shapely.contains(pressed, points), depth / halves[:, 1], 0.0))


def polygons_at(track: GridTrack, t: float) -> list[Polygon]:
    """What a track covers at t, in px; it may touch itself, or be nothing."""
    return [*drawn_at([track], t)[0]]


def drawn_at(tracks: Sequence[GridTrack], t: float) -> tuple[NDArray[np.object_], NDArray[np.intp]]:
    """What tracks cover at t, in px, and which of them it is (n,); some may cover nothing.

    Polygons may touch themselves.
    """
    counts = [np.empty(0, dtype=np.intp), *(np.diff(track.offsets) for track in tracks)]
    owner = np.repeat(np.arange(len(tracks)), [len(count) for count in counts[1:]])
    offsets = np.concatenate([[0], np.cumsum(np.concatenate(counts))]).astype(np.intp)
    places = np.concatenate([np.empty((0, 2)), *(track.at(t) for track in tracks)])
    found = to_polygons(places * GRID, offsets, owner)
    which = np.flatnonzero([polygon is not None for polygon in found])
    return found[which], which


def data_at(page: Page, points: Floats) -> Floats:
    """Points (n, 2) in px as places of the data."""
    return np.asarray((points - page.shift) / page.scale)


def boxes(places: Floats, half: Floats) -> Floats:
    """The boxes (k, 4) of a text at some places."""
    return np.hstack([places - half, places + half])


def clash(one: Floats, other: Floats) -> NDArray[np.bool_]:
    """Which boxes (k, 4) come too near to their counterparts."""
    apart = (one[:, 2:] + CLEAR <= other[:, :2]) | (other[:, 2:] + CLEAR <= one[:, :2])
    return np.asarray(~apart.any(axis=1))


def _pressed(polygons: NDArray[np.object_], widths: Floats) -> NDArray[np.object_]:
    """Polygons, each as many times narrower as it says."""
    points = shapely.get_coordinates(polygons)
    counts = shapely.get_num_coordinates(polygons)
    points[:, 0] /= np.repeat(widths, counts)
    return np.asarray(shapely.set_coordinates(polygons.copy(), points))
