"""Times in the names of files."""

from __future__ import annotations

import datetime
import re
from collections.abc import Sequence

from geotween.data.steps.times import alike
from geotween.scene.values import Time

UNDERSTOOD = "understood are 2024-01-05, 20240105, 2024-01-05_1230, 2024-01 and 2024"

# The year first: no other order can be told from its digits. Digits around would make another
# number.
_DATE = re.compile(
    r"(?<!\d)(?P<year>\d{4})(?:"
    r"(?P<month>[01]\d)(?P<day>[0-3]\d)|(?P<mark>[-_. ])(?P<month_>\d\d?)(?P=mark)(?P<day_>\d\d?)"
    r")(?:[-T_ .](?P<hour>[0-2]\d)(?:[-:.h]?(?P<minute>[0-5]\d))?(?:[-:.]?(?P<second>[0-5]\d))?)?"
    r"(?!\d)"
)
_MONTH = re.compile(r"(?<!\d)(?P<year>\d{4})-(?P<month>[01]\d)(?!\d)")
_YEAR = re.compile(r"(?<!\d)[12]\d{3}(?!\d)")

_MONTHS = (
    "jan(?:uary)?|feb(?:ruary)?|mar(?:ch)?|apr(?:il)?|may|june?|july?|aug(?:ust)?|sept?(?:ember)?"
    "|oct(?:ober)?|nov(?:ember)?|dec(?:ember)?"
)
# A year that is part of it is not the whole time: 7_24_2024, 24.7.24, 2024-13-45, July 24, 2024.
_LIKE_A_DATE = re.compile(
    r"(?<!\d)(?:\d{1,2}[-_. ]\d{1,2}[-_. ]\d{2}(?:\d{2})?|\d{4}[-_. ]\d{1,2}[-_. ]\d{1,2})(?!\d)"
    rf"|(?<![a-z])(?:{_MONTHS})(?![a-z])",
    re.IGNORECASE,
)


def times_in_names(names: Sequence[str]) -> list[Time | None]:
    """The time in each of some files' names, of one kind; None where one has none.

    Where one has a date, a year alone is no time. Years alone are times only where they cannot
    be part of something else: a date in another order, or numbers that count files.
    """
    dates = [_date_in(name) for name in names]
    if any(dates):
        found = iter(alike([date for date in dates if date is not None]))
        return [None if date is None else next(found) for date in dates]
    years = [None if looks_like_a_date(name) else _YEAR.search(name) for name in names]
    others = [
        re.search(r"\d", _YEAR.sub("", name, count=1 if year else 0))
        for name, year in zip(names, years, strict=True)
    ]
    without = any(other and not year for other, year in zip(others, years, strict=True))
    told = [year[0] for year in years if year]
    if without or (len(set(told)) < len(told) and any(others)):
        return [None] * len(names)
    return [float(year[0]) if year else None for year in years]


def looks_like_a_date(name: str) -> bool:
    """Whether a name seems to hold a date, in whatever order."""
    return bool(_LIKE_A_DATE.search(name))


def _date_in(name: str) -> datetime.date | None:
    """The first date in a name, with the time of day behind it; a month is its first day."""
    for match in (*_DATE.finditer(name), *_MONTH.finditer(name)):
        parts = {k.rstrip("_"): int(v) for k, v in match.groupdict().items() if v and k != "mark"}
        try:
            if "hour" in parts:
                return datetime.datetime(**parts)  # type: ignore[arg-type]  # its zone is no number
            return datetime.date(parts["year"], parts["month"], parts.get("day", 1))
        except ValueError:  # 2024-13-45 is no date
            continue
    return None
