"""Whole numbers as text that packs well: one character for a small one.

A number is folded, 0, -1, 1, -2, 2 … as 0, 1, 2, 3, 4 …, and written in digits, the last one of
64, those before it of 26 that begin at 1. So the last digit is known by its size, and nothing
parts the numbers. Digits are the printable characters from ``#`` on, without ``<`` and the
backslash, which a script element and JSON would have to escape.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.int64]

LAST, FIRST = 64, 26  # how many last digits there are, and how many others
_DIGITS = np.array([c for c in range(35, 127) if chr(c) not in "<\\"], dtype=np.uint8)


def told(values: Sequence[int] | Numbers) -> str:
    """Numbers (n,) as text. Cost: linear."""
    signed = np.asarray(values, dtype=np.int64).ravel()
    folded = np.where(signed < 0, -2 * signed - 1, 2 * signed)
    high, last = np.divmod(folded, LAST)
    columns = [last]
    while high.any():
        high, digit = np.divmod(np.maximum(high - 1, -1), FIRST)
        columns.append(np.where(high < 0, -1, LAST + digit))
        high = np.maximum(high, 0)
    digits = np.stack(columns[::-1], axis=1).ravel()
    return str(_DIGITS[digits[digits >= 0]].tobytes(), "ascii")


def heard(text: str) -> Numbers:
    """The numbers (n,) that a text tells."""
    digits = np.searchsorted(_DIGITS, np.frombuffer(text.encode("ascii"), dtype=np.uint8))
    ends = np.flatnonzero(digits < LAST)
    place = (
        np.arange(len(digits)) - np.append(-1, ends)[np.searchsorted(ends, np.arange(len(digits)))]
    )
    high = np.zeros(len(ends), dtype=np.int64)
    for k in range(1, int(place.max(initial=0))):
        mine = np.flatnonzero((place == k) & (digits >= LAST))
        number = np.searchsorted(ends, mine)
        high[number] = high[number] * FIRST + digits[mine] - LAST + 1
    folded = high * LAST + digits[ends]
    return np.where(folded % 2, -(folded + 1) // 2, folded // 2)
