"""What all tests share: how long properties are searched, and scenes written to a folder."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import settings

settings.register_profile("default", deadline=None, derandomize=True)
settings.register_profile("prove", deadline=None, max_examples=2000)  # make prove
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "default"))

os.environ["GEOTWEEN_CACHE"] = ""  # tests plan anew, and keep nothing

WriteScene = Callable[..., Path]

# Two steps, each a square of side 4; the second one lies 1 to the right.
SCENE = """\
title: Two squares
steps:
  - polygons: [[[0, 0], [4, 0], [4, 4], [0, 4]]]
  - polygons: [[[1, 0], [5, 0], [5, 4], [1, 4]]]
"""


@pytest.fixture
def write_scene(tmp_path: Path) -> WriteScene:
    """Write a scene, and what it names, into an empty folder; the path of the scene comes back."""

    def write(text: str | bytes = SCENE, name: str = "scene.yaml", **files: str | bytes) -> Path:
        for stem, content in {**files, "": text}.items():
            path = tmp_path / (f"{stem}.geojson" if stem else name)
            path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return tmp_path / name

    return write


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--update-golden", action="store_true", help="write the golden outlines anew")
