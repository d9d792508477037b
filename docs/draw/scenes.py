"""Frames of scenes, those of the repository and of real sets: five moments of one transition."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon

from docs.draw.canvas import Box, Canvas, mixed
from geotween.data.load import Step, load
from geotween.data.polygons import bounds_of
from geotween.export.build import plan_scene
from geotween.export.paint import Painter
from geotween.export.paths import runs
from geotween.export.resources import resource
from geotween.motion.tracks import SEAM_AT_ORIGIN, SEAM_AT_TARGET, Track

MOMENTS = (0.0, 0.25, 0.5, 0.75, 1.0)
WIDTH = 170
# px by which outlines in the figure may be off.
OFF = 0.3
# What is smaller than this is not drawn, in px².
SPECK = 1.0
# Widths in px: of outlines, and of what closes the hairline between pieces of one fill.
STROKE, HAIR = 0.5, 0.8
# The transition that is drawn of each scene, by its number.
SHOWN = {"fire": 3, "territory": 1, "lake": 3, "hotspots": 3}


# Public sets that may lie beside the project: scenes, and the transition of each that is drawn.
SETS = Path(__file__).resolve().parents[3] / "shared" / "data"
REAL = {
    "creek": (
        """
title: The Creek Fire of 2020
data: {file: SETS/wildfire_creek2020, time: date}
style: {fill: "#c1440e", stroke: none}
""",
        1,
    ),
    "nation": (
        """
title: The regions and the divisions of the United States
data: {file: SETS/us_regions/step-*.geojson, key: id}
steps: [{label: Nation}, {label: Regions}, {label: Divisions}, {label: States}]
""",
        1,
    ),
    "storm": (
        """
title: The winds of Hurricane Sandy
data: {file: SETS/hurricane_sandy_winds, class: category, key: id}
style: {class: {34kt: {fill: "#56b4e9"}, 50kt: {fill: "#0072b2"}, 64kt: {fill: "#003e63"}}}
""",
        12,
    ),
}


def frames(path: Path, number: int) -> str:
    """The transition of a scene that has this number."""
    scene = load(path)
    scene = replace(scene, steps=scene.steps[number : number + 2])
    tracks = plan_scene(scene)[0][0].tracks
    everyone = (identity for step in scene.steps for identity in step.regions.identities)
    painter = Painter(scene.model.style, everyone, scene.layer_order)
    before, after = scene.steps
    titles = [
        f"{before.label}, t = 0",
        *(f"t = {t}" for t in MOMENTS[1:-1]),
        f"{after.label}, t = 1",
    ]
    label = f"{scene.model.title}, {before.label} to {after.label}, at five moments"
    box = _box(scene.steps)
    ground = scene.model.map.background
    canvas = Canvas(box, titles, WIDTH, label=label, ground=ground)
    places = {layer: place for place, layer in enumerate(scene.layer_order)}
    ordered = sorted(tracks, key=lambda track: places.get(track.layer, 0))
    for panel, t in enumerate(MOMENTS):
        for layer, polygons in scene.layers:
            near = shapely.clip_by_rect(polygons.polygons, *box)
            canvas.area(panel, shapely.simplify(near, OFF / canvas.scale), layer.fill)
        for track in ordered:
            if track.is_there(t):
                polygon = shapely.simplify(_polygon(track, t), OFF / canvas.scale)
                if polygon.area * canvas.scale**2 < SPECK:
                    continue
                one, other = (painter.paint(identity) for identity in track.ends)
                fill = mixed(one.fill, other.fill, t)
                canvas.area(panel, polygon, fill, stroke=fill, stroke_width=HAIR)
                if one.stroked:
                    canvas.lines(panel, _stroked(track, t, OFF / canvas.scale), one.stroke, STROKE)
    return canvas.svg()


def real(name: str) -> str:
    """A transition of a real set, which lies beside the project."""
    text, number = REAL[name]
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"{name}.yaml"
        path.write_text(text.replace("SETS", str(SETS)), encoding="utf-8")
        return frames(path, number)


FIGURES: dict[str, Callable[[], str]] = {
    name: partial(frames, resource("scenes") / f"{name}.yaml", number)
    for name, number in SHOWN.items()
} | {name: partial(real, name) for name in REAL}


def _box(steps: Sequence[Step]) -> Box:
    low_x, low_y, high_x, high_y = bounds_of([step.regions for step in steps])
    margin = 0.03 * max(high_x - low_x, high_y - low_y)
    return low_x - margin, low_y - margin, high_x + margin, high_y + margin


def _polygon(track: Track, t: float) -> Polygon:
    rings = np.split(track.at(t), track.offsets[1:-1])
    return Polygon(rings[0], rings[1:])


def _stroked(track: Track, t: float, off: float) -> list[LineString]:
    """The lines of a track but for seams, which are closed at their end of the transition."""
    closed = {0.0: SEAM_AT_ORIGIN, 1.0: SEAM_AT_TARGET}.get(t, 0)
    drawn = [
        np.append(line, line[0]) if whole else line
        for line, whole in runs((track.seams & closed) == 0, track.offsets)
    ]
    return [shapely.simplify(LineString(track.at(t)[line]), off) for line in drawn]
