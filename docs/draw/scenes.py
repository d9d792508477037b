"""Frames of the repository's scenes: five moments of one transition each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
import shapely
from shapely.geometry import Polygon

from docs.draw.canvas import Box, Canvas, Floats, mixed
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
OFF = 0.15
# Widths in px: of outlines, and of what closes the hairline between pieces of one fill.
STROKE, HAIR = 0.5, 0.8
# The transition that is drawn of each scene, by its number.
SHOWN = {"fire": 3, "territory": 1, "lake": 3, "hotspots": 3}


def frames(name: str, number: int) -> str:
    scene = load(resource("scenes") / f"{name}.yaml")
    tracks = plan_scene(scene)[0][number].tracks
    everyone = (identity for step in scene.steps for identity in step.regions.identities)
    painter = Painter(scene.model.style, everyone, scene.layer_order)
    before, after = scene.steps[number : number + 2]
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
                one, other = (painter.paint(identity) for identity in track.ends)
                fill = mixed(one.fill, other.fill, t)
                canvas.area(panel, polygon, fill, stroke=fill, stroke_width=HAIR)
                if one.stroked:
                    canvas.lines(panel, _stroked(track, t), one.stroke, STROKE)
    return canvas.svg()


FIGURES: dict[str, Callable[[], str]] = {
    name: partial(frames, name, number) for name, number in SHOWN.items()
}


def _box(steps: Sequence[Step]) -> Box:
    low_x, low_y, high_x, high_y = bounds_of([step.regions for step in steps])
    margin = 0.03 * max(high_x - low_x, high_y - low_y)
    return low_x - margin, low_y - margin, high_x + margin, high_y + margin


def _polygon(track: Track, t: float) -> Polygon:
    rings = np.split(track.at(t), track.offsets[1:-1])
    return Polygon(rings[0], rings[1:])


def _stroked(track: Track, t: float) -> list[Floats]:
    """The lines of a track but for seams, which are closed at their end of the transition."""
    closed = {0.0: SEAM_AT_ORIGIN, 1.0: SEAM_AT_TARGET}.get(t, 0)
    drawn = [
        np.append(line, line[0]) if whole else line
        for line, whole in runs((track.seams & closed) == 0, track.offsets)
    ]
    return [track.at(t)[line] for line in drawn]
