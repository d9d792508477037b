"""Polygons from one coordinate reference system to another, and onto the plane of a map."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon, Polygon

from geotween.data.globe.densify import Points, placed
from geotween.data.globe.longitudes import (
    TURN,
    Parts,
    cut_at,
    finite,
    first_longitude,
    joined,
    parts_of,
    unwrapped,
    with_equal_sides,
)
from geotween.data.polygons import RELATIVE_TOLERANCE
from geotween.data.problems import Problem

if TYPE_CHECKING:
    from pyproj import CRS

    from geotween.data.globe.projection import Projection

# How far (degrees, 0.1 mm) inside the cut of the map a point at the cut is drawn: PROJ takes a
# longitude for the same in another turn, and would choose the side.
INSIDE = 1e-9

# What lies farther out than this many radii of the globe is at infinity in truth, as the other
# pole is in a stereographic projection.
FARTHEST = 100.0


def reproject(geometries: NDArray[np.object_], source: CRS, target: CRS) -> NDArray[np.object_]:
    """(Multi)Polygons (n,) of one coordinate reference system in another, x first in both.

    Points are added where a straight edge of the source is none in the target. Longitudes of a
    geographic target may jump where a ring crosses the antimeridian. What the target cannot show
    has coordinates that are not finite.
    """
    from pyproj import Transformer

    if source.equals(target, ignore_axis_order=True):
        return geometries
    transformer = Transformer.from_crs(source, target, always_xy=True)

    def place(points: Points) -> Points:
        x, y = transformer.transform(points[:, 0], points[:, 1])
        return np.column_stack([x, y])

    if source.is_geographic and target.is_geographic:

        def nearby(points: Points) -> Points:
            new = place(points)
            shown = np.isfinite(new[:, 0])
            turns = np.rint((points[shown, 0] - new[shown, 0]) / TURN)
            new[shown, 0] += TURN * turns  # it stays on its turn
            return new

        return np.asarray(shapely.transform(geometries, nearby), dtype=object)
    parts = parts_of(geometries)
    new = placed(
        parts.polygons, place, from_globe=source.is_geographic, to_globe=target.is_geographic
    )
    return _gathered(new, parts.owners, len(geometries))


def _gathered(
    parts: NDArray[np.object_], owners: NDArray[np.intp], count: int
) -> NDArray[np.object_]:
    """Features (count,) of their parts: polygons, MultiPolygons, or empty polygons."""
    features = np.full(count, shapely.Polygon(), dtype=object)
    counts = np.bincount(owners, minlength=count)
    single = counts[owners] == 1
    features[owners[single]] = parts[single]
    if not single.all():
        order = np.argsort(owners[~single], kind="stable")
        shapely.multipolygons(parts[~single][order], indices=owners[~single][order], out=features)
    return features


def plain_geographic(crs: CRS) -> CRS:
    """The geographic system that a system is based on; WGS 84 if not in degrees from Greenwich."""
    from pyproj import CRS

    base = crs.geodetic_crs
    if base is None or not base.is_geographic or base.prime_meridian is None:
        return CRS.from_epsg(4326)
    degrees = np.isclose(base.axis_info[0].unit_conversion_factor, np.pi / 180, rtol=1e-9)
    plain = degrees and base.prime_meridian.longitude == 0
    return base.to_2d() if plain else CRS.from_epsg(4326)


def project(
    geometries: NDArray[np.object_], crs: CRS, projection: Projection
) -> tuple[NDArray[np.object_], list[Problem]]:
    """(Multi)Polygons (n,) of a system as planar ones on a map, and what it could not show.

    A result is empty where the projection shows nothing of it. Borders that are shared stay so,
    bit for bit, among all geometries of one call (points are added to suit its extent): pass those
    of all steps together. What is valid in longitude and latitude comes out valid. Geometries of
    the map's own projected system are returned as they are.
    """
    target = projection.crs
    if crs.is_projected and crs.equals(target, ignore_axis_order=True):
        return geometries, []
    globe = plain_geographic(target)
    parts, lost = finite(parts_of(reproject(geometries, crs, globe)))
    parts, crossing = unwrapped(parts)
    problems = _crossed(crossing)
    parts = joined(parts, projection.cut)
    cut = projection.cut
    parts = with_equal_sides(parts) if cut is None else cut_at(parts, cut)
    parts, beyond = _within(parts, projection.reach)
    problems += beyond
    drawn = placed(parts.polygons, _forward(projection, globe), from_globe=True)
    planar, unseen = finite(_mended(Parts(drawn, parts.owners), parts))
    problems += _not_shown(len(np.union1d(lost, unseen)))
    return _gathered(planar.polygons, planar.owners, len(geometries)), problems


def _forward(projection: Projection, globe: CRS) -> Callable[[Points], Points]:
    """Longitudes and latitudes (k, 2) onto the map."""
    from pyproj import Transformer

    target, cut = projection.crs, projection.cut
    transformer = Transformer.from_crs(globe, target, always_xy=True)
    radius = target.ellipsoid.semi_major_metre if target.ellipsoid else np.inf
    farthest = FARTHEST * radius / target.axis_info[0].unit_conversion_factor

    def forward(points: Points) -> Points:
        if target.is_geographic:
            return points
        longitudes = points[:, 0]
        if cut is None:  # one place has one image, bit for bit, on whatever turn it lies
            longitudes = longitudes - TURN * np.ceil((longitudes - TURN / 2) / TURN)
        else:
            start = first_longitude(cut)
            longitudes = np.clip(longitudes, start + INSIDE, start + TURN - INSIDE)
        images = np.column_stack(transformer.transform(longitudes, points[:, 1]))
        images[(np.abs(images) > farthest).any(axis=1)] = np.inf
        return images

    return forward


def _within(parts: Parts, reach: float) -> tuple[Parts, list[Problem]]:
    """Polygons between two latitudes, and the share of the globe's area that this cuts off."""
    bounds = parts.bounds
    beyond = np.flatnonzero((bounds[:, 1] < -reach) | (bounds[:, 3] > reach))
    if not len(beyond):
        return parts, []
    west, east = bounds[beyond, 0].min(), bounds[beyond, 2].max()
    band = shapely.box(west - 1, -reach, east + 1, reach)
    solid = shapely.make_valid(parts.polygons[beyond])
    inside = parts.with_changed(beyond, shapely.intersection(solid, band))
    before, after = _area(parts), _area(inside)
    problem = Problem(
        "beyond projection", "warning",
        f"what lies beyond {reach:g}° of latitude is not on this map and was cut off",
        measure=(before - after) / before if before else 0.0, unit="of the area",
        hint="choose an equal-area projection, such as auto",
    )  # fmt: skip
    return inside, [problem]


def _area(parts: Parts) -> float:
    """Area on a sphere, in no unit; edges straight on the cylinder."""
    flat = shapely.transform(
        parts.polygons, lambda xy: np.column_stack([xy[:, 0], np.sin(np.radians(xy[:, 1]))])
    )
    return float(shapely.area(flat).sum())


def _mended(planar: Parts, globe: Parts) -> Parts:
    """Planar polygons, valid where those on the globe were, the way to a pole and back dissolved.

    On a map around the pole that way is a spike without area; if the data have other points on its
    two sides, there may be slivers in the width of rounding, which go too.
    """
    finite = np.isfinite(shapely.bounds(planar.polygons).reshape(-1, 4)).all(axis=1)
    broken = np.flatnonzero(finite & ~shapely.is_valid(planar.polygons))
    broken = broken[shapely.is_valid(globe.polygons[broken])]
    solid = shapely.make_valid(planar.polygons[broken], method="structure", keep_collapsed=False)
    return planar.with_changed(broken, [_without_slivers(geometry) for geometry in solid])


def _without_slivers(geometry: Polygon | MultiPolygon) -> MultiPolygon:
    least = RELATIVE_TOLERANCE * geometry.area
    kept = [
        Polygon(part.exterior, [hole for hole in part.interiors if Polygon(hole).area > least])
        for part in shapely.get_parts(geometry)
        if part.area > least
    ]
    return MultiPolygon(kept)


def _crossed(count: int) -> list[Problem]:
    if not count:
        return []
    message = "longitudes that jump from one turn to another were led the short way round"
    return [Problem("antimeridian", "note", message, measure=float(count), unit="polygons")]


def _not_shown(count: int) -> list[Problem]:
    if not count:
        return []
    return [
        Problem(
            "beyond projection", "error",
            "features lie, wholly or in part, where this projection shows nothing, and were left"
            " out there",
            measure=float(count), unit="features", hint="choose another projection, such as auto",
        )
    ]  # fmt: skip
