"""Which way three points turn, exactly."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from geotween.motion.front.plane import Floats, Ints

# Below this share of its terms a determinant in double precision may have the wrong sign
# (Shewchuk, Adaptive Precision Floating-Point Arithmetic, 1997: (3 + 16 e) e for e = 2^-53).
UNSURE = 3.3306690738754716e-16


def turns(points: Floats, triangles: Ints) -> Floats:
    """Twice the signed areas (T,) of triangles (T, 3), with exact signs: positive to the left."""
    a, b, c = (points[triangles[:, i]] for i in range(3))
    one, other = (a - c)[:, 0] * (b - c)[:, 1], (a - c)[:, 1] * (b - c)[:, 0]
    found = one - other
    unsure = np.flatnonzero(np.abs(found) <= UNSURE * (np.abs(one) + np.abs(other)))
    for i in unsure.tolist():
        found[i] = _turn(points[triangles[i]].tolist())
    return np.asarray(found)


def _turn(corners: list[list[float]]) -> float:
    (ax, ay), (bx, by), (cx, cy) = ((Fraction(x), Fraction(y)) for x, y in corners)
    exact = (ax - cx) * (by - cy) - (ay - cy) * (bx - cx)
    tiny = float(np.finfo(float).tiny)
    return max(float(exact), tiny) if exact > 0 else min(float(exact), -tiny) if exact else 0.0
