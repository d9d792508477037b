"""Series: the steps that one file with times makes, or several files, whatever the format."""

from __future__ import annotations

import datetime
import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import Point

from geotween.data.load import load
from geotween.data.steps.times import CODES
from tests.conftest import WriteScene
from tests.data.timed import scene, steps_of, timed
from tests.data.written import told, write

EXPECTED = "expected 2024-01-05, 2024-01-05T12:30 or a number; for others name time_format"
PERIOD = "expected a time, or a period: 2020, 2020-09, 2020-09-01/2020-09-14"
DAYS = ["2019-05-01", "2020-06-01", "2020-09-30", "2021-01-01"]


# One file with times


@pytest.mark.parametrize(
    ("times", "labels"),
    [
        (["2020-06-01", "2019-05-01", "2020-06-01"], ["2019-05-01", "2020-06-01"]),
        ([3, 1.5, 3, -2], ["-2", "1.5", "3"]),
        (["3", 1.5], ["1.5", "3"]),
        (["2020-06-01T12:00", "2020-06-01"], ["2020-06-01 00:00", "2020-06-01 12:00"]),
        (["2020-06-01T00:00:00", "2020/06/02"], ["2020-06-01", "2020-06-02"]),
        (["2020-06-01T12:00Z", "2020-06-01T14:00+02:00", "2020-06-01T12:30Z"],
         ["2020-06-01 12:00+00:00", "2020-06-01 12:30+00:00"]),
    ],
)  # fmt: skip
def test_steps_are_the_distinct_times_in_order(
    write_scene: WriteScene, times: list[Any], labels: list[str]
) -> None:
    found = load(write_scene(scene("{file: a.geojson, time: t}"), a=timed(times)))
    assert list(steps_of(found)) == labels


@given(st.lists(st.integers(0, 5), min_size=2, max_size=8), st.randoms(use_true_random=False))
@settings(max_examples=20)
def test_order_of_rows_does_not_matter(
    tmp_path_factory: pytest.TempPathFactory, times: list[int], chance: Any
) -> None:
    folder = tmp_path_factory.mktemp("rows")
    collection = json.loads(timed([*times, 9]))
    (folder / "scene.yaml").write_text(scene("{file: a.geojson, time: t}"))
    (folder / "a.geojson").write_text(json.dumps(collection))
    expected = steps_of(load(folder / "scene.yaml"))
    assert expected == {
        str(t): [str(i) for i, time in enumerate([*times, 9]) if time == t]
        for t in sorted({*times, 9})
    }
    chance.shuffle(collection["features"])
    (folder / "a.geojson").write_text(json.dumps(collection))
    found = steps_of(load(folder / "scene.yaml"))
    assert {label: sorted(keys) for label, keys in found.items()} == expected


def test_time_format(write_scene: WriteScene) -> None:
    text = scene("{file: a.geojson, time: t, time_format: '%d.%m.%Y'}")
    found = load(write_scene(text, a=timed(["05.01.2020", "01.06.2019"])))
    assert [step.time for step in found] == [
        datetime.date(2019, 6, 1), datetime.date(2020, 1, 5),
    ]  # fmt: skip


def test_time_format_of_a_column_of_whole_numbers(write_scene: WriteScene) -> None:
    text = scene("{file: a.geojson, time: t, time_format: '%Y%m%d'}")
    found = load(write_scene(text, a=timed([20200105, 20190601])))
    assert list(steps_of(found)) == ["2019-06-01", "2020-01-05"]


@pytest.mark.parametrize(
    ("pattern", "message"),
    [
        (
            "%d.%m.%Y",
            'a.geojson, row 2: "soon" does not match time_format "%d.%m.%Y" (and 1 more rows)',
        ),
        ("%Q", '"%Q" is no format of times'),
        ("MM/YYYY", '"MM/YYYY" is no format of times: it has no code such as %Y'),
    ],
)
def test_time_format_that_does_not_fit(write_scene: WriteScene, pattern: str, message: str) -> None:
    text = scene(f"{{file: a.geojson, time: t, time_format: '{pattern}'}}")
    path = write_scene(text, a=timed(["05.01.2020", "soon", "later"]))
    assert told(path) == [f"scene.yaml:3:47: {message} = {CODES}"]


@pytest.mark.parametrize(
    ("times", "message"),
    [
        (["2020-06-01", None], f"a.geojson, row 2: no time = {EXPECTED}"),
        (["soon", "2020", "later"],
         f'a.geojson, row 1: "soon" is no time (and 1 more rows) = {EXPECTED}'),
        (["2020-06-01", 5], '"time": some times are numbers, others dates'),
        (["2020-06-01T12:00Z", "2020-06-02"], '"time": some times have a zone, others do not'),
    ],
)  # fmt: skip
def test_times_that_are_none(write_scene: WriteScene, times: list[Any], message: str) -> None:
    path = write_scene(scene("{file: a.geojson, time: t}"), a=timed(times))
    assert told(path) == [f"scene.yaml:3:31: {message}"]


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ("{file: a.geojson, time: when}", '31: a.geojson has no column "when" = there are t, key'),
        ("{file: a.geojson, time: t, where: t > 5}",
         '41: "where" selects none of the 2 features of a.geojson'),
        ("{file: a.geojson, time: t, where: t = 1}",
         "1: a map that moves needs at least two steps, and this makes 1"),
        ("a.geojson",
         "7: one file with all steps needs the column of their times: time: … = there are t, key"),
        ("{file: a.geojson, time: t, times: [1]}", '34: "times": expected at least 2'),
        ("{file: a.geojson, tiem: t}", '25: unknown key "tiem" = did you mean "time"?'),
        ("{time: t}", '7: "data" needs "file"'),
        ("b.geojson", "7: cannot read b.geojson: no such file or directory = "
         'did you mean "a.geojson"?'),
        ("'*.shp'", "7: no file of polygons is at *.shp = paths are relative to the scene file"),
    ],
)  # fmt: skip
def test_data_that_make_no_series(write_scene: WriteScene, data: str, message: str) -> None:
    assert told(write_scene(scene(data), a=timed([1, 2]))) == [f"scene.yaml:3:{message}"]


def test_files_without_polygons(tmp_path: Path) -> None:
    for name in "ab":
        write(tmp_path / f"{name}.geojson", [], {"t": []})
    (tmp_path / "scene.yaml").write_text(scene("{file: '*.geojson', time: t}"))
    message = "no polygon is in a.geojson, b.geojson"
    assert told(tmp_path / "scene.yaml") == [f"scene.yaml:3:7: {message}"]
    write(tmp_path / "b.geojson", [Point(0, 0), Point(1, 1)], {"t": [1, 2]})
    message += ": the 2 features are points, lines or empty"
    assert told(tmp_path / "scene.yaml") == [f"scene.yaml:3:7: {message}"]


def test_too_many_steps(write_scene: WriteScene) -> None:
    path = write_scene(scene("{file: a.geojson, time: t}"), a=timed(range(1001)))
    assert told(path) == [
        "scene.yaml:3:7: the times make 1001 steps, more than 1000 = name those to keep: times: […]"
    ]


# Times and periods to keep


@pytest.mark.parametrize(
    ("times", "steps"),
    [
        ("2020-06-01, 2019-05-01", {"2020-06-01": ["1"], "2019-05-01": ["0"]}),
        ("2019, 2020", {"2019": ["0"], "2020": ["1", "2"]}),
        ("2020-06, 2020-09", {"2020-06": ["1"], "2020-09": ["2"]}),
        ("2019, 2020-06-01/2020-09-30", {"2019": ["0"], "2020-06-01/2020-09-30": ["1", "2"]}),
        ("2019, 2020-01-01/9999-12-31", {"2019": ["0"], "2020-01-01/9999-12-31": ["1", "2", "3"]}),
        ("2019, 2020/2021", {"2019": ["0"], "2020/2021": ["1", "2", "3"]}),
    ],
)
def test_steps_that_are_kept(write_scene: WriteScene, times: str, steps: dict[str, Any]) -> None:
    text = scene(f"{{file: a.geojson, time: t, times: [{times}]}}")
    assert steps_of(load(write_scene(text, a=timed(DAYS)))) == steps


def test_day_to_keep_holds_the_moments_of_it(write_scene: WriteScene) -> None:
    times = ["2020-06-01T06:00", "2020-06-01T18:00", "2020-06-02T00:00"]
    text = scene("{file: a.geojson, time: t, times: [2020-06-01, 2020-06-02]}")
    found = steps_of(load(write_scene(text, a=timed(times))))
    assert found == {"2020-06-01": ["0", "1"], "2020-06-02": ["2"]}


def test_moment_to_keep_beside_a_period(write_scene: WriteScene) -> None:
    times = ["2020-06-01T06:00", "2020-06-02T18:00"]
    text = scene("{file: a.geojson, time: t, times: [2020-06-01, 2020-06-02T18:00]}")
    found = steps_of(load(write_scene(text, a=timed(times))))
    assert found == {"2020-06-01": ["0"], "2020-06-02T18:00": ["1"]}


@pytest.mark.parametrize(
    ("times", "of"),
    [
        (DAYS, datetime.date), ([f"{day}T12:00" for day in DAYS], datetime.date),
        ([f"{day}T12:00Z" for day in DAYS], datetime.datetime), ([2019, 2020.5, 2020], float),
    ],
)  # fmt: skip
def test_kept_steps_have_times_of_one_kind(
    write_scene: WriteScene, times: list[Any], of: type
) -> None:
    text = scene("{file: a.geojson, time: t, times: [2019, 2020/2021]}")
    found = load(write_scene(text, a=timed(times)))
    assert [type(step.time) for step in found] == [of, of]


@pytest.mark.parametrize(
    ("time", "message"),
    [
        ("2018-01-01T00:00Z", '"2018-01-01T00:00Z": it has a zone, the times have none'),
        ("2018", 'there is nothing at "2018" = they run from 2019-05-01 to 2021-01-01'),
        ("soon", f'"soon" is no time and no period = {PERIOD}'),
        ("2020-13", f'"2020-13" is no time and no period = {PERIOD}'),
        ("2020/", f'"2020/" is no time and no period = {PERIOD}'),
        *((odd, None) for odd in ("0", "-5", "9999", "10000", "20200601")),
    ],
)
def test_time_to_keep_that_is_not_there(
    write_scene: WriteScene, time: str, message: str | None
) -> None:
    text = scene(f"{{file: a.geojson, time: t, times: [2019, {time}]}}")
    (found,) = told(write_scene(text, a=timed(DAYS)))
    if message is None:
        message = f'there is nothing at "{time}" = they run from 2019-05-01 to 2021-01-01'
    assert found == f"scene.yaml:3:48: {message}"


# Words for the steps


@pytest.mark.parametrize(
    ("words", "labels"),
    [
        ("- {label: A}\n- {caption: c}\n- {label: C}\n- {}",
         ["A", "2020-06-01", "C", "2021-01-01"]),
        ("- {time: 2020-09-30, label: B}", ["2019-05-01", "2020-06-01", "B", "2021-01-01"]),
        ("- {time: 2019, label: B}", ["B", "2020-06-01", "2020-09-30", "2021-01-01"]),
        ("- {time: 2021-01-01}\n- {time: 2019-05-01, label: A}",
         ["A", "2020-06-01", "2020-09-30", "2021-01-01"]),
    ],
)  # fmt: skip
def test_words_by_time_or_all_in_order(
    write_scene: WriteScene, words: str, labels: list[str]
) -> None:
    text = scene("{file: a.geojson, time: t}", f"steps:\n{words}\n")
    assert list(steps_of(load(write_scene(text, a=timed(DAYS))))) == labels


def test_step_has_the_caption_and_the_rest_of_its_words(write_scene: WriteScene) -> None:
    words = "timing: {hold: 3}\nsteps: [{time: 2020-06-01, caption: It burns., hold: 0}]\n"
    found = load(write_scene(scene("{file: a.geojson, time: t}", words), a=timed(DAYS)))
    assert [(step.caption, step.hold) for step in found][:2] == [("", 3), ("It burns.", 0)]


@pytest.mark.parametrize(
    ("words", "messages"),
    [
        ("[{label: A}]",
         ["4:1: there are words for 1 steps, and 4 steps = name the time of each: "
          "- {time: …, label: …}; "]),
        ("[{time: 2020, label: A}]", ["4:16: 2 steps lie at 2020 = "]),
        ("[{time: 2019-05-01, label: A}, {time: 2019-05-01, label: B}]",
         ["4:46: 2019-05-01 has words already, in entry 1 = "]),
        ("[{time: 2018-01-01}, {label: B}]",
         ["4:16: no step lies at 2018-01-01 = ",
          "4:29: step 2 needs a time, as others have one = "]),
    ],
)  # fmt: skip
def test_words_for_steps_that_are_not_there(
    write_scene: WriteScene, words: str, messages: list[str]
) -> None:
    text = scene("{file: a.geojson, time: t}", f"steps: {words}\n")
    known = "the steps are 2019-05-01, 2020-06-01, 2020-09-30, 2021-01-01"
    expected = [f"scene.yaml:{message}{known}" for message in messages]
    assert told(write_scene(text, a=timed(DAYS))) == expected
