"""Tables with geometry: what GDAL reads (through pyogrio), and GeoParquet (through pyarrow)."""

from __future__ import annotations

import json
import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon, Polygon

from geotween.data.columns import Columns, identity
from geotween.data.parse import LARGEST_COORDINATE
from geotween.data.polygons import Feature

PARQUET = (".parquet", ".geoparquet")
# A file of this kind names others, and may name them anywhere.
_VIRTUAL = b"<OGRVRT"


class UnreadableError(Exception):
    """A file that cannot be read as polygons; the message is for its author."""

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.hint = hint


@dataclass(frozen=True, eq=False)
class Table:
    """Rows of a file: a geometry (object array, None where there is none) and attributes each."""

    geometries: NDArray[np.object_]
    rows: list[dict[str, Any]]
    crs: str | None
    warnings: tuple[str, ...] = ()


def read_table(path: Path, layer: str | None = None, encoding: str | None = None) -> Table:
    """The rows of a file with geometry, by its suffix.

    Raises
    ------
    UnreadableError
        Where the library for it is missing, or cannot make sense of the file.
    """
    if path.stat().st_size == 0:
        raise UnreadableError("the file is empty")
    if path.suffix.lower() in PARQUET:
        return _parquet(path)
    with path.open("rb") as file:
        if _VIRTUAL in file.read(1024):
            hint = "name the files that it refers to"
            raise UnreadableError("a virtual dataset is no file of polygons", hint)
    return _gdal(path, layer, encoding)


def table_features(table: Table, columns: Columns) -> tuple[list[Feature], int, list[str]]:
    """The features of a table's polygons, how many rows have no area, and what is wrong."""
    wrong: list[str] = []
    coordinates, owner = shapely.get_coordinates(table.geometries, return_index=True)
    wild = np.unique(owner[~(np.abs(coordinates) <= LARGEST_COORDINATE).all(axis=1)])
    if len(wild):
        wrong.append(f"row {wild[0] + 1} has coordinates beyond any map")
    features, skipped = [], 0
    for number, (geometry, row) in enumerate(zip(table.geometries, table.rows, strict=True)):
        shape, others = _polygonal(geometry)
        skipped += others
        if shape is None:
            continue

        def report(_: str, message: str, number: int = number) -> None:
            wrong.append(f"row {number + 1}: {message}")

        names = identity(row, columns, report)
        features.append(Feature(shape, *names, position=number, attributes=row))
    return features, skipped, wrong


def _polygonal(geometry: Any) -> tuple[Polygon | MultiPolygon | None, int]:
    """A geometry's polygons, and how many parts without area it has beside them."""
    if geometry is None:
        return None, 1
    if isinstance(geometry, Polygon | MultiPolygon):
        return (None, 0) if geometry.is_empty else (geometry, 0)
    members = shapely.get_parts(shapely.get_parts(geometry))
    parts = [part for part in members if isinstance(part, Polygon) and not part.is_empty]
    lines = sum(not isinstance(part, Polygon) for part in members)
    return (MultiPolygon(parts) if parts else None), lines


def _gdal(path: Path, layer: str | None, encoding: str | None) -> Table:
    try:
        import pyogrio
    except ImportError:
        message = f"{path.suffix or 'this'} files need the package pyogrio"
        raise UnreadableError(message, "pip install 'geotween[geo]'") from None
    where = str(path.resolve())  # never a name that GDAL takes for a driver or an address
    try:
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            # Tables without geometry, such as styles, are none.
            layers = [str(name) for name, kind in pyogrio.list_layers(where) if kind is not None]
            chosen = _layer(layers, layer)
            meta, _, binary, fields = pyogrio.raw.read(
                where, layer=chosen, encoding=encoding, datetime_as_string=True
            )
            geometries = _from_binary(binary)
    except UnreadableError:
        raise
    except UnicodeDecodeError as error:
        message = f"the byte 0x{error.object[error.start]:02X} is not {error.encoding.upper()}"
        raise UnreadableError(message, "name its encoding, such as encoding: latin-1") from None
    except Exception as error:  # GDAL's readers raise many things on a broken file
        reason = str(error).partition(";")[0].replace(where, path.name).rstrip(". ")
        hint = "is the file complete, and of the kind that its name says?"
        raise UnreadableError(f"cannot be read: {reason}", hint) from None
    names, flags = [str(name) for name in meta["fields"]], meta["ogr_subtypes"]
    columns = [_values(v, f) for v, f in zip(fields, flags, strict=True)]
    count = len(geometries)
    rows = [dict(zip(names, values, strict=True)) for values in zip(*columns, strict=True)]
    said = tuple(dict.fromkeys(str(item.message).replace(where, path.name) for item in told))
    return Table(geometries, rows or [{} for _ in range(count)], meta["crs"], said)


def _layer(layers: Sequence[str], wanted: str | None) -> str | None:
    if not layers:
        raise UnreadableError("the file has no geometry")
    if wanted is None and len(layers) == 1:
        return layers[0]
    if wanted in layers:
        return wanted
    hint = f"there are {', '.join(layers)}"
    if wanted is None:
        raise UnreadableError("the file has several layers: name one with layer:", hint)
    raise UnreadableError(f'there is no layer "{wanted}"', hint)


def _from_binary(binary: Any) -> NDArray[np.object_]:
    if binary is None:
        raise UnreadableError("the file has no geometry")
    shapes: NDArray[np.object_] = shapely.force_2d(shapely.from_wkb(binary))
    return shapes


def _values(column: NDArray[Any], subtype: str) -> list[Any]:
    """A column's values as Python's own; None where there is none."""
    values: list[Any] = column.tolist()
    if subtype == "OFSTBoolean":
        return [None if value is None else bool(value) for value in values]
    return [None if isinstance(v, float) and math.isnan(v) else v for v in values]


def _parquet(path: Path) -> Table:
    try:
        from pyarrow import ArrowException, parquet
    except ImportError:
        hint = "pip install 'geotween[parquet]'"
        raise UnreadableError("GeoParquet files need the package pyarrow", hint) from None
    try:
        table = parquet.read_table(path)
        about = json.loads((table.schema.metadata or {}).get(b"geo", b"null"))
        if about is None:
            raise UnreadableError("the file is Parquet, but not GeoParquet: it has no geometry")
        name = about["primary_column"]
        column = about["columns"][name]
        if column.get("encoding") != "WKB":
            message = f"its geometry is encoded as {column.get('encoding')}, not as WKB"
            raise UnreadableError(message)
        geometries = _from_binary(np.array(table[name].to_pylist(), dtype=object))
        rows = table.drop_columns([name]).to_pylist()
    except (ArrowException, OSError, KeyError, ValueError, shapely.errors.GEOSException) as error:
        reason = str(error).splitlines()[0].replace(str(path), path.name)
        raise UnreadableError(f"cannot be read: {reason}") from None
    crs = column.get("crs", "OGC:CRS84")
    return Table(geometries, rows, json.dumps(crs) if isinstance(crs, dict) else crs)
