"""Times: read from columns and file names, kept by periods, and put into words."""

from __future__ import annotations

import datetime
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from geotween.scene.values import Time, read_time

_SLASHES = re.compile(r"^(\d{4})/(\d{1,2})/(\d{1,2})")  # GDAL's way to write a date as text
# In the name of a file, the most particular first; digits around them would make another number.
_IN_NAMES = (
    re.compile(
        r"(?<!\d)(?P<year>\d{4})-?(?P<month>[01]\d)-?(?P<day>[0-3]\d)"
        r"(?:[T_ ](?P<hour>[0-2]\d)(?:[-:.h]?(?P<minute>[0-5]\d))?(?:[-:.]?(?P<second>[0-5]\d))?)?"
        r"(?!\d)"
    ),
    re.compile(r"(?<!\d)(?P<year>\d{4})-(?P<month>[01]\d)(?!\d)"),
    re.compile(r"(?<!\d)(?P<year>[12]\d{3})(?!\d)"),
)
_MONTH = re.compile(r"(\d{4})-(\d{2})")


@dataclass(frozen=True)
class Period:
    """From a first moment up to, not including, an end; with ``closed`` the end belongs to it."""

    text: str
    first: Time
    end: Time
    closed: bool = False

    def holds(self, time: Time) -> bool:
        """Whether a time of the same kind lies in it."""
        if isinstance(self.first, float) != isinstance(time, float):
            return False
        first, end = _alike(self.first, time), _alike(self.end, time)
        if self.closed and not isinstance(self.end, datetime.datetime | float):
            end = _alike(self.end + datetime.timedelta(days=1), time)
            return bool(first <= time < end)
        return bool(first <= time <= end if self.closed else first <= time < end)


def time_of(value: Any, pattern: str | None = None) -> Time:
    """The time that a column's value tells; ``pattern`` is as ``strptime`` takes it.

    Raises
    ------
    ValueError
        Where it tells none.
    """
    if isinstance(value, int | float) and not isinstance(value, bool):
        return read_time(repr(value))
    text = str(value).strip()
    if pattern is not None:
        return datetime.datetime.strptime(text, pattern)
    return read_time(_SLASHES.sub(lambda m: f"{m[1]}-{m[2]:0>2}-{m[3]:0>2}", text))


def alike(times: Sequence[Time]) -> list[Time]:
    """Times of one kind: all dates where no time of day is told, else all date-times.

    Raises
    ------
    ValueError
        Where some are numbers and others dates, or some have a zone and others none.
    """
    if len({isinstance(time, float) for time in times}) > 1:
        raise ValueError("some times are numbers, others dates")
    moments = [t for t in times if isinstance(t, datetime.datetime)]
    if len({t.tzinfo is None for t in moments}) > 1 or (
        len(moments) < len(times) and any(t.tzinfo for t in moments)
    ):
        raise ValueError("some times have a zone, others do not")
    if all(t.tzinfo is None and t.time() == datetime.time() for t in moments):
        return [t.date() if isinstance(t, datetime.datetime) else t for t in times]
    return [_moment(t) if isinstance(t, datetime.date) else t for t in times]


def times_in_names(names: Sequence[str]) -> list[Time] | None:
    """The time in each of some files' names, all written alike; None where there is none."""
    for pattern in _IN_NAMES:
        matches = [pattern.search(name) for name in names]
        found = [_named(match) for match in matches if match]
        if len(found) == len(names) and None not in found:
            return alike([time for time in found if time is not None])
    return None


def period_of(text: str) -> Period | Time:
    """A period (2020, 2020-09, 2020-09-01/2020-09-14) or a single time.

    A bare year comes back as a number; ``year`` makes a period of it.

    Raises
    ------
    ValueError
        Where it is neither.
    """
    first, slash, last = text.strip().partition("/")
    if slash:
        return Period(text, time_of(first), time_of(last), closed=True)
    if month := _MONTH.fullmatch(first):
        start = datetime.date(int(month[1]), int(month[2]), 1)
        return Period(text, start, _next(start, "month"))
    return time_of(first)


def year(number: float) -> Period:
    """A year as a period."""
    start = datetime.date(int(number), 1, 1)
    return Period(str(int(number)), start, _next(start, "year"))


def start_of(time: datetime.date, period: str) -> datetime.date:
    """The first moment of the year, quarter, month, week (from Monday), day or hour of a time."""
    if period == "hour":
        return _moment(time).replace(minute=0, second=0, microsecond=0)
    day = time.date() if isinstance(time, datetime.datetime) else time
    if period == "week":
        return day - datetime.timedelta(days=day.weekday())
    if period == "day":
        return day
    month = {"year": 1, "quarter": 3 * ((day.month - 1) // 3) + 1}.get(period, day.month)
    return day.replace(month=month, day=1)


def periods_between(first: datetime.date, last: datetime.date, period: str) -> list[datetime.date]:
    """The starts of all periods from the one of ``first`` to that of ``last``."""
    found, now = [], start_of(first, period)
    while now <= start_of(last, period):
        found.append(now)
        now = _next(now, period)
    return found


def words_of(time: Time, period: str | None = None) -> str:
    """A time as a step is called by it: 1984, 2024-01-05, 2024-01-05 12:30, 2024 Q1, 2024-W02."""
    if isinstance(time, float):
        return f"{time:.15g}"
    if period == "year":
        return str(time.year)
    if period == "quarter":
        return f"{time.year} Q{(time.month + 2) // 3}"
    if period == "month":
        return f"{time.year}-{time.month:02}"
    if period == "week":
        return f"{time.isocalendar().year}-W{time.isocalendar().week:02}"
    if isinstance(time, datetime.datetime):
        whole = not (time.second or time.microsecond)
        return time.isoformat(" ", "minutes" if whole else "auto")
    return time.isoformat()


def _named(match: re.Match[str]) -> Time | None:
    parts = {name: int(text) for name, text in match.groupdict().items() if text is not None}
    if len(parts) == 1:
        return float(parts["year"])
    try:
        if "hour" in parts:
            return datetime.datetime(**parts)  # type: ignore[arg-type]  # its zone is no number
        return datetime.date(parts["year"], parts["month"], parts.get("day", 1))
    except ValueError:  # 2024-13-45 is no date
        return None


def _next(start: datetime.date, period: str) -> datetime.date:
    months = {"year": 12, "quarter": 3, "month": 1}.get(period)
    if months is None:
        return (
            start
            + {
                "week": datetime.timedelta(days=7),
                "day": datetime.timedelta(days=1),
                "hour": datetime.timedelta(hours=1),
            }[period]
        )
    total = start.month - 1 + months
    return start.replace(year=start.year + total // 12, month=total % 12 + 1)


def _moment(time: datetime.date) -> datetime.datetime:
    if isinstance(time, datetime.datetime):
        return time
    return datetime.datetime.combine(time, datetime.time())


def _alike(bound: Time, time: Time) -> Any:
    """A bound of a period as the kind of a time that is compared with it."""
    if isinstance(time, datetime.datetime) and isinstance(bound, datetime.date):
        moment = _moment(bound)
        return moment if moment.tzinfo else moment.replace(tzinfo=time.tzinfo)
    if isinstance(bound, datetime.datetime):
        return bound.date()
    return bound
