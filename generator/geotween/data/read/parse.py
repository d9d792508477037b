"""Coordinates, WKT and GeoJSON to features, with every fault at its place in the file."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from itertools import chain
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon, Polygon

from geotween.data.polygons import Feature
from geotween.data.read.columns import NAMED_SO, NOTHING, Columns, identity
from geotween.scene.document import Location
from geotween.scene.errors import did_you_mean

# No map has larger coordinates: the Earth's girth is 4e10 mm.
LARGEST_COORDINATE = 1e12

SRID = re.compile(r"\s*SRID=(\d+);", re.IGNORECASE)
# polygons.geojson begins like WKT, and is a path.
_WKT = re.compile(
    r"\s*((MULTI)?(POLYGON|POINT|LINESTRING)|GEOMETRYCOLLECTION)(ZM?|M)?(\s|\(|$)", re.IGNORECASE
)
_WITH_AREA = ("Polygon", "MultiPolygon", "GeometryCollection")
_WITHOUT_AREA = ("Point", "MultiPoint", "LineString", "MultiLineString")
_FEATURE_KEYS = ("key", "class", "name", "polygon")
_NUMERIC = {str, int, float}  # YAML's numbers are texts here; true is no coordinate

Report = Callable[[Location, str, str], None]


class Invalid(Exception):  # noqa: N818 - control flow inside this file, never seen outside
    """A value that cannot be read; it was reported where it was found."""


class Parser:
    """Reads polygons out of plain values; what is wrong goes to ``report``.

    ``columns`` are the properties of GeoJSON that tell key, class and name. ``skipped`` counts
    geometries that have no area, such as points and lines.
    """

    def __init__(self, report: Report, columns: Columns = NAMED_SO) -> None:
        self.report = report
        self.columns = columns
        self.skipped = 0

    def features(self, value: Any, at: Location = ()) -> list[Feature]:
        """The features of a step's ``polygons`` value (not of a path: see ``load``)."""
        if isinstance(value, dict):
            return self.geojson(value, at)
        if isinstance(value, str):
            return self._feature(lambda: self._wkt(value, at))
        if not isinstance(value, list):
            self.report(at, f"expected polygons, not {value!r}", "[] is a step without polygons")
            return []
        if _is_point(value[:1]):  # a single ring where a list of polygons was expected
            return self._feature(lambda: self._polygon(value, at))
        found: list[Feature] = []
        for index, item in enumerate(value):
            found += self._item(item, (*at, index))
        return found

    def geojson(self, value: Any, at: Location = ()) -> list[Feature]:
        """The features of a GeoJSON object."""
        kind = value.get("type") if isinstance(value, dict) else None
        if kind == "FeatureCollection":
            members = value.get("features")
            if not isinstance(members, list):
                self.report(at, 'a FeatureCollection needs a list "features"', "")
                return []
            found: list[Feature] = []
            for index, member in enumerate(members):
                found += self.geojson(member, (*at, "features", index))
            return found
        if kind == "Feature":
            properties = value.get("properties") or {}
            if not isinstance(properties, dict):
                self.report((*at, "properties"), "properties must be a mapping", "")
                properties = {}
            geometry = value.get("geometry")
            if geometry is None:
                self.skipped += 1
                return []
            if "id" in value:
                properties = {"id": value["id"], **properties}
            return self._feature(
                lambda: self._geometry(geometry, (*at, "geometry")),
                properties,
                self.columns,
                (*at, "properties"),
                at[-1] if at else None,
            )
        if kind in _WITH_AREA + _WITHOUT_AREA:
            return self._feature(lambda: self._geometry(value, at))
        self._no_type(kind, at)
        return []

    def _item(self, item: Any, at: Location) -> list[Feature]:
        if isinstance(item, str):
            return self._feature(lambda: self._wkt(item, at))
        if isinstance(item, list):
            return self._feature(lambda: self._polygon(item, at))
        if not isinstance(item, dict):
            self.report(at, f"expected a polygon, not {item!r}", "")
            return []
        if "type" in item:
            return self.geojson(item, at)
        for key in item:
            if key not in _FEATURE_KEYS:
                self.report((*at, key), f'unknown key "{key}"', did_you_mean(key, _FEATURE_KEYS))
        if "polygon" not in item:
            self.report(at, 'a feature needs a "polygon"', "{key: a, polygon: [[0, 0], ...]}")
            return []
        said = {name: item[name] for name in _FEATURE_KEYS[:-1] if name in item}
        polygon = item["polygon"]
        return self._feature(lambda: self._any(polygon, (*at, "polygon")), said, NAMED_SO, at)

    def _feature(
        self,
        geometry: Callable[[], MultiPolygon | Polygon],
        attributes: Mapping[str, Any] = NOTHING,
        columns: Columns = NAMED_SO,
        at: Location = (),
        position: object = None,
    ) -> list[Feature]:
        def report(column: str, message: str) -> None:
            self.report((*at, column), message, "")

        names = identity(attributes, columns, report) if attributes else (None, None, "")
        try:
            shape = geometry()
        except Invalid:
            return []
        place = position if isinstance(position, int) else None
        return [] if shape.is_empty else [Feature(shape, *names, place, attributes=attributes)]

    def _any(self, value: Any, at: Location) -> Polygon | MultiPolygon:
        if isinstance(value, str):
            return self._wkt(value, at)
        if isinstance(value, dict):
            return self._geometry(value, at)
        if isinstance(value, list):
            return self._polygon(value, at)
        raise self._invalid(at, f"expected a polygon, not {value!r}")

    def _geometry(self, value: Any, at: Location) -> Polygon | MultiPolygon:
        """A GeoJSON geometry; what it holds without area is counted and left out."""
        kind = value.get("type") if isinstance(value, dict) else None
        if kind in _WITHOUT_AREA:
            self.skipped += 1
            return MultiPolygon()
        if kind == "GeometryCollection":
            members = value.get("geometries")
            if not isinstance(members, list):
                raise self._invalid(at, 'a GeometryCollection needs a list "geometries"')
            parts = [self._geometry(m, (*at, "geometries", i)) for i, m in enumerate(members)]
            return _collect(parts)
        if kind not in ("Polygon", "MultiPolygon"):
            self._no_type(kind, at)
            raise Invalid
        place = (*at, "coordinates")
        coordinates = value.get("coordinates")
        if not isinstance(coordinates, list):
            raise self._invalid(at, f'a {kind} needs a list "coordinates"')
        if kind == "Polygon":
            return self._rings(coordinates, place)
        return _collect([self._rings(rings, (*place, i)) for i, rings in enumerate(coordinates)])

    def _polygon(self, value: list[Any], at: Location) -> Polygon | MultiPolygon:
        """A ring, a list of rings, or a list of those, by how deeply it is nested."""
        depth, inner = 0, value
        while isinstance(inner, list) and inner:
            depth, inner = depth + 1, inner[0]
        if depth == 2:
            return Polygon(self._ring(value, at))
        if depth == 3:
            return self._rings(value, at)
        if depth == 4:
            return _collect([self._rings(rings, (*at, i)) for i, rings in enumerate(value)])
        raise self._invalid(at, "expected a ring [[x, y], [x, y], [x, y], ...] or a list of rings")

    def _rings(self, value: Any, at: Location) -> Polygon:
        if not isinstance(value, list):
            raise self._invalid(at, "expected a list of rings")
        if not value:
            return Polygon()
        rings: list[NDArray[np.float64]] = []
        broken = False
        for index, ring in enumerate(value):
            try:
                rings.append(self._ring(ring, (*at, index)))
            except Invalid:
                broken = True
        if broken:
            raise Invalid
        return Polygon(rings[0], rings[1:])

    def _ring(self, value: Any, at: Location) -> NDArray[np.float64]:
        """A ring's points, (n, 2); further ordinates such as heights are dropped."""
        if not isinstance(value, list):
            raise self._invalid(at, "expected a ring: [[x, y], [x, y], [x, y], ...]")
        points = _points(value)
        if points is None:
            points = np.array([self._point(v, (*at, i)) for i, v in enumerate(value)])
        if points.ndim != 2 or points.shape[1] < 2:
            raise self._invalid(at, "expected a ring: [[x, y], [x, y], [x, y], ...]")
        return self._checked(points[:, :2], at)

    def _checked(self, points: NDArray[np.float64], at: Location) -> NDArray[np.float64]:
        wild = np.flatnonzero(~(np.abs(points) <= LARGEST_COORDINATE).all(axis=1))
        if len(wild):
            x, y = points[wild[0]]
            raise self._invalid(
                (*at, int(wild[0])),
                f"the coordinates {x:g}, {y:g} are beyond any map",
                f"expected finite numbers of at most {LARGEST_COORDINATE:g}",
            )
        second = points[(points != points[0]).any(axis=1)]
        distinct = 1 + len(second[:1]) + bool((second != second[:1]).any())
        if distinct < 3:
            message = f"a ring needs at least three distinct points, not {distinct}"
            raise self._invalid(at, message, "add points: [[x, y], [x, y], [x, y]]")
        return points

    def _point(self, value: Any, at: Location) -> tuple[float, float]:
        points = _points([value[:2]]) if isinstance(value, list) else None
        if points is None or points.shape != (1, 2):
            hint = "two decimal numbers with a comma between, such as [9.5, -37.2]"
            raise self._invalid(at, f"expected a point [x, y], not {_short(value)}", hint)
        return float(points[0, 0]), float(points[0, 1])

    def _wkt(self, text: str, at: Location) -> Polygon | MultiPolygon:
        try:
            with np.errstate(over="ignore"):  # what overflows is met as infinite below
                geometry = shapely.from_wkt(SRID.sub("", text, count=1))
        except (shapely.errors.GEOSException, NotImplementedError) as error:
            reason = str(error).partition(": ")[2] or str(error)
            message = f"this is not WKT: {reason.strip()}"
            hint = "for example POLYGON ((0 0, 9 0, 9 9, 0 0))"
            raise self._invalid(at, message, hint) from None
        geometry = shapely.force_2d(geometry)
        parts = parts_of(geometry)
        polygons = [part for part in parts if isinstance(part, Polygon)]
        self.skipped += len(parts) - len(polygons)
        for polygon in polygons:
            for ring in (polygon.exterior, *polygon.interiors):
                if not polygon.is_empty:
                    self._checked(shapely.get_coordinates(ring), at)
        return _collect(polygons)

    def _no_type(self, kind: Any, at: Location) -> None:
        known = (*_WITH_AREA, "Feature", "FeatureCollection")
        if kind is None:
            self.report(at, 'GeoJSON needs a "type"', f"one of {', '.join(known)}")
        else:
            message = f'"{kind}" is no type of GeoJSON'
            self.report((*at, "type"), message, did_you_mean(str(kind), known))

    def _invalid(self, at: Location, message: str, hint: str = "") -> Invalid:
        self.report(at, message, hint)
        return Invalid()


def is_wkt(text: str) -> bool:
    """Whether a text under ``polygons`` is WKT rather than a path."""
    without_srid = SRID.sub("", text, count=1)
    return without_srid != text or _WKT.match(text) is not None


def _points(value: list[Any]) -> NDArray[np.float64] | None:
    """Points read all at once, (n, ordinates); None where one of them is no point."""
    if not all(isinstance(point, list) for point in value):
        return None
    if not set(map(type, chain.from_iterable(value))) <= _NUMERIC:
        return None
    try:
        return np.array(value, dtype=np.float64)
    except (ValueError, OverflowError):
        return None


def _is_point(value: list[Any]) -> bool:
    return (
        bool(value)
        and isinstance(value[0], list)
        and bool(value[0])
        and all(isinstance(v, str | float | int) and _is_number(v) for v in value[0])
    )


def _is_number(value: str | float) -> bool:
    try:
        float(value)
    except ValueError:
        return False
    return True


def _collect(parts: Sequence[Polygon | MultiPolygon]) -> Polygon | MultiPolygon:
    flat = [
        p for part in parts for p in parts_of(part) if isinstance(p, Polygon) and not p.is_empty
    ]
    return flat[0] if len(flat) == 1 else MultiPolygon(flat)


def parts_of(geometry: Any) -> list[Any]:
    """The points, lines and polygons of a geometry, however deeply it holds them."""
    if hasattr(geometry, "geoms"):
        return [part for member in geometry.geoms for part in parts_of(member)]
    return [geometry]


def _short(value: object) -> str:
    text = f"[{', '.join(map(str, value))}]" if isinstance(value, list) else repr(value)
    return text if len(text) <= 40 else text[:39] + "…"
