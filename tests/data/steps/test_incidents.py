"""Incidents: points with times in a CSV, as steps of hotspots."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import Point

from geotween.data.load import Scene, load
from geotween.data.steps.times import CODES
from tests.data.written import told

HEAD = "x,y,t,kind\n"
JANUARY = "".join(f"{x},{y},2020-01-{10 + x},fire\n" for x, y in [(0, 0), (1, 1), (2, 1)])
MARCH = "".join(f"{x},{y},2020-03-{10 + y},flood\n" for x, y in [(5, 5), (6, 5), (6, 7)])
PLANAR = "x: x, y: y, time: t"
NO_TIME = "expected 2024-01-05, 2024-01-05T12:30 or a number; for others name time_format"
WHERE = "leave out the rows that have none: where: typeof(\"y\") = 'real'"


def scene(folder: Path, points: str | bytes, words: str = PLANAR, frame: str = "") -> Path:
    (folder / "p.csv").write_bytes(points if isinstance(points, bytes) else points.encode())
    frame = frame or "{projection: none, simplify: off}"
    path = folder / "scene.yaml"
    path.write_text(f"title: t\nmap: {frame}\nhotspots: {{file: p.csv, {words}}}\n", "utf-8")
    return path


def labels(found: Scene) -> list[tuple[str, int]]:
    """What each step is called, and of how many polygons it is."""
    return [(step.label, len(step.regions)) for step in found]


# Steps


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (PLANAR, ["2020-01-10", "2020-01-11", "2020-01-12",
                  "2020-03-15", "2020-03-17"]),
        (f"{PLANAR}, period: month", ["2020-01", "2020-02", "2020-03"]),
        (f"{PLANAR}, period: quarter, where: kind IS NOT NULL", ["2020 Q1"]),
        (f"{PLANAR}, period: week, where: y < 2", ["2020-W02", ]),
        (f"{PLANAR}, period: week", [f"2020-W{week:02}" for week in range(2, 13)]),
    ],
)  # fmt: skip
def test_steps_are_the_periods_from_the_first_to_the_last(
    tmp_path: Path, words: str, expected: list[str]
) -> None:
    path = scene(tmp_path, HEAD + MARCH + JANUARY, words)
    if len(expected) == 1:  # one step is no map that moves
        assert told(path)[0].endswith("needs at least two steps, and this makes 1")
    else:
        assert [label for label, _ in labels(load(path))] == expected


def test_month_without_points_is_a_step_without_polygons(tmp_path: Path) -> None:
    found = load(scene(tmp_path, HEAD + JANUARY + MARCH, f"{PLANAR}, period: month"))
    assert [(label, count > 0) for label, count in labels(found)] == [
        ("2020-01", True), ("2020-02", False), ("2020-03", True),
    ]  # fmt: skip


def test_numbers_are_steps_in_order(tmp_path: Path) -> None:
    found = load(scene(tmp_path, "x,y,t\n0,0,10\n1,1,9\n0,1,-1\n", f"{PLANAR}, bandwidth: 1"))
    assert [label for label, _ in labels(found)] == ["-1", "9", "10"]


def test_hotspots_lie_where_the_points_do(tmp_path: Path) -> None:
    text = HEAD + JANUARY + MARCH
    found = load(scene(tmp_path, text, f"{PLANAR}, period: month, bandwidth: 1"))
    first, _, last = (shapely.union_all(step.regions.polygons) for step in found)
    assert first.contains(Point(1, 1))
    assert last.contains(Point(6, 5))
    assert not first.intersects(last)
    (note,) = (p for p in found.problems if p.kind == "hotspots")
    assert "bandwidth 1 map units" in note.message


@given(st.randoms(use_true_random=False), st.sampled_from([",", ";", "\t"]))
@settings(max_examples=8)
def test_order_of_rows_and_delimiter_do_not_matter(
    tmp_path_factory: pytest.TempPathFactory, chance: Any, delimiter: str
) -> None:
    folder = tmp_path_factory.mktemp("rows")
    rows = (JANUARY + MARCH).splitlines(keepends=True)
    words = f"{PLANAR}, period: month, bandwidth: 1"
    one = load(scene(folder, HEAD + "".join(rows), words))
    chance.shuffle(rows)
    shuffled = (HEAD + "".join(rows)).replace(",", delimiter).replace("\n", "\r\n")
    other = load(scene(folder, shuffled, words))
    for before, after in zip(one, other, strict=True):
        assert before.label == after.label
        for a, b in zip(before.regions.polygons, after.regions.polygons, strict=True):
            assert a.hausdorff_distance(b) < 1e-6


def test_levels_are_classes_one_on_the_other(tmp_path: Path) -> None:
    text = HEAD + JANUARY + MARCH
    found = load(scene(tmp_path, text, f"{PLANAR}, period: month, levels: [60%, 20%]"))
    assert found.layer_order == ("20%", "60%")
    low, high = (
        shapely.union_all(found.steps[0].regions.in_layer(level).polygons)
        for level in found.layer_order
    )
    assert low.contains(high)
    assert {i.name for i in found.steps[0].regions.identities} == {"above 20%", "above 60%"}


def test_threshold_is_a_fifth_of_the_peak_unless_the_scene_names_one(tmp_path: Path) -> None:
    text, words = HEAD + JANUARY + MARCH, f"{PLANAR}, period: month"
    plain = load(scene(tmp_path, text, words)).steps[0].regions
    named = load(scene(tmp_path, text, f"{words}, threshold: 20%")).steps[0].regions
    assert all(map(shapely.equals, plain.polygons, named.polygons))
    assert {i.name for i in plain.identities} == {i.name for i in named.identities} == {"above 20%"}


def test_longitude_and_latitude_are_put_in_a_plane_in_metres(tmp_path: Path) -> None:
    degrees = "lon,lat,t\n8,47,1\n8.01,47,1\n8.02,47.01,2\n8,47.01,2\n"
    words = "lon: lon, lat: lat, time: t, bandwidth: 1000"
    found = load(scene(tmp_path, degrees, words, frame="{simplify: off}"))
    assert found.projection.startswith("Lambert azimuthal equal-area, centred on 47")
    east, north = np.ptp(found.steps[0].regions.bounds.reshape(2, 2), axis=0)
    assert 2000 < north < east < 8000
    assert any("bandwidth 1000 m" in str(p) for p in found.problems)


def test_points_on_both_sides_of_the_antimeridian_are_neighbours(tmp_path: Path) -> None:
    degrees = "lon,lat,t\n179.9,0,1\n-179.9,0,1\n179.8,0.1,2\n-179.8,0,2\n"
    words = "lon: lon, lat: lat, time: t, bandwidth: 20000"
    found = load(scene(tmp_path, degrees, words, frame="{simplify: off}"))
    assert np.ptp(found.steps[0].regions.bounds.reshape(2, 2), axis=0).max() < 200e3


def test_time_format_and_encoding(tmp_path: Path) -> None:
    text = "x;y;Tag;Straße\n0;0;05.01.20;Größe\n1;1;06.02.20;Größe\n2;2;06.02.20;x\n"
    words = "x: x, y: y, time: Tag, time_format: '%d.%m.%y', where: Straße = 'Größe'"
    options = "bandwidth: 1, encoding: latin-1"
    found = load(scene(tmp_path, text.encode("latin-1"), f"{words}, {options}"))
    assert [label for label, _ in labels(found)] == ["2020-01-05", "2020-02-06"]
    assert told(scene(tmp_path, text.encode("latin-1"), words)) == [
        "p.csv:1:13: the byte 0xDF is not UTF-8 = "
        "save the file as UTF-8, or name its encoding: {file: …, encoding: latin-1}"
    ]


def test_rows_without_a_place_or_a_time_are_left_out_and_told(tmp_path: Path) -> None:
    holes = "1,,2020-01-01,\n ,2,2020-01-01,\n3,3, ,\n,,,fire\n"
    found = load(scene(tmp_path, HEAD + JANUARY + holes + MARCH, f"{PLANAR}, period: month"))
    whole = load(scene(tmp_path, HEAD + JANUARY + MARCH, f"{PLANAR}, period: month"))
    for one, other in zip(found, whole, strict=True):
        assert list(one.regions.polygons) == list(other.regions.polygons)
    assert [str(problem) for problem in found.problems if problem.severity == "warning"] == [
        "warning: 4 of the 10 rows of p.csv were left out, which have no coordinates or no time; "
        "the first is row 5"
    ]


def test_level_above_every_place_is_told(tmp_path: Path) -> None:
    words = f"{PLANAR}, period: month, bandwidth: 1, levels: [0.1, 60]"
    found = load(scene(tmp_path, HEAD + JANUARY + MARCH, words))
    (problem,) = (p for p in found.problems if p.severity == "warning")
    assert problem.kind == "unused level"
    assert problem.message.startswith("no step has a place above 60: the highest density is 0.")
    assert problem.hint == "a share of it is written 60%"
    assert {i.class_ for step in found for i in step.regions.identities} == {"0.1"}


@pytest.mark.parametrize(
    ("times", "period"),
    [
        (["2020-01-01T12:10Z", "2020-01-01T12:10+05:30", "2020-01-01T14:00Z"], "hour"),
        (["2020-01-01T23:30-05:00", "2020-01-02T00:30+05:00", "2020-01-03T00:00Z"], "day"),
    ],
)
def test_times_in_several_zones(tmp_path: Path, times: list[str], period: str) -> None:
    rows = "".join(f"{i},{i},{time},\n" for i, time in enumerate(times))
    found = load(scene(tmp_path, HEAD + rows, f"{PLANAR}, period: {period}, bandwidth: 1"))
    assert len(found.steps) == {"hour": 9, "day": 3}[period]
    assert sum(len(step.regions) for step in found) == 3


@pytest.mark.parametrize("encoding", ["", ", encoding: utf-8"])
def test_byte_order_mark_is_no_part_of_the_first_column(tmp_path: Path, encoding: str) -> None:
    text = "\ufeff" + HEAD + JANUARY + MARCH
    assert len(load(scene(tmp_path, text, PLANAR + encoding)).steps) == 5


# What cannot be

ROWS = HEAD + JANUARY


@pytest.mark.parametrize(
    ("text", "column", "message"),
    [
        ("", 18, "p.csv is empty"),
        ("\n\n", 18, "p.csv is empty"),
        (HEAD, 18, "p.csv has no rows, only the names of columns"),
        ("\n" + HEAD + "\n\n", 18, "p.csv has no rows, only the names of columns"),
        (HEAD + ",,,\n,,2020-01-01,\n", 18, "no row of p.csv has coordinates and a time"),
        (ROWS + "1,2\n", 18, "p.csv, row 5, has 2 values for 4 columns"),
        (ROWS + '"1,2\n', 18, "p.csv is not CSV: unexpected end of data"),
        (ROWS.replace("x,", "lon,"), 28, 'p.csv has no column "x" = there are lon, y, t, kind'),
        (ROWS.replace("t,kind", "kind,t"), 43, f'p.csv, row 2: "fire" is no time (and 2 more rows) = {NO_TIME}'),  # noqa: E501
        (ROWS + "1,2,5,\n", 43, '"time": some times are numbers, others dates'),
        (ROWS + "1,2,2020-01-01T12:00Z,\n", 43, '"time": some times have a zone, others do not'),
        (ROWS + "1,north,2020-01-01,\n", 34, f'p.csv, row 5: "north" is no coordinate = {WHERE}'),
        ("\n" + ROWS + "\n,,,\n1,NA,2020-01-01,\n", 34, f'p.csv, row 8: "NA" is no coordinate = {WHERE}'),  # noqa: E501
        (ROWS + "inf,2,2020-01-01,\n" * 2, 28, 'p.csv, row 5: "inf" is no coordinate (and 1 more rows)'),  # noqa: E501
        ("x,y,t\n" + "0,0,1\n0,0,2\n", 11, "all points lie in the same place: give a bandwidth"),
    ],
)  # fmt: skip
def test_points_that_cannot_be_read(tmp_path: Path, text: str, column: int, message: str) -> None:
    assert told(scene(tmp_path, text)) == [f"scene.yaml:3:{column}: {message}"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (f"{PLANAR}, where: x > 99", '53: "where" selects none of the 3 rows of p.csv'),
        (f"{PLANAR}, where: x >", '53: "where": near ")": syntax error = there are x, y, t, kind'),
        (f"{PLANAR}, where: q = 1", '53: "where": no such column: q'),
        ("x: x, y: y, lon: x, time: t", '11: "hotspots": name the columns x and y, or lon and lat'),
        ("x: x, time: t", '11: "hotspots": name the columns x and y, or lon and lat'),
        ("time: t", '11: "hotspots": name the columns of the coordinates: x and y, or lon and lat'),
        (f"{PLANAR}, levels: [20%, 3]", '11: "hotspots": levels are all shares of the peak, or none is'),  # noqa: E501
        (f"{PLANAR}, levels: [20%], threshold: 2", '11: "hotspots": name a threshold or levels, not both'),  # noqa: E501
        (f"{PLANAR}, levels: [20%, 20%]", "11: a level is given twice"),
        (f"{PLANAR}, period: hour, bandwidth: 1", "43: more than 1000 hours lie from 2020-01-01 00:00 to 2020-03-02 00:00 = name a longer period: month or year"),  # noqa: E501
        (f"{PLANAR}, threshold: 1e9", "57: no step has a place above 1000000000: the highest density is 0.3619 points per square unit"),  # noqa: E501
        (f"{PLANAR}, threshold: 20, bandwidth: 1", "57: no step has a place above 20: the highest density is 0.1608 points per square unit = a share of it is written 20%"),  # noqa: E501
        (f"{PLANAR}, levels: [20, 40]", "54: no step has a place above 20, 40: the highest density is 0.3619 points per square unit = a share of it is written 20%"),  # noqa: E501
        (f"{PLANAR}, time_format: '%d.%m.%Y'", f'59: p.csv, row 2: "2020-01-01T00:00" does not match time_format "%d.%m.%Y" (and 2 more rows) = {CODES}'),  # noqa: E501
        (f"{PLANAR}, time_format: '%'", f'59: "%" is no format of times = {CODES}'),
    ],
)  # fmt: skip
def test_hotspots_that_cannot_be_made(tmp_path: Path, words: str, message: str) -> None:
    text = HEAD + "0,0,2020-01-01T00:00,\n1,1,2020-01-05T12:00,\n2,1,2020-03-02T00:30,\n"
    (found,) = told(scene(tmp_path, text, words))
    assert found.startswith(f"scene.yaml:3:{message}")


@pytest.mark.parametrize(
    ("period", "count"), [("year", 1), ("month", 1), ("week", 4), ("day", 22), ("hour", 528)]
)
def test_last_days_of_the_calendar(tmp_path: Path, period: str, count: int) -> None:
    text = ROWS.replace("2020-01", "9999-12") + "3,3,9999-12-31T23:30,\n"
    path = scene(tmp_path, text, f"{PLANAR}, period: {period}, bandwidth: 1")
    if count == 1:
        assert told(path)[0].endswith("at least two steps, and this makes 1")
    else:
        assert len(load(path).steps) == count


def test_numbers_have_no_months(tmp_path: Path) -> None:
    path = scene(tmp_path, "x,y,t\n0,0,1\n1,1,2\n", f"{PLANAR}, period: month")
    message = '"period": month needs dates, and the times are numbers'
    assert told(path) == [f"scene.yaml:3:54: {message} = leave it out: each number is a step"]


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("45,170,1\n46,171,2\n",
         '40: the column "lat" has latitudes up to 171 = are latitude and longitude swapped?'),
        ("150,0,1\n160,-171,2\n", '40: the column "lat" has latitudes up to -171'),
        ("361,0,1\n0,1,2\n", '30: the column "lon" has longitudes up to 361'
         " = planar columns are x and y, and their system crs"),
        ("1e6,5e6,1\n1e6,6e6,2\n", '40: the column "lat" has latitudes up to 6e+06'
         " = planar columns are x and y, and their system crs"),
        ("1e6,0,1\n-2e6,6,2\n", '30: the column "lon" has longitudes up to -2e+06'
         " = planar columns are x and y, and their system crs"),
    ],
)  # fmt: skip
def test_degrees_that_are_none(tmp_path: Path, rows: str, message: str) -> None:
    path = scene(tmp_path, f"lon,lat,t\n{rows}", "lon: lon, lat: lat, time: t")
    assert told(path) == [f"scene.yaml:3:{message}"]


@pytest.mark.parametrize(
    "names",
    [("Longitude", "Latitude"), ("LNG_1", "LAT_1"), ("pointLon", "pointLat"), ("a", "lat")],
)
def test_longitude_and_latitude_given_as_each_other(tmp_path: Path, names: tuple[str, str]) -> None:
    lon, lat = names
    text = f"{lon},{lat},t\n-87,41,1\n-88,42,2\n"
    path = scene(tmp_path, text, f"lon: {lat}, lat: {lon}, time: t")
    message = f'the column "{lat}" is given as the longitude = lon: {lon}, lat: {lat}'
    assert told(path) == [f"scene.yaml:3:30: {message}"]


def degrees_told(found: Scene) -> list[tuple[str, str]]:
    return [(p.message, p.hint) for p in found.problems if p.kind == "degrees"]


def test_degrees_given_as_planar_coordinates_are_told(tmp_path: Path) -> None:
    text = "Longitude,Latitude,t\n-87,41,1\n-88,42,2\n"
    words, options = "x: Longitude, y: Latitude", "time: t, bandwidth: 1"
    message = 'the columns "Longitude" and "Latitude" are drawn as planar coordinates, in degrees'
    expected = [(message, "lon: Longitude, lat: Latitude")]
    assert degrees_told(load(scene(tmp_path, text, f"{words}, {options}"))) == expected
    swapped = load(scene(tmp_path, text, f"x: Latitude, y: Longitude, {options}"))
    assert [hint for _, hint in degrees_told(swapped)] == [expected[0][1]]
    planar = text.replace("-8", "-8000").replace(",4", ",4000")
    assert degrees_told(load(scene(tmp_path, planar, f"{words}, {options}"))) == []
    other = text.replace("Longitude", "along").replace("Latitude", "lateral")
    found = load(scene(tmp_path, other, f"x: along, y: lateral, {options}"))
    assert degrees_told(found) == []


@pytest.mark.parametrize(
    ("package", "message"),
    [
        ("contourpy", "11: hotspots need the package contourpy = "
         "pip install 'geotween[hotspots]'"),
        ("pyproj", "30: longitude and latitude need the package pyproj = "
         "pip install 'geotween[geo]', or name planar columns x and y"),
    ],
)  # fmt: skip
def test_missing_library_is_told_with_how_to_install_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, package: str, message: str
) -> None:
    for name in [n for n in sys.modules if n.partition(".")[0] == package]:
        monkeypatch.setitem(sys.modules, name, None)
    monkeypatch.setitem(sys.modules, package, None)
    path = scene(tmp_path, ROWS, "lon: x, lat: y, time: t")
    assert told(path) == [f"scene.yaml:3:{message}"]


def test_points_on_both_sides_of_the_antimeridian_lie_near_each_other(tmp_path: Path) -> None:
    rows = "".join(f"{x},{y},{t}\n" for t in (1, 2) for x in (179, -179) for y in (-17, -18))
    (tmp_path / "fiji.csv").write_text(f"lon,lat,t\n{rows}")
    text = "title: t\nhotspots: {file: fiji.csv, lon: lon, lat: lat, time: t, bandwidth: 5e4}\n"
    (tmp_path / "scene.yaml").write_text(text)
    found = load(tmp_path / "scene.yaml")
    west, _, east, _ = found.steps[0].regions.bounds
    assert east - west < 500e3
    assert found.projection.endswith("180° W")
