"""A problem in words."""

from __future__ import annotations

import pytest

from geotween.data.problems import Problem


@pytest.mark.parametrize(
    ("problem", "words"),
    [
        (Problem("k", "note", "seen"), "note: seen"),
        (Problem("k", "error", "bad", ("1990",)), "error: 1990: bad"),
        (Problem("k", "warning", "bad", ("1990", "2000"), "Aral Sea"),
         "warning: 1990 → 2000, Aral Sea: bad"),
        (Problem("k", "note", "seen", measure=0.12345, unit="of its area", hint="look"),
         "note: seen (12.35% of its area); look"),
    ],
)  # fmt: skip
def test_problem_in_words(problem: Problem, words: str) -> None:
    assert str(problem) == words
