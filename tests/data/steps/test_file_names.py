"""Times in the names of files: what is one, and what only looks like one."""

from __future__ import annotations

import datetime
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from geotween.data.steps.file_names import looks_like_a_date, times_in_names
from tests.data.timed import DAYS, day, moment


@pytest.mark.parametrize(
    ("names", "times"),
    [
        (["fire_2020-01-05", "fire_2020-01-06"], [day("2020-01-05"), day("2020-01-06")]),
        (["20200105", "20200106"], [day("2020-01-05"), day("2020-01-06")]),
        (["a2020-01", "b2020-02"], [day("2020-01-01"), day("2020-02-01")]),
        (["1950", "census 1960 final"], [1950.0, 1960.0]),
        (["x_20200105T1230", "x_20200105 0600"],
         [moment("2020-01-05T12:30"), moment("2020-01-05T06:00")]),
        (["x_2020-01-05_12h30", "x_2020-01-06"],
         [moment("2020-01-05T12:30"), moment("2020-01-06T00:00")]),
        (["f_2020_1_5", "f_2020.01.06"], [day("2020-01-05"), day("2020-01-06")]),
        (["2020-01-05-0600", "2020-01-05_1800"],
         [moment("2020-01-05T06:00"), moment("2020-01-05T18:00")]),
        (["a_20201345_20200105"], [day("2020-01-05")]),
        (["tile_3_1950", "tile_4_1960"], [1950.0, 1960.0]),
        (["a_1950", "b_1950"], [1950.0, 1950.0]),
    ],
)  # fmt: skip
def test_times_in_names(names: list[str], times: Any) -> None:
    assert times_in_names(names) == times


@pytest.mark.parametrize(
    ("names", "times"),
    [
        (["spring", "2020"], [None, 2020.0]),
        (["start", "2020-01-05"], [None, day("2020-01-05")]),
        (["20201345", "20200106"], [None, day("2020-01-06")]),  # no month 13, and no year either
        (["fire_2019", "fire_2020-01-05"], [None, day("2020-01-05")]),
        (["Park_7_24_2024", "Park_20240725"], [None, day("2024-07-25")]),
    ],
)
def test_times_in_some_names(names: list[str], times: Any) -> None:
    assert times_in_names(names) == times


@pytest.mark.parametrize(
    "names",
    [
        ["1", "2"],
        ["scene-12020", "scene-12021"],
        ["frame_0999", "frame_1000"],  # a count
        ["2020_1", "2020_2", "2021_1"],  # of what in a year?
        ["Park_7_24_2023", "Park_7_24_2024"],
        ["park_07-24-24", "park_07-25-24"],
        ["24.7.2023", "24.7.2024"],
        ["park July 24, 2024", "park July 25, 2024"],
        ["24Jul2024", "25Jul2024"],
        ["2020-13-45", "2021-13-45"],
    ],
)
def test_names_without_times(names: list[str]) -> None:
    assert times_in_names(names) == [None] * len(names)


@pytest.mark.parametrize(
    ("name", "date"),
    [("Park_7_24_2024", True), ("07-24-24", True), ("24Jul24", True), ("sept 2020", True),
     ("s10", False), ("spring", False), ("maritime_2024", False), ("v1.2", False)],
)  # fmt: skip
def test_name_that_looks_like_a_date(name: str, date: bool) -> None:
    assert looks_like_a_date(name) == date


@given(st.lists(DAYS, min_size=1, max_size=5), st.sampled_from(["%Y-%m-%d", "%Y%m%d"]))
def test_dates_in_names_are_found_again(days: list[datetime.date], form: str) -> None:
    assert times_in_names([f"fire_{d.strftime(form)}_v2" for d in days]) == days
