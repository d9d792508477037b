"""Times: out of columns and names of files, kept by periods, and as people call them."""

from __future__ import annotations

import datetime
import re
from datetime import UTC
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from geotween.data.steps.times import (
    alike,
    check_pattern,
    period_of,
    periods_between,
    start_of,
    time_of,
    words_of,
)
from tests.data.timed import DAYS, day, moment

PERIODS = ("year", "quarter", "month", "week", "day")


# What a value tells


@pytest.mark.parametrize(
    ("value", "time"),
    [
        (1984, 1984.0),
        (0.5, 0.5),
        ("1984", 1984.0),
        (" -1.2e6 ", -1.2e6),
        ("2024-01-05", day("2024-01-05")),
        ("2024-01", day("2024-01-01")),
        ("2024/1/5", day("2024-01-05")),
        ("2024/01/05 12:30:00", moment("2024-01-05T12:30")),
        ("2024-01-05T12:30", moment("2024-01-05T12:30")),
        ("2024-01-05 12:30:00.25", moment("2024-01-05T12:30:00.25")),
        ("2024-01-05T12:30Z", moment("2024-01-05T12:30+00:00")),
        ("2024-W02-3", day("2024-01-10")),
        (day("2024-01-05"), day("2024-01-05")),
        (moment("2024-01-05T12:30"), moment("2024-01-05T12:30")),
    ],
)
def test_time_of_a_value(value: Any, time: Any) -> None:
    assert time_of(value) == time
    assert type(time_of(value)) is type(time)


@pytest.mark.parametrize(
    "value",
    ["soon", "", None, True, float("nan"), float("inf"), 1e300, [2020], "2024-13-45", "05.01.2024"],
)
def test_value_that_tells_no_time(value: Any) -> None:
    with pytest.raises(ValueError, match="expected a"):
        time_of(value)


@pytest.mark.parametrize(
    ("value", "pattern"),
    [("05.01.2024", "%d.%m.%Y"), ("20240105", "%Y%m%d"), (20240105, "%Y%m%d"),
     (20240105.0, "%Y%m%d"), ("5 Jan 24", "%d %b %y")],
)  # fmt: skip
def test_time_as_a_pattern_has_it(value: Any, pattern: str) -> None:
    assert time_of(value, pattern) == moment("2024-01-05T00:00")


@pytest.mark.parametrize("value", ["2024-01-05", None, True, [2024], {}])
def test_value_that_does_not_fit_the_pattern(value: Any) -> None:
    with pytest.raises(ValueError, match=r"does not match|expected a text"):
        time_of(value, "%d.%m.%Y")


def test_date_needs_no_pattern() -> None:
    assert time_of(day("2024-01-05"), "%d.%m.%Y") == day("2024-01-05")


@pytest.mark.parametrize(
    "pattern", ["%d.%m.%Y", "%Y%m%d", "%m/%d/%Y %I:%M %p", "%Y-%m-%dT%H:%M:%S.%f%z", "%a %d %b %y",
                "%H:%M %Z", "%j", "%G-W%V-%u"]
)  # fmt: skip
def test_pattern(pattern: str) -> None:
    check_pattern(pattern)


@pytest.mark.parametrize("pattern", ["%", "%Q", "%d %d", "%s", "%-d", "MM/DD/YYYY", "", "%G %V"])
def test_pattern_that_is_none(pattern: str) -> None:
    with pytest.raises(ValueError, match="is no format of times"):
        check_pattern(pattern)


# Of one kind


def test_dates_stay_dates_where_no_time_of_day_is_told() -> None:
    found = alike([moment("2024-01-05T00:00"), day("2024-01-06")])
    assert found == [day("2024-01-05"), day("2024-01-06")]
    assert not any(isinstance(time, datetime.datetime) for time in found)


def test_dates_among_date_times_are_their_midnight() -> None:
    found = alike([moment("2024-01-05T12:00"), day("2024-01-06")])
    assert found == [moment("2024-01-05T12:00"), moment("2024-01-06T00:00")]


@pytest.mark.parametrize(
    ("times", "message"),
    [
        ([1984.0, day("2024-01-05")], "some times are numbers, others dates"),
        ([moment("2024-01-05T12:00"), moment("2024-01-05T12:00Z")], "some times have a zone"),
        ([day("2024-01-05"), moment("2024-01-05T12:00Z")], "some times have a zone"),
    ],
)
def test_times_of_two_kinds(times: list[Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        alike(times)


# Periods


@pytest.mark.parametrize(
    ("text", "inside", "outside"),
    [
        ("2020-09", ["2020-09-01", "2020-09-30"], ["2020-08-31", "2020-10-01"]),
        ("2020-12", ["2020-12-31"], ["2021-01-01", "2020-11-30"]),
        ("2020-09-01/2020-09-14", ["2020-09-01", "2020-09-14"], ["2020-09-15", "2020-08-31"]),
        ("2019/2020", ["2019-01-01", "2020-12-31"], ["2018-12-31", "2021-01-01"]),
        ("2020-09/2020-10", ["2020-09-01", "2020-10-31"], ["2020-11-01", "2020-08-31"]),
        ("2020-06-01/2021", ["2020-06-01", "2021-12-31"], ["2020-05-31", "2022-01-01"]),
        ("2020/9999-12-31", ["2020-01-01", "9999-12-31"], ["2019-12-31"]),
    ],
)
def test_days_of_a_period(text: str, inside: list[str], outside: list[str]) -> None:
    period = period_of(text)
    assert [period.holds(day(d)) for d in inside] == [True] * len(inside)
    assert [period.holds(day(d)) for d in outside] == [False] * len(outside)
    late = datetime.timedelta(hours=23, minutes=59)  # the last moments of a day are of that day
    assert all(period.holds(moment(d) + late) for d in inside)
    assert not any(period.holds(moment(d) + late) for d in outside)
    assert all(period.holds(moment(d).replace(tzinfo=UTC)) for d in inside)


def test_numbers_of_a_period() -> None:
    period = period_of("-5/5")
    assert [period.holds(number) for number in (-5.1, -5.0, 0.0, 5.0, 5.1)] == [
        False, True, True, True, False,
    ]  # fmt: skip


@pytest.mark.parametrize("text", ["2019/2020", "2020-05/2020-09-14", "2020", "2020-06-01", "-5/5"])
@pytest.mark.parametrize("time", [1984.0, day("2020-06-01"), moment("2020-06-01T12:00"),
                                  moment("2020-06-01T12:00Z")])  # fmt: skip
def test_period_of_days_and_time_of_any_kind_can_be_compared(text: str, time: Any) -> None:
    assert period_of(text).holds(time) == (not isinstance(time, float) and text != "-5/5")


@pytest.mark.parametrize(
    ("text", "inside", "outside"),
    [
        ("2020-06-01T12:00", ["2020-06-01T12:00"], ["2020-06-01T12:00:00.000001"]),
        ("2020-06-01T12:00/2020-06-02T12:00", ["2020-06-01T12:00", "2020-06-02T12:00"],
         ["2020-06-01T11:59", "2020-06-02T12:01"]),
        ("2020-06-01T12:00/2020-06-02", ["2020-06-01T12:00", "2020-06-02T23:59"],
         ["2020-06-01T11:59", "2020-06-03T00:00"]),
        ("2020/2020-06-02T12:00Z", ["2020-01-01T00:00+00:00", "2020-06-02T14:00+02:00"],
         ["2020-01-01T00:00+02:00", "2020-06-02T12:01+00:00"]),
        ("2020-06-01", ["2020-06-01T00:00+02:00", "2020-06-01T23:59-02:00"],
         ["2020-05-31T23:59+00:00"]),
    ],
)  # fmt: skip
def test_moments_of_a_period(text: str, inside: list[str], outside: list[str]) -> None:
    period = period_of(text)
    assert all(period.holds(moment(time)) for time in inside)
    assert not any(period.holds(moment(time)) for time in outside)


@pytest.mark.parametrize(
    ("text", "time", "message"),
    [
        ("2020-01-01T00:00Z", day("2020-01-01"), "it has a zone, the times have none"),
        ("2020-01-01T00:00Z/2020-06-01", moment("2020-02-01T12:00"), "it has a zone"),
        ("2020-01-01T00:00", moment("2020-01-01T00:00Z"), "it has no zone, the times have one"),
    ],
)
def test_period_in_a_zone_and_time_without_one(text: str, time: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        period_of(text).holds(time)


@pytest.mark.parametrize(
    ("text", "like", "start"),
    [
        ("2020", 1984.0, 2020.0),
        ("2020", day("2020-06-01"), day("2020-01-01")),
        ("2020-06", moment("2020-06-02T12:00Z"), moment("2020-06-01T00:00Z")),
        ("2020-06-01T12:00/2020-07", moment("2020-06-02T12:00"), moment("2020-06-01T12:00")),
    ],
)
def test_start_of_a_period_is_of_the_kind_of_its_times(text: str, like: Any, start: Any) -> None:
    found = period_of(text).start(like)
    assert (found, type(found)) == (start, type(start))


EDGES = ["0", "1", "0001", "9999", "10000", "-5", "1e15", "0001-01", "9999-12", "0001-01-01",
         "9999-12-31", "9999-12-31T23:59:59.999999", "0001-01-01T00:00+14:00",
         "9999-12-31T23:59:59.999999-14:00", "2020-06-01", "2020-06-01T12:00"]  # fmt: skip


@given(st.sampled_from(EDGES), st.sampled_from(["", *EDGES]), st.sampled_from(EDGES))
def test_edges_of_the_calendar(first: str, last: str, time: str) -> None:
    try:
        period = period_of(f"{first}/{last}" if last else first)
        assert period.holds(time_of(time)) in (True, False)
    except ValueError as error:
        assert re.search(r"zone|end", str(error))  # noqa: PT017
    if not last:
        assert period_of(first).holds(time_of(first))


@pytest.mark.parametrize(
    "text",
    ["x", "2020-13", "2020/", "/2020", "a/b", "", "2020-02-30", "2021/2020", "-5/2020-06-01",
     "2020-06-01T12:00Z/2020-06-02T12:00", "2020/06/01"],
)  # fmt: skip
def test_text_that_is_no_period(text: str) -> None:
    with pytest.raises(ValueError, match=r"."):
        period_of(text)


def test_starts_of_periods() -> None:
    starts = [start_of(day("2024-08-15"), period) for period in PERIODS]
    assert list(map(str, starts)) == [
        "2024-01-01", "2024-07-01", "2024-08-01", "2024-08-12", "2024-08-15",
    ]  # fmt: skip
    assert start_of(moment("2024-08-15T12:30"), "hour") == moment("2024-08-15T12:00")
    assert start_of(moment("2024-08-15T12:30"), "day") == day("2024-08-15")


@pytest.mark.parametrize("period", PERIODS)
@given(DAYS, st.integers(0, 800))
def test_every_day_lies_in_the_period_that_it_starts(
    period: str, first: datetime.date, after: int
) -> None:
    last = min(first + datetime.timedelta(days=after), datetime.date(2100, 1, 1))
    found = periods_between(first, last, period)
    assert found[0] == start_of(first, period)
    assert found[-1] == start_of(last, period)
    assert found == sorted(set(found))
    assert [start_of(start, period) for start in found] == found


@pytest.mark.parametrize("period", [*PERIODS, "hour"])
def test_last_period_of_the_calendar(period: str) -> None:
    end = moment("9999-12-31T23:30")
    assert periods_between(end, end, period) == [start_of(end, period)]


def test_periods_are_counted_no_further_than_one_beyond_the_most() -> None:
    found = periods_between(day("0001-01-01"), day("9999-12-31"), "hour", 100)
    assert len(found) == 101
    assert len(periods_between(day("2024-01-01"), day("2024-12-31"), "month", 12)) == 12


# Words


@pytest.mark.parametrize(
    ("time", "period", "words"),
    [
        (1984.0, None, "1984"),
        (-1.2e6, None, "-1200000"),
        (0.1, None, "0.1"),
        (day("2024-01-05"), None, "2024-01-05"),
        (moment("2024-01-05T12:30"), None, "2024-01-05 12:30"),
        (moment("2024-01-05T12:30:01"), None, "2024-01-05 12:30:01"),
        (day("2024-01-01"), "year", "2024"),
        (day("2024-10-01"), "quarter", "2024 Q4"),
        (day("2024-03-01"), "month", "2024-03"),
        (day("2024-12-30"), "week", "2025-W01"),
        (day("2024-12-30"), "day", "2024-12-30"),
        (moment("2024-12-30T05:00"), "hour", "2024-12-30 05:00"),
    ],
)
def test_words_of_a_time(time: Any, period: str | None, words: str) -> None:
    assert words_of(time, period) == words
