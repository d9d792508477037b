"""A scene from its file: every step's polygons read, put in place and made ready to move."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from geotween.data.checks import doubts
from geotween.data.frame import check_size, pixels_per_unit
from geotween.data.globe.place import crs_of_all, place
from geotween.data.notes import Note, notes_of
from geotween.data.polygons import (
    Feature,
    PolygonSet,
    bounds,
    fitted,
    geometries_of,
    polygon_set,
    with_geometries,
)
from geotween.data.problems import Problem, condensed, in_kilometres
from geotween.data.read.sources import Held, SourceReader
from geotween.data.read.tables import Table
from geotween.data.steps.series import Member
from geotween.data.steps.steps import members_of, place_of
from geotween.data.tidy.identity import TwoClassesError, merge_keys
from geotween.data.tidy.nodes import noded_features
from geotween.data.tidy.tidy import tidy
from geotween.data.tidy.valid import mended, valid_features
from geotween.displayed import Displayed
from geotween.scene.document import Document, read_text
from geotween.scene.errors import SceneError
from geotween.scene.model import Layer, SceneFile
from geotween.scene.read import check_transitions, read_scene
from geotween.scene.values import UNWRITABLE, Time

if TYPE_CHECKING:
    from pyproj import CRS


@dataclass(frozen=True, eq=False)
class Step:
    """The polygon set at one time, with its words.

    ``exact`` has the same polygons as ``regions``, not simplified: they are measured, not drawn.
    """

    label: str
    time: Time | None
    caption: str
    hold: float
    regions: PolygonSet
    exact: PolygonSet


@dataclass(frozen=True, eq=False)
class Scene(Displayed):
    """A scene ready to be planned: its model, its steps and what was mended in them.

    ``layers`` are the static shapes underneath or above, each with its polygons; ``layer_order``
    names the layers of the regions, the lowest first. All coordinates are in the plane that
    ``projection`` tells in words, which is that of the system ``crs`` if one is known; with
    ``fit: each`` every step is already centred in the frame of the first one that has polygons.
    ``projection`` is empty where coordinates are drawn as they are.
    """

    name: str
    path: Path
    model: SceneFile
    steps: tuple[Step, ...]
    layers: tuple[tuple[Layer, PolygonSet], ...]
    layer_order: tuple[str, ...]
    projection: str
    problems: tuple[Problem, ...]
    crs: CRS | None = None
    notes: tuple[Note, ...] = ()
    words: Document | None = None

    def __iter__(self) -> Iterator[Step]:
        return iter(self.steps)


def load(
    path: str | os.PathLike[str],
    sandbox: str | os.PathLike[str] | None = None,
    *,
    reads: set[Path] | None = None,
) -> Scene:
    """Read a scene file and all that it names.

    With a ``sandbox`` the scene may name files in that folder only. ``reads`` gets the files and
    folders that were looked at, those before an error too.

    Raises
    ------
    SceneError
        With every fault of the scene and of the files it names.
    """
    name, file = str(path), Path(path)
    if reads is not None:
        reads.add(file)
    document = Document(name, file, read_text(file, name))
    return read(document, None if sandbox is None else Path(sandbox), reads=reads)


def read(
    document: Document,
    sandbox: Path | None = None,
    *,
    tables: Mapping[str, Table] | None = None,
    reads: set[Path] | None = None,
) -> Scene:
    """The scene that a text tells; ``tables`` are in memory what it names as if they were files.

    Raises
    ------
    SceneError
        With every fault of the scene and of the files it names.
    """
    file = document.path
    if UNWRITABLE.search(file.stem):
        shown = file.stem.encode(errors="replace").decode()
        hint = "rename it: pages are called as their scene"
        raise SceneError([document.fault((), f"the file name {shown} cannot be written", hint)])
    model, values, faults = read_scene(document)
    reader = SourceReader(document, sandbox, tables, reads)
    if model is None:
        reader.members(values, "steps")
    members = members_of(reader, model, values) if model else []
    layers = reader.members(values.get("map"), "layers", ("map",))
    words = _words(reader, model) if model else None
    faults += reader.faults
    if model is None or faults:
        raise SceneError(sorted(set(faults)))
    _check_steps(document, model, values, members)
    static = [layers.get(i, Held([])) for i in range(len(model.map.layers))]
    return replace(_scene(document, model, members, static), words=words)


def _words(reader: SourceReader, model: SceneFile) -> Document | None:
    """The file of wording that a scene names; what is wrong goes to the reader."""
    name, at = model.story.words, ("story", "words")
    path = None if name is None else reader.path(name, at)
    if name is None or path is None:
        return None
    reader.reads.add(path)
    try:
        return Document(name, path, read_text(path, name, named_by=reader.document.fault(at, "")))
    except SceneError as error:
        reader.faults += error.faults
        return None


def _check_steps(
    document: Document, model: SceneFile, values: dict[str, Any], members: Sequence[Member]
) -> None:
    """Raise where data or points make too few steps, or times that the timing cannot use."""
    at = place_of(model)
    if at == ("steps",):
        return
    if len(members) < 2:
        message = f"a map that moves needs at least two steps, and this makes {len(members)}"
        raise SceneError([document.fault(at, message, at_key=True)])
    times = [member.time for member in members]
    faults = check_transitions(document, values.get("timing", {}), times, lambda _: at)
    if faults:
        raise SceneError(faults)


def _scene(
    document: Document, model: SceneFile, members: Sequence[Member], static: Sequence[Held]
) -> Scene:
    """The scene of what was read: valid, in place, tidy.

    Raises
    ------
    SceneError
        Where it has no polygon, or they cannot be put in place.
    """
    at, labels = place_of(model), [member.label for member in members]
    sources = [held for member in members for held in member.held] + list(static)
    owners = [i for i, member in enumerate(members) for _ in member.held]
    owners += range(len(members), len(members) + len(static))
    named = labels + [f"layer {layer.name or i + 1}" for i, layer in enumerate(model.map.layers)]
    systems = crs_of_all(document, model.map, sources)
    problems: list[Problem] = []
    features = []
    for source, owner, system in zip(sources, owners, systems, strict=True):
        geographic = system is not None and system.is_geographic
        valid, found = valid_features(source, step=named[owner], geographic=geographic)
        features.append(valid)
        problems += found
    count = len(sources) - len(static)
    features = noded_features(features, systems)
    placed = place(document, model.map, sources, systems, features, owners, len(members))
    problems += placed.problems
    features = []
    for shapes, owner in zip(placed.features, owners, strict=True):
        kept, found = mended(shapes, step=named[owner])
        features.append(kept)
        problems += found
    steps, found = _merged(document, members, features[:count])
    problems += found
    if not any(steps):
        hint = "; ".join(dict.fromkeys(p.message for p in problems if p.severity != "note"))
        raise SceneError([document.fault(at, "no step has a polygon", hint, at_key=True)])
    if model.map.fit == "each":
        steps = _in_one_frame(steps)
    box = bounds([f for part in [*steps, *features[count:]] for f in part])
    check_size(document, at, model.map, box)
    tidied = tidy(steps, features[count:], labels, model.map, pixels_per_unit(model.map, box))
    if not any(tidied.steps):
        message = "no step has a polygon as large as this"
        raise SceneError([document.fault(("map", "min_area"), message)])
    sets = [polygon_set(step) for step in tidied.steps]
    return Scene(
        document.path.stem,
        document.path,
        model,
        tuple(
            Step(member.label, member.time, member.caption, member.hold, regions, exact)
            for member, regions, exact in zip(
                members, sets, map(polygon_set, tidied.exact), strict=True
            )
        ),
        tuple(zip(model.map.layers, map(polygon_set, tidied.static), strict=True)),
        tidied.layers,
        placed.words,
        tuple(
            in_kilometres(problem, placed.metres)
            for problem in condensed([*problems, *tidied.problems, *doubts(model, sets, members)])
        ),
        placed.plane,
        notes_of(document, model.map, labels, placed, [i for s in sets for i in s.identities]),
    )


def _merged(
    document: Document, members: Sequence[Member], features: Sequence[list[Feature]]
) -> tuple[list[list[Feature]], list[Problem]]:
    """The features of each step, those of one key as one."""
    parts = iter(features)
    steps: list[list[Feature]] = []
    problems: list[Problem] = []
    faults = []
    for member in members:
        together = [feature for _ in member.held for feature in next(parts)]
        try:
            kept, found = merge_keys(together, step=member.label)
        except TwoClassesError as error:
            hint = "leave the key out, or name a column that tells them apart"
            message = f"{member.label}: {error}"
            faults.append(document.fault(member.held[0].at, message, hint))
            continue
        steps.append(kept)
        problems += found
    if faults:
        raise SceneError(faults)
    return steps, problems


def _in_one_frame(steps: Sequence[Sequence[Feature]]) -> list[list[Feature]]:
    """Steps scaled and centred into the bounds of the first one that has polygons."""
    frame = next(bounds(step) for step in steps if step)
    return [with_geometries(step, fitted(geometries_of(step), frame)) for step in steps]
