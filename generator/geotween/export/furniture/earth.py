"""Where on Earth places of a map are. pyproj is imported when a map has a system, not before."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from pyproj import CRS, Transformer

Floats: TypeAlias = NDArray[np.float64]


def to_globe(crs: CRS, points: Floats) -> Floats:
    """Places (n, 2) of a system as longitudes and latitudes; not finite where there are none."""
    x, y = points.T
    return np.column_stack(_transformer(crs).transform(x, y, direction="INVERSE"))


def from_globe(crs: CRS, places: Floats) -> Floats:
    """Longitudes and latitudes (n, 2) as places of a system; not finite where it has none."""
    longitudes, latitudes = places.T
    return np.column_stack(_transformer(crs).transform(longitudes, latitudes))


def distances(crs: CRS, starts: Floats, ends: Floats) -> Floats:
    """Metres along the ellipsoid (n,) between places (n, 2) of a system; NaN off the globe."""
    from geotween.data.globe.reproject import plain_geographic

    one, other = to_globe(crs, starts), to_globe(crs, ends)
    there = np.isfinite(one).all(axis=1) & np.isfinite(other).all(axis=1)
    geod = plain_geographic(crs).get_geod()
    found = np.full(len(starts), np.nan)
    if geod is not None and there.any():
        found[there] = geod.inv(*one[there].T, *other[there].T)[2]
    return found


@lru_cache(maxsize=8)
def _transformer(crs: CRS) -> Transformer:
    from pyproj import Transformer

    from geotween.data.globe.reproject import plain_geographic

    return Transformer.from_crs(plain_geographic(crs), crs, always_xy=True)
