"""The gallery's scenes as they go into pictures, each planned once."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest

from geotween.data.load import load
from geotween.export.build import shown_scene
from geotween.export.jobs import plan_scenes
from geotween.export.pictures.picture import Shown
from geotween.export.resources import resource
from tests.conftest import WriteScene

GALLERY = sorted(path.stem for path in resource("scenes").glob("*.yaml"))

# A red square of 72 px that goes from x = 10 px to x = 118 px in the two seconds from 1 to 3.
SQUARES = """\
title: Squares
source: By hand
timing: {transition: 2, hold: 1}
map: {width: 200, padding: 10, labels: none}
style: {fill: "#ff0000", stroke: none}
motion: {easing: linear, method: morph}
steps:
  - label: Before
    polygons: {type: FeatureCollection, features: [
      {type: Feature, properties: {key: one},
       geometry: {type: Polygon, coordinates: [[[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]]]}}]}
  - label: After
    polygons: {type: FeatureCollection, features: [
      {type: Feature, properties: {key: one},
       geometry: {type: Polygon, coordinates: [[[6, 0], [10, 0], [10, 4], [6, 4], [6, 0]]]}}]}
"""


def as_shown(path: Path) -> Shown:
    scene = load(path)
    (plans,) = plan_scenes([scene])
    return shown_scene(scene, plans)


@cache
def gallery_scene(name: str) -> Shown:
    """A scene of the gallery; planned once for all tests of a process."""
    return as_shown(resource("scenes") / f"{name}.yaml")


@pytest.fixture
def squares(write_scene: WriteScene) -> Shown:
    return as_shown(write_scene(SQUARES))
