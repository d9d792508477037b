"""How well shaped the triangles of a mesh are."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geotween.mesh.mesh import Mesh

# A triangle of this quality or more is a good one. So are the right isosceles ones, of 0.828.
GOOD = 0.8

# Quality lies within rounding of GOOD in triangles with sides as 3, 4 and 5: it counts as good.
ROUNDING = 1e-12

BINS = 10  # of a histogram, unless told


def quality(mesh: Mesh) -> NDArray[np.float64]:
    """Twice the radius of the inscribed circle over that of the circumscribed one, per triangle.

    Returns
    -------
    (m,) values from 0, for a flat triangle, to 1, for an equilateral one.

    Notes
    -----
    By the lengths a, b, c of the sides it is (b + c - a)(c + a - b)(a + b - c) / abc. Cost: linear.
    """
    corners = mesh.points[mesh.triangles]
    sides = np.roll(corners, -1, axis=1) - corners
    lengths = np.hypot(sides[..., 0], sides[..., 1])
    longest = lengths.max(axis=1, initial=0, keepdims=True)
    longest[longest == 0] = 1
    lengths = np.sort(lengths / longest, axis=1)
    a, b, c = lengths.T
    # The area by a cross product: sums of lengths cancel in slivers.
    one, other = (sides[:, :2] / longest[:, :, None]).transpose(1, 2, 0)
    area = np.abs(one[0] * other[1] - one[1] * other[0]) / 2
    perimeter = a + b + c
    with np.errstate(invalid="ignore", divide="ignore"):
        # 2 r / R, of r = 2 area / perimeter and R = abc / (4 area).
        value = 16 * area**2 / (perimeter * a * b * c)
    return np.asarray(np.where(area > 0, np.minimum(value, 1), 0.0))


def histogram(mesh: Mesh, bins: int = BINS) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """How many triangles there are in each of equal ranges of quality, from 0 to 1.

    Returns
    -------
    counts : (bins,)
    edges : (bins + 1,) the ranges' ends. A range holds its lower end; the last holds 1, too.

    Raises
    ------
    ValueError
        If there is not at least one range.
    """
    if bins < 1:
        raise ValueError(f"a histogram has one range or more, not {bins}")
    counts, edges = np.histogram(quality(mesh), bins=bins, range=(0, 1))
    return counts, edges


def share_good(mesh: Mesh, good: float = GOOD) -> float:
    """The share of triangles of some quality or better; NaN for a mesh without triangles."""
    values = quality(mesh)
    return float(np.mean(values >= good - ROUNDING)) if len(values) else float("nan")
