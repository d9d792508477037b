"""Tables in Markdown, and the numbers in them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

# What rounds to nothing at the digits shown is told as nothing, unless it is more than rounding.
ROUNDING = 1e-9


def table(heads: Sequence[str], rows: Iterable[Sequence[str]], words: int = 1) -> str:
    """A table, whose first columns hold words and all others numbers."""
    marks = ["---"] * words + ["---:"] * (len(heads) - words)
    return "\n".join("| " + " | ".join(row) + " |" for row in (heads, marks, *rows))


def percent(value: float) -> str:
    """A share; 0 where it is rounding, and "< 0.01%" where it is more but not shown."""
    if abs(value) < ROUNDING:
        return "0"
    if abs(value) < 5e-5:
        return "< 0.01%"
    return f"{value:.2%}"


def number(value: float, digits: int = 0) -> str:
    return f"{value:,.{digits}f}"


def yes(value: bool) -> str:
    return "yes" if value else "no"
