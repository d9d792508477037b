"""A scene from its file: steps, layers, and the files that it names."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from geotween.data.load import load
from geotween.data.problems import Problem
from geotween.scene.errors import SceneError
from tests.conftest import WriteScene

SQUARE = "[[[0, 0], [4, 0], [4, 4], [0, 4]]]"
CLOCKWISE = "[[[0, 0], [0, 4], [4, 4], [4, 0]]]"
PLANAR = "map: {projection: none}"
LINE = "[[[0, 0], [1, 1], [2, 2]]]"


def scene(*steps: str, head: str = "") -> str:
    members = "".join(f"  - {{polygons: {polygons}}}\n" for polygons in steps)
    return f"title: t\n{head}\nsteps:\n{members}"


def geojson(*rings: Any, points: int = 0) -> str:
    geometries = [{"type": "Polygon", "coordinates": [ring]} for ring in rings]
    geometries += [{"type": "Point", "coordinates": [0, 0]}] * points
    features = [{"type": "Feature", "properties": {}, "geometry": g} for g in geometries]
    return json.dumps({"type": "FeatureCollection", "features": features})


def told(path: Path) -> list[str]:
    with pytest.raises(SceneError) as caught:
        load(path)
    return [
        f"{Path(f.file).name}:{f.line}:{f.column}: {f.message}" for f in caught.value.faults
    ]  # fmt: skip


def kinds(problems: tuple[Problem, ...]) -> list[tuple[str, tuple[str, ...], float]]:
    return [(p.kind, p.steps, p.measure) for p in problems]


def test_scene_has_its_name_its_path_its_model_and_its_steps(write_scene: WriteScene) -> None:
    path = write_scene(name="lake.yaml")
    found = load(path)
    assert (found.name, found.path, found.model.title) == ("lake", path, "Two squares")
    assert [step.regions.polygons[0].bounds for step in found] == [(0, 0, 4, 4), (1, 0, 5, 4)]
    assert found.problems == ()
    assert found.layers == ()


def test_path_may_be_a_text(write_scene: WriteScene) -> None:
    assert len(load(str(write_scene())).steps) == 2


def test_step_keeps_its_words_and_its_rest(write_scene: WriteScene) -> None:
    text = f"""
title: t
timing: {{hold: 3}}
steps:
  - {{label: no, caption: "It begins.", polygons: {SQUARE}}}
  - {{hold: 0, polygons: {SQUARE}}}
"""
    first, second = load(write_scene(text))
    assert (first.label, first.caption, first.hold) == ("no", "It begins.", 3)
    assert (second.label, second.caption, second.hold) == ("2", "", 0)


@pytest.mark.parametrize(
    ("time", "label"),
    [
        ("1984", "1984"),
        ("-1200000", "-1200000"),
        ("0.1", "0.1"),
        ("20240105", "20240105"),
        ("2024-01-05", "2024-01-05"),
        ("2024-01-05 12:30", "2024-01-05 12:30"),
        ("2024-01-05T12:30:01", "2024-01-05 12:30:01"),
    ],
)
def test_step_without_a_label_is_called_by_its_time(
    write_scene: WriteScene, time: str, label: str
) -> None:
    text = f"title: t\nsteps: [{{time: {time}, polygons: {SQUARE}}}, {{polygons: []}}]"
    assert [step.label for step in load(write_scene(text))] == [label, "2"]


def test_empty_step_is_allowed(write_scene: WriteScene) -> None:
    path = write_scene(scene("[]", SQUARE, '"POLYGON EMPTY"'))
    assert [len(step.regions) for step in load(path)] == [0, 1, 0]


def test_scene_without_any_polygon_is_refused(write_scene: WriteScene) -> None:
    assert told(write_scene(scene("[]", "[]"))) == ["scene.yaml:3:1: no step has a polygon"]


@pytest.mark.parametrize("fit", ["shared", "each"])
def test_scene_of_polygons_without_area_is_refused(write_scene: WriteScene, fit: str) -> None:
    path = write_scene(scene(LINE, LINE, head=f"map: {{fit: {fit}}}"))
    assert told(path) == ["scene.yaml:3:1: no step has a polygon"]


def test_steps_in_one_frame_each(write_scene: WriteScene) -> None:
    small, wide = "[[[9, 9], [11, 9], [11, 11], [9, 11]]]", "[[[0, 0], [8, 0], [8, 4], [0, 4]]]"
    path = write_scene(scene("[]", SQUARE, small, wide, head="map: {fit: each}"))
    bounds = [tuple(step.regions.bounds) for step in load(path) if len(step.regions)]
    assert bounds == [(0, 0, 4, 4), (0, 0, 4, 4), (0, 1, 4, 3)]


def test_far_coordinates_are_read_while_they_can_be_told_apart(write_scene: WriteScene) -> None:
    ring = "[[[1e10, 0], [10000000004, 0], [10000000004, 4]]]"
    assert load(write_scene(scene(ring, "[]"))).steps[0].regions.polygons[0].area == 8


def test_data_too_fine_for_their_distance_are_refused(write_scene: WriteScene) -> None:
    ring = "[[[1e11, 0], [100000000000.0625, 0], [100000000000.0625, 0.0625]]]"
    assert told(write_scene(scene(ring, "[]"))) == [
        "scene.yaml:3:1: the data span 0.0625 units at 1e+11 from the origin: too fine to draw"
    ]


# Files


def test_file_is_found_beside_the_scene(
    write_scene: WriteScene, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    monkeypatch.chdir(elsewhere)
    ring = [[0, 0], [9, 0], [9, 9], [0, 0]]
    found = load(
        write_scene(scene("polygons.geojson", SQUARE, head=PLANAR), polygons=geojson(ring))
    )
    assert found.steps[0].regions.polygons[0].bounds == (0, 0, 9, 9)


def test_file_in_a_folder_may_hold_a_bare_geometry(write_scene: WriteScene, tmp_path: Path) -> None:
    (tmp_path / "data").mkdir()
    text = '{"type": "Polygon", "coordinates": [[[0, 0], [9, 0], [9, 9], [0, 0]]]}'
    (tmp_path / "data" / "1990.json").write_text(f"\ufeff{text}", encoding="utf-8")
    found = load(write_scene(scene("data/1990.json", SQUARE, head=PLANAR)))
    assert found.steps[0].regions.polygons[0].bounds == (0, 0, 9, 9)


def test_file_with_its_byte_order_mark_tabs_and_windows_line_ends(write_scene: WriteScene) -> None:
    text = '{\r\n\t"type": "Polygon",\r\n\t"coordinates": [[[0, 0], [9, 0], [9, "x"]]]\r\n}'
    path = write_scene(scene("lake.geojson", SQUARE), lake=f"\ufeff{text}")
    assert told(path) == ["lake.geojson:3:35: expected a point [x, y], not [9, x]"]


@pytest.mark.parametrize(
    ("name", "message", "hint"),
    [
        ("lak.geojson", "cannot read lak.geojson: no such file", 'did you mean "lake.geojson"?'),
        ("data/lake.geojson", "cannot read data/lake.geojson: no such file",
         "there is no folder data/ there"),
        ("lake.geojson/x", "cannot read lake.geojson/x: not a directory",
         "there is no folder lake.geojson/ there"),
        (".", "cannot read .: is a directory", "paths are relative to the scene file"),
        ('"a\\0b"', "cannot read a\0b: embedded null byte", "paths are relative"),
        (300 * "x" + "/x", "file name too long", "paths are relative"),
    ],
)  # fmt: skip
def test_file_that_cannot_be_read_is_told_where_it_is_named(
    write_scene: WriteScene, name: str, message: str, hint: str
) -> None:
    path = write_scene(scene(SQUARE, name), lake=geojson())
    with pytest.raises(SceneError) as caught:
        load(path)
    (fault,) = caught.value.faults
    assert (fault.file, fault.line, fault.column) == (str(path), 5, 16)
    assert message in fault.message
    assert hint in fault.hint


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "1:1: not JSON: Expecting value"),
        ('{"type": "FeatureColl', "1:10: not JSON: Unterminated string starting at"),
        ('{"type": "FeatureCollection", "features": [', "1:44: not JSON: Expecting value"),
        ("<!DOCTYPE html>\n<html>", "1:1: not JSON: Expecting value"),
        ("[1, 2]", '1:1: GeoJSON needs a "type"'),
        ('"text"', '1:1: GeoJSON needs a "type"'),
        ("null", '1:1: GeoJSON needs a "type"'),
        ('{"type": "Topologie"}', '1:10: "Topologie" is no type of GeoJSON'),
        ('{"type": "\\ud800"}', '1:1: "\ud800" is no type of GeoJSON'),
        ('{\n "type": "Polygon",\n "coordinates": [[[0, 0], [1, NaN], [1, 1]]]}',
         "3:27: the coordinates 1, nan are beyond any map"),
        (b"\xff\xfe{\x00}\x00", "1:1: the byte 0xFF is not UTF-8"),
    ],
)  # fmt: skip
def test_fault_in_a_file_is_told_at_its_place_there(
    write_scene: WriteScene, content: str | bytes, message: str
) -> None:
    path = write_scene(scene("lake.geojson", SQUARE), lake=content)
    assert told(path) == [f"lake.geojson:{message}"]


def test_geometries_nested_deeper_than_can_be_followed(write_scene: WriteScene) -> None:
    opened = '{"type": "GeometryCollection", "geometries": [' * 3000
    path = write_scene(scene("lake.geojson", SQUARE), lake=opened + "]}" * 3000)
    assert told(path) == ["lake.geojson:1:1: nested too deeply"]


def test_faults_of_the_scene_and_of_its_files_come_at_once_and_sorted(
    write_scene: WriteScene,
) -> None:
    steps = ("[[[0, 0], [4, 0]]]", "lake.geojson", "[[[0, 0], [4, 0], [4, nan]]]", "sea.geojson")
    path = write_scene(scene(*steps, head="titel: x"), lake="{}")
    assert told(path) == [
        'lake.geojson:1:1: GeoJSON needs a "type"',
        'scene.yaml:2:1: unknown key "titel"',
        "scene.yaml:4:17: a ring needs at least three distinct points, not 2",
        "scene.yaml:6:34: the coordinates 4, nan are beyond any map",
        "scene.yaml:7:16: cannot read sea.geojson: no such file or directory",
    ]


# Problems


def test_repair_is_told_with_its_step(write_scene: WriteScene) -> None:
    bow_tie = "[[[0, 0], [4, 4], [4, 0], [0, 4]]]"
    found = load(write_scene(scene(SQUARE, bow_tie)))
    assert kinds(found.problems) == [("repaired", ("2",), 1.0)]
    assert all(polygon.is_valid for polygon in found.steps[1].regions.polygons)


def test_points_in_a_file_are_counted(write_scene: WriteScene) -> None:
    ring = [[0, 0], [9, 0], [9, 9], [0, 0]]
    found = load(write_scene(scene(SQUARE, "a.geojson"), a=geojson(ring, points=3)))
    assert kinds(found.problems) == [("no area", ("2",), 3)]


def test_points_are_counted_for_a_step_and_for_a_layer_apart(write_scene: WriteScene) -> None:
    ring = [[0, 0], [9, 0], [9, 9], [0, 0]]
    head = "map: {layers: [{polygons: b.geojson}, {name: sea, polygons: a.geojson}]}"
    text = scene("a.geojson", SQUARE, head=head)
    found = load(write_scene(text, a=geojson(ring, points=3), b=geojson(ring)))
    assert kinds(found.problems) == [("no area", ("1",), 3), ("no area", ("layer sea",), 3)]


def test_winding_is_noted_for_geojson_only(write_scene: WriteScene) -> None:
    clockwise = [[0, 0], [0, 9], [9, 9], [0, 0]]
    inline = f"{{type: Polygon, coordinates: {CLOCKWISE}}}"
    text = scene(CLOCKWISE, inline, "a.geojson", head=f"map: {{layers: [{{polygons: {SQUARE}}}]}}")
    found = load(write_scene(text, a=geojson(clockwise)))
    assert kinds(found.problems) == [("winding", (), 2)]
    assert found.problems[0].message.endswith("were turned, in 2 steps")
    assert all(step.regions.polygons[0].exterior.is_ccw for step in found)


# Layers


def test_layers_come_with_their_polygons(write_scene: WriteScene) -> None:
    head = f"map: {{layers: [{{name: sea, polygons: {SQUARE}}}, {{polygons: []}}]}}"
    layers = load(write_scene(scene(SQUARE, SQUARE, head=head))).layers
    assert [(layer.name, len(polygons)) for layer, polygons in layers] == [("sea", 1), ("", 0)]


def test_fault_in_a_layer_is_told_at_its_place(write_scene: WriteScene) -> None:
    head = "map: {layers: [{polygons: [[[0, 0], [4, 0]]]}, {polygons: sea.geojson}]}"
    assert told(write_scene(scene(SQUARE, SQUARE, head=head))) == [
        "scene.yaml:2:28: a ring needs at least three distinct points, not 2",
        "scene.yaml:2:59: cannot read sea.geojson: no such file or directory",
    ]
