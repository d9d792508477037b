"""The gallery's scenes against what they were: an outline of every path of every span.

The outlines are rounded to whole pixels and compared with a tolerance of one, so that another
version of a geometry library may differ in its last digits. ``make golden`` writes them anew.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import geotween
from geotween.export.build import plan_scene
from geotween.export.keyframes import keyframes
from geotween.export.page_grid import GRID
from geotween.export.resources import resource
from geotween.export.shapes import Shape
from geotween.motion.divide import divide

GOLDEN = Path(__file__).parent / "golden"
SCENES = sorted(resource("scenes").glob("*.yaml"))


def outline(shape: Shape) -> dict[str, Any]:
    """Who a path is, how it is painted, how many rings it has, and its box at both ends."""
    ends = [np.concatenate([t.vertices[k] for t in shape.tracks]) * GRID for k in (0, -1)]
    return {
        "kind": shape.slot.kind,
        "key": shape.slot.key,
        "fill": [paint.fill for paint in shape.paints],
        "rings": sum(len(t.offsets) - 1 for t in shape.tracks),
        "boxes": [np.rint([*e.min(axis=0), *e.max(axis=0)]).tolist() for e in ends],
    }


def outlines(path: Path) -> list[dict[str, Any]]:
    scene = geotween.load(path)
    frames = keyframes(scene, plan_scene(scene)[0])
    return [
        {"start": span.start, "end": span.end, "shapes": [outline(s) for s in shapes]}
        for span, shapes in frames.spans
    ]


def without_boxes(spans: list[dict[str, Any]]) -> list[dict[str, Any]]:
    return [
        {**s, "shapes": [{k: v for k, v in x.items() if k != "boxes"} for x in s["shapes"]]}
        for s in spans
    ]


def boxes(spans: list[dict[str, Any]]) -> list[list[float]]:
    return [box for span in spans for shape in span["shapes"] for box in shape["boxes"]]


@pytest.mark.parametrize("path", SCENES, ids=lambda p: p.stem)
def test_a_scene_is_what_it_was(path: Path, request: pytest.FixtureRequest) -> None:
    golden, found = GOLDEN / f"{path.stem}.json", outlines(path)
    text = json.dumps(found, indent=1) + "\n"
    if request.config.getoption("--update-golden"):
        golden.write_text(text, encoding="utf-8")
    known = json.loads(golden.read_text(encoding="utf-8"))
    golden.with_suffix(".json.new").write_text(text, encoding="utf-8")
    assert without_boxes(found) == without_boxes(known)
    assert np.abs(np.subtract(boxes(found), boxes(known))).max() <= 1
    golden.with_suffix(".json.new").unlink()


def test_the_gallery_has_splits_merges_births_deaths_and_holes() -> None:
    seen = set()
    for path in SCENES:
        scene = geotween.load(path)
        for morph in plan_scene(scene)[0]:
            divisions = (d for one in morph.layers for d in (one.division, divide(one.swept)))
            origin, target = np.concatenate([division.indices for division in divisions]).T
            seen |= {"birth"} if (origin < 0).any() else set()
            seen |= {"death"} if (target < 0).any() else set()
            seen |= {"split"} if np.bincount(origin[origin >= 0], minlength=1).max() > 1 else set()
            seen |= {"merge"} if np.bincount(target[target >= 0], minlength=1).max() > 1 else set()
        polygons = [p for step in scene for p in step.regions.polygons]
        seen |= {"hole"} if any(p.interiors for p in polygons) else set()
        assert len(scene.steps) >= 3
        assert max(len(step.regions) for step in scene) > 1
        assert scene.model.source
    assert seen == {"birth", "death", "split", "merge", "hole"}
