"""Scenes and motions as notebooks show them, and as files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from geotween.data.load import Scene, Step
from geotween.data.polygons import PolygonSet
from geotween.export.build import KNOWN_FORMATS, render_scene, shown_step, write
from geotween.export.cache import default_cache
from geotween.export.interchange import NAMES
from geotween.export.jobs import plan_scenes
from geotween.export.keyframes import Keyframes, keyframes
from geotween.export.pictures.extras import MissingExtraError
from geotween.export.plans import Plan
from geotween.export.svg import still_svg
from geotween.hosts.frame import in_notebook
from geotween.motion.morph import Morph
from geotween.scene.model import Map, SceneFile

# What one file is; the others are for a page that stands beside them.
ALONE = [name for name in KNOWN_FORMATS if name not in ("embed", "fragment")]
ENDINGS = {**NAMES, "svg-still": "-still.svg"}
SUFFIXES = {name: ENDINGS.get(name, f".{name}") for name in ALONE}
WIDTH = 480  # px of the map of a motion, which has no scene to say it
MOST_IN_STRIP = 6  # maps beside each other; more of them are set in rows

Planned = tuple[Scene, Sequence[Plan | Morph]]


def as_mimebundle(shown: Scene | Morph) -> dict[str, str]:
    """A map by media type: a page in a frame, the steps side by side, and a line of text."""
    scene, plans = _planned(shown)
    frames = keyframes(scene, plans)
    words = f"{type(shown).__name__} of {len(scene.steps)} steps: {scene.model.title}"
    return {
        "text/html": _html(scene, plans, frames),
        "image/svg+xml": _steps(scene, frames),
        "text/plain": words,
    }


def as_html(shown: Scene | Morph) -> str:
    """A map's page in a frame, over a still for where frames are stripped."""
    scene, plans = _planned(shown)
    return _html(scene, plans, keyframes(scene, plans))


def save(shown: Scene | Morph, path: Path) -> Path:
    """Write a map to a file, as the suffix of its name says.

    Raises
    ------
    ValueError
        For a suffix that says no format.
    MissingExtraError
        Where what draws pictures of that kind is not installed.
    OSError
        Where the file cannot be written.
    """
    formats = [name for name, suffix in SUFFIXES.items() if path.name.endswith(suffix)]
    if not formats:
        raise ValueError(f"{path.name} says no format; known are {', '.join(SUFFIXES.values())}")
    name = max(formats, key=lambda name: len(SUFFIXES[name]))
    scene, plans = _planned(shown)
    (content,) = render_scene(scene, [name], plans=plans).files.values()
    write(path.parent, {path.name: content})
    return path


def _html(scene: Scene, plans: Sequence[Plan | Morph], frames: Keyframes) -> str:
    rendered = render_scene(scene, ["html"], plans=plans)
    still = still_svg(frames, scene.model.title, shown_step(scene))
    return str(in_notebook(rendered, scene.model.title, still))


def _steps(scene: Scene, frames: Keyframes) -> str:
    """The steps side by side as SVG; one of them where what draws letters is not installed."""
    from geotween.export.pictures.moments import at_place, each_step
    from geotween.export.pictures.picture import Shown
    from geotween.export.pictures.sheet import Layout, sheet_svg

    model = scene.model
    moments = [at_place(frames, place) for place in each_step(frames)]
    layout: Layout = "strip" if len(moments) <= MOST_IN_STRIP else "grid"
    try:
        return sheet_svg(Shown(frames, model.title, model.source), moments, layout)
    except MissingExtraError:
        return still_svg(frames, model.title, shown_step(scene))


def _planned(shown: Scene | Morph) -> Planned:
    if isinstance(shown, Morph):
        return _scene_of(shown), [shown]
    (plans,) = plan_scenes([shown], cache=default_cache())
    return shown, plans


def _scene_of(motion: Morph) -> Scene:
    """A motion's two ends as the steps of a scene."""
    ends = (
        _joined([s for m in motion.layers for s in (m.division.origin, m.swept.origin)]),
        _joined([s for m in motion.layers for s in (m.division.target, m.swept.target)]),
    )
    steps = tuple(
        Step(label, None, "", 1.0, regions, regions)
        for label, regions in zip(("origin", "target"), ends, strict=True)
    )
    model = SceneFile(title="From origin to target", map=Map(width=WIDTH))
    layers = tuple(motion_of.layer for motion_of in motion.layers)
    return Scene("morph", Path("morph.yaml"), model, steps, (), layers, "", motion.problems)


def _joined(sets: Sequence[PolygonSet]) -> PolygonSet:
    return PolygonSet(
        np.concatenate([np.empty(0, dtype=object), *(one.polygons for one in sets)]),
        tuple(identity for one in sets for identity in one.identities),
    )
