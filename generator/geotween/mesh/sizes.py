"""How large the triangles of a polygon should be, place by place, by the lengths of its edges."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Size = Callable[[Floats], Floats]

# Boundary edges whose lengths differ by less than this factor count as equally long.
ALIKE = 2**0.25


def size_function(middles: Floats, lengths: Floats, growth: float, cap: float) -> Size:
    """The size of elements at places (n, 2): the least of length + growth * distance, and a cap.

    That minimum runs over the boundary edges, given by their middles (k, 2) and lengths (k,): from
    short edges on, sizes grow inwards, evenly in all directions.

    Notes
    -----
    Cost: log k for each place and each quarter octave of lengths that occurs.
    """
    from scipy.spatial import KDTree

    octave = np.floor(np.log(lengths) / np.log(ALIKE)).astype(np.intp)
    classes = []
    for value in np.unique(octave):
        alike = octave == value
        classes.append((lengths[alike].mean(), KDTree(middles[alike])))

    def size(places: Floats) -> Floats:
        least = np.full(len(places), cap)
        for length, tree in classes:
            reach = (least - length).max(initial=0) / growth
            if reach > 0:
                distance, _ = tree.query(places, distance_upper_bound=reach)
                least = np.minimum(least, length + growth * distance)
        return least

    return size
