"""Moves: which shapes have left their place for another one, and did not only grow on one side."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

# A thing moved where its centroid did by this part of its width, the side of a square of its area,
WAY = 0.05
# where it left at least this part of its ground and entered as much elsewhere,
LEFT = 0.01
# and where laying it on the other end, centroid on centroid, leaves at most this part of that.
LAID_ON = 0.5

Floats = NDArray[np.float64]
Shapes = NDArray[np.object_]  # (Multi)Polygons


def have_moved(here: Shapes, there: Shapes) -> NDArray[np.bool_]:
    """Which shapes (m,) that went far enough are better told to have moved than to have changed.

    What grows on one side has its centroid elsewhere, but has left no ground; what changes on all
    sides has left some, but fits no better when it is laid on the other.
    """
    if not len(here):
        return np.zeros(0, dtype=bool)
    one, other = (shapely.get_coordinates(shapely.centroid(end)) for end in (here, there))
    points, owner = shapely.get_coordinates(here, return_index=True)
    laid = shapely.set_coordinates(here.copy(), points + (other - one)[owner])
    exchanged, left = _exchanged(here, there), _exchanged(laid, there)
    least = np.minimum(shapely.area(here), shapely.area(there))
    return np.asarray((exchanged >= LEFT * least) & (left <= LAID_ON * exchanged))


def _exchanged(here: Shapes, there: Shapes) -> Floats:
    """The smaller one of the ground that was left and that was entered (m,)."""
    common = shapely.area(shapely.intersection(here, there))
    return np.asarray(np.minimum(shapely.area(here), shapely.area(there)) - common)
