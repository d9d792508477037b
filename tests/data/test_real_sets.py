"""Real sets from file to simplified steps, and the same set in several formats."""

from __future__ import annotations

import zipfile
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pyogrio
import pytest
import shapely
from numpy.typing import NDArray

import geotween
from geotween.data.frame import pixels_per_unit
from geotween.data.load import Scene
from geotween.data.polygons import bounds_of
from tests.real_data import SCENES, files, needs_real_data, write_scene

Edges = set[tuple[tuple[float, float], tuple[float, float]]]

pytestmark = needs_real_data


def pixel(scene: Scene) -> float:
    """The length of a pixel in the scene's plane."""
    return 1 / pixels_per_unit(scene.model.map, bounds_of([step.regions for step in scene]))


def borders(polygons: NDArray[np.object_]) -> Any:
    return shapely.get_rings(polygons)


def edges(polygons: NDArray[np.object_]) -> Edges:
    found: Edges = set()
    for ring in borders(polygons):
        points = [tuple(point) for point in shapely.get_coordinates(ring)]
        found |= {(min(a, b), max(a, b)) for a, b in pairwise(points)}
    return found


@pytest.mark.parametrize("name", SCENES)
def test_a_real_set_is_a_scene_of_at_most_15_lines_without_a_warning(
    name: str, tmp_path: Path
) -> None:
    assert len(SCENES[name].strip().splitlines()) <= 15
    scene = geotween.load(write_scene(tmp_path, name))
    assert len(scene.steps) == len(files(name.replace("-px", "/albers-px")))
    serious = [p for p in scene.problems if p.severity != "note"]
    repaired = name == "scale_us_counties"  # 22 of its polygons are invalid
    assert {p.kind for p in serious} == ({"repaired"} if repaired else set())


@pytest.mark.parametrize("tolerance", [0.25, 2])
def test_a_simplified_tiling_stays_one_within_the_tolerance(
    tolerance: float, tmp_path: Path
) -> None:
    path = write_scene(tmp_path, "us_regions", "map: {simplify: off}\n")
    exact = geotween.load(path)
    path = write_scene(tmp_path, "us_regions", f"map: {{simplify: {tolerance}}}\n")
    simple = geotween.load(path)
    allowed = tolerance * pixel(exact) * (1 + 1e-9)
    for before, after in zip(exact, simple, strict=True):
        assert shapely.coverage_is_valid(after.regions.polygons)
        rings, simpler = borders(before.regions.polygons), borders(after.regions.polygons)
        assert shapely.get_num_coordinates(simpler).sum() < shapely.get_num_coordinates(rings).sum()
        fine, finer = shapely.segmentize([rings, simpler], allowed)
        assert shapely.hausdorff_distance(fine, simpler).max() <= allowed
        assert shapely.hausdorff_distance(finer, rings).max() <= allowed


def test_borders_that_steps_have_in_common_are_simplified_alike(tmp_path: Path) -> None:
    exact = geotween.load(write_scene(tmp_path, "us_regions", "map: {simplify: off}\n"))
    simple = geotween.load(write_scene(tmp_path, "us_regions", "map: {simplify: 2}\n"))
    for coarse, fine in zip((0, 1, 2), (1, 2, 3), strict=True):
        assert edges(exact.steps[coarse].regions.polygons) <= edges(
            exact.steps[fine].regions.polygons
        )
        assert edges(simple.steps[coarse].regions.polygons) <= edges(
            simple.steps[fine].regions.polygons
        )


def test_sandys_classes_lie_in_layers_the_strongest_above(tmp_path: Path) -> None:
    scene = geotween.load(write_scene(tmp_path, "hurricane_sandy_winds"))
    assert scene.layer_order == ("34kt", "50kt", "64kt")


def test_creeks_unburnt_islands_are_kept(tmp_path: Path) -> None:
    scene = geotween.load(write_scene(tmp_path, "wildfire_creek2020"))
    holes = [int(shapely.get_num_interior_rings(step.regions.polygons).sum()) for step in scene]
    given = [
        int(shapely.get_num_interior_rings(shapely.get_parts(geometries(file))).sum())
        for file in files("wildfire_creek2020")
    ]
    assert holes == given
    assert max(holes) > 15


def test_alaska_and_hawaii_are_where_they_lie(tmp_path: Path) -> None:
    scene = geotween.load(write_scene(tmp_path, "scale_us_counties"))
    states = scene.steps[1].regions
    names = np.array([i.name for i in states.identities])
    alaska, hawaii, texas, maine = (
        shapely.total_bounds(states.polygons[names == name])
        for name in ("Alaska", "Hawaii", "Texas", "Maine")
    )
    assert alaska[1] > texas[3]
    assert hawaii[2] < texas[0] < maine[0]
    assert alaska[2] - alaska[0] < 4.5e6  # m; 3,600 km from Attu to Ketchikan, in one piece


def geometries(file: Path) -> Any:
    return shapely.from_wkb(pyogrio.raw.read(file)[2])


def test_a_folder_a_geopackage_and_a_zipped_shapefile_give_the_same_steps(tmp_path: Path) -> None:
    name = "wildfire_creek2020"
    read = [pyogrio.raw.read(file, columns=["name", "date"]) for file in files(name)]
    binary = np.concatenate([of_one[2] for of_one in read])
    columns = [np.concatenate([of_one[3][i] for of_one in read]).astype(str) for i in range(2)]
    for file, driver in (("creek.gpkg", "GPKG"), ("creek.shp", "ESRI Shapefile")):
        pyogrio.raw.write(
            tmp_path / file, binary, [c.astype(object) for c in columns], ["name", "date"],
            driver=driver, geometry_type="MultiPolygon", crs="EPSG:4326",
            promote_to_multi=True,
        )  # fmt: skip
    with zipfile.ZipFile(tmp_path / "creek.zip", "w") as archive:
        for part in tmp_path.glob("creek.[sdp][hbr]*"):
            archive.write(part, part.name)
    folder = geotween.load(write_scene(tmp_path, name))
    for other in ("creek.gpkg", "creek.zip"):
        path = tmp_path / "other.yaml"
        path.write_text(f"title: t\ndata: {{file: {other}, time: date}}\n", encoding="utf-8")
        found = geotween.load(path)
        assert found.projection == folder.projection
        assert [step.label for step in found] == [step.label for step in folder]
        for one, same in zip(folder, found, strict=True):
            assert shapely.equals_exact(
                shapely.multipolygons(one.regions.polygons),
                shapely.multipolygons(same.regions.polygons),
                tolerance=0.01 * pixel(folder),
                normalize=True,
            )
