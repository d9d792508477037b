"""Bad data: files that are empty, cut off or damaged, and columns that are not there."""

from __future__ import annotations

import json
import os
import random
import shutil
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import MultiPolygon, Polygon, box

from geotween.data.load import load
from geotween.scene.errors import SceneError
from tests.data.written import FORMATS, TABLES, attempt, told, write

SHAPES = [
    box(0, 0, 4, 4),
    MultiPolygon([box(10, 0, 12, 2), box(20, 0, 22, 2)]),
    Polygon(box(0, 10, 9, 19).exterior, [box(3, 13, 6, 16).exterior]),
]
COLUMNS = {
    "key": ["Größe", "日本", "c"],
    "n": [1, None, 3],
    "t": ["2020-01-05"] * 2 + ["2020-01-06"],
}
INLINE = "[[[0, 0], [4, 0], [4, 4]]]"
CSV = "x,y,t\n" + "".join(f"{x},{y},{t}\n" for t in (1, 2) for x, y in [(0, 0), (1, 1), (2, 1)])


def scene(folder: Path, text: str) -> Path:
    path = folder / "scene.yaml"
    path.write_text(f"title: t\nmap: {{projection: none}}\n{text}\n", encoding="utf-8")
    return path


def steps(polygons: str) -> str:
    return f"steps:\n  - polygons: {polygons}\n  - polygons: {INLINE}"


def reading(folder: Path, kind: str) -> tuple[Path, Path]:
    """A scene that reads all of a file of some kind, and that file."""
    if kind == "csv":
        (folder / "a.csv").write_text(CSV)
        hotspots = "hotspots: {file: a.csv, x: x, y: y, time: t, bandwidth: 1}"
        return scene(folder, hotspots), folder / "a.csv"
    file = write(folder / f"a.{kind}", SHAPES, {} if kind == "wkt" else COLUMNS)
    data = f"data: {{file: a.{kind}, time: t, where: n IS NULL OR n > 0}}"
    return scene(folder, steps("a.wkt") if kind == "wkt" else data), file


# Empty, cut off, damaged


@pytest.mark.parametrize("kind", [*FORMATS, "csv"])
def test_good_file_is_read(tmp_path: Path, kind: str) -> None:
    assert len(load(reading(tmp_path, kind)[0]).steps) == 2


@pytest.mark.parametrize(
    ("kind", "message"),
    [
        *((kind, f"scene.yaml:3:14: a.{kind}: the file is empty") for kind in TABLES),
        ("geojson", "a.geojson:1:1: not JSON: Expecting value = the file is empty"),
        ("topojson", "a.topojson:1:1: not JSON: Expecting value = the file is empty"),
        ("wkt", ""),
        ("csv", "scene.yaml:3:18: a.csv is empty"),
    ],
)
def test_empty_file(tmp_path: Path, kind: str, message: str) -> None:
    path, file = reading(tmp_path, kind)
    file.write_bytes(b"")
    (found,) = told(path)
    assert found == message if kind != "wkt" else "empty" in found


@pytest.mark.parametrize("share", [0.1, 0.35, 0.6, 0.95])
@pytest.mark.parametrize("kind", FORMATS)
def test_file_that_is_cut_off_is_not_taken_for_the_whole(
    tmp_path: Path, kind: str, share: float
) -> None:
    shapes = [box(6 * i, 0, 6 * i + 4, 4) for i in range(12)]
    file = write(tmp_path / f"a.{kind}", shapes, {"n": list(range(12))})
    file.write_bytes(file.read_bytes()[: int(share * file.stat().st_size)])
    held, faults = attempt(file)
    assert faults or held.skipped or held.problems
    assert not any("several layers" in message for message, _ in faults)
    assert not any(str(tmp_path) in message for message, _ in faults)


def test_truncated_csv_is_told_with_its_row(tmp_path: Path) -> None:
    path, file = reading(tmp_path, "csv")
    file.write_text(CSV[:-4])
    assert told(path) == ["scene.yaml:3:18: a.csv, row 7, has 2 values for 3 columns"]


@pytest.mark.parametrize("suffix", [".shx", ".dbf", ".prj", ".cpg"])
@pytest.mark.parametrize("damage", ["missing", "empty", "half"])
def test_shapefile_with_a_part_that_is_damaged(tmp_path: Path, suffix: str, damage: str) -> None:
    path, file = reading(tmp_path, "shp")
    part = file.with_suffix(suffix)
    content = part.read_bytes()
    part.unlink() if damage == "missing" else part.write_bytes(content[: len(content) // 2])
    if damage == "empty":
        part.write_bytes(b"")
    said = outcome(path)
    assert said == "read" or said.startswith("scene.yaml:")
    assert str(tmp_path) not in said
    if suffix in (".shx", ".dbf"):
        assert said != "read"


def damaged(content: bytes, seed: int) -> bytes:
    """Some bytes cut off, or changed, or left out, at random places."""
    chance = random.Random(seed)
    found = bytearray(content)
    if chance.random() < 0.3:
        return bytes(found[: chance.randrange(len(found))])
    for _ in range(chance.choice([1, 1, 2, 8])):
        place = chance.randrange(len(found))
        bit = found[place] ^ (1 << chance.randrange(8))
        found[place] = chance.choice([0, 255, bit, chance.randrange(256)])
    if chance.random() < 0.2:
        place = chance.randrange(len(found))
        del found[place : place + chance.randrange(50)]
    return bytes(found)


def outcome(path: Path) -> str:
    """That a scene was read, or the first fault of it."""
    try:
        load(path)
    except SceneError as error:
        if min(min(fault.line, fault.column) for fault in error.faults) < 1:
            return f"without a place: {error}"
        return str(error).replace(f"{path.parent}/scene.yaml:", "scene.yaml:", 1)
    return "read"


@pytest.mark.parametrize("kind", [*FORMATS, "csv"])
@given(st.integers(0, 2**32))
@settings(max_examples=40)
def test_damaged_file_is_read_or_refused(
    tmp_path_factory: pytest.TempPathFactory, kind: str, seed: int
) -> None:
    folder = tmp_path_factory.mktemp("damaged")
    path, file = reading(folder, kind)
    file.write_bytes(damaged(file.read_bytes(), seed))
    assert not outcome(path).startswith("without")
    shutil.rmtree(folder)


@pytest.mark.parametrize(
    "about",
    [None, 5, [], {}, {"primary_column": "shape"}, {"primary_column": "shape", "columns": []},
     {"primary_column": "shape", "columns": {"shape": 5}}, {"primary_column": [], "columns": {}},
     {"primary_column": "no", "columns": {"no": {"encoding": "WKB"}}},
     {"primary_column": "n", "columns": {"n": {"encoding": "WKB"}}},
     {"primary_column": "shape", "columns": {"shape": {"encoding": "point"}}}],
)  # fmt: skip
def test_parquet_that_is_not_geoparquet(tmp_path: Path, about: Any) -> None:
    from pyarrow import parquet

    path, file = reading(tmp_path, "parquet")
    table = parquet.read_table(file)
    geo = {} if about is None else {"geo": json.dumps(about)}
    parquet.write_table(table.replace_schema_metadata(geo), file)
    (message,) = told(path)
    assert message.startswith("scene.yaml:3:14: a.parquet: ")


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read anything")
@pytest.mark.parametrize("kind", [*FORMATS, "csv"])
def test_file_without_permission(tmp_path: Path, kind: str) -> None:
    path, file = reading(tmp_path, kind)
    file.chmod(0)
    (message,) = told(path)
    assert "permission denied" in message.lower()


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read anything")
def test_folder_without_permission(tmp_path: Path) -> None:
    (tmp_path / "set").mkdir(mode=0)
    (message,) = told(scene(tmp_path, "data: set"))
    assert "permission denied" in message.lower()


def test_shapefile_that_is_cut_off_says_so(tmp_path: Path) -> None:
    file = write(tmp_path / "a.shp", SHAPES, COLUMNS)
    size = file.stat().st_size
    file.write_bytes(file.read_bytes()[:-8])
    message = f"a.shp: cannot be read: {size - 8} of its {size} bytes are there"
    assert [said for said, _ in attempt(file)[1]] == [message]


def test_geopackage_whose_schema_is_damaged(tmp_path: Path) -> None:
    file = write(tmp_path / "a.gpkg", SHAPES, COLUMNS)
    file.write_bytes(file.read_bytes().replace(b"CREATE TRIGGER", b"CREATE TRIGG\xffR"))
    ((message, _),) = attempt(file)[1]
    assert message == "a.gpkg: cannot be read: malformed database schema"


def test_libraries_say_nothing_of_folders(tmp_path: Path) -> None:
    file = write(tmp_path / "a.shp", SHAPES, COLUMNS)
    file.with_suffix(".shx").unlink()
    ((message, _),) = attempt(file)[1]
    assert "a.shx" in message
    assert "/" not in message


@pytest.mark.parametrize("name", ["**.geojson", "f/**.geojson", "***", "f/x*.geojson"])
def test_pattern_that_nothing_fits(tmp_path: Path, name: str) -> None:
    path = scene(tmp_path, f"data: '{name}'")
    path.rename(tmp_path / ".scene.yaml")
    (message,) = told(tmp_path / ".scene.yaml")
    assert message.startswith(f".scene.yaml:3:7: no file of polygons is at {name} = ")


def test_fault_of_all_files_of_a_folder_is_told_once(tmp_path: Path) -> None:
    (tmp_path / "set").mkdir()
    for year in range(2020, 2024):
        write(tmp_path / "set" / f"{year}.geojson", SHAPES, COLUMNS)
    write(tmp_path / "set" / "2024.geojson", SHAPES, {"q": ["a", "b", "c"]})
    assert told(scene(tmp_path, "data: {file: set, key: q}")) == [
        'scene.yaml:3:24: 2020.geojson has no column "q" (and in 3 more files) '
        "= there are key, n, t"
    ]
    for year in (2020, 2021):
        text = '{"type": "Feature", "geometry": {"type": "Polygon", "coordinates": [5, 6]}}'
        (tmp_path / "set" / f"{year}.geojson").write_text(text)
    ring = "expected a ring: [[x, y], [x, y], [x, y], ...]"
    assert told(scene(tmp_path, "data: set")) == [
        f"2020.geojson:1:69: {ring} (and in one more file)",
        f"2020.geojson:1:72: {ring}",
    ]


# What features are, and which are meant


@pytest.mark.parametrize(
    ("source", "messages"),
    [
        ("{file: a.geojson, key: q, class: r, name: s}",
         ['4:38: a.geojson has no column "q" = there are key, n, t',
          '4:48: a.geojson has no column "r" = there are key, n, t',
          '4:57: a.geojson has no column "s" = there are key, n, t']),
        ("{file: a.geojson, kye: q}", ['4:33: unknown key "kye" = did you mean "key"?']),
        ("{file: a.geojson, where: n >}",
         ['4:40: "where": near ")": syntax error = there are key, n, t']),
        ("{file: a.geojson, where: q = 1}",
         ['4:40: "where": no such column: q; a text needs single quotes: '
          "'q' = there are key, n, t"]),
        ("{file: a.wkt, key: q}",
         ['4:34: a.wkt has no column "q" = there are no columns']),
    ],
)  # fmt: skip
def test_columns_that_are_not_there(tmp_path: Path, source: str, messages: list[str]) -> None:
    write(tmp_path / "a.geojson", SHAPES, COLUMNS)
    write(tmp_path / "a.wkt", SHAPES)
    assert told(scene(tmp_path, steps(source))) == [f"scene.yaml:{m}" for m in messages]


def test_selection_of_nothing_is_told(tmp_path: Path) -> None:
    write(tmp_path / "a.geojson", SHAPES, COLUMNS)
    path = scene(tmp_path, steps("{file: a.geojson, where: n > 99}"))
    assert [str(problem) for problem in load(path).problems] == [
        'warning: "where" selects none of the 3 features of a.geojson'
    ]
    path = scene(tmp_path, steps('{file: a.geojson, where: \'"state" = "CA"\'}'))
    (problem,) = load(path).problems
    assert problem.hint == "no column is called state or CA: there are key, n, t"
