"""Times: read from columns, kept by periods, and put into words."""

from __future__ import annotations

import datetime
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from geotween.data.read.columns import as_text
from geotween.scene.values import Time, read_time

AnyDate = TypeVar("AnyDate", bound=datetime.date)

_SLASHES = re.compile(r"^(\d{4})/(\d{1,2})/(\d{1,2})")  # GDAL's way to write a date as text
_MONTH = re.compile(r"\s*\d{4}-\d{2}\s*")
_DELTAS = {
    "week": datetime.timedelta(days=7),
    "day": datetime.timedelta(days=1),
    "hour": datetime.timedelta(hours=1),
    "moment": datetime.datetime.resolution,
}
_MONTHS = {"year": 12, "quarter": 3, "month": 1}
# Written and read back, it shows whether a pattern can be read by: it has a zone, and no part is 0.
_SAMPLE = datetime.datetime(2024, 1, 5, 12, 30, 15, 250, tzinfo=datetime.UTC)

_WRITTEN = "expected 2024-01-05, 2024-01-05T12:30 or a number; for others name time_format"
CODES = '"%m/%d/%Y %I:%M %p" reads 01/05/2024 12:30 PM, "%d.%m.%y" reads 05.01.24'


@dataclass(frozen=True)
class Period:
    """A time or a stretch of time, and what lies in it.

    ``numbers`` are its ends among numbers, which belong to it. ``moments`` are its first moment
    among dates and the first one after it, None where the calendar ends; a period of whole
    ``days`` begins and ends by the clock of the time that is compared with it.
    """

    numbers: tuple[float, float] | None
    moments: tuple[datetime.datetime, datetime.datetime | None] | None
    days: bool = True

    def holds(self, time: Time) -> bool:
        """Whether a time lies in it.

        Raises
        ------
        ValueError
            Where one has a zone, and the other a time of day without one.
        """
        if isinstance(time, float):
            return self.numbers is not None and self.numbers[0] <= time <= self.numbers[1]
        if self.moments is None:
            return False
        first, end = self.moments
        moment = _moment(time)
        if self.days:
            moment = moment.replace(tzinfo=None)
        elif first.tzinfo is None and moment.tzinfo is not None:
            raise ValueError("it has no zone, the times have one")
        elif first.tzinfo is not None and moment.tzinfo is None:
            raise ValueError("it has a zone, the times have none")
        return first <= moment and (end is None or moment < end)

    def start(self, like: Time) -> Time:
        """Its beginning, as a time of the kind of one that it holds."""
        if isinstance(like, float):
            assert self.numbers is not None
            return self.numbers[0]
        assert self.moments is not None
        first, _ = self.moments
        if not isinstance(like, datetime.datetime):
            return first.date()
        return first.replace(tzinfo=like.tzinfo) if self.days else first


def check_pattern(pattern: str | None) -> None:
    """Raise ValueError for a pattern that ``strptime`` cannot read by."""
    if pattern is None:
        return
    try:
        datetime.datetime.strptime(_SAMPLE.strftime(pattern), pattern)
    except (ValueError, re.error):
        raise ValueError(f'"{pattern}" is no format of times') from None
    if "%" not in pattern:
        raise ValueError(f'"{pattern}" is no format of times: it has no code such as %Y')


def time_of(value: Any, pattern: str | None = None) -> Time:
    """The time that a column's value tells; ``pattern`` is as ``strptime`` takes it.

    Raises
    ------
    ValueError
        Where it tells none.
    """
    if pattern is not None and not isinstance(value, datetime.date):
        return datetime.datetime.strptime(as_text(value).strip(), pattern)
    if isinstance(value, int | float) and not isinstance(value, bool):
        return read_time(repr(value))
    text = str(value).strip()
    return read_time(_SLASHES.sub(lambda m: f"{m[1]}-{m[2]:0>2}-{m[3]:0>2}", text))


def wrong_time(value: Any, pattern: str | None) -> tuple[str, str, str]:
    """What to say of a value that tells no time: the word of the scene to blame, why, a hint."""
    if value is None:
        return "time", "no time", _WRITTEN
    if pattern is None:
        return "time", f'"{value}" is no time', _WRITTEN
    return "time_format", f'"{value}" does not match time_format "{pattern}"', CODES


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


def period_of(text: str) -> Period:
    """A time or a period as it is written: 2020, 2020-09, 2020-09-01T12:00, 2020-09-01/2020-09-14.

    A year, a month or a day is all of it, and ``a/b`` runs from the first moment of ``a`` to the
    last one of ``b``. A number is a year among dates, where there is such a year.

    Raises
    ------
    ValueError
        Where it is none, or its end does not go with its beginning.
    """
    first, slash, last = text.partition("/")
    if not slash:
        return _single(text)
    before, after = _single(first), _single(last)
    numbers = moments = None
    if before.numbers and after.numbers and before.numbers[0] <= after.numbers[1]:
        numbers = before.numbers[0], after.numbers[1]
    if before.moments and after.moments:
        start, end = before.moments[0], after.moments[1]
        if before.days and not after.days:
            start = start.replace(tzinfo=after.moments[0].tzinfo)
        elif after.days and end is not None:
            end = end.replace(tzinfo=start.tzinfo)
        if end is not None and (start.tzinfo is None) != (end.tzinfo is None):
            raise ValueError("one end has a zone, the other does not")
        if end is None or start < end:
            moments = start, end
    if numbers is None and moments is None:
        raise ValueError("its end does not go with its beginning")
    return Period(numbers, moments, before.days and after.days)


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


def periods_between(
    first: datetime.date, last: datetime.date, period: str, most: int | None = None
) -> list[datetime.date]:
    """The starts of all periods from the one of ``first`` to that of ``last``.

    Where they are more than ``most``, one more than that comes back.
    """
    found: list[datetime.date] = []
    now: datetime.date | None = start_of(first, period)
    end = start_of(last, period)
    while now is not None and now <= end and (most is None or len(found) <= most):
        found.append(now)
        now = _after(now, period)
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
        return f"{time.year:04}-{time.month:02}"
    if period == "week":
        return f"{time.isocalendar().year}-W{time.isocalendar().week:02}"
    if isinstance(time, datetime.datetime):
        whole = not (time.second or time.microsecond)
        return time.isoformat(" ", "minutes" if whole else "auto")
    return time.isoformat()


def _single(text: str) -> Period:
    """A year, month, day, date-time or number as a period."""
    time = time_of(text)
    if isinstance(time, datetime.datetime):
        return Period(None, (time, _after(time, "moment")), days=False)
    if isinstance(time, datetime.date):
        return Period(None, _all_of(time, "month" if _MONTH.fullmatch(text) else "day"))
    is_year = time.is_integer() and datetime.MINYEAR <= time <= datetime.MAXYEAR
    return Period(
        (time, time), _all_of(datetime.date(int(time), 1, 1), "year") if is_year else None
    )


def _all_of(
    start: datetime.date, period: str
) -> tuple[datetime.datetime, datetime.datetime | None]:
    return _moment(start), _after(_moment(start), period)


def _after(start: AnyDate, period: str) -> AnyDate | None:
    """The start of the next period; None where the calendar ends."""
    try:
        if period in _DELTAS:
            return start + _DELTAS[period]
        years, month = divmod(start.month - 1 + _MONTHS[period], 12)
        return start.replace(year=start.year + years, month=month + 1)
    except (ValueError, OverflowError):
        return None


def _moment(time: datetime.date) -> datetime.datetime:
    if isinstance(time, datetime.datetime):
        return time
    return datetime.datetime.combine(time, datetime.time())
