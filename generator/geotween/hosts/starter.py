"""The files to begin with: a commented scene with data, or one of the shipped examples."""

from __future__ import annotations

import json
from pathlib import Path

from geotween.data.load import load
from geotween.export.resources import resource
from geotween.scene.read import scene_schema

SCHEMA = "scene.schema.json"
STARTER = Path("starter/scene.yaml")
STARTER_DATA = {"perimeters.geojson": "fire.geojson"}  # as the starter calls it, as it is shipped


def examples() -> list[str]:
    """The names of the shipped examples."""
    return sorted(path.stem for path in resource("scenes").glob("*.yaml"))


def starter_files(example: str | None = None) -> dict[str, bytes]:
    """A scene, its data and the schema for editors, by name.

    Raises
    ------
    KeyError
        Where no example is called so.
    """
    scenes = resource("scenes")
    if example is None:
        sources = {STARTER.name: scenes / STARTER}
        sources |= {name: scenes / shipped for name, shipped in STARTER_DATA.items()}
    elif example in examples():
        reads: set[Path] = set()
        load(scenes / f"{example}.yaml", reads=reads)
        sources = {path.name: path for path in sorted(reads)}
    else:
        raise KeyError(example)
    schema = json.dumps(scene_schema(), indent=2, ensure_ascii=False) + "\n"
    return {**{name: path.read_bytes() for name, path in sources.items()}, SCHEMA: schema.encode()}
