"""Choose the projection of a map: by the extent of its data, or as its author names it."""

from __future__ import annotations

import math
import textwrap
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geotween.data.globe.longitudes import (
    TURN,
    Parts,
    finite,
    joined,
    parts_of,
    unwrapped,
    widest_gap,
)
from geotween.data.globe.reproject import plain_geographic, reproject

if TYPE_CHECKING:
    from pyproj import CRS

# A narrower gap (degrees) is none that a map of the world should be cut in: between Siberia and
# Alaska there is one of 1°.
GAP_OF_NOTE = 15.0

# Data wider or higher than this (degrees) are a map of the world.
WORLD_ARC, WORLD_HEIGHT, BAND_HEIGHT = 180.0, 120.0, 60.0

# Latitude (degrees) beyond which data are polar: all around a pole, or on a good part of the way.
AROUND_POLE, NEAR_POLE, POLAR_ARC = 40.0, 60.0, 60.0

# Nearer to the equator than this (degrees) a cone is nearly a cylinder; nearer to a pole than the
# second, nearly a plane.
EQUATORIAL, HIGH = 15.0, 70.0

# What is this much wider than high is called wide, as in the Projection Wizard.
WIDE = 1.25

# Smaller data (degrees) look the same on a plane and on a cone: scales differ by less than 0.1 %.
SMALL = 5.0

# Mercator's projection has no end; the web's map of the world ends (degrees) where it is a square.
MERCATOR_REACH = 85.06

# What names the methods that map the globe onto a plane that touches it: these need no cut.
AZIMUTHAL = ("azimuthal", "stereographic", "orthographic", "gnomonic", "perspective", "airy")


@dataclass(frozen=True, eq=False)
class Projection:
    """A map projection: its system, its description for people, and where the map is cut.

    ``cut`` is a longitude in degrees east of Greenwich; None where the map needs no cut. The map
    is drawn up to the latitude ``reach`` (degrees), north and south.
    """

    crs: CRS
    words: str
    cut: float | None
    reach: float = 90.0


def read_crs(text: str) -> CRS:
    """The coordinate reference system that a text names, to be used with x (east) first.

    An EPSG code (``EPSG:5070``, ``5070``), another authority's (``OGC:CRS84``), a PROJ string or
    WKT. Raises ValueError, with a message for people, where it is none of a flat map or a globe.
    """
    from pyproj import CRS
    from pyproj.exceptions import CRSError

    name = text.strip()
    short = textwrap.shorten(name, 60, placeholder=" …")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # an old spelling, +init=, is understood all the same
            crs = CRS.from_user_input(f"EPSG:{name}" if name.isdecimal() else name)
    except CRSError:
        raise ValueError(
            f"unknown coordinate reference system {short!r}: "
            "write an EPSG code such as EPSG:4326, a PROJ string or WKT"
        ) from None
    if crs.is_compound:
        crs = crs.sub_crs_list[0]
    if not (crs.is_geographic or crs.is_projected):
        raise ValueError(f"{short!r} has no coordinates on a map or in longitude and latitude")
    return crs


def fitting(geometries: NDArray[np.object_], crs: CRS) -> Projection:
    """The equal-area projection that suits the extent of (Multi)Polygons (n,) in a system.

    The map is cut in the widest gap between the data's longitudes and centred opposite. Parameters
    are rounded to between a tenth and a hundredth of the extent. The datum is the data's, or
    WGS 84 where that does not count degrees from Greenwich.

    Notes
    -----
    After J. P. Snyder, Map Projections: A Working Manual, 1987 (the choice by extent, and standard
    parallels a sixth of the range inside it), and B. Šavrič, B. Jenny, H. Jenny, "Projection
    Wizard", The Cartographic Journal 53, 2016 (the classes of extent). The world: Equal Earth.
    Around a pole: Lambert azimuthal on it. Wide and along the equator: cylindrical. Wide
    elsewhere: Albers conic. All else: Lambert azimuthal on the centre.
    """
    parts = _globe(geometries, crs)
    gap, room = widest_gap(parts)
    wide = TURN - room
    south, north = -90.0, 90.0
    if len(parts.polygons):
        bounds = parts.bounds
        south, north = float(bounds[:, 1].min()), float(bounds[:, 3].max())
    step = _step(max(wide, north - south))
    centre = _rounded(gap + TURN / 2, step) if room > GAP_OF_NOTE else 0.0
    centre = (centre + TURN / 2) % TURN - TURN / 2
    method, words, cut = _suiting(wide, south, north, centre, step)
    return Projection(
        _with_datum(f"{method} +lon_0={centre!r}", plain_geographic(crs)),
        words,
        _opposite(centre) if cut else None,
    )


def _suiting(
    wide: float, south: float, north: float, centre: float, step: float
) -> tuple[str, str, bool]:
    """PROJ's method and parameters, words, and whether a cut is needed (degrees)."""
    high, middle = north - south, (south + north) / 2
    east = _degrees(centre, "E", "W")
    nearest = max(south, -north)  # how far from the equator all data lie
    enclosed = max(north, -south) == 90
    polar = (wide > WORLD_ARC or enclosed) and nearest >= AROUND_POLE
    if polar or (wide > POLAR_ARC and nearest >= NEAR_POLE):
        pole, where = (90, "north") if middle > 0 else (-90, "south")
        words = f"Lambert azimuthal equal-area, centred on the {where} pole, along {east}"
        return f"+proj=laea +lat_0={pole}", words, False
    width = wide * math.cos(math.radians(middle))
    equatorial = wide > WIDE * high and south < 0 < north and abs(middle) < EQUATORIAL
    if high > WORLD_HEIGHT or (wide > WORLD_ARC and not (equatorial and high <= BAND_HEIGHT)):
        return "+proj=eqearth", f"Equal Earth, centred on {east}", True
    if equatorial and high > SMALL:
        true = _rounded(max(north, -south) * 2 / 3, step)
        words = (
            f"cylindrical equal-area, centred on {east}, true to scale at {_degrees(true)} N and S"
        )
        return f"+proj=cea +lat_ts={true!r}", words, True
    latitude = _rounded(middle, step)
    place = f"{_degrees(latitude, 'N', 'S')}, {east}"
    conic = EQUATORIAL <= abs(middle) <= HIGH and width > max(WIDE * high, SMALL)
    if conic:
        first, second = (_rounded(y, step) for y in (south + high / 6, north - high / 6))
        parallels = f"{_degrees(first, 'N', 'S')} and {_degrees(second, 'N', 'S')}"
        words = f"Albers equal-area conic, centred on {place}, true to scale at {parallels}"
        return f"+proj=aea +lat_0={latitude!r} +lat_1={first!r} +lat_2={second!r}", words, True
    return (
        f"+proj=laea +lat_0={latitude!r}",
        f"Lambert azimuthal equal-area, centred on {place}",
        False,
    )


def named(text: str, geometries: NDArray[np.object_], crs: CRS) -> Projection:
    """The projection that an author names, as `read_crs` reads it; ValueError as there.

    Cut opposite its central meridian. A map in longitudes and latitudes is cut at 180°, or where
    the (Multi)Polygons (n,), which are in ``crs``, leave the widest gap if they lie at 180°.
    """
    target = read_crs(text)
    code = textwrap.shorten(text, 60, placeholder=" …")
    words = code if target.name == "unknown" else f"{target.name} ({code})"
    if target.is_geographic:
        gap, room = widest_gap(_globe(geometries, crs))
        clear = TURN / 2 - abs(gap) <= room / 2
        return Projection(target, words, 180.0 if clear or room < GAP_OF_NOTE else gap)
    method = _method(target)
    if any(name in method for name in AZIMUTHAL):
        return Projection(target, words, None)
    endless = "mercator" in method and "transverse" not in method and "oblique" not in method
    reach = MERCATOR_REACH if endless else 90.0
    return Projection(target, words, _opposite(_central_meridian(target)), reach)


def _method(crs: CRS) -> str:
    """The name of a projected system's method, in small letters."""
    base = crs.source_crs if crs.is_bound else crs
    operation = base.coordinate_operation if base else None
    return operation.method_name.lower() if operation else ""


def _central_meridian(crs: CRS) -> float:
    """Longitude (degrees from Greenwich) of a projected system's origin."""
    base = (crs.source_crs if crs.is_bound else crs) or crs
    meridian = base.prime_meridian
    zero = meridian.longitude * float(meridian.unit_conversion_factor) if meridian else 0.0
    operation = base.coordinate_operation
    for parameter in operation.params if operation else ():
        if "longitude of" in parameter.name.lower():
            radians = float(parameter.value) * parameter.unit_conversion_factor
            return round(math.degrees(zero + radians), 9)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that a PROJ string says less than WKT does
        return math.degrees(zero) + float(base.to_dict().get("lon_0", 0.0))


def _with_datum(proj: str, base: CRS) -> CRS:
    """The projected system of a PROJ string on the datum of a geographic one."""
    from pyproj import CRS
    from pyproj.crs import ProjectedCRS

    conversion = CRS.from_string(proj).coordinate_operation
    return ProjectedCRS(conversion=conversion, name="fitting", geodetic_crs=base)


def _globe(geometries: NDArray[np.object_], crs: CRS) -> Parts:
    """Polygons with continuous longitudes, in degrees."""
    parts = parts_of(reproject(geometries, crs, plain_geographic(crs)))
    return joined(unwrapped(finite(parts)[0])[0], None)


def _opposite(longitude: float) -> float:
    """The meridian on the other side of the globe, in (-180, 180]."""
    return TURN / 2 - (-longitude % TURN)


def _step(extent: float) -> float:
    """A power of ten (degrees), between a tenth and a hundredth of an extent, at most 1."""
    return min(1.0, 10.0 ** math.floor(math.log10(max(extent, 1e-9) / 10)))


def _rounded(degrees: float, step: float) -> float:
    """To the nearest multiple of a step, halves upwards: turning the globe keeps them so."""
    return round(math.floor(degrees / step + 0.5) * step, 12) + 0.0


def _degrees(angle: float, positive: str = "", negative: str = "") -> str:
    """``38° N``; no letter at 0."""
    letter = positive if angle > 0 else negative
    return f"{abs(angle):.12g}°" + (f" {letter}" if angle and letter else "")
