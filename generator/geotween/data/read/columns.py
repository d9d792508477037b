"""Columns: who a feature is by its attributes, and which features are meant."""

from __future__ import annotations

import datetime
import decimal
import json
import re
import sqlite3
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from geotween.scene.values import UNWRITABLE

_NUMBER = '"the row\'s number"'  # a name that no column of a file has
NOTHING: Mapping[str, Any] = MappingProxyType({})

# What an expression may do: read its columns, and call functions that always say the same.
_ALLOWED = (sqlite3.SQLITE_SELECT, sqlite3.SQLITE_READ, sqlite3.SQLITE_FUNCTION)
_UNSTEADY = ("random", "randomblob", "load_extension")
# SQLite's instructions, counted rather than seconds, so that every machine agrees.
_CHUNK = 10_000
_LONGEST = 10**8  # bytes of a value
_MOST_STEPS, _STEPS_PER_ROW = 20_000_000, 2_000

_QUOTED = re.compile(r"'(?:[^']|'')*'" r'|"((?:[^"]|"")*)"')


@dataclass(frozen=True)
class Columns:
    """The columns that tell a feature's key, class and name.

    ``asked`` are those that the scene names: of others that happen to be called so, a value that
    is no text says nothing.
    """

    key: str = "key"
    class_: str = "class"
    name: str = "name"
    asked: frozenset[str] = frozenset()


# Features written in the scene itself.
NAMED_SO = Columns(asked=frozenset({"key", "class", "name"}))


class SelectionError(ValueError):
    """An expression that SQLite cannot evaluate."""


def identity(
    attributes: Mapping[str, Any], columns: Columns, report: Callable[[str, str], None]
) -> tuple[str | None, str | None, str]:
    """A feature's key, class and name; a value that is no text is told by its column."""
    found = []
    for column in (columns.key, columns.class_, columns.name):
        value = attributes.get(column)
        try:
            found.append(None if value is None else as_text(value))
        except ValueError as error:
            if column in columns.asked:
                report(column, f'"{column}"{error}')
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

    Dates are ISO texts to it. A word in double quotes that is no column is a text, as SQLite has
    it: see ``unknown_words``.

    Raises
    ------
    SelectionError
        Where it is no expression, names a column that is not there, or would run too long.
    """
    every = names_of(rows)
    if not every:
        raise SelectionError("there are no columns")
    names = list({name.lower(): name for name in reversed(_mentioned(every, where))}.values())[::-1]
    places = {name: f"column{number}" for number, name in enumerate(names)}
    shown = [f"{place} AS {_quoted(name)}" for name, place in places.items()]
    try:
        with closing(sqlite3.connect(":memory:")) as base:
            base.execute(f"CREATE TABLE held ({', '.join(['number INTEGER', *places.values()])})")
            base.executemany(
                f"INSERT INTO held VALUES ({', '.join('?' * (len(names) + 1))})",
                ([number, *(_plain(row.get(n)) for n in names)] for number, row in enumerate(rows)),
            )
            _confine(base, len(rows))
            found = base.execute(
                f"SELECT {_NUMBER} FROM "
                f"(SELECT {', '.join([f'number AS {_NUMBER}', *shown])} FROM held) "
                f"WHERE ({where}\n) ORDER BY {_NUMBER}"
            )
            chosen = [number for (number,) in found]
    except (sqlite3.Error, sqlite3.Warning, ValueError) as error:
        reason = "it takes too long" if str(error) == "interrupted" else str(error)
        raise SelectionError(reason + _advice(reason, where, every)) from None
    if not all(isinstance(number, int) and 0 <= number < len(rows) for number in chosen):
        raise SelectionError("it selects what is no row")
    return chosen


def unknown_words(where: str, names: Sequence[str]) -> list[str]:
    """The words of an expression in double quotes that are no columns, but texts to SQLite."""
    known = {name.lower() for name in names}
    words = [found[1].replace('""', '"') for found in _QUOTED.finditer(where) if found[1]]
    return [word for word in dict.fromkeys(words) if word.lower() not in known]


def _mentioned(names: Sequence[str], where: str) -> list[str]:
    """The columns whose name occurs in an expression; SQLite takes no more than 2,000."""
    text = where.casefold()
    return [n for n in names if n.casefold() in text or _quoted(n).casefold() in text]


def _confine(base: sqlite3.Connection, count: int) -> None:
    """Deny an expression over some rows all but reading, and end it where it runs too long."""
    left = (_MOST_STEPS + _STEPS_PER_ROW * count) // _CHUNK

    def authorize(action: int, _: str | None, name: str | None, *__: str | None) -> int:
        called = action == sqlite3.SQLITE_FUNCTION and (name or "").lower() in _UNSTEADY
        return sqlite3.SQLITE_OK if action in _ALLOWED and not called else sqlite3.SQLITE_DENY

    def spent() -> bool:
        nonlocal left
        left -= 1
        return left < 0

    base.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, _LONGEST)
    base.set_authorizer(authorize)
    base.set_progress_handler(spent, _CHUNK)


def _advice(reason: str, where: str, names: Sequence[str]) -> str:
    """How to mend an expression that lacks quotes."""
    missing = re.match(r"no such column: (\w+)$", reason)
    if not missing and "syntax error" not in reason:
        return ""
    bare = _QUOTED.sub("''", where).casefold()
    odd = [n for n in names if not n.isidentifier() and any(map(str.isalpha, n))]
    unquoted = [n for n in odd if n.casefold() in bare]
    keywords = [n for n in names if reason.lower() == f'near "{n.lower()}": syntax error']
    for name in unquoted + keywords:
        return f"; this name needs double quotes: {_quoted(name)}"
    return f"; a text needs single quotes: '{missing[1]}'" if missing else ""


def _plain(value: Any) -> Any:
    """A value as SQLite takes it."""
    if isinstance(value, int):
        if -(2**63) <= value < 2**63:
            return value
        return float(value) if abs(value) < 2**1023 else str(value)
    if value is None or isinstance(value, float | bytes):
        return value
    if isinstance(value, decimal.Decimal):
        return float(value)
    if isinstance(value, datetime.date | datetime.time):
        return value.isoformat()
    text = json.dumps(value, default=str) if isinstance(value, dict | list) else str(value)
    return text.encode(errors="replace").decode()


def _quoted(name: str) -> str:
    return '"' + name.replace('"', '""') + '"'
