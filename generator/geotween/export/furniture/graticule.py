"""The graticule: meridians and parallels at round degrees, true to the projection."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.globe.longitudes import TURN
from geotween.data.load import Scene
from geotween.export.furniture.earth import from_globe, to_globe
from geotween.export.furniture.room import data_at
from geotween.export.page_grid import GRID, Page

if TYPE_CHECKING:
    from pyproj import CRS

Line = NDArray[np.int64]  # (n, 2), in steps of the page's grid

# Degrees between lines that are round, and how many lines the shorter side has at least.
ROUND = (30, 15, 10, 5, 2, 1, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001)
FEWEST = 3

LOOKS = 41  # places along each side of the page whose longitudes and latitudes are looked at
POINTS = 721  # along each line before it is made simpler: two for a degree of a whole turn

# The most lines of one kind: more would be a texture.
MOST = 360


def graticule(scene: Scene, page: Page) -> tuple[Line, ...]:
    """The lines of a map's graticule within its frame."""
    wanted, crs = scene.model.map.graticule, scene.crs
    if wanted == "none" or crs is None or scene.model.map.fit == "each":
        return ()
    seen = _seen(crs, page)
    if not len(seen):
        return ()
    centre, low, high = _bounds(seen)
    step = _step(high - low) if isinstance(wanted, str) else wanted
    return tuple(line for one in _lines(centre, low, high, step) for line in _drawn(one, crs, page))


def _seen(crs: CRS, page: Page) -> NDArray[np.float64]:
    """Longitudes and latitudes (k, 2) of places all over the page that are on the globe."""
    x, y = np.meshgrid(np.linspace(0, page.width, LOOKS), np.linspace(0, page.height, LOOKS))
    planar = data_at(page, np.column_stack([x.ravel(), y.ravel()]))
    globe = to_globe(crs, planar)
    back = from_globe(crs, np.where(np.isfinite(globe), globe, 0))
    near = np.abs(back - planar).max(axis=1) * np.abs(page.scale[0]) < 1
    return np.asarray(globe[np.isfinite(globe).all(axis=1) & near])


def _bounds(
    seen: NDArray[np.float64],
) -> tuple[float, NDArray[np.float64], NDArray[np.float64]]:
    """The middle longitude, and the least and greatest degrees east of it and north."""
    turns = np.exp(1j * np.radians(seen[:, 0]))
    middle = float(np.degrees(np.angle(turns.mean())))
    east = (seen[:, 0] - middle + TURN / 2) % TURN - TURN / 2
    places = np.column_stack([east, seen[:, 1]])
    return middle, places.min(axis=0), places.max(axis=0)


def _step(size: NDArray[np.float64]) -> float:
    return next((step for step in ROUND if size.min() / step >= FEWEST), ROUND[-1])


def _lines(
    middle: float, low: NDArray[np.float64], high: NDArray[np.float64], step: float
) -> list[NDArray[np.float64]]:
    """Meridians and parallels at multiples of a step, as points in longitude and latitude."""
    margin = (high - low) / LOOKS  # the page's edge may reach beyond the places looked at
    low, high = np.maximum(low - margin, [-TURN / 2, -90]), np.minimum(high + margin, [180, 90])
    along_x = np.linspace(low[0], high[0], POINTS) + middle
    along_y = np.linspace(low[1], high[1], POINTS)
    east = _multiples(low[0] + middle, high[0] + middle, step)
    north = [y for y in _multiples(low[1], high[1], step) if abs(y) < 90]
    return [
        *(np.column_stack([np.full(POINTS, x), along_y]) for x in east),
        *(np.column_stack([along_x, np.full(POINTS, y)]) for y in north),
    ]


def _multiples(low: float, high: float, step: float) -> list[float]:
    first, last = np.ceil(low / step), np.floor(high / step)
    last = min(last, first + np.ceil(TURN / step) - 1)  # a whole turn has each meridian once
    return [float(k * step) for k in np.arange(first, min(last, first + MOST) + 1)]


def _drawn(line: NDArray[np.float64], crs: CRS, page: Page) -> list[Line]:
    """A line on the page, within its frame; in several where the projection tears it."""
    longitudes = (line[:, 0] + TURN / 2) % TURN - TURN / 2
    places = page.pixels(from_globe(crs, np.column_stack([longitudes, line[:, 1]])))
    there = np.asarray(np.isfinite(places).all(axis=1))
    leap = np.hypot(*np.diff(np.where(there[:, None], places, 0), axis=0).T) > page.width / 4
    cuts = np.flatnonzero(leap | (there[1:] != there[:-1])) + 1
    runs = np.split(np.where(there[:, None], places, np.nan), cuts)
    kept = [run for run in runs if len(run) > 1 and np.isfinite(run).all()]
    frame = shapely.box(0, 0, page.width, page.height)
    inside = shapely.intersection([shapely.LineString(run) for run in kept], frame)
    parts = shapely.get_parts(shapely.simplify(inside, GRID))
    lines = parts[shapely.get_type_id(parts) == shapely.GeometryType.LINESTRING]
    found = [np.rint(shapely.get_coordinates(one) / GRID).astype(np.int64) for one in lines]
    return [one for one in found if len(one) > 1]
