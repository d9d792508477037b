"""Series out of several files: times in their names, and the same map whatever the format."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
import shapely
from shapely.geometry import box

from geotween.data.load import load
from geotween.export.build import render_scene
from tests.conftest import WriteScene
from tests.data.timed import scene, steps_of, timed
from tests.data.written import LAYER, told, write


@pytest.mark.parametrize("data", ["fires", "fires/", "fires/*.geojson", "f*/fire_*.geojson"])
def test_folder_and_glob_are_steps_by_the_times_in_their_names(tmp_path: Path, data: str) -> None:
    (tmp_path / "fires").mkdir()
    for day in ("20200110", "20191231", "20200105"):
        (tmp_path / "fires" / f"fire_{day}.geojson").write_text(timed([day]))
    (tmp_path / "fires" / "README.txt").write_text("no polygons")
    (tmp_path / "scene.yaml").write_text(scene(data))
    found = load(tmp_path / "scene.yaml")
    assert list(steps_of(found)) == ["2019-12-31", "2020-01-05", "2020-01-10"]
    (tmp_path / "scene.yaml").write_text(scene(f"{{file: {data}, times: [2019, 2020-01-05]}}"))
    assert list(steps_of(load(tmp_path / "scene.yaml"))) == ["2019", "2020-01-05"]


@pytest.mark.parametrize("data", ["f", "f/*.geojson"])
def test_folder_of_the_scene_may_be_called_anything(tmp_path: Path, data: str) -> None:
    folder = tmp_path / "maps [2024]*"
    (folder / "f").mkdir(parents=True)
    for year in (2020, 2021):
        (folder / "f" / f"{year}.geojson").write_text(timed([1]))
    (folder / "scene.yaml").write_text(scene(data))
    assert list(steps_of(load(folder / "scene.yaml"))) == ["2020", "2021"]
    assert list(steps_of(load(folder / "scene.yaml", sandbox=folder))) == ["2020", "2021"]


def test_files_without_times_come_in_the_order_of_their_numbers(tmp_path: Path) -> None:
    for name in ("2", "10", "1"):
        (tmp_path / f"s{name}.geojson").write_text(timed([1]))
    (tmp_path / "scene.yaml").write_text(scene("'*.geojson'"))
    found = load(tmp_path / "scene.yaml")
    assert [(step.label, step.time) for step in found] == [
        ("s1", None), ("s2", None), ("s10", None),
    ]  # fmt: skip
    (tmp_path / "scene.yaml").write_text(scene("{file: '*.geojson', times: [1, 2]}"))
    message = '"times" needs a time in the name of each file, such as 2024-01-05'
    assert told(tmp_path / "scene.yaml") == [f"scene.yaml:3:34: {message}"]


def test_files_without_times_are_told_as_what_they_are(tmp_path: Path) -> None:
    for names, severity in ((("a", "b"), "note"), (("7_24_2024", "7_25_2024"), "warning")):
        (tmp_path / names[0]).mkdir()
        for name in names:
            (tmp_path / names[0] / f"{name}.geojson").write_text(timed([1]))
        (tmp_path / "scene.yaml").write_text(scene(names[0]))
        found = load(tmp_path / "scene.yaml")
        assert [step.label for step in found] == list(names)
        (problem,) = found.problems
        assert (problem.kind, problem.severity) == ("no times", severity)
        assert f"{names[0]}.geojson" in problem.message
    assert problem.hint.startswith("understood are 2024-01-05, ")


def test_file_without_a_time_among_files_with_times(tmp_path: Path) -> None:
    for name in ("fire_20200105", "fire_20200106", "start"):
        (tmp_path / f"{name}.geojson").write_text(timed([1]))
    (tmp_path / "scene.yaml").write_text(scene("{file: '*.geojson'}"))
    (message,) = told(tmp_path / "scene.yaml")
    assert message.startswith(
        "scene.yaml:3:14: start.geojson has no time in its name, as fire_20200105.geojson has = "
        "rename it"
    )


def test_files_of_one_time_are_one_step(tmp_path: Path) -> None:
    for number, name in enumerate(["fire_20200105", "fire_b_20200105", "fire_20200106"]):
        square = box(10 * number, 0, 10 * number + 5, 5)
        write(tmp_path / f"{name}.geojson", [square], {"key": [name]})
    (tmp_path / "scene.yaml").write_text(scene("'*.geojson'"))
    found = load(tmp_path / "scene.yaml")
    assert steps_of(found) == {
        "2020-01-05": ["fire_20200105", "fire_b_20200105"], "2020-01-06": ["fire_20200106"],
    }  # fmt: skip
    assert [str(problem) for problem in found.problems] == [
        "note: 2020-01-05: fire_20200105.geojson, fire_b_20200105.geojson are of one time: "
        "they are one step"
    ]


@pytest.mark.parametrize("pattern", ["**.geojson", "f/**.geojson", "[.geojson", "***"])
def test_pattern_that_is_none(write_scene: WriteScene, pattern: str) -> None:
    (message,) = told(write_scene(scene(f"'{pattern}'"), a=timed([1, 2])))
    assert message.startswith("scene.yaml:3:7: ")


# One map, whatever the format

ISLANDS = {
    2001: [box(0, 0, 20, 12), box(30, 4, 44, 20)],
    2002: [box(2, 0, 24, 12).difference(box(6, 3, 10, 7)), box(30, 4, 40, 20)],
    2003: [box(5, 1, 27, 14).difference(box(8, 4, 12, 9)), box(28, 4, 36, 18)],
}
KEYS = ["Ærø", "Fanø"]
KEY = re.compile(r'data-key="(.*?)"')


def as_series(folder: Path, kind: str) -> str:
    """The islands in a folder of GeoJSON, or in one file; what names them."""
    if kind == "folder":
        (folder / "islands").mkdir()
        for year, shapes in ISLANDS.items():
            write(folder / "islands" / f"{year}.geojson", shapes, {"key": KEYS})
        return "islands"
    rows = [(year, *row) for year, shapes in ISLANDS.items() for row in zip(KEYS, shapes)]  # noqa: B905
    columns = {"year": [row[0] for row in rows], "key": [row[1] for row in rows]}
    write(folder / f"islands.{kind}", [row[2] for row in rows], columns)
    layer = f", layer: {LAYER}" if kind in ("gpkg", "topojson") else ""
    return f"{{file: islands.{kind}, time: year{layer}}}"


@pytest.mark.parametrize("projection", ["none", "auto"])
@pytest.mark.parametrize("kind", ["gpkg", "zip", "topojson", "fgb", "kml", "parquet"])
def test_same_islands_give_the_same_page(tmp_path: Path, kind: str, projection: str) -> None:
    pages = []
    for name in ("folder", kind):
        (tmp_path / name).mkdir()
        path = tmp_path / name / "islands.yaml"
        head = f"title: t\nmap: {{projection: {projection}, simplify: off}}\n"
        path.write_text(head + f"data: {as_series(path.parent, name)}\n", encoding="utf-8")
        pages.append(load(path))
    one, other = pages
    assert [s.label for s in other] == [s.label for s in one] == ["2001", "2002", "2003"]
    width = max(np.ptp(shapely.total_bounds(one.steps[0].regions.polygons).reshape(2, 2), axis=0))
    for before, after in zip(one, other, strict=True):
        shapes = [dict(zip([i.key for i in step.regions.identities], step.regions.polygons,
                           strict=True)) for step in (before, after)]  # fmt: skip
        assert set(shapes[0]) == set(shapes[1]) == set(KEYS)
        for key in KEYS:  # a tenth of a pixel of a map 960 px wide
            assert shapes[0][key].hausdorff_distance(shapes[1][key]) < 1e-4 * width
    first, second = (render_scene(page, ["html", "svg"]).files for page in pages)
    drawn = [sorted(KEY.findall(str(f["islands.svg"], "utf-8"))) for f in (first, second)]
    assert drawn[0] == drawn[1]
    assert set(drawn[0]) == set(KEYS)
    if kind in ("topojson", "gpkg", "parquet"):  # which keep rings and rows as they are
        assert second == first
