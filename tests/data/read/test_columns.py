"""Columns: keys as text, and which rows an expression selects."""

from __future__ import annotations

import contextlib
import datetime
import decimal
import re
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from geotween.data.read.columns import (
    Columns,
    SelectionError,
    as_text,
    identity,
    names_of,
    select,
    unknown_words,
)

ROWS = [
    {"n": 1, "name": "pond", "Größe": 2.5, "on": True},
    {"n": 2, "name": None, "Größe": None, "on": False},
    {"n": 3, "name": 'O\'Hara "Pond"', "Größe": -1.0},
]


@pytest.mark.parametrize(
    ("value", "text"),
    [
        ("a b", "a b"),
        (7, "7"),
        (7.0, "7"),
        (-0.0, "0"),
        (2.5, "2.5"),
        (1e300, "1e+300"),
        (2**63, "9223372036854775808"),
        (True, "true"),
        (False, "false"),
        (datetime.date(2020, 1, 5), "2020-01-05"),
        ("007", "007"),
    ],
)
def test_value_as_text(value: object, text: str) -> None:
    assert as_text(value) == text


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ([1], "expected a text"),
        ({"en": "Pond"}, "expected a text"),
        ("a\0b", "holds a character that cannot be shown"),
        ("\ud800", "holds a character that cannot be shown"),
    ],
)
def test_value_that_is_no_text(value: object, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        as_text(value)


def test_identity_is_told_by_three_columns_and_faults_by_their_column() -> None:
    told: list[tuple[str, str]] = []
    row = {"id": 7, "kind": ["a"], "name": None}
    columns = Columns("id", "kind", "name", frozenset({"id", "kind"}))
    found = identity(row, columns, lambda column, message: told.append((column, message)))
    assert found == ("7", None, "")
    assert told == [("kind", '"kind": expected a text')]


def test_column_that_happens_to_be_called_so_may_hold_anything() -> None:
    told: list[object] = []
    row = {"key": {"a": 1}, "class": ["a"], "name": "x"}
    assert identity(row, Columns(), lambda *words: told.append(words)) == (None, None, "x")
    assert told == []


def test_names_come_in_the_order_of_their_appearance() -> None:
    assert names_of([{"b": 1}, {"a": 1, "b": 2}, {}]) == ["b", "a"]


# Which rows are meant


@pytest.mark.parametrize(
    ("where", "rows"),
    [
        ("n > 1", [1, 2]),
        ("N > 1", [1, 2]),
        ("name = 'pond'", [0]),
        ("name IS NULL", [1]),
        ("name LIKE '%pond%'", [0, 2]),
        ("name = 'O''Hara \"Pond\"'", [2]),
        ('"Größe" < 0 OR "n" IN (1, 5)', [0, 2]),
        ('"on"', [0]),
        ("1 = 1 -- all of them", [0, 1, 2]),
        ("n = 99", []),
        ("NULL", []),
    ],
)
def test_selected_rows(where: str, rows: list[int]) -> None:
    assert select(ROWS, where) == rows


@pytest.mark.parametrize(
    ("where", "message"),
    [
        ("n >", 'near ")": syntax error'),
        ("", 'near ")": syntax error'),
        ("n = 1)", 'near ")": syntax error'),
        ("n = 1; DROP TABLE held", 'near ";": syntax error'),
        ("m = 1", "no such column: m"),
        ("m = 1", "no such column: m; a text needs single quotes: 'm'"),
        ("Fire Name = 'Oak'", '; this name needs double quotes: "Fire Name"'),
        ("park-id = 1", '; this name needs double quotes: "park-id"'),
        ("group = 1", '; this name needs double quotes: "group"'),
        ("column0 = 1", "no such column: column0"),
        ("number = 0", "no such column: number"),
        ("n = ?", "Incorrect number of bindings"),
        ("load_extension('evil')", "not authorized"),
        ("random() > 0", "not authorized"),
        ("n IN (SELECT name FROM pragma_database_list)", "not authorized"),
        ("n IN (WITH RECURSIVE c(i) AS (VALUES (1) UNION ALL SELECT i + 1 FROM c) SELECT i FROM c)",
         "not authorized"),
        (f"n + (SELECT count(*) FROM {', '.join(f'held AS h{i}' for i in range(20))}) > 0",
         "it takes too long"),
    ],
)  # fmt: skip
def test_expression_that_cannot_be_evaluated(where: str, message: str) -> None:
    with pytest.raises(SelectionError, match=re.escape(message)):
        select([{**row, "Fire Name": "Oak", "park-id": 1, "group": 1} for row in ROWS], where)


def test_word_in_double_quotes_that_is_no_column_is_a_text() -> None:
    assert select(ROWS, 'name = "pond"') == [0]
    assert select(ROWS, '"m" = 1') == []
    where = """"m" = 1 AND "N" = '"o"' AND "a""b" = "m" """
    assert unknown_words(where, names_of(ROWS)) == ["m", 'a"b']


def test_dates_are_compared_as_texts() -> None:
    rows = [{"t": datetime.date(2020, 1, day)} for day in (5, 6)]
    assert select(rows, "t > '2020-01-05'") == [1]
    noon = [{"t": datetime.datetime(2020, 1, 5, 12)}]
    assert select(noon, "t = '2020-01-05T12:00:00'") == [0]


@pytest.mark.parametrize("where", ["0) UNION SELECT 99 WHERE (1", "0) UNION SELECT 'z' WHERE (1"])
def test_nothing_but_rows_is_selected(where: str) -> None:
    with contextlib.suppress(SelectionError):
        assert set(select(ROWS, where)) <= {0, 1, 2}


def test_expression_over_rows_without_columns() -> None:
    with pytest.raises(SelectionError, match="there are no columns"):
        select([{}, {}], "n = 1")


@pytest.mark.parametrize(
    "value",
    [
        2**70,
        -(2**63) - 1,
        "\ud800",
        float("nan"),
        b"\xff",
        [1, 2],
        {"a": datetime.date(2020, 1, 5)},
        decimal.Decimal("1.5"),
        datetime.date(2020, 1, 5),
        datetime.datetime(2020, 1, 5, 12),
        datetime.time(12),
        datetime.timedelta(1),
    ],
    ids=lambda value: type(value).__name__,
)
def test_rows_may_hold_whatever_files_do(value: object) -> None:
    assert select([{"n": 1, "odd": value}, {"n": 2, "odd": value}], "n = 2") == [1]


@pytest.mark.parametrize("name", ['a "b"', "", "rowid", "select", "\ud800", "ſ"])
def test_columns_may_be_called_anything(name: str) -> None:
    assert select([{name: 1, "n": 1}, {name: 2, "n": 2}], "n = 2") == [1]


def test_more_columns_than_sqlite_takes_are_selected_from_or_refused() -> None:
    row = {f"c{number}": number for number in range(3000)}
    with contextlib.suppress(SelectionError):
        assert select([row], "c7 = 7") == [0]


def test_of_columns_that_differ_in_case_only_the_first_is_meant() -> None:
    assert select([{"Name": 1, "name": 2}, {"Name": 2, "name": 1}], "name = 1") == [0]


TESTS: dict[str, Callable[[Any], bool]] = {
    "n > 3": lambda n: n is not None and n > 3,
    "n IS NULL": lambda n: n is None,
    "NOT (n % 2 = 0)": lambda n: n is not None and n % 2 != 0,
    "n BETWEEN 2 AND 5 OR n = 9": lambda n: n is not None and (2 <= n <= 5 or n == 9),
}


@pytest.mark.parametrize("where", TESTS)
@given(st.lists(st.none() | st.integers(0, 10), min_size=1, max_size=20))
def test_selection_is_that_of_python(where: str, values: list[int | None]) -> None:
    expected = [number for number, value in enumerate(values) if TESTS[where](value)]
    assert select([{"n": value} for value in values], where) == expected


@given(st.lists(st.text(max_size=5), min_size=1, max_size=8), st.data())
def test_text_is_found_by_itself(texts: list[str], data: st.DataObject) -> None:
    wanted = data.draw(st.sampled_from(texts).filter(lambda text: "\0" not in text))
    quoted = wanted.replace("'", "''")
    expected = [number for number, text in enumerate(texts) if text == wanted]
    assert select([{"t": text} for text in texts], f"t = '{quoted}'") == expected
