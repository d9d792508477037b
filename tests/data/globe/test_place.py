"""Places: which coordinate reference system coordinates are in, and the plane that they come to."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import shapely.affinity
from pyproj import Transformer
from shapely.geometry import box

from geotween.data.load import Scene, load
from tests.conftest import WriteScene
from tests.data.written import as_collection, told, write

COUNTY = box(8, 47, 9, 48)
PLANAR = box(1000, 2000, 5000, 5000)
SWAPPED = "are latitude and longitude swapped? longitude (x) comes first"
OR_PLANAR = "if they are planar, say map: {projection: none}"
SAY = f"say what its coordinates are: map: {{crs: EPSG:4326}}; {OR_PLANAR}"
UNKNOWN = "unknown coordinate reference system 'nope': write an EPSG code such as EPSG:4326, a PROJ string or WKT"  # noqa: E501


def geojson(shape: Any, crs: str | None = None) -> str:
    member = {"crs": {"type": "name", "properties": {"name": crs}}} if crs else {}
    return json.dumps({**as_collection([shape]), **member})


def scene(*steps: str, frame: str = "simplify: off") -> str:
    listed = "".join(f"  - polygons: {step}\n" for step in steps)
    return f"title: t\nmap: {{{frame}}}\nsteps:\n{listed}"


def bounds(found: Scene, step: int = 0) -> Any:
    return found.steps[step].regions.bounds


def into(crs: str, shape: Any, source: str = "EPSG:4326") -> Any:
    way = Transformer.from_crs(source, crs, always_xy=True)
    points = shapely.get_coordinates(shape)
    return np.array(way.transform(*points.T)).T


def test_geojson_is_longitude_and_latitude_where_it_can_be(write_scene: WriteScene) -> None:
    found = load(write_scene(scene("a.geojson", "a.geojson"), a=geojson(COUNTY)))
    assert found.projection.startswith("Lambert azimuthal equal-area, centred on ")
    east, north = np.ptp(bounds(found).reshape(2, 2), axis=0)
    assert (east, north) == (pytest.approx(75.3e3, rel=0.02), pytest.approx(111.2e3, rel=0.01))


@pytest.mark.parametrize("of_file", ["EPSG:5070", "urn:ogc:def:crs:EPSG::5070"])
def test_crs_of_the_file_comes_first(write_scene: WriteScene, of_file: str) -> None:
    text = scene("{file: a.geojson, crs: EPSG:3857}", "[]", frame="crs: EPSG:2056")
    found = load(write_scene(text, a=geojson(PLANAR, of_file)))
    assert bounds(found) == pytest.approx(PLANAR.bounds)
    assert "5070" in found.projection


def test_then_that_of_the_source_then_that_of_the_map(write_scene: WriteScene) -> None:
    text = scene("{file: a.geojson, crs: EPSG:3857}", "[]", frame="crs: EPSG:2056")
    path = write_scene(text, a=geojson(PLANAR))
    assert load(path).projection == "EPSG:3857, as the data are"
    path.write_text(scene("a.geojson", "[]", frame="crs: EPSG:2056"))
    assert load(path).projection == "EPSG:2056, as the data are"


def test_planar_geojson_is_drawn_as_it_is(write_scene: WriteScene) -> None:
    found = load(write_scene(scene("a.geojson", "[]"), a=geojson(PLANAR)))
    assert (found.projection, tuple(bounds(found))) == ("", PLANAR.bounds)


def test_without_a_projection_nothing_moves_and_no_library_is_needed(
    write_scene: WriteScene, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pyproj", None)
    found = load(write_scene(scene("a.geojson", "[]", frame="projection: none"), a=geojson(COUNTY)))
    assert (found.projection, tuple(bounds(found))) == ("", COUNTY.bounds)


@pytest.mark.parametrize("kind", ["shp", "wkt"])
def test_file_that_names_no_crs_is_asked_for_it(tmp_path: Path, kind: str) -> None:
    write(tmp_path / f"a.{kind}", [COUNTY])
    (tmp_path / "a.prj").unlink(missing_ok=True)
    path = tmp_path / "scene.yaml"
    path.write_text(scene(f"a.{kind}", "[]"))
    assert told(path) == [f"scene.yaml:4:15: a.{kind} names no coordinate reference system = {SAY}"]
    path.write_text(scene(f"{{file: a.{kind}, crs: EPSG:4326}}", "[]"))
    assert load(path).projection.startswith("Lambert")
    path.write_text(scene(f"a.{kind}", "[]", frame="projection: none"))
    assert tuple(bounds(load(path))) == COUNTY.bounds


def test_named_projection_needs_to_know_what_it_projects(write_scene: WriteScene) -> None:
    path = write_scene(scene("a.geojson", "[]", frame="projection: EPSG:3035"), a=geojson(PLANAR))
    assert told(path) == [
        f"scene.yaml:4:15: a.geojson names no coordinate reference system = {SAY}"
    ]


def test_named_projection(write_scene: WriteScene) -> None:
    frame = "projection: EPSG:3035, simplify: off"
    found = load(write_scene(scene("a.geojson", "[]", frame=frame), a=geojson(COUNTY)))
    drawn = shapely.points(into("EPSG:3035", COUNTY))
    (polygon,) = found.steps[0].regions.polygons
    assert found.projection.endswith("(EPSG:3035)")
    assert shapely.distance(polygon.exterior, drawn).max() < 1
    assert polygon.exterior.is_ccw


def test_coordinates_of_the_scene_are_those_of_its_first_file(write_scene: WriteScene) -> None:
    inline = json.dumps([list(map(list, COUNTY.exterior.coords))])
    found = load(write_scene(scene("a.geojson", inline), a=geojson(COUNTY)))
    assert bounds(found, 1) == pytest.approx(bounds(found, 0))


def test_sources_of_several_systems_are_reprojected_to_the_first(
    write_scene: WriteScene, tmp_path: Path
) -> None:
    metres = shapely.Polygon(into("EPSG:3857", COUNTY))
    write(tmp_path / "b.gpkg", [metres], crs="EPSG:3857")
    write(tmp_path / "c.gpkg", [COUNTY], crs="EPSG:4326")
    found = load(write_scene(scene("b.gpkg", "c.gpkg", "a.geojson"), a=geojson(COUNTY)))
    assert found.projection == "EPSG:3857, as the data are"
    assert bounds(found, 1) == pytest.approx(metres.bounds)
    assert bounds(found, 2) == pytest.approx(metres.bounds)
    assert [str(p) for p in found.problems if p.kind == "reprojected"] == [
        f"note: {name} was reprojected to EPSG:3857, as the first source is"
        for name in ("c.gpkg", "a.geojson")
    ]


def test_static_layer_comes_to_the_plane_of_the_steps(
    write_scene: WriteScene, tmp_path: Path
) -> None:
    write(tmp_path / "sea.gpkg", [shapely.Polygon(into("EPSG:3857", COUNTY))], crs="EPSG:3857")
    text = scene("a.geojson", "[]", frame="simplify: off, layers: [{polygons: sea.gpkg}]")
    found = load(write_scene(text, a=geojson(COUNTY)))
    ((_, sea),) = found.layers
    assert sea.bounds == pytest.approx(bounds(found), rel=1e-6)


def test_each_step_has_a_projection_of_its_own_where_each_fits_the_frame(
    write_scene: WriteScene,
) -> None:
    text = scene("a.geojson", "b.geojson", frame="fit: each")
    found = load(write_scene(text, a=geojson(COUNTY), b=geojson(box(-80, 25, -79, 26))))
    assert len(found.projection.split("; ")) == 2


# What cannot be


@pytest.mark.parametrize(
    ("frame", "step", "message"),
    [
        ("crs: nope", "a.geojson", f'2:12: "crs": {UNKNOWN}'),
        ("projection: nope", "a.geojson", f'2:19: "projection": {UNKNOWN}'),
        ("width: 500", "{file: a.geojson, crs: nope}", f'4:38: "crs": {UNKNOWN}'),
    ],
)
def test_system_that_does_not_exist(
    write_scene: WriteScene, frame: str, step: str, message: str
) -> None:
    (found,) = told(write_scene(scene(step, "[]", frame=frame), a=geojson(COUNTY)))
    assert found.startswith(f"scene.yaml:{message}")


@pytest.mark.parametrize("crs", ["", " ", "EPSG:0", "5", "+proj=", "LOCAL_CS[]", "EPSG:5703"])
def test_odd_name_of_a_system(write_scene: WriteScene, crs: str) -> None:
    path = write_scene(scene("a.geojson", "[]", frame=f'crs: "{crs}"'), a=geojson(COUNTY))
    (message,) = told(path)
    assert message.startswith('scene.yaml:2:12: "crs": ')


@pytest.mark.parametrize("crs", [5, ["x"], {"a": 1}, "nope", ""])
def test_crs_in_a_file_that_is_none(tmp_path: Path, crs: Any) -> None:
    write(tmp_path / "a.parquet", [COUNTY], crs=crs)
    (tmp_path / "scene.yaml").write_text(scene("a.parquet", "[]"))
    (message,) = told(tmp_path / "scene.yaml")
    assert message.startswith("scene.yaml:4:15: ")


def test_latitudes_beyond_the_poles_are_longitudes(write_scene: WriteScene) -> None:
    swapped = box(40, 120, 50, 130)
    path = write_scene(scene("a.geojson", "[]"), a=geojson(swapped))
    message = "scene.yaml:4:15: a.geojson has latitudes up to 130"
    assert told(path) == [f"{message} = {SWAPPED}; {OR_PLANAR}"]
    path.write_text(scene("{file: a.geojson, crs: EPSG:4326}", "[]"))
    assert told(path) == [f"{message.replace('15', '22')} = {SWAPPED}"]
    path.write_text(scene("a.geojson", "[]", frame="projection: none"))
    assert tuple(bounds(load(path))) == swapped.bounds


def test_hint_for_planar_data_in_a_file_that_says_degrees_helps(tmp_path: Path) -> None:
    """The file's own system comes first, so that naming another one would change nothing."""
    write(tmp_path / "a.gpkg", [PLANAR], crs="EPSG:4326")
    (tmp_path / "scene.yaml").write_text(scene("a.gpkg", "[]"))
    (message,) = told(tmp_path / "scene.yaml")
    assert message.startswith("scene.yaml:4:15: a.gpkg has latitudes up to 5000 = ")
    assert "name its coordinate reference system: crs" not in message


@pytest.mark.parametrize(
    ("crs", "what"),
    [
        (None, "is in longitude and latitude: projecting it needs"),
        ("EPSG:3857", "is in EPSG:3857: reading that needs"),
    ],
)
def test_missing_library_is_told_with_how_to_install_it(
    write_scene: WriteScene, monkeypatch: pytest.MonkeyPatch, crs: str | None, what: str
) -> None:
    path = write_scene(scene("a.geojson", "[]"), a=geojson(COUNTY, crs))
    monkeypatch.setitem(sys.modules, "pyproj", None)
    assert told(path) == [
        f"scene.yaml:4:15: a.geojson {what} the package pyproj = "
        "pip install 'geotween[geo]', or draw it as it is: map: {projection: none}"
    ]


ACROSS = shapely.Polygon([(175, 10), (-175, 10), (-175, 20), (175, 20)])
WORLD = box(-180, -90, 180, 90)


def test_a_polygon_across_180_degrees_comes_whole_to_a_projected_first_source(
    write_scene: WriteScene,
) -> None:
    plane = geojson(box(-2e6, 1e6, -1e6, 2e6), "EPSG:3832")  # the Pacific's Mercator
    found = load(write_scene(scene("a.geojson", "b.geojson"), a=plane, b=geojson(ACROSS)))
    (shape,) = found.steps[1].regions.polygons
    assert shape.is_valid
    assert np.ptp(bounds(found, 1)[::2]) == pytest.approx(10 / 360 * 2 * np.pi * 6378137)


def test_a_background_of_the_world_ends_where_the_map_of_the_first_source_does(
    write_scene: WriteScene,
) -> None:
    plane = geojson(box(0, 0, 1e6, 1e6), "EPSG:3857")
    text = scene("a.geojson", "[]", frame="layers: [{polygons: w.geojson}]")
    found = load(write_scene(text, a=plane, w=geojson(WORLD)))
    ((_, world),) = found.layers
    assert np.abs(world.bounds).max() == pytest.approx(20_048_966)
    assert [p.kind for p in found.problems if p.severity == "warning"] == ["beyond projection"]


def test_a_static_layer_lies_under_the_step_whose_frame_is_the_maps(
    write_scene: WriteScene,
) -> None:
    text = scene("a.geojson", "b.geojson", frame="fit: each, layers: [{polygons: c.geojson}]")
    far = geojson(shapely.affinity.translate(COUNTY, 80, -30))
    land = geojson(COUNTY.buffer(0.3))
    found = load(write_scene(text, a=geojson(COUNTY), b=far, c=land))
    ((_, layer),) = found.layers
    assert layer.polygons[0].contains(found.steps[0].regions.polygons[0])


def test_a_box_of_200_degrees_is_as_wide_as_it_is_written(write_scene: WriteScene) -> None:
    wide, inside = geojson(box(-100, -30, 100, 50)), geojson(box(-10, 0, 10, 10))
    found = load(write_scene(scene("a.geojson", "b.geojson"), a=wide, b=inside))
    assert found.steps[0].regions.polygons[0].contains(found.steps[1].regions.polygons[0])
    assert not [p for p in found.problems if p.kind == "antimeridian"]


def test_degrees_and_metres_without_a_system_are_asked_for(write_scene: WriteScene) -> None:
    path = write_scene(scene("a.geojson", "b.geojson"), a=geojson(COUNTY), b=geojson(PLANAR))
    assert told(path) == [
        "scene.yaml:5:15: b.geojson is not in longitude and latitude, as other files seem to be = "
        f"name its system: {{file: …, crs: …}}; {OR_PLANAR}"
    ]


def test_areas_too_small_for_all_are_told(write_scene: WriteScene) -> None:
    path = write_scene(scene("a.geojson", "[]", frame="min_area: 1e9"), a=geojson(COUNTY))
    assert told(path) == ["scene.yaml:2:17: no step has a polygon as large as this"]
