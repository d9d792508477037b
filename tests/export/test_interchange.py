"""Keyframes for others: JSON by the small decoder, path pairs by their numbers, GeoJSON by GDAL."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pyogrio
import pytest
import shapely
from shapely.geometry import Polygon

import geotween
from geotween.export.build import plan_scene, render_scene
from geotween.export.decoded import tracks_told
from geotween.export.page_grid import GRID, fit_page
from tests.conftest import SCENE, WriteScene

DATED = """\
title: Two
map: {crs: EPSG:4326, simplify: off, PROJECTION}
steps:
  - time: 2024-01-01
    polygons: [{key: a, name: Aland, class: x, polygon: [[7, 50], [8, 50], [8, 51], [7, 51]]}]
  - time: 2024-01-11
    polygons: [{key: a, name: Aland, class: x, polygon: [[7, 50], [9, 50], [9, 51], [7, 51]]}]
  - time: 2024-02-10
    polygons: [{key: a, name: Aland, class: x, polygon: [[7, 50], [9, 50], [9, 52], [7, 52]]}]
"""


def dated(projection: str = "EPSG:3035") -> str:
    return DATED.replace("PROJECTION", f"projection: {projection}")


def told(scene: geotween.Scene, name: str, **options: Any) -> Any:
    (content,) = render_scene(scene, [name], **options).files.values()
    return json.loads(content)


def rings(path: str) -> list[np.ndarray]:
    found = [re.findall(r"-?[\d.]+", ring) for ring in path.split("Z") if ring]
    return [np.array(numbers, dtype=float).reshape(-1, 2) for numbers in found]


def test_json_is_read_by_the_small_decoder(write_scene: WriteScene) -> None:
    scene = geotween.load(write_scene())
    data = told(scene, "json")
    (moving,) = [t for t in tracks_told(data) if (t.at(0) != t.at(1)).any()]
    page = fit_page(scene.model.map, [step.regions for step in scene.steps])
    for end, step in zip((0.0, 1.0), scene.steps, strict=True):
        drawn = Polygon(moving.at(end) * data["grid"])
        wanted = shapely.transform(step.regions.polygons[0], page.pixels)
        assert drawn.symmetric_difference(wanted).area < 1
    assert (data["map"]["width"], data["map"]["height"]) == (page.width, page.height)
    assert data["about"]["title"] == "Two squares"


def test_static_layers_go_along(write_scene: WriteScene) -> None:
    layer = "{name: sea, fill: blue, polygons: [[[0, 0], [9, 0], [9, 9]]]}"
    data = told(geotween.load(write_scene(f"map: {{layers: [{layer}]}}\n{SCENE}")), "json")
    (sea,) = data["map"]["layers"]
    assert (sea["name"], sea["fill"], sea["above"]) == ("sea", "#0000ff", False)
    assert sea["d"].startswith("M")


@pytest.mark.parametrize("method", ["morph", "front", "paper"])
def test_paths_of_a_region_have_the_same_commands_at_all_times(
    write_scene: WriteScene, method: str
) -> None:
    holed = SCENE.replace("[4, 4], [0, 4]]", "[4, 4], [0, 4]], [[1, 1], [1, 2], [2, 2]]", 1)
    holed = holed.replace("- polygons: [[[0", "- polygons: [[[[0").replace("[2, 2]]]", "[2, 2]]]]")
    data = told(geotween.load(write_scene(f"motion: {{method: {method}}}\n{holed}")), "paths")
    stages = [s for t in data["transitions"] for r in t["regions"] for s in r["stages"]]
    assert stages
    for stage in stages:
        assert len(stage["times"]) == len(stage["d"])
        assert len({re.sub(r"-?[\d.]+", "", path) for path in stage["d"]}) == 1
        assert all(re.fullmatch(r"(M[^MLZ]+(L[^MLZ]+)*Z)+", path) for path in stage["d"])


def test_paths_begin_and_end_at_the_steps_and_move_in_straight_lines(
    write_scene: WriteScene,
) -> None:
    scene = geotween.load(write_scene(f"motion: {{method: morph}}\n{SCENE}"))
    data = told(scene, "paths")
    (stage,) = data["transitions"][0]["regions"][0]["stages"]
    assert stage["times"] == [0, 1]
    page = fit_page(scene.model.map, [step.regions for step in scene.steps])
    one, other = (Polygon(rings(path)[0]) for path in stage["d"])
    for drawn, step in zip((one, other), scene.steps, strict=True):
        wanted = shapely.transform(step.regions.polygons[0], page.pixels)
        assert drawn.hausdorff_distance(wanted) <= GRID
    half = Polygon((rings(stage["d"][0])[0] + rings(stage["d"][1])[0]) / 2)
    (morph,), _ = plan_scene(scene)
    wanted = shapely.transform(morph.frame(0.5).polygons[0], page.pixels)
    assert half.hausdorff_distance(wanted) <= 2 * GRID


def geojson(scene: geotween.Scene, folder: Path, between: int = 9) -> Any:
    rendered = render_scene(scene, ["geojson"], between=between)
    path = folder / "frames.geojson"
    path.write_bytes(*rendered.files.values())
    return pyogrio.read_dataframe(path)


@pytest.mark.parametrize("projection", ["EPSG:3035", "auto", "EPSG:4326"])
def test_frames_are_where_the_data_are(
    write_scene: WriteScene, tmp_path: Path, projection: str
) -> None:
    rows = geojson(geotween.load(write_scene(dated(projection))), tmp_path)
    assert rows.crs.to_epsg() == 4326
    assert rows.geometry.is_valid.all()
    assert shapely.is_ccw(shapely.get_exterior_ring(rows.geometry.values)).all()
    steps = rows[rows.t == 0].geometry
    for found, corner in zip(steps, [(8, 51), (9, 51), (9, 52)], strict=True):
        # Parallels are no straight lines on these planes, and get points that are.
        assert found.hausdorff_distance(shapely.box(7, 50, *corner)) < 2e-3


def test_frames_follow_each_other_in_time(write_scene: WriteScene, tmp_path: Path) -> None:
    rows = geojson(geotween.load(write_scene(dated())), tmp_path, between=1)
    written = [str(start)[:16] for start in rows.start]
    assert written == [
        "2024-01-01 00:00", "2024-01-06 00:00", "2024-01-11 00:00", "2024-01-26 00:00",
        "2024-02-10 00:00",
    ]  # fmt: skip
    assert list(rows.end[:-1]) == list(rows.start[1:])
    assert str(rows.end.iloc[-1])[:10] == "2024-02-25"
    assert list(rows.t) == [0, 0.5, 0, 0.5, 0]
    assert set(rows.key) == {"a"}
    assert set(rows["class"]) == {"x"}
    assert set(rows.name) == {"Aland"}


def test_without_dates_frames_follow_the_clock_of_the_map(
    write_scene: WriteScene, tmp_path: Path
) -> None:
    text = dated().replace("2024-01-01", "1").replace("2024-01-11", "2").replace("2024-02-10", "4")
    scene = geotween.load(write_scene(f"timing: {{transition: 2, hold: 1}}\n{text}"))
    rows = geojson(scene, tmp_path, between=1)
    assert [start.second for start in rows.start] == [0, 2, 3, 5, 6]
    assert rows.end.iloc[-1].second == 7
    assert list(rows.time) == [1, 1.5, 2, 3, 4]


def test_area_between_steps_grows_without_a_jump(write_scene: WriteScene, tmp_path: Path) -> None:
    rows = geojson(geotween.load(write_scene(dated())), tmp_path)
    areas = shapely.area(rows.geometry.values)
    assert (np.diff(areas) > 0).all()
    assert np.diff(areas).max() < 0.25


def test_frames_are_cut_at_the_180th_meridian(write_scene: WriteScene, tmp_path: Path) -> None:
    text = dated("auto")
    for west, east in ((7, 178), (8, 181), (9, 183)):
        text = text.replace(f"[{west}, 5", f"[{east}, 5")
    rows = geojson(geotween.load(write_scene(text)), tmp_path)
    west, _, east, _ = rows.total_bounds
    assert (west, east) == (-180, 180)
    assert rows.geometry.is_valid.all()
    widths = rows.geometry.explode().bounds
    assert (widths.maxx - widths.minx).max() < 6


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (SCENE, "nothing tells those of this map"),
        (dated().replace("simplify: off", "fit: each"), "fit: each"),
    ],
    ids=["planar", "each"],
)
def test_frames_of_nowhere_are_refused(write_scene: WriteScene, text: str, message: str) -> None:
    with pytest.raises(geotween.SceneError, match=message):
        render_scene(geotween.load(write_scene(text)), ["geojson"])
