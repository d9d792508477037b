"""Events as records: for a page and for programs (JSON), for spreadsheets (CSV), for a terminal."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from geotween.data.load import Scene
from geotween.data.polygons import Identity
from geotween.story.captions import alternative, told
from geotween.story.events import Event, Transition, scene_events
from geotween.story.words import Words, words_of_scene

FIELDS = (
    "scene", "from", "to", "event", "feature", "class", "layer", "with",
    "area_before", "area_after", "change", "area_unit", "distance", "distance_unit", "bearing",
)  # fmt: skip
DIGITS = 7  # of amounts; more than their accuracy, and the same on every machine


def scene_record(
    scene: Scene, transitions: Sequence[Transition] | None = None, words: Words | None = None
) -> dict[str, Any]:
    """A scene's events and their words as plain values, ready for JSON.

    ``units`` names those of areas and distances, empty where nobody knows them. ``before`` and
    ``after`` are the places of an event's polygons in the sets of its two steps. Texts are plain:
    a page has to escape them.

    Raises
    ------
    SceneError
        Where the scene's file of words has faults.
    """
    words = words or words_of_scene(scene)
    found = scene_events(scene) if transitions is None else transitions
    made = told(scene, found, words)
    real = any(transition.real for transition in found)
    return {
        "scene": scene.name,
        "title": scene.model.title,
        "lang": words.lang,
        "units": {"area": "m²" if real else "", "distance": "m" if real else ""},
        "opening": made[0],
        "alternative": list(alternative(scene, found, words)),
        "transitions": [
            {
                "from": transition.origin.label,
                "to": transition.target.label,
                "caption": text,
                "events": [_event(event) for event in transition.events],
            }
            for transition, text in zip(found, made[1:], strict=True)
        ],
    }


def csv_text(records: Iterable[Mapping[str, Any]]) -> str:
    """The events of some scenes as CSV after RFC 4180, one a line under a line of FIELDS."""
    buffer = io.StringIO()
    writer = csv.DictWriter(buffer, FIELDS, lineterminator="\r\n")
    writer.writeheader()
    for record in records:
        writer.writerows(_rows(record))
    return buffer.getvalue()


def table_text(record: Mapping[str, Any], words: Words) -> str:
    """The events of a scene as a table for a terminal, under the caption of each transition."""
    lines = [record["title"]]
    for transition in record["transitions"]:
        lines += ["", f"{transition['from']} → {transition['to']}", f"  {transition['caption']}"]
        real = bool(record["units"]["area"])
        cells = [_cells(event, words, real=real) for event in transition["events"]]
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        lines += [_line(row, widths) for row in cells]
    return "\n".join(_printable(line).rstrip() for line in lines) + "\n"


def _event(event: Event) -> dict[str, Any]:
    return {
        "kind": event.kind,
        "feature": _who(event.subject),
        "with": [_who(partner) for partner in event.partners],
        "area_before": _number(event.area_before),
        "area_after": _number(event.area_after),
        "change": _number(event.change),
        "distance": _number(event.distance),
        "bearing": _number(event.bearing),
        "before": list(event.before),
        "after": list(event.after),
    }


def _who(identity: Identity) -> dict[str, Any]:
    return {
        "key": identity.key if identity.keyed else None,
        "name": identity.name,
        "called": identity.called,
        "class": identity.class_,
        "layer": identity.layer,
    }


def _number(value: float | None) -> float | None:
    return None if value is None else float(f"{value:.{DIGITS}g}") + 0.0


def _rows(record: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    for transition in record["transitions"]:
        for event in transition["events"]:
            yield {
                "scene": record["scene"],
                "from": transition["from"],
                "to": transition["to"],
                "event": event["kind"],
                "feature": event["feature"]["called"],
                "class": event["feature"]["class"],
                "layer": event["feature"]["layer"],
                "with": "; ".join(partner["called"] for partner in event["with"]),
                **{name: event[name] for name in ("area_before", "area_after", "change")},
                "area_unit": record["units"]["area"],
                "distance": event["distance"],
                "distance_unit": record["units"]["distance"],
                "bearing": event["bearing"],
            }


def _cells(event: Mapping[str, Any], words: Words, *, real: bool) -> list[str]:
    areas = [a for a in (event["area_before"], event["area_after"]) if a is not None]
    ends = [words.area(area) if real else f"{area:,.4g}" for area in areas]
    change = f"{event['change']:+.1%}" if event["change"] is not None else ""
    way, far = "", event["distance"]
    if far is not None:
        way = f"{words.length(far) if real else f'{far:,.4g}'} at {event['bearing']:.0f}°"
    partners = ", ".join(partner["called"] for partner in event["with"])
    return [event["kind"], event["feature"]["called"], " → ".join(ends), change, way, partners]


def _line(cells: Sequence[str], widths: Sequence[int]) -> str:
    return "  " + "  ".join(cell.ljust(width) for cell, width in zip(cells, widths, strict=True))


def _printable(text: str) -> str:
    """Text without what a terminal would obey."""
    return "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in text)
