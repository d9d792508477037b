"""Whole numbers as text, and back."""

from __future__ import annotations

import json

from hypothesis import given
from hypothesis import strategies as st

from geotween.export.numerals import heard, told


def test_small_numbers_are_one_character_each() -> None:
    assert told([0, -1, 1, -2, 31, -32]) == "#$%&cd"
    assert len(told([32, -33, 863])) == 6


@given(st.lists(st.integers(-(2**60), 2**60)))
def test_numbers_come_back(values: list[int]) -> None:
    assert heard(told(values)).tolist() == values


@given(st.lists(st.integers(-(10**6), 10**6)))
def test_nothing_has_to_be_escaped(values: list[int]) -> None:
    text = told(values)
    assert json.dumps(text) == f'"{text}"'
    assert "<" not in text
