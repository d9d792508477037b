"""How much room words take: generous, as the font is the reader's."""

from __future__ import annotations

import unicodedata

LETTER = 0.56  # the width of a letter in sizes of its font
WIDE = 1.0  # that of one that fills a square, as in Chinese and Japanese
LEADING = 1.4  # lines in sizes of their font
FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, sans-serif"
INK, HALO = "#1c1b19", "#ffffff"  # of words that stand on the map


def text_width(text: str, size: float) -> float:
    """The width of a line in px."""
    wide = sum(unicodedata.east_asian_width(letter) in "WF" for letter in text)
    marks = sum(unicodedata.combining(letter) > 0 for letter in text)
    return size * (LETTER * (len(text) - wide - marks) + WIDE * wide)


def number_text(value: float, decimal: str, group: str) -> str:
    """A number with the marks of a language; four digits are not grouped."""
    whole = f"{value:,.10g}"
    if abs(value) < 10_000:
        whole = whole.replace(",", "")
    return "".join({",": group, ".": decimal}.get(letter, letter) for letter in whole)
