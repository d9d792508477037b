"""Triangle meshes of polygons."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles that fill a polygon without overlap and conform, each anticlockwise.

    ``points`` is (n, 2) float64, in the polygon's units; ``triangles`` (m, 3) int, the numbers of
    their corners.
    """

    points: NDArray[np.float64]
    triangles: NDArray[np.intp]
