"""Real polygon sets that may lie beside the project; tests that use them skip where they do not."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

SETS = Path(__file__).resolve().parents[2] / "shared" / "data"

needs_real_data = pytest.mark.skipif(
    not SETS.is_dir(), reason="the real polygon sets are not present beside the project"
)


def files(name: str) -> list[Path]:
    """The steps of a set, in order of time."""
    return sorted((SETS / name).glob("step-*.geojson"))


def write_scene(folder: Path, name: str, rest: str) -> Path:
    """A scene of all steps of a set; ``rest`` is further YAML."""
    steps = "".join(
        f"  - {{label: {json.dumps(file.stem)}, polygons: {json.dumps(str(file))}}}\n"
        for file in files(name)
    )
    path = folder / f"{name.replace('/', '-')}.yaml"
    path.write_text(f"title: {name}\n{rest}\nsteps:\n{steps}", encoding="utf-8")
    return path
