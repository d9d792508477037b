"""Sources: the polygons that a scene names, in its own text or in files, as features."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from geotween.data.problems import Problem
from geotween.data.read.columns import Columns, SelectionError, names_of, select, unknown_words
from geotween.data.read.held import Held as Held
from geotween.data.read.kinds import JSON, PARQUET, WKT, UnreadableError
from geotween.data.read.parse import SRID, Parser, is_wkt
from geotween.data.read.paths import (
    ForbiddenError,
    check_inside,
    fixed_part,
    is_file,
    is_pattern,
    several,
    with_companions,
)
from geotween.data.read.tables import Table, read_table, table_features
from geotween.data.read.texts import json_features, wkt_features
from geotween.data.read.topojson import LayerError
from geotween.scene.document import Document, Location, read_json, read_text
from geotween.scene.errors import Fault, SceneError
from geotween.scene.model import Source
from geotween.scene.read import validated


class SourceReader:
    """Reads what a scene names; what is wrong goes to ``faults``.

    With a ``sandbox`` no file outside of that folder is read. ``tables`` are in memory, by the
    names that the scene has for them. ``reads`` gets the files and folders that were looked at.
    """

    def __init__(
        self,
        document: Document,
        sandbox: Path | None = None,
        tables: Mapping[str, Table] | None = None,
        reads: set[Path] | None = None,
    ) -> None:
        self.document = document
        self.sandbox = sandbox
        self.tables = tables or {}
        self.reads = set() if reads is None else reads
        self.faults: list[Fault] = []
        self._alike: dict[object, tuple[int, Fault, list[str]]] = {}

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
        parser = Parser(lambda where, *words: self._report((*at, *where), *words))
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
        folder, name = self.document.path.parent, source.file
        path = self.path(name, at, pattern=True)
        if path is None:
            return []
        try:
            many = is_pattern(folder, name) or path.is_dir()
            paths = several(folder, name) if many else [path]
            self.reads |= {fixed_part(folder, name)} if many else set()
            check_inside(paths, self.sandbox, "" if many else name)
        except ForbiddenError as error:
            self._report(at, error.message, error.hint)
            return []
        except (OSError, ValueError) as error:
            reason = str(getattr(error, "strerror", None) or error).lower()
            self._report(at, f"cannot read {name}: {reason}")
            return []
        if not paths:
            hint = "paths are relative to the scene file"
            self._report(at, f"no file of polygons is at {name}", hint)
        return [(p, self.read(p, p.name if many else name, source, at)) for p in paths]

    def read(self, path: Path, name: str, source: Source, at: Location) -> Held:
        """What one file holds, its columns and its selection as the source says."""
        faults: list[Fault] = []
        if name not in self.tables:
            self.reads.add(path)
        try:
            held = self._held(path, name, source, at, faults)
            held = replace(held, at=at, name=name, crs=held.crs or source.crs)
            named = {"key": source.key, "class": source.class_, "name": source.name}
            faults += self._missing(held, named) if held.features else []
            held = self._selected(held, source)
        except SceneError as error:
            faults += error.faults
            held = Held([])
        for fault in faults:
            self._tell(fault, name, at)
        return held

    def path(self, name: str, at: Location, *, pattern: bool = False) -> Path | None:
        """The path of a name, relative to the scene; None where the sandbox forbids it."""
        folder = self.document.path.parent
        try:
            start = fixed_part(folder, name) if pattern else folder / name
            check_inside([start], self.sandbox, name)
        except ForbiddenError as error:
            self._report(at, error.message, error.hint)
            return None
        return folder / name

    def check_columns(self, held: Held, named: dict[str, str | None]) -> None:
        """Report columns that are named but not there, by the word that names them."""
        for fault in self._missing(held, named):
            self._tell(fault, held.name, held.at)

    def _held(
        self, path: Path, name: str, source: Source, at: Location, faults: list[Fault]
    ) -> Held:
        """What a file holds by its suffix; whatever else can be told of it goes to ``faults``."""
        kind = path.suffix.lower()
        asked = frozenset(filter(None, (source.key, source.class_, source.name)))
        columns = Columns(
            source.key or "key", source.class_ or "class", source.name or "name", asked
        )
        if name in self.tables:
            return self._of_table(self.tables[name], columns, source.name, name, at)
        if source.layer is not None and kind in (*WKT, *PARQUET):
            raise self._no_layers(name, at)
        if kind not in (*JSON, *WKT) and is_file(path):
            return self._table(path, source, columns, name, at)
        named_by = self.document.fault(at, "")
        text = read_text(path, name, named_by=named_by, encoding=source.encoding)
        opened = Document(str(path), path, text)
        if kind in WKT:
            return wkt_features(opened, faults)
        value = read_json(opened)
        topology = isinstance(value, dict) and value.get("type") == "Topology"
        if source.layer is not None and not topology:
            raise self._no_layers(name, at)
        try:
            return json_features(opened, value, source.layer, columns, faults)
        except LayerError as error:
            place = _beside(at, "layer") if source.layer else at
            fault = self.document.fault(place, f"{name}: {error.message}", error.hint)
            raise SceneError([fault]) from None

    def _table(self, path: Path, source: Source, columns: Columns, name: str, at: Location) -> Held:
        """What a file holds that a library reads, with those beside it."""
        confined = self.sandbox is not None
        try:
            if confined:
                check_inside(with_companions(path), self.sandbox)
            table = read_table(path, source.layer, source.encoding, confined=confined)
        except (ForbiddenError, UnreadableError) as error:
            message = f"{name}: {error.message}"
            raise SceneError([self.document.fault(at, message, error.hint)]) from None
        except OSError as error:
            reason = str(error.strerror or error).lower()
            message = f"{name}: cannot be read: {reason}"
            raise SceneError([self.document.fault(at, message)]) from None
        with suppress(OSError):  # a folder that may not be listed
            self.reads.update(with_companions(path))
        return self._of_table(table, columns, source.name, name, at)

    def _of_table(
        self, table: Table, columns: Columns, naming: str | None, name: str, at: Location
    ) -> Held:
        if naming is None:
            columns = replace(columns, name=table.naming)
        features, skipped, wrong = table_features(table, columns)
        if wrong:
            more = f" (and {len(wrong) - 1} more)" if len(wrong) > 1 else ""
            raise SceneError([self.document.fault(at, f"{name}: {wrong[0]}{more}")])
        shown = Path(name).name
        problems = (Problem("source", "note", f"{shown}: {text}") for text in table.warnings)
        return Held(features, crs=table.crs, skipped=skipped, problems=tuple(problems))

    def _missing(self, held: Held, named: dict[str, str | None]) -> list[Fault]:
        known = names_of([feature.attributes for feature in held.features])
        return [
            self.document.fault(
                _beside(held.at, word), f'{held.name} has no column "{column}"', there_are(known)
            )
            for word, column in named.items()
            if column is not None and column not in known
        ]

    def _selected(self, held: Held, source: Source) -> Held:
        if source.where is None or not held.features:
            return held
        rows = [feature.attributes for feature in held.features]
        known = names_of(rows)
        try:
            kept = select(rows, source.where)
        except SelectionError as error:
            place = _beside(held.at, "where")
            fault = self.document.fault(place, f'"where": {error}', there_are(known))
            raise SceneError([fault]) from None
        if not kept:
            message = f'"where" selects none of the {len(rows)} features of {held.name}'
            words = unknown_words(source.where, known)
            hint = f"no column is called {' or '.join(words)}: {there_are(known)}" if words else ""
            problem = Problem("no selection", "warning", message, hint=hint)
            return replace(held, features=[], problems=(*held.problems, problem))
        return replace(held, features=[held.features[i] for i in kept])

    def _no_layers(self, name: str, at: Location) -> SceneError:
        place = _beside(at, "layer")
        message = f'"layer": {name} is of a format without layers'
        return SceneError([self.document.fault(place, message, "leave it out")])

    def _tell(self, fault: Fault, name: str, at: Location) -> None:
        """Keep a fault of a file; what files of one folder have alike is told once, and counted."""
        place = (fault.line, fault.column) if fault.file == self.document.name else None
        alike = (at, fault.message.replace(name, ""), place)
        index, first, names = self._alike.setdefault(alike, (len(self.faults), fault, []))
        if not names or names == [name]:
            self.faults.append(fault)
            names[:] = [name]
            return
        names += [name] if name not in names else []
        count = len(names) - 1
        more = " (and in one more file)" if count == 1 else f" (and in {count} more files)"
        self.faults[index] = replace(first, message=first.message + more)

    def _report(self, at: Location, message: str, hint: str = "") -> None:
        self.faults.append(self.document.fault(at, message, hint))


def _beside(at: Location, word: str) -> Location:
    """The place of another word of a source whose file stands at a place."""
    return (*at[:-1], word) if at and at[-1] == "file" else at


def there_are(columns: Sequence[str]) -> str:
    """A hint that lists columns."""
    return f"there are {', '.join(columns)}" if columns else "there are no columns"
