"""A fault as it is printed: place, excerpt, caret and how to mend it."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from geotween.scene.errors import EXCERPT_WIDTH, Fault, SceneError, did_you_mean


def fault(text: str, column: int, hint: str = "") -> Fault:
    return Fault("s.yaml", 7, column, "wrong", hint, text)


def excerpt(text: str, column: int) -> tuple[str, str]:
    """The lines of the excerpt and of the caret, without what stands before them."""
    _, shown, caret = str(fault(text, column)).splitlines()
    assert shown[:9] == "     7 | "
    assert caret[:9] == "       | "
    return shown[9:], caret[9:]


def test_fault_shows_its_line_a_caret_and_a_hint() -> None:
    assert str(fault("style: {fil: red}", 9, 'did you mean "fill"?')) == (
        "s.yaml:7:9: wrong\n"
        "     7 | style: {fil: red}\n"
        "       |         ^\n"
        '       = did you mean "fill"?'
    )


def test_fault_without_a_line_shows_no_excerpt() -> None:
    assert str(fault("", 1)) == "s.yaml:7:1: wrong"


def test_caret_may_stand_behind_the_line() -> None:
    assert excerpt("abc", 4) == ("abc", "   ^")


def test_tab_and_control_character_take_one_column_each() -> None:
    assert excerpt("a\tb\x1bc", 5) == ("a b\N{REPLACEMENT CHARACTER}c", "    ^")


def test_line_of_full_width_is_not_shortened() -> None:
    line = "x" * EXCERPT_WIDTH
    assert excerpt(line, EXCERPT_WIDTH) == (line, " " * (EXCERPT_WIDTH - 1) + "^")


@pytest.mark.parametrize(
    ("column", "before", "after"), [(1, "", " …"), (150, "… ", " …"), (300, "… ", "")]
)
def test_long_line_is_shortened_around_the_fault(column: int, before: str, after: str) -> None:
    line = "." * (column - 1) + "X" + "." * (300 - column)
    shown, caret = excerpt(line, column)
    assert shown.startswith(before + ".") or (not before and shown.startswith("X"))
    assert shown.endswith("." + after) or (not after and shown.endswith("X"))
    assert len(shown) == len(before) + EXCERPT_WIDTH + len(after)
    assert shown.index("X") == caret.index("^")


@given(st.text("abc", max_size=400), st.integers(1, 400))
def test_caret_points_at_the_column_whatever_is_cut(line: str, column: int) -> None:
    column = min(column, len(line) + 1)
    marked = line[: column - 1] + "X" + line[column:]
    shown, caret = excerpt(marked, column)
    assert shown[caret.index("^")] == "X"


def test_faults_are_counted_and_each_is_told_once() -> None:
    one, other = fault("", 1), fault("", 2)
    error = SceneError([one, other, one])
    assert error.faults == (one, other)
    assert str(error) == "s.yaml:7:1: wrong\n\ns.yaml:7:2: wrong\n\n2 errors"
    assert str(SceneError([one])).endswith("\n\n1 error")


@pytest.mark.parametrize(
    ("word", "hint"),
    [
        ("fil", 'did you mean "fill"?'),
        ("FILL", 'did you mean "fill"?'),
        ("opactiy", 'did you mean "opacity"?'),
        ("quux", "known here: fill, opacity, width"),
    ],
)
def test_did_you_mean(word: str, hint: str) -> None:
    assert did_you_mean(word, ["width", "opacity", "fill"]) == hint
