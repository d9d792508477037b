"""Tips: what is told of a region that someone points at, step by step."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from geotween.data.load import Scene
from geotween.data.polygons import Identity
from geotween.data.read.columns import as_text
from geotween.export.furniture.language import words_in
from geotween.export.furniture.text import number_text

COLUMNS = 5  # told at most, unless a scene names them
LONGEST = 80  # letters of a value that is told unasked


@dataclass(frozen=True)
class Tip:
    """A region's name, and rows of what else is known: label and value."""

    name: str
    rows: tuple[tuple[str, str], ...]


def tips(scene: Scene, called: Mapping[str, str]) -> list[dict[str, Tip]]:
    """For each step the tips of its regions, by key.

    ``called`` has words for classes that the legend tells of. Regions without keys are told of
    where a step has a single one. A tip that is the same in all steps that have its key is told in
    the first of them.
    """
    if scene.model.map.tooltip == "none":
        return [{} for _ in scene.steps]
    found: list[dict[str, Tip]] = []
    for step in scene.steps:
        identities = dict.fromkeys(step.regions.identities)
        bare = [i for i in identities if not i.keyed]
        told = [i for i in identities if i.keyed] + (bare if len(bare) == 1 else [])
        of_step: dict[str, Tip] = {}
        for identity in told:
            tip = _tip(identity, scene, called)
            if tip.name or tip.rows:
                of_step.setdefault(str(identity.key) if identity.keyed else "", tip)
        found.append(of_step)
    return _once(found)


def _tip(identity: Identity, scene: Scene, called: Mapping[str, str]) -> Tip:
    wanted = scene.model.map.tooltip
    key = str(identity.key) if identity.keyed else ""
    class_ = identity.class_ or ""
    marks = words_in(scene.model.lang)
    rows = []
    if isinstance(wanted, tuple):
        for column in wanted:
            value = _value(identity.attributes.get(column), marks)
            if value:
                rows.append((column, value))
        return Tip(identity.name or key, tuple(rows))
    time = scene.model.data.time if scene.model.data else None
    if called.get(class_, identity.name) != identity.name:
        rows.append(("", called[class_]))
    said = {key, class_, identity.name}
    for column, held in identity.attributes.items():
        value = _value(held, marks)
        plain = _value(held, {"decimal": ".", "group": ""})
        if value and column != time and plain not in said and len(value) <= LONGEST:
            rows.append((column, value))
    return Tip(identity.name or key, tuple(rows[:COLUMNS]))


def _value(value: object, marks: Mapping[str, str]) -> str:
    """A value in words, a number with the language's marks; nothing for what is no text."""
    if value is None:
        return ""
    if isinstance(value, float) and not value.is_integer():
        return number_text(value, marks["decimal"], marks["group"]) if value == value else ""
    try:
        return as_text(value).strip()
    except ValueError:
        return ""


def _once(found: Sequence[dict[str, Tip]]) -> list[dict[str, Tip]]:
    told: dict[str, set[Tip]] = {}
    for of_step in found:
        for key, tip in of_step.items():
            told.setdefault(key, set()).add(tip)
    seen: set[str] = set()
    kept = []
    for of_step in found:
        kept.append({k: tip for k, tip in of_step.items() if len(told[k]) > 1 or k not in seen})
        seen.update(of_step)
    return kept
