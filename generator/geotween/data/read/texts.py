"""Text formats: the features of GeoJSON, TopoJSON and WKT files, with faults at their places."""

from __future__ import annotations

from typing import Any

from geotween.data.read.columns import Columns
from geotween.data.read.held import Held
from geotween.data.read.parse import SRID, Parser
from geotween.data.read.topojson import LayerError, TopologyError, to_geojson
from geotween.scene.document import Document, Location
from geotween.scene.errors import Fault, SceneError


def json_features(
    source: Document, value: Any, layer: str | None, columns: Columns, faults: list[Fault]
) -> Held:
    """The features of GeoJSON or TopoJSON; single faults go to ``faults``.

    Raises
    ------
    LayerError
        Where a topology has no such layer, or several and none is named.
    SceneError
        Where it cannot be read at all.
    """
    decoded = isinstance(value, dict) and value.get("type") == "Topology"

    def report(at: Location, *words: str) -> None:
        # Places of what was decoded are not those in the file.
        faults.append(source.fault(() if decoded else at, *words))

    parser = Parser(report, columns)
    try:
        features = parser.geojson(to_geojson(value, layer) if decoded else value)
    except LayerError:
        raise
    except TopologyError as error:
        fault = source.fault(error.location, error.message, error.hint)
        raise SceneError([fault]) from None
    except RecursionError:
        raise SceneError([source.fault((), "nested too deeply")]) from None
    return Held(
        features,
        crs=_crs_member(value),
        skipped=parser.skipped,
        lonlat=True,
        wound=not decoded,
    )


def wkt_features(source: Document, faults: list[Fault]) -> Held:
    """The features of WKT, one geometry a line; single faults go to ``faults``.

    Raises
    ------
    SceneError
        Where the file is empty.
    """
    if not source.text.strip():
        raise SceneError([source.fault_at(1, 1, "the file is empty")])
    parser = Parser(lambda *_: None)
    features = []
    for number, line in enumerate(source.lines, start=1):

        def report(_: Location, *words: str, number: int = number) -> None:
            faults.append(source.fault_at(number, 1, *words))

        parser.report = report
        features += parser.features(line) if line.strip() else []
    srid = SRID.match(source.text)
    crs = f"EPSG:{srid[1]}" if srid else None
    return Held(features, crs=crs, skipped=parser.skipped)


def _crs_member(value: Any) -> str | None:
    """The name in a GeoJSON's ``crs``, which RFC 7946 did away with and many files have."""
    member = value.get("crs") if isinstance(value, dict) else None
    properties = member.get("properties") if isinstance(member, dict) else None
    name = properties.get("name") if isinstance(properties, dict) else None
    return name if isinstance(name, str) else None
