"""Sets of polygons written in every format that can be read, and what is read of them."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

import numpy as np
import pyarrow as pa
import pyarrow.parquet
import pyogrio
import pytest
import shapely
from hypothesis import strategies as st
from shapely.affinity import translate
from shapely.geometry import LineString, MultiPolygon, Point, Polygon

from geotween.data.load import load
from geotween.data.read.sources import Held, SourceReader
from geotween.scene.document import Document
from geotween.scene.errors import SceneError
from tests.data.shapes import as_geojson, polygons

Shape = Polygon | MultiPolygon
Columns = Mapping[str, Sequence[Any]]

TEXTS = ("geojson", "topojson", "wkt")
TABLES = ("gpkg", "shp", "zip", "fgb", "kml", "parquet")
FORMATS = TEXTS + TABLES
SIDECARS = (".shp", ".shx", ".dbf", ".prj", ".cpg")

LAYER = "held"
KML_TYPES = {bool: "bool", int: "int", float: "double"}


def write(
    path: Path, shapes: Sequence[Any], columns: Columns | None = None, **options: Any
) -> Path:
    """A file of some shapes (None is no geometry) and columns, by its suffix.

    ``options`` are those of ``pyogrio.raw.write``; ``crs`` is EPSG:4326 unless one is named.
    """
    kind, columns = path.suffix[1:], columns or {}
    if kind == "wkt":
        path.write_text("".join(f"{shape.wkt}\n" for shape in shapes), encoding="utf-8")
    elif kind in TEXTS:
        wanted = as_topology if kind == "topojson" else as_collection
        path.write_text(json.dumps(wanted(shapes, columns)), encoding="utf-8")
    elif kind == "kml":
        path.write_text(as_kml(shapes, columns), encoding="utf-8")
    elif kind == "parquet":
        _write_parquet(path, shapes, columns, **options)
    elif kind == "zip":
        inner = write(path.with_suffix(".shp"), shapes, columns, **options)
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            for suffix in SIDECARS:
                archive.write(inner.with_suffix(suffix), inner.with_suffix(suffix).name)
                inner.with_suffix(suffix).unlink()
    else:
        layer = {} if kind in ("shp", "fgb") else {"layer": LAYER}
        several = any(isinstance(shape, MultiPolygon) for shape in shapes)
        every = {
            "crs": "EPSG:4326", "geometry_type": "Polygon" if kind == "shp" else "Unknown",
            "promote_to_multi": several and kind == "fgb", **layer, **options,
        }  # fmt: skip
        with_areas = np.array([shapely.to_wkb(s) if s else None for s in shapes], dtype=object)
        fields = [_field(values) for values in columns.values()]
        data, masks = [f for f, _ in fields], [m for _, m in fields]
        pyogrio.raw.write(str(path), with_areas, data, list(columns), masks, **every)
    return path


def as_collection(shapes: Sequence[Any], columns: Columns | None = None) -> dict[str, Any]:
    """A GeoJSON FeatureCollection."""
    rows = _rows(len(shapes), columns or {})
    return {
        "type": "FeatureCollection",
        "features": [
            {"type": "Feature", "properties": row, "geometry": shape and as_geojson(shape)}
            for shape, row in zip(shapes, rows, strict=True)
        ],
    }


def as_topology(shapes: Sequence[Any], columns: Columns | None = None) -> dict[str, Any]:
    """A TopoJSON topology, each ring an arc of its own."""
    arcs: list[Any] = []
    geometries = []
    for shape, row in zip(shapes, _rows(len(shapes), columns or {}), strict=True):
        geometry = shape and as_geojson(shape)
        parts = geometry["coordinates"] if geometry else []
        numbers = []
        for rings in [parts] if geometry and geometry["type"] == "Polygon" else parts:
            numbers.append([[len(arcs) + i] for i in range(len(rings))])
            arcs += rings
        kind = geometry["type"] if geometry else None
        own = numbers[0] if kind == "Polygon" else numbers
        geometries.append({"type": kind, "properties": row, "arcs": own})
    held = {"type": "GeometryCollection", "geometries": geometries}
    return {"type": "Topology", "objects": {LAYER: held}, "arcs": arcs}


def as_kml(shapes: Sequence[Any], columns: Columns | None = None) -> str:
    """A KML document whose schema names the types of its columns."""
    columns = columns or {}
    fields, marks = "", []
    for name, values in columns.items():
        present = next((value for value in values if value is not None), "")
        kind = KML_TYPES.get(type(present), "string")
        fields += f'<SimpleField name="{name}" type="{kind}"/>'
    for shape, row in zip(shapes, _rows(len(shapes), columns), strict=True):
        told = "".join(
            f'<SimpleData name="{name}">{escape(str(value))}</SimpleData>'
            for name, value in row.items()
            if value is not None
        )
        about = f'<ExtendedData><SchemaData schemaUrl="#s">{told}</SchemaData></ExtendedData>'
        marks.append(f"<Placemark>{about}{_kml_geometry(shape)}</Placemark>")
    schema = f'<Schema name="s" id="s">{fields}</Schema>'
    folder = f"<Folder><name>{LAYER}</name>{''.join(marks)}</Folder>"
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n<kml xmlns="http://www.opengis.net/kml/2.2">'
        f"<Document>{schema}{folder}</Document></kml>\n"
    )


def _kml_geometry(shape: Any) -> str:
    if shape is None or isinstance(shape, LineString | Point):
        points = " ".join(f"{x!r},{y!r}" for x, y in shape.coords) if shape else ""
        name = type(shape).__name__
        return f"<{name}><coordinates>{points}</coordinates></{name}>" if shape else ""
    if not isinstance(shape, Polygon):
        return f"<MultiGeometry>{''.join(map(_kml_geometry, shape.geoms))}</MultiGeometry>"
    rings = [
        ("outerBoundaryIs", shape.exterior),
        *(("innerBoundaryIs", r) for r in shape.interiors),
    ]
    inside = "".join(f"<{n}>{_kml_geometry(LineString(ring))}</{n}>" for n, ring in rings)
    return f"<Polygon>{inside.replace('LineString', 'LinearRing')}</Polygon>"


def _write_parquet(
    path: Path, shapes: Sequence[Any], columns: Columns, crs: Any = "EPSG:4326"
) -> None:
    binary = [shapely.to_wkb(shape) if shape else None for shape in shapes]
    about: dict[str, Any] = {"encoding": "WKB", "geometry_types": []}
    if crs != "EPSG:4326":
        about["crs"] = crs
    geo = {"version": "1.0.0", "primary_column": "shape", "columns": {"shape": about}}
    arrays = {name: pa.array(list(values)) for name, values in columns.items()}
    table = pa.table({**arrays, "shape": pa.array(binary, pa.binary())})
    pyarrow.parquet.write_table(table.replace_schema_metadata({"geo": json.dumps(geo)}), path)


def _rows(count: int, columns: Columns) -> list[dict[str, Any]]:
    return [{name: values[i] for name, values in columns.items()} for i in range(count)]


def _field(values: Sequence[Any]) -> tuple[Any, Any]:
    """A column as pyogrio takes it: an array, and a mask of what is not there."""
    absent = np.array([value is None for value in values])
    present = next((value for value in values if value is not None), "")
    if isinstance(present, str):
        return np.array(list(values), dtype=object), absent
    kind: Any = type(present) if isinstance(present, bool | int | float) else "datetime64[D]"
    filled = [present if value is None else value for value in values]
    return np.array(filled, dtype=kind), absent


def told(path: Path, **options: Any) -> list[str]:
    """What is told of a scene that cannot be loaded: place, message, and a hint behind ``=``."""
    with pytest.raises(SceneError) as caught:
        load(path, **options)
    return [
        f"{Path(f.file).name}:{f.line}:{f.column}: {f.message}" + (f" = {f.hint}" if f.hint else "")
        for f in caught.value.faults
    ]


def read(path: Path, **words: Any) -> Held:
    """What a file holds; ``words`` are those of a source (key, class, where, ...)."""
    held, told = attempt(path, **words)
    assert told == []
    return held


def attempt(path: Path, **words: Any) -> tuple[Held, list[tuple[str, str]]]:
    """What a file holds, and what is told of it: message and hint."""
    reader = SourceReader(Document("scene.yaml", path.parent / "scene.yaml", ""))
    held = reader.polygons({"file": path.name, **words}, ("steps", 0, "polygons"))
    return held, [(fault.message, fault.hint) for fault in reader.faults]


@st.composite
def shapes(draw: st.DrawFn) -> Shape:
    """A polygon, some with a hole, or two of them side by side."""
    first = draw(polygons())
    if draw(st.booleans()):
        return first
    return MultiPolygon([first, translate(draw(polygons()), 110)])
