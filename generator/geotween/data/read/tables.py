"""Tables with geometry: what GDAL reads (through pyogrio), and GeoParquet (through pyarrow)."""

from __future__ import annotations

import codecs
import json
import math
import re
import warnings
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon, Polygon

from geotween.data.polygons import Feature
from geotween.data.read.archives import unpacked
from geotween.data.read.columns import Columns, identity
from geotween.data.read.held import GEOGRAPHIC
from geotween.data.read.kinds import (
    ARCHIVES,
    INCOMPLETE,
    PARQUET,
    POINTS,
    UnreadableError,
    check_kind,
)
from geotween.data.read.parse import LARGEST_COORDINATE, parts_of

# The folders of a path in a library's message: those of another machine, or nobody's concern.
_FOLDERS = re.compile(r"(?<![\w:/.])(?:[A-Za-z]:)?[\\/](?:[^\s'\"\\/:]+[\\/])+(?=[^\s'\"\\/])")


@dataclass(frozen=True, eq=False)
class Table:
    """Rows of a file: a geometry (object array, None where there is none) and attributes each.

    ``naming`` is the column with the features' names unless a source says another.
    """

    geometries: NDArray[np.object_]
    rows: list[dict[str, Any]]
    crs: str | None
    warnings: tuple[str, ...] = ()
    naming: str = "name"


def read_table(
    path: Path, layer: str | None = None, encoding: str | None = None, *, confined: bool = False
) -> Table:
    """The rows of a file with geometry, by its suffix.

    Where it is ``confined``, a file that may name others is refused.

    Raises
    ------
    UnreadableError
        Where the library for it is missing, or cannot make sense of the file.
    """
    try:
        check_kind(path, confined=confined)
        if path.suffix.lower() in ARCHIVES:
            with TemporaryDirectory() as folder:
                inner, layer = unpacked(path, layer, Path(folder))
                check_kind(inner, confined=confined)
                return _read(inner, layer, encoding, path.suffix)
        return _read(path, layer, encoding, path.suffix)
    except OSError as error:
        reason = str(error.strerror or error).lower()
        raise UnreadableError(f"cannot be read: {reason}") from None


def _read(path: Path, layer: str | None, encoding: str | None, suffix: str) -> Table:
    if path.suffix.lower() in PARQUET:
        return _parquet(path)
    return _gdal(path, layer, encoding, suffix)


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
    members = parts_of(geometry)
    parts = [part for part in members if isinstance(part, Polygon) and not part.is_empty]
    lines = sum(not isinstance(part, Polygon) for part in members)
    return (MultiPolygon(parts) if parts else None), lines


def _gdal(path: Path, layer: str | None, encoding: str | None, suffix: str) -> Table:
    try:
        import pyogrio
    except ImportError:
        message = f"{suffix or 'this'} files need the package pyogrio"
        raise UnreadableError(message, "pip install 'geotween[geo]'") from None
    where = str(path.resolve())  # never a name that GDAL takes for a driver or an address
    kind, options = path.suffix.lower(), {}
    try:
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            if kind == ".gml":  # to list its layers would leave a file beside it
                options = {"WRITE_GFS": "NO", "DOWNLOAD_SCHEMA": "NO"}
            else:
                layer = _layer(pyogrio.list_layers(where), layer, kind)
            meta, _, binary, fields = pyogrio.raw.read(
                where, layer=layer, encoding=_as_gdal_has_it(encoding), datetime_as_string=True,
                **options,
            )  # fmt: skip
            geometries = _from_binary(binary)
            said = [_shorn(str(item.message), path) for item in told]
            if any("More than one layer" in text for text in said):
                raise UnreadableError("the file has several layers: name one with layer:")
            if kind == ".fgb":
                _check_count(len(geometries), pyogrio.read_info(where)["features"])
    except UnreadableError:
        raise
    except UnicodeDecodeError as error:
        named = encoding or error.encoding.upper()
        message = f"the byte 0x{error.object[error.start]:02X} is not {named}"
        raise UnreadableError(message, "name its encoding, such as encoding: latin-1") from None
    except Exception as error:  # GDAL's readers raise many things on a broken file
        reason = _shorn(str(error), path).partition(";")[0].rstrip(". ")
        raise UnreadableError(f"cannot be read: {reason}", INCOMPLETE) from None
    rows = _rows(meta, fields) or [{} for _ in geometries]
    naming = "Name" if kind == ".kml" and "name" not in meta["fields"] else "name"
    return Table(geometries, rows, meta["crs"], tuple(dict.fromkeys(said)), naming)


def _rows(meta: dict[str, Any], fields: list[NDArray[Any]]) -> list[dict[str, Any]]:
    names = [str(name) for name in meta["fields"]]
    columns = [_values(v, f) for v, f in zip(fields, meta["ogr_subtypes"], strict=True)]
    return [dict(zip(names, values, strict=True)) for values in zip(*columns, strict=True)]


def _layer(listed: NDArray[np.object_], wanted: str | None, kind: str) -> str:
    # Tables without geometry, such as styles, are none.
    layers = [str(name) for name, geometry in listed if geometry is not None]
    if not layers:
        raise UnreadableError("the file has no geometry", POINTS if kind == ".csv" else "")
    if wanted is None and len(layers) == 1:
        return layers[0]
    if wanted in layers:
        return str(wanted)
    hint = f"there are {', '.join(layers)}"
    if wanted is None:
        raise UnreadableError("the file has several layers: name one with layer:", hint)
    raise UnreadableError(f'there is no layer "{wanted}"', hint)


def _as_gdal_has_it(encoding: str | None) -> str | None:
    """GDAL's name of an encoding of Python, which has more of them."""
    if encoding is None:
        return None
    try:
        name = codecs.lookup(encoding).name
    except LookupError:
        hint = "such as utf-8, latin-1, cp1252 or utf-16"
        raise UnreadableError(f"no encoding {encoding}", hint) from None
    return name.removesuffix("-sig").replace("_", "-").upper()


def _check_count(found: int, said: int) -> None:
    if found < said:
        raise UnreadableError(
            f"cannot be read: {found} of its {said} features are there", INCOMPLETE
        )


def _shorn(message: str, path: Path) -> str:
    """A library's message without the folders of paths."""
    return _FOLDERS.sub("", message.replace(f"{path.parent.resolve()}/", ""))


def _from_binary(binary: Any) -> NDArray[np.object_]:
    if binary is None:
        raise UnreadableError("the file has no geometry")
    shapes: NDArray[np.object_] = shapely.force_2d(shapely.from_wkb(binary))
    return shapes


def _values(column: NDArray[Any], subtype: str) -> list[Any]:
    """A column's values as Python's own; None where there is none."""
    values = [_present(value) for value in column.tolist()]
    if subtype == "OFSTBoolean":
        return [None if value is None else bool(value) for value in values]
    return values


def _present(value: Any) -> Any:
    return None if isinstance(value, float) and math.isnan(value) else value


def _parquet(path: Path) -> Table:
    try:
        from pyarrow import ArrowException, parquet
    except ImportError:
        hint = "pip install 'geotween[parquet]'"
        raise UnreadableError("GeoParquet files need the package pyarrow", hint) from None
    try:
        with parquet.ParquetFile(path) as file:
            table = file.read()
        about = json.loads((table.schema.metadata or {}).get(b"geo", b"null"))
        if about is None:
            raise UnreadableError("the file is Parquet, but not GeoParquet: it has no geometry")
        name, crs = _geometry_column(about)
        geometries = _from_binary(np.array(table[name].to_pylist(), dtype=object))
        rows = [
            {column: _present(value) for column, value in row.items()}
            for row in table.drop_columns([name]).to_pylist()
        ]
    except (
        ArrowException, OSError, KeyError, TypeError, ValueError, RecursionError,
        shapely.errors.GEOSException,
    ) as error:  # fmt: skip
        reason = _shorn((str(error) or type(error).__name__).splitlines()[0], path)
        raise UnreadableError(f"cannot be read: {reason}", INCOMPLETE) from None
    return Table(geometries, rows, crs)


def _geometry_column(about: Any) -> tuple[str, str | None]:
    """The column with the geometry, by GeoParquet's metadata, and its crs."""
    columns = about.get("columns") if isinstance(about, dict) else None
    name = about.get("primary_column") if isinstance(about, dict) else None
    column = columns.get(name) if isinstance(columns, dict) and isinstance(name, str) else None
    if not isinstance(name, str) or not isinstance(column, dict):
        message = "its metadata do not say which column is the geometry, as GeoParquet's do"
        raise UnreadableError(message)
    if column.get("encoding") != "WKB":
        raise UnreadableError(f"its geometry is encoded as {column.get('encoding')}, not as WKB")
    crs = column.get("crs", GEOGRAPHIC)
    if not isinstance(crs, dict | str | None):
        raise UnreadableError("its metadata name a crs that is no PROJJSON")
    return name, json.dumps(crs) if isinstance(crs, dict) else crs
