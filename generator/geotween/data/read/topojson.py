"""TopoJSON to GeoJSON: arcs that polygons share, put together to rings."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from geotween.scene.document import Location
from geotween.scene.errors import did_you_mean

Json = dict[str, Any]
Points = NDArray[np.float64]

_FLAT_TYPES = ("Point", "MultiPoint", "LineString", "MultiLineString", "Polygon", "MultiPolygon")
_TYPES = (*_FLAT_TYPES, "GeometryCollection")


class TopologyError(ValueError):
    """A document that is no TopoJSON: what is wrong, where in it, and how to mend it."""

    def __init__(self, message: str, location: Location = (), hint: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.location = location
        self.hint = hint


class LayerError(TopologyError):
    """No object is named where there are several, or one that is not there."""


def to_geojson(topology: Json, object_name: str | None = None) -> Json:
    """One object of a topology as a GeoJSON FeatureCollection, one feature per geometry.

    Each arc is decoded once, so that a border is the same to the last bit in the polygons on both
    of its sides. A ring of fewer than three different points, as quantization leaves them of tiny
    islands, is left out; a polygon of which nothing remains has null as geometry.

    Parameters
    ----------
    topology
        The document, parsed; quantized (with ``transform``) or not.
    object_name
        Which of its objects; needed where it has several.

    Raises
    ------
    TopologyError
        Where the document is not as the specification has it.
    LayerError
        Where it has several objects and none is named, or has no such object.

    Notes
    -----
    The TopoJSON Format Specification 1.0, https://github.com/topojson/topojson-specification.
    Linear in the number of positions.
    """
    if not isinstance(topology, dict) or topology.get("type") != "Topology":
        message = 'TopoJSON begins with {"type": "Topology", ...}'
        raise TopologyError(message, ("type",) if isinstance(topology, dict) else ())
    name, content = _chosen(topology.get("objects"), object_name)
    decoder = _Decoder(topology)
    at: Location = ("objects", name)
    if not isinstance(content, dict):
        raise TopologyError("expected a geometry object", at)
    members, places = [content], [at]
    if content.get("type") == "GeometryCollection":
        members = decoder.members(content, at)
        places = [(*at, "geometries", index) for index in range(len(members))]
    features = [decoder.feature(m, place) for m, place in zip(members, places, strict=True)]
    return {"type": "FeatureCollection", "features": features}


def _chosen(objects: Any, name: str | None) -> tuple[str, Any]:
    if not isinstance(objects, dict) or not objects:
        hint = '{"objects": {"states": {"type": "GeometryCollection", ...}}}'
        raise TopologyError('a Topology needs "objects"', ("objects",), hint)
    if name is None and len(objects) > 1:
        message = "the file has several layers: name one with layer:"
        raise LayerError(message, ("objects",), f"there are {', '.join(objects)}")
    if name is None:
        name = next(iter(objects))
    elif name not in objects:
        message = f'there is no layer "{name}"'
        raise LayerError(message, ("objects",), did_you_mean(name, list(objects)))
    return name, objects[name]


class _Decoder:
    """The geometries of one topology; its arcs are decoded once."""

    def __init__(self, topology: Json) -> None:
        self.scale, self.translate = _transform(topology.get("transform"))
        self.quantized = topology.get("transform") is not None
        arcs = topology.get("arcs")
        if not isinstance(arcs, list):
            raise TopologyError('a Topology needs a list "arcs"', ("arcs",))
        self.arcs = [self._arc(arc, ("arcs", index)) for index, arc in enumerate(arcs)]

    def feature(self, value: Any, at: Location) -> Json:
        geometry = self.geometry(value, at)  # first, as it checks that this is a mapping
        found: Json = {"type": "Feature", "properties": value.get("properties")}
        if "id" in value:
            found["id"] = value["id"]
        return {**found, "geometry": geometry}

    def geometry(self, value: Any, at: Location) -> Json | None:
        if not isinstance(value, dict) or "type" not in value:
            raise TopologyError("expected a geometry object", at, '{"type": "Polygon", "arcs": ..}')
        kind = value["type"]
        if kind is None:
            return None
        if kind == "GeometryCollection":
            members = self.members(value, at)
            parts = [self.geometry(m, (*at, "geometries", i)) for i, m in enumerate(members)]
            return {"type": kind, "geometries": [part for part in parts if part is not None]}
        if kind not in _FLAT_TYPES:
            message = f'"{kind}" is no type of TopoJSON'
            raise TopologyError(message, (*at, "type"), did_you_mean(str(kind), _TYPES))
        source = "coordinates" if kind.endswith("Point") else "arcs"
        if not isinstance(value.get(source), list):
            raise TopologyError(f'a {kind} needs a list "{source}"', (*at, source))
        coordinates = self._coordinates(kind, value[source], (*at, source))
        if kind.endswith("Polygon") and not coordinates:
            return None
        return {"type": kind, "coordinates": coordinates}

    def _coordinates(self, kind: str, value: Any, at: Location) -> list[Any]:
        match kind:
            case "Point":
                return self._point(value, at)
            case "MultiPoint":
                return _each(value, at, self._point)
            case "LineString":
                return self._line(value, at)
            case "MultiLineString":
                return _each(value, at, self._line)
            case "Polygon":
                return self._polygon(value, at)
            case _:
                return [rings for rings in _each(value, at, self._polygon) if rings]

    def members(self, value: Json, at: Location) -> list[Any]:
        members = value.get("geometries")
        if not isinstance(members, list):
            message = 'a GeometryCollection needs a list "geometries"'
            raise TopologyError(message, (*at, "geometries"))
        return members

    def _arc(self, value: Any, at: Location) -> Points:
        points = _numbers(value, at)
        if len(points) < 2:
            raise TopologyError(f"an arc needs two positions, not {len(points)}", at)
        return self._placed(points.cumsum(axis=0) if self.quantized else points, at)

    def _placed(self, points: Points, at: Location) -> Points:
        with np.errstate(over="ignore", invalid="ignore"):  # what overflows is met just below
            placed = points * self.scale + self.translate
        if not np.isfinite(placed).all():
            raise TopologyError("expected finite coordinates", at)
        return placed

    def _point(self, value: Any, at: Location) -> list[Any]:
        return _listed(self._placed(_numbers([value], at), at))[0]  # type: ignore[no-any-return]

    def _line(self, value: Any, at: Location) -> list[Any]:
        return _listed(self._joined(value, at))

    def _polygon(self, value: Any, at: Location) -> list[Any]:
        """The rings of a polygon, closed; none where its outer ring has no area."""
        rings = _each(value, at, self._ring)
        if not rings or _collapsed(rings[0]):
            return []
        return [_listed(ring) for ring in rings if not _collapsed(ring)]

    def _ring(self, value: Any, at: Location) -> Points:
        ring = self._joined(value, at)
        if len(ring) and (ring[0] != ring[-1]).any():
            raise TopologyError("the arcs of this ring do not close it", at)
        return ring

    def _joined(self, value: Any, at: Location) -> Points:
        """Arcs one after the other, (n, 2); where two meet, the position counts once."""
        arcs = _each(value, at, self._directed)
        for index, (before, after) in enumerate(pairwise(arcs), start=1):
            if (before[-1] != after[0]).any():
                message = "this arc does not begin where the one before ends"
                raise TopologyError(message, (*at, index))
        return np.concatenate([a[:-1] for a in arcs[:-1]] + arcs[-1:]) if arcs else np.empty((0, 2))

    def _directed(self, index: Any, at: Location) -> Points:
        """An arc by its number; ~i, which is -1 - i, is arc i reversed."""
        if not isinstance(index, int) or isinstance(index, bool):
            raise TopologyError(f"expected the number of an arc, not {index!r}", at)
        number = ~index if index < 0 else index
        if number >= len(self.arcs):
            message = f"there is no arc {number}"
            raise TopologyError(message, at, f"the topology has {len(self.arcs)}, counted from 0")
        return self.arcs[number][::-1] if index < 0 else self.arcs[number]


def _each(values: Any, at: Location, read: Callable[[Any, Location], Any], /) -> list[Any]:
    if not isinstance(values, list):
        raise TopologyError(f"expected a list, not {values!r}", at)
    return [read(value, (*at, index)) for index, value in enumerate(values)]


def _listed(points: Points) -> list[Any]:
    return cast("list[Any]", points.tolist())


def _collapsed(ring: Points) -> bool:
    return len(ring) < 4 or len(np.unique(ring, axis=0)) < 3


def _transform(value: Any) -> tuple[Points, Points]:
    if value is None:
        return np.ones(2), np.zeros(2)
    hint = '{"transform": {"scale": [0.01, 0.01], "translate": [-180, -90]}}'
    found = []
    for name in ("scale", "translate"):
        pair = value.get(name) if isinstance(value, dict) else None
        at = ("transform", name)
        if not isinstance(pair, list) or len(pair) != 2:
            raise TopologyError(f'a transform needs two numbers "{name}"', at, hint)
        found.append(_numbers([pair], at)[0])
    return found[0], found[1]


def _numbers(positions: Any, at: Location) -> Points:
    """Positions as (n, 2); further ordinates are dropped."""
    try:
        points = np.array([position[:2] for position in positions])
    except (TypeError, ValueError, KeyError):
        points = np.empty(0)
    shaped = points.ndim == 2 and points.shape[1] == 2 and points.dtype.kind in "iuf"
    if not shaped or not np.isfinite(points).all():
        raise TopologyError("expected positions [x, y] of finite numbers", at)
    return points.astype(np.float64)
