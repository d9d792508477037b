"""Kinds of files: what a file is by its suffix, and whether its first bytes say the same.

GDAL goes by what is in a file, and follows some of them to other files and to the network. So no
file is handed to it that is not of the kind that its suffix says.
"""

from __future__ import annotations

import re
import sqlite3
from contextlib import closing, suppress
from pathlib import Path
from xml.parsers import expat

JSON = (".geojson", ".json", ".topojson")
WKT = (".wkt",)
PARQUET = (".parquet", ".geoparquet")
ARCHIVES = (".zip", ".kmz")
PACKED = (".gpkg", ".shp", ".fgb", ".kml", *PARQUET)  # what an archive may hold
TABLES = (*PACKED, ".gml", *ARCHIVES)

INCOMPLETE = "is the file complete, and of the kind that its name says?"
POINTS = "points with times make hotspots: {file: …, lon: …, lat: …, time: …}"

_HEAD = 65536  # bytes: more than any library looks at to tell what a file is
_MAGIC = {
    ".gpkg": b"SQLite format 3\0",
    ".shp": (9994).to_bytes(4, "big"),
    ".fgb": b"fgb\x03",
    ".zip": b"PK",
    ".kmz": b"PK",
    ".parquet": b"PAR1",
    ".geoparquet": b"PAR1",
}
_ROOTS = {".kml": "kml", ".gml": "FeatureCollection"}
# What stands for other files, or for a service.
_STAND_IN = re.compile(
    rb"<OGR\w*DataSource|<OGRVRT|gdal_streamed_alg|<(\w+:)?(WFS_)?Capabilities", re.IGNORECASE
)
_VIRTUAL_TABLE = re.compile(r"virtual(\s|/\*.*?\*/|--[^\n]*\n)+table", re.IGNORECASE | re.DOTALL)
_INDEX = re.compile(r"\s*CREATE VIRTUAL TABLE (\"[^\"]*\"|\w+) USING (rtree|fts[345])\b", re.I)


class UnreadableError(Exception):
    """A file that cannot be read as polygons; the message is for its author."""

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.hint = hint


def check_kind(path: Path, *, confined: bool = False) -> None:
    """Whether a table's file is of the kind that its suffix says.

    Where it is ``confined``, kinds that may name other files are refused.

    Raises
    ------
    UnreadableError
        Where it is not, or stands for other files.
    OSError
        Where it cannot be opened.
    """
    kind = path.suffix.lower()
    size = path.stat().st_size
    with path.open("rb") as file:
        head = file.read(_HEAD)
    if not size:
        raise UnreadableError("the file is empty")
    if _STAND_IN.search(head):
        hint = "name the files that it refers to"
        raise UnreadableError("a virtual dataset is no file of polygons", hint)
    if confined and (kind not in TABLES or kind == ".gml"):
        hint = POINTS if kind == ".csv" else f"what may be: {', '.join((*JSON, *WKT, *PACKED))}"
        raise UnreadableError(f"{kind or 'such'} files are not read in a sandbox", hint)
    if kind not in TABLES and head.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"{"):
        raise UnreadableError("the file is JSON", "GeoJSON and TopoJSON need the suffix .json")
    if not head.startswith(_MAGIC.get(kind, b"")) or (
        kind in _ROOTS and _root(head) != _ROOTS[kind]
    ):
        raise UnreadableError(f"cannot be read: it is no {kind} file", INCOMPLETE)
    if kind == ".shp":
        _check_length(head, size)
    if kind == ".gpkg":
        _check_tables(path)


def _root(head: bytes) -> str:
    """The local name of an XML's root; empty where it is no XML, or defines entities."""
    names: list[str] = []
    parser = expat.ParserCreate()
    parser.StartElementHandler = lambda name, _: names.append(name)
    parser.StartDoctypeDeclHandler = lambda *_: names.append("")
    # What follows the root may be broken: GDAL tells.
    with suppress(expat.ExpatError, LookupError, ValueError):
        parser.Parse(head, False)
    return names[0].rpartition(":")[2] if names else ""


def _check_length(head: bytes, size: int) -> None:
    length = 2 * int.from_bytes(head[24:28], "big")
    if size < length:
        raise UnreadableError(
            f"cannot be read: {size:,} of its {length:,} bytes are there", INCOMPLETE
        )


def _check_tables(path: Path) -> None:
    """Refuse a GeoPackage with virtual tables other than indices: some read files of any name."""
    query = "SELECT sql FROM sqlite_master WHERE sql LIKE '%virtual%'"
    try:
        with closing(sqlite3.connect(f"{path.resolve().as_uri()}?mode=ro", uri=True)) as base:
            made = [str(sql) for (sql,) in base.execute(query)]
    except (sqlite3.Error, UnicodeDecodeError) as error:  # messages quote what is damaged
        reason = str(error) if isinstance(error, sqlite3.Error) else "malformed database schema"
        raise UnreadableError(f"cannot be read: {reason}", INCOMPLETE) from None
    if not all(map(_INDEX.match, filter(_VIRTUAL_TABLE.search, made))):
        raise UnreadableError("a table that stands for another file is no table of polygons")
