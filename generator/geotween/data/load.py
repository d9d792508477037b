"""A scene from its file: every step's polygons read, made valid and put into one frame."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geotween.data.checks import doubts
from geotween.data.parse import Parser, is_wkt
from geotween.data.polygons import (
    Feature,
    PolygonSet,
    bounds_of,
    extent,
    fit_into,
    polygon_set,
    too_far,
)
from geotween.data.problems import Problem
from geotween.data.repair import repair
from geotween.scene.document import Document, Location, read_json, read_text
from geotween.scene.errors import Fault, SceneError
from geotween.scene.model import Layer, SceneFile
from geotween.scene.read import read_scene
from geotween.scene.values import UNWRITABLE, Time

HIGHEST = 20  # times its width, a page whose height follows from the data


@dataclass(frozen=True, eq=False)
class Step:
    """The polygon set at one time, with its words."""

    label: str
    time: Time | None
    caption: str
    hold: float
    regions: PolygonSet


@dataclass(frozen=True, eq=False)
class Scene:
    """A scene ready to be planned: its model, its steps and what was mended in them.

    ``layers`` are the static shapes underneath, each with its polygons. All coordinates are the
    data's own; with ``fit: each`` every step is already centred in the frame of the first one
    that has polygons.
    """

    name: str
    path: Path
    model: SceneFile
    steps: tuple[Step, ...]
    layers: tuple[tuple[Layer, PolygonSet], ...]
    problems: tuple[Problem, ...]

    def __iter__(self) -> Iterator[Step]:
        return iter(self.steps)


def load(path: str | os.PathLike[str]) -> Scene:
    """Read a scene file and all that it names.

    Raises
    ------
    SceneError
        With every fault of the scene and of the files it names.
    """
    name = str(path)
    file = Path(path)
    document = Document(name, file, read_text(file, name))
    if UNWRITABLE.search(file.stem):
        shown = file.stem.encode(errors="replace").decode()
        hint = "rename it: pages are called as their scene"
        raise SceneError([document.fault((), f"the file name {shown} cannot be written", hint)])
    model, values, faults = read_scene(document)
    reader = _SourceReader(document)
    steps = reader.all_sources(values, "steps")
    layers = reader.all_sources(values.get("map"), "layers", prefix=("map",))
    faults += reader.faults
    if model is None or faults:
        raise SceneError(sorted(set(faults)))

    labels = [_label(step.label, step.time, i) for i, step in enumerate(model.steps)]
    problems: list[Problem] = []
    sets = []
    for index, label in enumerate(labels):
        regions, found = _valid(steps[index], label)
        problems += found
        sets.append(regions)
    if not any(map(len, sets)):
        hint = "what has no area is left out" if problems else ""
        raise SceneError([document.fault(("steps",), "no step has a polygon", hint, at_key=True)])
    if model.map.fit == "each":
        frame = next(s.bounds for s in sets if len(s))
        sets = [fit_into(s, frame) for s in sets]
    static = []
    for index, layer in enumerate(model.map.layers):
        shapes, found = _valid(layers[index], f"layer {layer.name or index + 1}")
        problems += found
        static.append((layer, shapes))
    problems += doubts(model, sets, labels)
    _check_size(document, [*sets, *(shapes for _, shapes in static)], model.map.height is None)
    return Scene(
        file.stem,
        file,
        model,
        tuple(
            Step(label, s.time, s.caption, model.timing.hold if s.hold is None else s.hold, regions)
            for label, s, regions in zip(labels, model.steps, sets, strict=True)
        ),
        tuple(static),
        tuple(problems),
    )


@dataclass(frozen=True)
class _Source:
    """What a ``polygons`` value holds; how many geometries without area were left out of it."""

    features: list[Feature]
    skipped: int = 0
    geojson: bool = False


class _SourceReader:
    """Reads the ``polygons`` of steps and layers, inline or from the files they name."""

    def __init__(self, document: Document) -> None:
        self.document = document
        self.faults: list[Fault] = []

    def all_sources(self, holder: Any, name: str, prefix: Location = ()) -> dict[int, _Source]:
        """The source of each member of a list (steps, layers) that has polygons."""
        members = holder.get(name) if isinstance(holder, dict) else None
        found: dict[int, _Source] = {}
        for index, member in enumerate(members if isinstance(members, list) else []):
            if isinstance(member, dict) and "polygons" in member:
                place = (*prefix, name, index, "polygons")
                found[index] = self._source(member["polygons"], place)
        return found

    def _source(self, value: Any, at: Location) -> _Source:
        if isinstance(value, str) and not is_wkt(value):
            return self._file(value, at)
        parser = Parser(lambda where, *words: self._report(self.document, (*at, *where), *words))
        features = parser.features(value)
        return _Source(features, parser.skipped, geojson=isinstance(value, dict))

    def _file(self, name: str, at: Location) -> _Source:
        named_by = self.document.fault(at, "")
        path = self.document.path.parent / name
        try:
            source = Document(str(path), path, read_text(path, name, named_by=named_by))
            value = read_json(source)
        except SceneError as error:
            self.faults += error.faults
            return _Source([])
        parser = Parser(lambda where, *words: self._report(source, where, *words))
        try:
            features = parser.geojson(value)
        except RecursionError:
            self._report(source, (), "nested too deeply", "")
            return _Source([])
        return _Source(features, parser.skipped, geojson=True)

    def _report(self, document: Document, at: Location, message: str, hint: str) -> None:
        self.faults.append(document.fault(at, message, hint))


def _label(label: str | None, time: Time | None, index: int) -> str:
    if label is not None:
        return label
    if time is None:
        return str(index + 1)
    return f"{time:.15g}" if isinstance(time, float) else time.isoformat()


def _valid(source: _Source, label: str) -> tuple[PolygonSet, list[Problem]]:
    """A source's polygons made valid, and what was mended or left out."""
    problems = []
    if source.skipped:
        message = "features without area (points, lines, null geometries) were left out"
        count = float(source.skipped)
        hint = "" if source.features else "nothing is left of it"
        problems.append(
            Problem("no area", "warning", message, (label,), "", count, "features", hint)
        )
    kept, found = repair(source.features, step=label, winding=source.geojson)
    return polygon_set(kept), problems + found


def _check_size(document: Document, sets: list[PolygonSet], free_height: bool) -> None:
    """Raise where double precision cannot tell the data's places apart, or they make no page."""
    box = bounds_of(sets)
    if too_far(box):
        size, reach = extent(box), np.abs(box).max()
        message = f"the data span {size:.3g} units at {reach:.3g} from the origin: too fine to draw"
        hint = "shift the coordinates nearer to 0"
        raise SceneError([document.fault(("steps",), message, hint, at_key=True)])
    if free_height and box[3] - box[1] > HIGHEST * (box[2] - box[0]):
        message = f"the data are more than {HIGHEST} times as high as wide"
        hint = "name the page's size: map: {width: 300, height: 900}"
        raise SceneError([document.fault(("steps",), message, hint, at_key=True)])
