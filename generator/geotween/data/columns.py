"""Columns: who a feature is by its attributes, and which features are meant."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from geotween.scene.values import UNWRITABLE

_NUMBER = '"the row\'s number"'  # a name that no column of a file has
NOTHING: Mapping[str, Any] = MappingProxyType({})


@dataclass(frozen=True)
class Columns:
    """The columns that tell a feature's key, class and name; None where there is none."""

    key: str | None = None
    class_: str | None = None
    name: str | None = None


# What a file calls them that was made for geotween.
NAMED_SO = Columns("key", "class", "name")


class SelectionError(ValueError):
    """An expression that SQLite cannot evaluate."""


def identity(
    attributes: Mapping[str, Any], columns: Columns, report: Callable[[str, str], None]
) -> tuple[str | None, str | None, str]:
    """A feature's key, class and name; a value that is no text is told by its column."""
    found = []
    for column in (columns.key, columns.class_, columns.name):
        value = attributes.get(column) if column is not None else None
        try:
            found.append(None if value is None else as_text(value))
        except ValueError as error:
            report(str(column), f'"{column}"{error}')
            found.append(None)
    key, class_, name = found
    return key, class_, name or ""


def as_text(value: object) -> str:
    """A value as it is shown: the same text whether a file keeps 7 as a number or a text.

    Raises
    ------
    ValueError
        For lists and mappings, and for characters that no page can show.
    """
    if isinstance(value, dict | list):
        raise ValueError(": expected a text")
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        return str(int(value))
    text = str(value)
    if UNWRITABLE.search(text):
        raise ValueError(" holds a character that cannot be shown")
    return text


def names_of(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """The columns of some rows, in order of appearance."""
    return list(dict.fromkeys(name for row in rows for name in row))


def select(rows: Sequence[Mapping[str, Any]], where: str) -> list[int]:
    """The indices of the rows for which an SQL expression holds, evaluated by SQLite.

    Raises
    ------
    SelectionError
        Where it is no expression, or names a column that is not there.
    """
    names = list({name.lower(): name for name in reversed(names_of(rows))}.values())[::-1]
    if not names:
        raise SelectionError("there are no columns")
    places = {name: f"column{number}" for number, name in enumerate(names)}
    shown = ", ".join(f"{place} AS {_quoted(name)}" for name, place in places.items())
    with closing(sqlite3.connect(":memory:")) as base:
        base.execute(f"CREATE TABLE held (number INTEGER, {', '.join(places.values())})")
        base.executemany(
            f"INSERT INTO held VALUES ({', '.join('?' * (len(names) + 1))})",
            ([number, *(_plain(row.get(n)) for n in names)] for number, row in enumerate(rows)),
        )
        try:
            chosen = base.execute(
                f"SELECT {_NUMBER} FROM (SELECT number AS {_NUMBER}, {shown} FROM held) "
                f"WHERE ({where}\n) ORDER BY {_NUMBER}"
            ).fetchall()
        except (sqlite3.Error, sqlite3.Warning) as error:
            raise SelectionError(str(error)) from None
    return [number for (number,) in chosen]


def _plain(value: Any) -> Any:
    return json.dumps(value) if isinstance(value, dict | list) else value


def _quoted(name: str) -> str:
    return '"' + name.replace('"', '""') + '"'
