"""Notes: an author's annotations, put in the plane of the map; and what its furniture needs."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from geotween.data.globe.place import Placed
from geotween.data.polygons import Identity
from geotween.scene.document import Document, Location
from geotween.scene.errors import Fault, SceneError, did_you_mean
from geotween.scene.model import Annotation, Map

LABELS = ("auto", "none", "names", "keys")  # what is not a column
SHOWN = 8  # names listed in a hint


@dataclass(frozen=True)
class Note:
    """Words at a place of the map's plane, and the steps that show them.

    ``offset`` is the way from the place to the words, in px right and down, if it is given.
    """

    text: str
    place: tuple[float, float]
    steps: tuple[int, ...]
    offset: tuple[float, float] | None


def notes_of(
    document: Document,
    frame: Map,
    labels: Sequence[str],
    placed: Placed,
    identities: Collection[Identity],
) -> tuple[Note, ...]:
    """The annotations of a map whose steps have these labels, and its features are these.

    Raises
    ------
    SceneError
        For a step that is not there, a place that the map does not show, and furniture that
        needs to know where on Earth the map is, how long its unit, or what no feature has.
    """
    faults = _unfounded(document, frame, placed) + _unknown(document, frame, identities)
    found = []
    for number, annotation in enumerate(frame.annotations):
        at: Location = ("map", "annotations", number)
        place = _placed(annotation, placed)
        if place is None:
            message = "this place is not on the map"
            faults.append(document.fault((*at, "at"), message, "longitude comes first"))
        unknown = [k for k, label in enumerate(annotation.steps or ()) if label not in labels]
        for k in unknown:
            label = (annotation.steps or ())[k]
            hint = did_you_mean(label, labels)
            faults.append(document.fault((*at, "steps", k), f'no step is called "{label}"', hint))
        wanted = labels if annotation.steps is None else annotation.steps
        steps = tuple(step for step, label in enumerate(labels) if label in wanted)
        if place is not None:
            found.append(Note(annotation.text, place, steps, annotation.offset))
    if faults:
        raise SceneError(sorted(faults))
    return tuple(found)


def _placed(annotation: Annotation, placed: Placed) -> tuple[float, float] | None:
    """Where an annotation is in the map's plane; None where that has no such place."""
    if placed.plane is None or placed.written is None:
        return annotation.at
    from pyproj import Transformer

    transformer = Transformer.from_crs(placed.written, placed.plane, always_xy=True)
    x, y = transformer.transform(*annotation.at)
    return (float(x), float(y)) if np.isfinite([x, y]).all() else None


def _unknown(document: Document, frame: Map, identities: Collection[Identity]) -> list[Fault]:
    """Columns, and words of the legend, that no feature answers to."""
    columns = dict.fromkeys(name for i in identities for name in i.attributes)
    asked: list[tuple[Location, str]] = []
    if frame.labels not in LABELS:
        asked.append((("map", "labels"), frame.labels))
    if not isinstance(frame.tooltip, str):
        asked += [(("map", "tooltip", k), name) for k, name in enumerate(frame.tooltip)]
    found = []
    for at, name in asked:
        if name not in columns:
            hint = did_you_mean(name, [*columns, *(LABELS if at[-1] == "labels" else ())])
            found.append(document.fault(at, f'no feature has a column "{name}"', hint))
    if isinstance(frame.legend, dict):
        known = [layer.name for layer in frame.layers if layer.name]
        known += [str(i.key) for i in identities if i.keyed]
        known += [i.class_ for i in identities if i.class_ is not None]
        for name in frame.legend:
            if name not in known:
                message = f'"{name}" is no class, key or layer of this map'
                hint = did_you_mean(name, list(dict.fromkeys(known))[:SHOWN])
                place: Location = ("map", "legend", name)
                found.append(document.fault(place, message, hint, at_key=True))
    return found


def _unfounded(document: Document, frame: Map, placed: Placed) -> list[Fault]:
    """What a scene asks for that its coordinates do not bear out."""
    found = []
    for name, wanted in (
        ("graticule", frame.graticule != "none"),
        ("scale_bar", frame.scale_bar == "true"),
    ):
        if wanted and frame.fit == "each":
            message = f'"{name}" is true to no step but the first where each is fitted on its own'
            found.append(document.fault(("map", name), message, 'say "fit: shared"'))
    if frame.graticule != "none" and placed.plane is None:
        message = "a graticule needs coordinates whose longitudes and latitudes are known"
        hint = "say what they are: map: {crs: EPSG:4326}"
        found.append(document.fault(("map", "graticule"), message, hint))
    if frame.scale_bar == "true" and placed.plane is None and frame.unit is None:
        message = "a scale bar needs to know how long a unit of the coordinates is"
        hint = "say so: map: {unit: km}; or where they are: map: {crs: EPSG:4326}"
        found.append(document.fault(("map", "scale_bar"), message, hint))
    if frame.unit is not None and placed.plane is not None:
        message = "the coordinates have a system, which says how long their unit is"
        found.append(document.fault(("map", "unit"), message, "leave it out", at_key=True))
    return found
