"""The way a language runs, its numbers, and the player's words in it."""

from __future__ import annotations

from typing import Literal

import pytest

from geotween.export.furniture.language import direction, words_in
from geotween.export.furniture.text import number_text, text_width


@pytest.mark.parametrize(
    ("lang", "way"),
    [("en", "ltr"), ("ar-EG", "rtl"), ("he", "rtl"), ("az-Arab", "rtl"), ("ks-Deva", "ltr")],
)
def test_direction_follows_the_script_then_the_language(lang: str, way: str) -> None:
    assert direction(lang) == way


@pytest.mark.parametrize("of", ["map", "page", "player"])
def test_german_has_all_words_and_other_languages_english_ones(
    of: Literal["map", "page", "player"],
) -> None:
    english, german = words_in("en", of), words_in("de-AT", of)
    assert english.keys() == german.keys()
    assert all(english[word] != german[word] for word in english)
    assert words_in("tlh", of) == english


@pytest.mark.parametrize(
    ("value", "text"), [(1234.5, "1234,5"), (12345.5, "12.345,5"), (-0.25, "-0,25")]
)
def test_numbers_have_the_marks_of_the_language(value: float, text: str) -> None:
    assert number_text(value, ",", ".") == text


def test_chinese_is_wider_than_latin_and_accents_take_no_room() -> None:
    assert text_width("地图", 10) > text_width("ab", 10)
    assert text_width("e\u0301", 10) == text_width("e", 10)
