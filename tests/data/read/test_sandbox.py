"""The sandbox: a scene reads nothing outside of the folder that it may read in."""

from __future__ import annotations

import shutil
import socket
import sqlite3
import zipfile
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
import shapely
from click.testing import CliRunner
from pyogrio.raw import write as write_table
from shapely.geometry import box

from geotween.cli import main
from geotween.data.load import load
from geotween.scene.errors import SceneError
from tests.data.written import TABLES, attempt, told, write

SHAPES = [box(0, 0, 4, 4), box(6, 0, 9, 4)]
INLINE = "[[[0, 0], [4, 0], [4, 4]]]"
CSV = "x,y,t\n" + "".join(f"{x},{y},{t}\n" for t in (1, 2) for x, y in [(0, 0), (1, 1), (2, 1)])
FLAT = "{projection: none}"


def scene(folder: Path, text: str, frame: str = FLAT) -> Path:
    path = folder / "scene.yaml"
    path.write_text(f"title: t\nmap: {frame}\n{text}\n", encoding="utf-8")
    return path


def steps(polygons: str) -> str:
    return f"steps:\n  - polygons: {polygons}\n  - polygons: {INLINE}"


def forbidden(name: str, inside: Path) -> str:
    return f"{name} lies outside of the sandbox = only files in {inside} may be read here"


@pytest.fixture
def places(tmp_path: Path) -> tuple[Path, Path]:
    """A folder to read in, with links out of it, and one beside it with a secret in its files."""
    inside, beside = tmp_path / "inside", tmp_path / "outside"
    for place in (inside, beside):
        (place / "set").mkdir(parents=True)
        for name in ("a", "set/2020", "set/2021"):
            write(place / f"{name}.geojson", SHAPES, {"key": ["a", "SECRET"]})
        (place / "p.csv").write_text(CSV)
    (inside / "link.geojson").symlink_to(beside / "a.geojson")
    (inside / "linked").symlink_to(beside / "set")
    (inside / "link.csv").symlink_to(beside / "p.csv")
    return inside, beside


def keys(inside: Path, source: str) -> list[object]:
    """The keys that a scene in a sandbox reads of a source; none where it is refused."""
    try:
        found = load(scene(inside, steps(source)), sandbox=inside)
    except SceneError:
        return []
    return [identity.key for identity in found.steps[0].regions.identities if identity.keyed]


def test_files_in_the_sandbox_are_read(places: tuple[Path, Path]) -> None:
    inside, _ = places
    assert keys(inside, "a.geojson") == keys(inside, "set/../a.geojson") == ["a", "SECRET"]
    assert keys(inside, str(inside / "a.geojson")) == ["a", "SECRET"]
    for data in ("set", "set/*.geojson", "*t/202?.geojson"):
        assert len(load(scene(inside, f"data: {data!r}"), sandbox=inside).steps) == 2


@pytest.mark.parametrize(
    "name",
    ["{outside}/a.geojson", "../outside/a.geojson", "set/../../outside/a.geojson",
     "link.geojson", "linked/2020.geojson"],
)  # fmt: skip
@pytest.mark.parametrize("word", ["polygons", "source", "data", "layer"])
def test_file_outside(places: tuple[Path, Path], name: str, word: str) -> None:
    inside, beside = places
    name = name.format(outside=beside)
    path = {
        "polygons": lambda: scene(inside, steps(name)),
        "source": lambda: scene(inside, steps(f"{{file: {name}, key: key}}")),
        "data": lambda: scene(inside, f"data: {{file: {name}, time: key}}"),
        "layer": lambda: scene(inside, steps(INLINE), f"{{layers: [{{polygons: {name}}}]}}"),
    }[word]()
    place = {"polygons": "4:15", "source": "4:22", "data": "3:14", "layer": "2:27"}[word]
    assert told(path, sandbox=inside) == [f"scene.yaml:{place}: {forbidden(name, inside)}"]


@pytest.mark.parametrize("name", ["{outside}/set", "../outside/set", "linked", "linked/*.geojson",
                                  "{outside}/set/*", "*/../../outside/set/*.geojson",
                                  "link*/*.geojson", "{outside}/*/*.geojson"])  # fmt: skip
def test_folder_or_glob_outside(places: tuple[Path, Path], name: str) -> None:
    inside, beside = places
    path = scene(inside, f"data: '{name.format(outside=beside)}'")
    (message,) = told(path, sandbox=inside)
    assert message.startswith("scene.yaml:3:7: ")
    assert "lies outside of the sandbox" in message


def test_link_in_a_folder_is_not_followed(places: tuple[Path, Path]) -> None:
    inside, beside = places
    (inside / "set" / "2022.geojson").symlink_to(beside / "a.geojson")
    path = scene(inside, "data: set")
    assert len(load(path).steps) == 3
    try:
        count = len(load(path, sandbox=inside).steps)
    except SceneError:
        return  # telling of it is as good as leaving it out
    assert count == 2


@pytest.mark.parametrize("name", ["{outside}/p.csv", "../outside/p.csv", "link.csv"])
def test_points_outside(places: tuple[Path, Path], name: str) -> None:
    inside, beside = places
    name = name.format(outside=beside)
    path = scene(inside, f"hotspots: {{file: {name}, x: x, y: y, time: t}}")
    assert told(path, sandbox=inside) == [f"scene.yaml:3:18: {forbidden(name, inside)}"]


@pytest.mark.parametrize("name", ["loop.geojson", '"a\\0b.geojson"', f"{'x' * 300}.geojson"])
def test_name_that_no_file_can_have(tmp_path: Path, name: str) -> None:
    (tmp_path / "loop.geojson").symlink_to("loop.geojson")
    (message,) = told(scene(tmp_path, steps(name)), sandbox=tmp_path)
    assert message.startswith("scene.yaml:4:15: ")


def test_part_of_a_shapefile_may_not_lie_outside(places: tuple[Path, Path]) -> None:
    inside, beside = places
    write(beside / "s.shp", SHAPES[:1], {"key": ["SECRET"]})
    for suffix in (".shp", ".shx", ".prj", ".cpg"):
        shutil.copy(beside / f"s{suffix}", inside)
    (inside / "s.dbf").symlink_to(beside / "s.dbf")
    assert "SECRET" not in keys(inside, "s.shp")


@pytest.mark.parametrize("sandboxed", [True, False])
def test_scene_folder_with_brackets(tmp_path: Path, sandboxed: bool) -> None:
    folder = tmp_path / "maps [2024]"
    (folder / "set").mkdir(parents=True)
    for name in ("set/2020", "set/2021", "set/a[1]"):
        write(folder / f"{name}.geojson", SHAPES, {"t": [1, 2]})
    sandbox = folder if sandboxed else None
    for data in ("set/20*.geojson", "**/20*.geojson", "{file: 'set/a[1].geojson', time: t}"):
        quoted = data if data.startswith("{") else repr(data)
        assert len(load(scene(folder, f"data: {quoted}"), sandbox=sandbox).steps) == 2


# Files that stand for others

STAND_INS = {
    "a.vrt": '<OGRVRTDataSource><OGRVRTLayer name="a"><SrcDataSource>{}</SrcDataSource>'
    "</OGRVRTLayer></OGRVRTDataSource>",
    "a.gdalg.json": '{{"type": "gdal_streamed_alg", "command_line": '
    '"gdal vector pipeline ! read {}"}}',
    "a.xml": "<OGRWFSDataSource><URL>{}</URL></OGRWFSDataSource>",
}


@pytest.mark.parametrize("suffix", ["kml", "gml", "gpkg", "shp", "fgb", "zip"])
@pytest.mark.parametrize("kind", ["a.vrt", "a.gdalg.json"])
def test_file_that_stands_for_another_is_not_followed(
    places: tuple[Path, Path], suffix: str, kind: str
) -> None:
    inside, beside = places
    content = STAND_INS[kind].format(beside / "a.geojson")
    if suffix == "zip":
        with zipfile.ZipFile(inside / "a.zip", "w", zipfile.ZIP_DEFLATED) as packed:
            packed.writestr(kind, content)
    else:
        (inside / f"a.{suffix}").write_text(content)
    assert keys(inside, f"a.{suffix}") == []


@pytest.mark.parametrize("suffix", ["gml", "vrt", "tab", "dxf", ""])
def test_other_kinds_are_not_read_in_a_sandbox(places: tuple[Path, Path], suffix: str) -> None:
    inside, _ = places
    name = f"b.{suffix}".removesuffix(".")
    (inside / name).write_text("0\nSECTION\n")
    (message,) = told(scene(inside, steps(name)), sandbox=inside)
    assert "files are not read in a sandbox" in message


def test_table_of_points_in_a_sandbox(places: tuple[Path, Path]) -> None:
    inside, _ = places
    (message,) = told(scene(inside, "data: {file: p.csv, time: t}"), sandbox=inside)
    assert message.endswith("hotspots: {file: …, lon: …, lat: …, time: …}")


def test_geopackage_with_a_table_that_is_another_file(places: tuple[Path, Path]) -> None:
    inside, beside = places
    write(beside / "s.shp", SHAPES[:1], {"key": ["SECRET"]})
    write(inside / "v.gpkg", SHAPES[:1], {"key": ["a"]})
    assert keys(inside, "v.gpkg") == ["a"]
    write(inside / "w.gpkg", SHAPES[:1], {"key": ["a"], "virtual": ["table"]})
    assert keys(inside, "w.gpkg") == ["a"]
    sql = f"CREATE/**/VIRTUAL TABLE s USING VirtualShape('{beside / 's'}', 'UTF-8', 4326)"
    with closing(sqlite3.connect(inside / "v.gpkg")) as base:
        base.execute("PRAGMA writable_schema = ON")
        base.execute("INSERT INTO sqlite_master VALUES ('table', 's', 's', 0, ?)", [sql])
        base.commit()
    assert keys(inside, "v.gpkg") == []


@pytest.mark.parametrize("kind", ["a.gdalg.json", "a.xml"])
def test_nothing_is_asked_of_the_network(tmp_path: Path, kind: str) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(0.2)
        address = f"http://127.0.0.1:{server.getsockname()[1]}/a.geojson"
        server.close()  # whoever asks is refused at once
        (tmp_path / "a.gml").write_text(STAND_INS[kind].format(address))
        _, faults = attempt(tmp_path / "a.gml")
    assert len(faults) == 1
    assert "connect" not in faults[0][0].lower()
    assert "127.0.0.1" not in faults[0][0]


def test_reading_writes_nothing(tmp_path: Path) -> None:
    """Not even what GDAL would leave beside a file to read it faster again."""
    for kind in TABLES:
        write(tmp_path / f"a.{kind}", SHAPES[:1], {"n": [1]})
    binary = shapely.to_wkb(np.array(SHAPES, dtype=object))
    write_table(tmp_path / "b.gml", binary, [], [], geometry_type="Polygon", crs="EPSG:4326")
    (tmp_path / "b.xsd").unlink()
    before = sorted(tmp_path.iterdir())
    for path in before:
        attempt(path)
    assert sorted(tmp_path.iterdir()) == before


def test_command_line_takes_a_sandbox(places: tuple[Path, Path], tmp_path: Path) -> None:
    inside, _ = places
    path = scene(inside, steps("../outside/a.geojson"))
    build = ["build", str(path), "-o", str(tmp_path / "out")]
    for command in (build, ["check", str(path)]):
        result = CliRunner().invoke(main, [*command, "--sandbox", str(inside)])
        assert result.exit_code == 2
        assert result.stderr.replace(f"{tmp_path}/", "") == (
            "inside/scene.yaml:4:15: ../outside/a.geojson lies outside of the sandbox\n"
            "     4 |   - polygons: ../outside/a.geojson\n"
            "       |               ^\n"
            "       = only files in inside may be read here\n\n1 error\n"
        )
    assert not (tmp_path / "out").exists()
    assert CliRunner().invoke(main, [*build, "--sandbox", str(tmp_path / "no")]).exit_code == 2
    assert CliRunner().invoke(main, [*build, "--sandbox", str(tmp_path)]).exit_code == 0
