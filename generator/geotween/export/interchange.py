"""Keyframes for others: as JSON, as aligned path pairs, and as GeoJSON of the frames in between."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geotween.data.load import Scene
from geotween.export.between import BETWEEN, frames_geojson
from geotween.export.keyframes import Keyframes, Scenery
from geotween.export.page import keyframes_json
from geotween.export.page_grid import GRID, GridTrack
from geotween.export.paths import closed_path
from geotween.export.plans import Plan
from geotween.export.shapes import Shape
from geotween.motion.morph import Morph

# By format. Not the bare suffixes: a scene's data often stand beside it as <name>.geojson.
NAMES = {"json": ".keyframes.json", "paths": ".paths.json", "geojson": ".frames.geojson"}
INTERCHANGE_FORMATS = tuple(NAMES)


def interchange_files(
    scene: Scene,
    frames: Keyframes,
    plans: Sequence[Plan | Morph],
    formats: Collection[str],
    between: int = BETWEEN,
) -> dict[str, bytes]:
    """The files of a scene by name, those of INTERCHANGE_FORMATS that are among the formats.

    ``between`` is the number of frames between two steps in GeoJSON.

    Raises
    ------
    SceneError
        For GeoJSON, where nothing tells where on Earth the coordinates are.
    """
    files: dict[str, bytes] = {}
    if "json" in formats:
        files[scene.name + NAMES["json"]] = _json(told_to_others(scene, frames))
    if "paths" in formats:
        files[scene.name + NAMES["paths"]] = _json(path_pairs(frames))
    if "geojson" in formats:
        text = frames_geojson(scene, [plan.tracks for plan in plans], between)
        files[scene.name + NAMES["geojson"]] = text.encode()
    return files


def told_to_others(scene: Scene, frames: Keyframes) -> dict[str, Any]:
    """What a page holds, and what it has around it: docs/format.md says what is what."""
    model = scene.model
    words = {
        "title": model.title,
        "subtitle": model.subtitle,
        "description": model.description,
        "source": model.source,
        "credit": model.credit,
        "lang": model.lang,
    }
    drawn = {
        "width": frames.page.width,
        "height": frames.page.height,
        "background": frames.background,
        "layers": [_static(layer) for layer in frames.scenery],
    }
    return {**keyframes_json(frames), "about": words, "map": drawn}


def path_pairs(frames: Keyframes) -> dict[str, Any]:
    """The regions of each transition as path data with the same commands at all their key times.

    Absolute coordinates in px, commands ``M``, ``L`` and ``Z`` only: what interpolates the numbers
    in two texts, as CSS and GSAP do, moves the region. The stages of a region follow each other
    in t; most morphs have one, with two times.
    """
    transitions = []
    for span, shapes in frames.spans:
        if span.rest:
            continue
        transitions.append(
            {
                "from": frames.labels[span.step],
                "to": frames.labels[span.step + 1],
                "start": span.start / 1000,
                "end": span.end / 1000,
                "regions": [_region(shape) for shape in shapes if shape.slot.kind == "region"],
            }
        )
    return {
        "width": frames.page.width,
        "height": frames.page.height,
        "easing": frames.easing,
        "transitions": transitions,
    }


def _region(shape: Shape) -> dict[str, Any]:
    return {
        "key": shape.slot.key,
        "layer": shape.slot.group.layer,
        "opacity": list(shape.slot.group.opacity),
        "fill": [paint.fill for paint in shape.paints],
        "stages": [
            {"times": times, "d": [_path(tracks, t) for t in times]}
            for times, tracks in _stages(shape)
        ],
    }


def _stages(shape: Shape) -> Iterator[tuple[list[float], tuple[GridTrack, ...]]]:
    """The key times in each part of a transition, and the tracks that are there."""
    for (start, end), tracks in shape.parts():
        inner = {t for track in tracks if not track.still for t in track.times if start < t < end}
        yield sorted({start, end, *inner}), tracks


def _path(tracks: Sequence[GridTrack], t: float) -> str:
    found = []
    for track in tracks:
        places = track.between(t) * GRID
        for start, end in zip(track.offsets[:-1], track.offsets[1:], strict=True):
            found.append(_ring(places[start:end]))
    return "".join(found)


def _ring(places: NDArray[np.float64]) -> str:
    return "M" + "L".join(f"{x:.7g},{y:.7g}" for x, y in (places.round(2) + 0.0).tolist()) + "Z"


def _static(layer: Scenery) -> dict[str, Any]:
    return {
        "name": layer.name,
        "fill": layer.paint.fill,
        "stroke": layer.paint.stroke,
        "width": layer.paint.width,
        "opacity": layer.opacity,
        "above": layer.above,
        "d": closed_path(layer.tracks),
    }


def _json(value: object) -> bytes:
    return json.dumps(value, separators=(",", ":"), ensure_ascii=False).encode() + b"\n"
