"""Areas, ways and directions of polygons: on the globe, or in a plane with or without a unit."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Protocol

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.load import Scene

if TYPE_CHECKING:
    from pyproj import CRS, Transformer

    from geotween.data.globe.projection import Projection

Floats = NDArray[np.float64]
Polygons = NDArray[np.object_]

METRES = {"m": 1.0, "km": 1000.0}


class Measure(Protocol):
    """How large polygons are and how far apart.

    ``real`` says that areas are in m² and ways in m, else they are in the data's own units;
    ``compass`` that bearings count from north, else they do from what is up on the page.
    """

    @property
    def real(self) -> bool: ...

    @property
    def compass(self) -> bool: ...

    def areas(self, polygons: Polygons) -> Floats:
        """The areas (n,)."""
        ...

    def centres(self, polygons: Polygons) -> Floats:
        """The centroids (n, k), in coordinates whose weighted means are centroids, too."""
        ...

    def ways(self, here: Floats, there: Floats) -> tuple[Floats, Floats]:
        """Distances (m,) from centres (m, k) to others, and bearings (degrees, clockwise)."""
        ...


@dataclass(frozen=True)
class Plane:
    """Planar coordinates; ``unit`` is the length of one in m, None where nobody knows it."""

    unit: float | None = None
    down: bool = False  # y grows downwards
    compass: bool = False

    @property
    def real(self) -> bool:
        return self.unit is not None

    def areas(self, polygons: Polygons) -> Floats:
        return np.asarray(shapely.area(polygons) * (self.unit or 1.0) ** 2)

    def centres(self, polygons: Polygons) -> Floats:
        return np.asarray(shapely.get_coordinates(shapely.centroid(polygons)))

    def ways(self, here: Floats, there: Floats) -> tuple[Floats, Floats]:
        east, north = (there - here).T * (self.unit or 1.0)
        up = -north if self.down else north
        return np.hypot(east, north), np.degrees(np.arctan2(east, up)) % 360


@dataclass(frozen=True, eq=False)
class Globe:
    """Coordinates of a known system, measured on its ellipsoid.

    ``flat`` is an equal-area projection that suits them: areas in it are those on the ellipsoid,
    as far as edges that are straight on the map are kept so, which densifying does.
    """

    crs: CRS
    flat: Projection
    real: bool = True
    compass: bool = True

    @classmethod
    def of(cls, crs: CRS, polygons: Polygons) -> Globe:
        """The measure of a map that shows some polygons (n,)."""
        from geotween.data.globe.projection import fitting

        return cls(crs, fitting(polygons, crs))

    def areas(self, polygons: Polygons) -> Floats:
        return np.asarray(shapely.area(self._flattened(polygons)) * self._metres() ** 2)

    def centres(self, polygons: Polygons) -> Floats:
        """Unit vectors (n, 3), normal to the ellipsoid: they have means across any meridian."""
        flat = shapely.get_coordinates(shapely.centroid(self._flattened(polygons)))
        east, north = np.radians(self._back.transform(flat[:, 0], flat[:, 1]))
        across = np.cos(north)
        return np.column_stack([across * np.cos(east), across * np.sin(east), np.sin(north)])

    def ways(self, here: Floats, there: Floats) -> tuple[Floats, Floats]:
        """Geodesics: their lengths and the directions in which they start."""
        geod = self.flat.crs.get_geod()
        assert geod is not None
        bearings, _, distances = geod.inv(*_lonlat(here), *_lonlat(there))
        return np.asarray(distances), np.asarray(bearings) % 360

    @cached_property
    def _back(self) -> Transformer:
        from pyproj import Transformer

        return Transformer.from_crs(self.flat.crs, self.flat.crs.geodetic_crs, always_xy=True)

    def _flattened(self, polygons: Polygons) -> Polygons:
        from geotween.data.globe.reproject import project

        return project(polygons, self.crs, self.flat)[0] if len(polygons) else polygons

    def _metres(self) -> float:
        return float(self.flat.crs.axis_info[0].unit_conversion_factor)


def measure_of(scene: Scene) -> Measure | None:
    """How a scene's polygons are measured; None where each step is drawn at a scale of its own."""
    if scene.model.map.fit == "each":
        return None
    if scene.crs is None:
        unit = scene.model.map.unit
        return Plane(METRES[unit] if unit else None, scene.model.map.y == "down")
    return Globe.of(scene.crs, np.concatenate([step.exact.polygons for step in scene.steps]))


def _lonlat(vectors: Floats) -> tuple[Floats, Floats]:
    """Longitudes and latitudes (degrees) of vectors (m, 3) of any length."""
    x, y, z = vectors.T
    return np.degrees(np.arctan2(y, x)), np.degrees(np.arctan2(z, np.hypot(x, y)))
