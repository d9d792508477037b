"""Sources: the polygons that a scene names, in its own text or in files, as features."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from geotween.data.columns import Columns, SelectionError, names_of, select
from geotween.data.parse import SRID, Parser, is_wkt
from geotween.data.polygons import Feature
from geotween.data.problems import Problem
from geotween.data.tables import UnreadableError, read_table, table_features
from geotween.data.topojson import TopologyError, to_geojson
from geotween.scene.document import Document, Location, read_json, read_text
from geotween.scene.errors import Fault, SceneError
from geotween.scene.model import Source
from geotween.scene.read import validated

JSON = (".geojson", ".json", ".topojson")
WKT = (".wkt",)
TABLES = (".gpkg", ".shp", ".zip", ".fgb", ".kml", ".kmz", ".gml", ".parquet", ".geoparquet")
_PATTERN = re.compile(r"[*?\[]")


@dataclass(frozen=True, eq=False)
class Held:
    """What a source holds, before it is made valid.

    ``name`` is the file as the scene names it, empty for coordinates in the scene itself; ``at``
    is where the scene does so. ``words`` tell what ``crs`` is. ``skipped`` counts geometries
    without area. ``lonlat`` is for formats whose coordinates are longitude and latitude unless
    they say otherwise, ``wound`` for those that say which way rings run.
    """

    features: list[Feature]
    at: Location = ()
    name: str = ""
    crs: str | None = None
    words: str = ""
    skipped: int = 0
    lonlat: bool = False
    wound: bool = False
    problems: tuple[Problem, ...] = field(default=())


class SourceReader:
    """Reads what a scene names; what is wrong goes to ``faults``.

    With a ``sandbox`` no file outside of that folder is read.
    """

    def __init__(self, document: Document, sandbox: Path | None = None) -> None:
        self.document = document
        self.sandbox = sandbox
        self.faults: list[Fault] = []

    def members(self, holder: Any, name: str, prefix: Location = ()) -> dict[int, Held]:
        """The polygons of each member of a list (steps, layers) that has some."""
        members = holder.get(name) if isinstance(holder, dict) else None
        found: dict[int, Held] = {}
        for index, member in enumerate(members if isinstance(members, list) else []):
            if isinstance(member, dict) and "polygons" in member:
                place = (*prefix, name, index, "polygons")
                found[index] = self.polygons(member["polygons"], place)
        return found

    def polygons(self, value: Any, at: Location) -> Held:
        """What a ``polygons`` value holds."""
        if isinstance(value, str) and not is_wkt(value):
            return self.file(Source.model_construct(file=value), at)
        if isinstance(value, dict) and "file" in value and "type" not in value:
            source, found = validated(self.document, Source, value, at)
            self.faults += found
            return self.file(source, (*at, "file")) if source else Held([])
        parser = Parser(lambda where, *words: self._report(self.document, (*at, *where), *words))
        features = parser.features(value)
        srid = SRID.match(value) if isinstance(value, str) else None
        return Held(
            features,
            at,
            crs=f"EPSG:{srid[1]}" if srid else None,
            skipped=parser.skipped,
            wound=isinstance(value, dict),
        )

    def file(self, source: Source, at: Location) -> Held:
        """What a file holds of a source; empty where that cannot be read."""
        path = self.path(source.file, at)
        return self.read(path, source.file, source, at) if path else Held([])

    def files(self, source: Source, at: Location) -> list[tuple[Path, Held]]:
        """What each file of a source holds, that may name a folder or a pattern."""
        path = self.path(source.file, at, pattern=True)
        if path is None:
            return []
        paths = [path] if _is_file(path) else self._several(path, source.file, at)
        return [(one, self.read(one, _shown(one, path, source.file), source, at)) for one in paths]

    def read(self, path: Path, name: str, source: Source, at: Location) -> Held:
        """What one file holds, its columns and its selection as the source says."""
        named_by = self.document.fault(at, "")
        columns = Columns(source.key or "key", source.class_ or "class", source.name or "name")
        suffix = path.suffix.lower()
        try:
            if suffix in JSON or suffix in WKT or not _is_file(path):
                text = read_text(path, name, named_by=named_by, encoding=source.encoding)
                opened = Document(str(path), path, text)
                held = self._wkt(opened) if suffix in WKT else self._json(opened, source, columns)
            else:
                held = self._table(path, source, columns)
        except SceneError as error:
            self.faults += error.faults
            return Held([])
        except UnreadableError as error:
            self._report(self.document, at, f"{name}: {error.message}", error.hint)
            return Held([])
        held = replace(held, at=at, name=name, crs=held.crs or source.crs)
        self._check_columns(held, source)
        return self._selected(held, source)

    def path(self, name: str, at: Location, *, pattern: bool = False) -> Path | None:
        """The path of a name, relative to the scene; None where the sandbox forbids it."""
        path = self.document.path.parent / name
        if self.sandbox is not None:
            fixed = path
            while pattern and _PATTERN.search(str(fixed)):
                fixed = fixed.parent
            if not fixed.resolve().is_relative_to(self.sandbox.resolve()):
                hint = f"only files in {self.sandbox} may be read here"
                self._report(self.document, at, f"{name} lies outside of the sandbox", hint)
                return None
        return path

    def _several(self, path: Path, name: str, at: Location) -> list[Path]:
        """The files of a folder, of its most frequent format, or those that fit a pattern."""
        known = (*JSON, *WKT, *TABLES)
        if path.is_dir():
            there = [p for p in sorted(path.iterdir()) if p.suffix.lower() in known]
            suffixes = [p.suffix.lower() for p in there]
            usual = max(dict.fromkeys(suffixes), key=suffixes.count, default="")
            found = [p for p in there if p.suffix.lower() == usual]
        elif _PATTERN.search(name):
            base = path.anchor or "."
            found = sorted(p for p in Path(base).glob(_relative(path, base)) if p.is_file())
        else:
            return [path]  # reading it tells what is wrong
        if not found:
            hint = "paths are relative to the scene file"
            self._report(self.document, at, f"no file of polygons is at {name}", hint)
        if self.sandbox is not None:
            inside = self.sandbox.resolve()
            found = [p for p in found if p.resolve().is_relative_to(inside)]
        return sorted(found, key=_natural)

    def _json(self, source: Document, said: Source, columns: Columns) -> Held:
        value = read_json(source)
        parser = Parser(lambda where, *words: self._report(source, where, *words), columns)
        kind = value.get("type") if isinstance(value, dict) else None
        try:
            if kind == "Topology":
                value = to_geojson(value, said.layer)
                parser.report = lambda _, *words: self._report(source, (), *words)
            features = parser.geojson(value)
        except TopologyError as error:
            raise SceneError([source.fault(error.location, str(error), error.hint)]) from None
        except RecursionError:
            raise SceneError([source.fault((), "nested too deeply")]) from None
        wound = kind != "Topology"
        crs = _crs_member(value)
        return Held(features, crs=crs, skipped=parser.skipped, lonlat=True, wound=wound)

    def _wkt(self, source: Document) -> Held:
        """One geometry a line."""
        parser = Parser(lambda at, *words: self._report(source, at, *words))
        features = []
        for number, line in enumerate(source.lines, start=1):
            if line.strip():

                def report(_: Location, *words: str, number: int = number) -> None:
                    self.faults.append(source.fault_at(number, 1, *words))

                parser.report = report
                features += parser.features(line)
        srid = SRID.match(source.text)
        crs = f"EPSG:{srid[1]}" if srid else None
        return Held(features, crs=crs, skipped=parser.skipped)

    def _table(self, path: Path, source: Source, columns: Columns) -> Held:
        table = read_table(path, source.layer, source.encoding)
        features, skipped, wrong = table_features(table, columns)
        if wrong:
            more = f" (and {len(wrong) - 1} more)" if len(wrong) > 1 else ""
            raise UnreadableError(wrong[0] + more)
        problems = (Problem("source", "note", f"{path.name}: {text}") for text in table.warnings)
        return Held(features, crs=table.crs, skipped=skipped, problems=tuple(problems))

    def _check_columns(self, held: Held, source: Source) -> None:
        """Report columns that the source names and no feature has."""
        if held.features:
            named = {"key": source.key, "class": source.class_, "name": source.name}
            self.check_columns(held, named)

    def check_columns(self, held: Held, named: dict[str, str | None]) -> None:
        """Report columns that are named but not there, by the word that names them."""
        known = names_of([feature.attributes for feature in held.features])
        for word, column in named.items():
            if column is not None and column not in known:
                place = self._beside(held.at, word)
                message = f'{held.name} has no column "{column}"'
                self._report(self.document, place, message, there_are(known))

    def _selected(self, held: Held, source: Source) -> Held:
        if source.where is None or not held.features:
            return held
        rows = [feature.attributes for feature in held.features]
        place = self._beside(held.at, "where")
        try:
            kept = select(rows, source.where)
        except SelectionError as error:
            self._report(self.document, place, f'"where": {error}', there_are(names_of(rows)))
            return held
        problems = held.problems
        if not kept:
            message = f'"where" selects none of the {len(rows)} features of {held.name}'
            problems = (*problems, Problem("no selection", "warning", message))
        return replace(held, features=[held.features[i] for i in kept], problems=problems)

    def _beside(self, at: Location, word: str) -> Location:
        """The place of another word of a source whose file stands at a place."""
        return (*at[:-1], word) if at and at[-1] == "file" else at

    def _report(self, document: Document, at: Location, message: str, hint: str = "") -> None:
        self.faults.append(document.fault(at, message, hint))


def there_are(columns: Sequence[str]) -> str:
    """A hint that lists columns."""
    return f"there are {', '.join(columns)}" if columns else "there are no columns"


def _crs_member(value: dict[str, Any]) -> str | None:
    """The name in a GeoJSON's ``crs``, which RFC 7946 did away with and many files have."""
    member = value.get("crs") if isinstance(value, dict) else None
    properties = member.get("properties") if isinstance(member, dict) else None
    name = properties.get("name") if isinstance(properties, dict) else None
    return name if isinstance(name, str) else None


def _shown(path: Path, base: Path, name: str) -> str:
    """What to call a file: as the scene names it, or by its own name in the folder named."""
    return name if path == base else path.name


def _relative(path: Path, base: str) -> str:
    return str(path.relative_to(base)) if path.is_absolute() else str(path)


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):  # a name that no file can have
        return False


def _natural(path: Path) -> list[tuple[bool, int, str]]:
    """Names in the order of the numbers in them: 2 before 10."""
    parts = re.split(r"(\d+)", path.name)
    return [(part.isdigit(), int(part) if part.isdigit() else 0, part) for part in parts]
