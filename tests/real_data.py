"""Real polygon sets that may lie beside the project; tests that use them skip where they do not."""

from __future__ import annotations

from pathlib import Path

import pytest

SETS = Path(__file__).resolve().parents[2] / "shared" / "data"

needs_real_data = pytest.mark.skipif(
    not SETS.is_dir(), reason="the real polygon sets are not present beside the project"
)

# What somebody would write who has such a folder.
SCENES = {
    "us_fig9_split": """
title: From Pennsylvania over Hawaii to Michigan
data: SETS/us_fig9_split
map: {fit: each}
""",
    "us_fig9_split-px": """
title: From Pennsylvania over Hawaii to Michigan, in pixels
data: SETS/us_fig9_split/albers-px
map: {fit: each, y: down}
""",
    "us_regions": """
title: The nation, its regions, divisions and states
data: {file: SETS/us_regions/step-*.geojson, key: id}
steps: [{label: Nation}, {label: Regions}, {label: Divisions}, {label: States}]
""",
    "wildfire_creek2020": """
title: The Creek Fire, day by day
data: {file: SETS/wildfire_creek2020, time: date}
style: {fill: "#c1440e", stroke: none}
timing: {transition: 1, hold: 0.5}
steps:
  - {time: 2020-09-05, caption: The first day.}
""",
    "hurricane_sandy_winds": """
title: The winds of Hurricane Sandy
data: {file: SETS/hurricane_sandy_winds, class: category}
map: {width: 500}
style: {class: {34kt: {fill: "#56b4e9"}, 50kt: {fill: "#0072b2"}, 64kt: {fill: "#003e63"}}}
timing: {transition: 0.5, hold: 0.25}
""",
    "scale_us_counties": """
title: Counties and states
data:
  file: SETS/scale_us_counties
  key: id
  class: state
  where: state NOT IN ("60", "66", "69", "72", "78")  # islands beyond the fifty states
map: {classes: together, clean: true}
steps: [{label: Counties}, {label: States}]
""",
}


def files(name: str) -> list[Path]:
    """The steps of a set, in order of time."""
    return sorted((SETS / name).glob("step-*.geojson"))


def write_scene(folder: Path, name: str, head: str = "") -> Path:
    """A set's scene as a file; ``head`` is further YAML."""
    path = folder / f"{name}.yaml"
    path.write_text(SCENES[name].replace("SETS", str(SETS)) + head, encoding="utf-8")
    return path
