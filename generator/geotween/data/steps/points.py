"""Points with times, out of a table of text (CSV)."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from geotween.data.problems import Problem
from geotween.data.read.columns import SelectionError, select, unknown_words
from geotween.data.read.parse import LARGEST_COORDINATE
from geotween.data.read.sources import SourceReader, there_are
from geotween.data.steps.times import CODES, alike, check_pattern, time_of, wrong_time
from geotween.scene.document import Location, read_text
from geotween.scene.model import Hotspots
from geotween.scene.values import Time

PLACE: Location = ("hotspots",)


class UnusableError(Exception):
    """Something about the points that the author has to mend: the word that names it, and why."""

    def __init__(self, word: str, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.word = word
        self.message = message
        self.hint = hint


@dataclass(frozen=True, eq=False)
class Incidents:
    """Points (n, 2) as they are written, the time of each, and what was left out."""

    points: NDArray[np.float64]
    times: list[Time]
    problems: tuple[Problem, ...] = ()


@dataclass(frozen=True)
class _Table:
    """Rows of a file, the number of each as a spreadsheet counts them, and their columns."""

    file: str
    names: list[str]
    rows: list[list[str]]
    numbers: list[int]

    def at(self, chosen: Sequence[int]) -> _Table:
        """Some of its rows."""
        rows, numbers = [self.rows[i] for i in chosen], [self.numbers[i] for i in chosen]
        return _Table(self.file, self.names, rows, numbers)

    def column(self, name: str) -> list[str]:
        """The texts of a column."""
        index = self.names.index(name)
        return [row[index].strip() for row in self.rows]

    def wrong(self, rows: Sequence[int], why: str) -> str:
        """What is wrong with some rows, the first of them named."""
        more = f" (and {len(rows) - 1} more rows)" if len(rows) > 1 else ""
        return f"{self.file}, row {self.numbers[rows[0]]}: {why}{more}"


def read_incidents(reader: SourceReader, path: Path, wanted: Hotspots) -> Incidents:
    """The points and times of a CSV; rows without a place or a time are left out, and told.

    Raises
    ------
    SceneError
        Where the file cannot be read.
    UnusableError
        Where it is no such table.
    """
    named_by = reader.document.fault((*PLACE, "file"), "")
    text = read_text(path, wanted.file, named_by=named_by, encoding=wanted.encoding)
    table = _table(text.removeprefix("\ufeff"), wanted.file)
    columns = {**coordinates(wanted), "time": wanted.time}
    for word, column in columns.items():
        if column not in table.names:
            message = f'{wanted.file} has no column "{column}"'
            raise UnusableError(word, message, there_are(table.names))
    if not table.rows:
        raise UnusableError("file", f"{wanted.file} has no rows, only the names of columns")
    if wanted.where is not None:
        table = _selected(table, wanted.where)
    table, problems = _complete(table, columns)
    points = [_numbers(table, word, column) for word, column in coordinates(wanted).items()]
    return Incidents(np.column_stack(points), _times(table, wanted), problems)


def coordinates(wanted: Hotspots) -> dict[str, str]:
    """The columns of the coordinates, the eastward one first, by the words that name them."""
    if wanted.x is not None:
        return {"x": wanted.x, "y": str(wanted.y)}
    return {"lon": str(wanted.lon), "lat": str(wanted.lat)}


def _table(text: str, file: str) -> _Table:
    """The head and the rows of a CSV, whichever of comma, semicolon and tab parts its columns."""
    head = next((line for line in text.splitlines() if line.strip()), "")
    delimiter = max(",;\t", key=head.count)
    try:
        lines = [
            (number, row)
            for number, row in enumerate(
                csv.reader(io.StringIO(text), delimiter=delimiter, strict=True), start=1
            )
            if any(map(str.strip, row))
        ]
    except csv.Error as error:
        raise UnusableError("file", f"{file} is not CSV: {error}") from None
    if not lines:
        raise UnusableError("file", f"{file} is empty")
    names = [column.strip() for column in lines[0][1]]
    for number, row in lines[1:]:
        if len(row) != len(names):
            message = f"{file}, row {number}, has {len(row)} values for {len(names)} columns"
            raise UnusableError("file", message)
    return _Table(file, names, [row for _, row in lines[1:]], [number for number, _ in lines[1:]])


def _selected(table: _Table, where: str) -> _Table:
    """The rows for which an SQL expression holds."""
    rows = [dict(zip(table.names, map(_typed, row), strict=True)) for row in table.rows]
    try:
        kept = select(rows, where)
    except SelectionError as error:
        raise UnusableError("where", f'"where": {error}', there_are(table.names)) from None
    if not kept:
        message = f'"where" selects none of the {len(rows)} rows of {table.file}'
        words = unknown_words(where, table.names)
        hint = f"no column is called {' or '.join(words)}" if words else ""
        raise UnusableError("where", message, hint)
    return table.at(kept)


def _complete(table: _Table, columns: Mapping[str, str]) -> tuple[_Table, tuple[Problem, ...]]:
    """The rows that have a text in each column; how many have none."""
    texts = list(zip(*map(table.column, columns.values()), strict=True))
    whole = [i for i, row in enumerate(texts) if all(row)]
    left = len(texts) - len(whole)
    if not whole:
        raise UnusableError("file", f"no row of {table.file} has coordinates and a time")
    if not left:
        return table, ()
    first = next(table.numbers[i] for i, row in enumerate(texts) if not all(row))
    message = (
        f"{left} of the {len(texts)} rows of {table.file} were left out, which have no coordinates "
        f"or no time; the first is row {first}"
    )
    return table.at(whole), (Problem("incomplete rows", "warning", message),)


def _numbers(table: _Table, word: str, column: str) -> NDArray[np.float64]:
    texts = table.column(column)
    found = np.array([_number(text) for text in texts])
    wild = np.flatnonzero(~(np.abs(found) <= LARGEST_COORDINATE)).tolist()
    if wild:
        hint = f"leave out the rows that have none: where: typeof(\"{column}\") = 'real'"
        message = table.wrong(wild, f'"{texts[wild[0]]}" is no coordinate')
        raise UnusableError(word, message, hint if np.isnan(found[wild]).all() else "")
    return found


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return np.nan


def _typed(text: str) -> float | str | None:
    try:
        return float(text)
    except ValueError:
        return text or None


def _times(table: _Table, wanted: Hotspots) -> list[Time]:
    texts, pattern = table.column(wanted.time), wanted.time_format
    try:
        check_pattern(pattern)
    except ValueError as error:
        raise UnusableError("time_format", str(error), CODES) from None
    known: dict[str, Time | None] = {}
    for text in dict.fromkeys(texts):
        try:
            known[text] = time_of(text, pattern)
        except ValueError:
            known[text] = None
    wrong = [i for i, text in enumerate(texts) if known[text] is None]
    if wrong:
        word, why, hint = wrong_time(texts[wrong[0]], pattern)
        raise UnusableError(word, table.wrong(wrong, why), hint)
    try:
        return alike([time for time in map(known.__getitem__, texts) if time is not None])
    except ValueError as error:
        raise UnusableError("time", f'"time": {error}') from None
