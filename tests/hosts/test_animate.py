"""Scenes from tables in memory."""

from __future__ import annotations

import datetime
from typing import Any

import geopandas
import numpy as np
import pandas
import pytest
from shapely.geometry import Point, box

import geotween
from geotween import SceneError, animate


def table(crs: str | None = None, size: float = 1000, **columns: Any) -> geopandas.GeoDataFrame:
    """Two neighbours, of which the left one grows."""
    sides = [(0, 2), (2, 4), (0, 3), (3, 4)]
    shapes = [box(left * size, 0, right * size, 2 * size) for left, right in sides]
    rows = {"day": [1, 1, 2, 2], "who": ["a", "b", "a", "b"], **columns}
    return geopandas.GeoDataFrame(rows, geometry=shapes, crs=crs)


def labels(scene: geotween.Scene) -> list[str]:
    return [step.label for step in scene.steps]


def keys(scene: geotween.Scene) -> list[list[object]]:
    return [[i.key for i in step.regions.identities] for step in scene.steps]


def test_one_line_makes_a_scene() -> None:
    scene = animate(table(), time="day", key="who")
    assert (labels(scene), keys(scene)) == (["1", "2"], [["a", "b"], ["a", "b"]])
    assert (scene.projection, scene.problems) == ("", ())
    assert [p.area for p in scene.steps[1].regions.polygons] == [6e6, 2e6]


@pytest.mark.parametrize(
    ("times", "found"),
    [
        (pandas.to_datetime(["2024-01-05"] * 2 + ["2024-02-01"] * 2), ["2024-01-05", "2024-02-01"]),
        ([datetime.date(2024, 1, 5)] * 2 + [datetime.date(2024, 2, 1)] * 2,
         ["2024-01-05", "2024-02-01"]),
        (np.array([1984.0, 1984, 1990, 1990]), ["1984", "1990"]),
        (["2024-02", "2024-02", "2024-01", "2024-01"], ["2024-01-01", "2024-02-01"]),
    ],
    ids=["timestamps", "dates", "numbers", "texts"],
)  # fmt: skip
def test_times_of_every_kind(times: Any, found: list[str]) -> None:
    assert labels(animate(table(day=times), time="day", key="who")) == found


def test_times_can_be_chosen_and_rows_selected() -> None:
    scene = animate(table(), time="day", key="who", times=[1, 2], where="who = 'a'")
    assert keys(scene) == [["a"], ["a"]]


def test_a_table_says_where_it_is() -> None:
    scene = animate(table("EPSG:4326", size=1), time="day", key="who")
    assert "equal-area" in scene.projection
    assert scene.crs is not None
    with pytest.raises(SceneError, match="GeoDataFrame names no coordinate reference system"):
        animate(table(size=1), time="day")


def test_what_a_scene_file_may_say_goes_as_keywords() -> None:
    scene = animate(
        table(), time="day", title="Borders", map={"width": 400, "clean": True},
        style={"fill": "#112233"}, steps=[{"caption": "first"}, {"caption": "then"}],
    )  # fmt: skip
    assert (scene.model.title, scene.model.map.width) == ("Borders", 400)
    assert [step.caption for step in scene.steps] == ["first", "then"]


def test_missing_values_are_no_keys_and_points_are_left_out() -> None:
    data = table(who=["a", None, "a", float("nan")])
    data.loc[3, "geometry"] = Point(0, 0)
    scene = animate(data, time="day", key="who")
    assert [[i.keyed for i in s.regions.identities] for s in scene.steps] == [[True, False], [True]]


def test_columns_and_options_that_are_wrong_are_told_like_a_file() -> None:
    with pytest.raises(SceneError) as caught:
        animate(table(), time="date", key="who")
    assert 'GeoDataFrame has no column "date"' in str(caught.value)
    assert "there are day, who" in str(caught.value)
    with pytest.raises(SceneError, match='unknown key "colour"'):
        animate(table(), time="day", style={"colour": "red"})
    with pytest.raises(SceneError, match="needs at least two steps, and this makes 1"):
        animate(table(day=[1, 1, 1, 1]), time="day")


def test_geojson_features_will_do() -> None:
    features = table(size=1).to_geo_dict()
    assert keys(animate(features, time="day", key="who")) == [["a", "b"], ["a", "b"]]


def test_anything_else_will_not() -> None:
    with pytest.raises(TypeError, match="expected a GeoDataFrame or GeoJSON features, not a list"):
        animate([box(0, 0, 1, 1)], time="day")


def test_same_table_gives_the_same_page(tmp_path: Any) -> None:
    pages = [
        animate(table(), time="day", key="who").save(tmp_path / name).read_bytes()
        for name in ("one.html", "two.html")
    ]
    assert pages[0] == pages[1]
