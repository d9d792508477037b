"""From a scene file's text to the scene model, with every fault at its line and column."""

from __future__ import annotations

import datetime
import difflib
from collections.abc import Callable
from itertools import pairwise
from typing import Any, TypeVar

from pydantic import BaseModel, TypeAdapter, ValidationError

from geotween.scene.document import Document, Location
from geotween.scene.errors import Fault, SceneError, did_you_mean
from geotween.scene.model import SceneFile
from geotween.scene.plain import read_yaml
from geotween.scene.values import Seconds, StepTime, Transition

_EXPECTED = {
    "string_type": "expected a text",
    "float_type": "expected a number",
    "float_parsing": "expected a number",
    "bool_type": "expected true or false",
    "bool_parsing": "expected true or false",
    "tuple_type": "expected a list",
    "list_type": "expected a list",
    "dict_type": "expected a mapping (key: value)",
    "model_type": "expected a mapping (key: value)",
    "model_attributes_type": "expected a mapping (key: value)",
    "finite_number": "expected a finite number",
}


_EXAMPLES = {
    "title": "for example title: A pond dries up",
    "steps": "each begins with - and has polygons, for example - polygons: spring.geojson",
    "polygons": "for example polygons: spring.geojson; [] is a step without polygons",
}


Model = TypeVar("Model", bound=BaseModel)

# Where else a key may belong, and what other tools call ours.
_PARTS = ("steps", "data", "hotspots", "map", "style", "motion", "timing", "story")
_SYNONYMS = {"color": "fill", "colour": "fill", "fill-opacity": "opacity", "stroke-width": "width"}

_TIME: TypeAdapter[Any] = TypeAdapter(StepTime)
_TRANSITION: TypeAdapter[Any] = TypeAdapter(Transition)
_SECONDS: TypeAdapter[Any] = TypeAdapter(Seconds)


def read_scene(document: Document) -> tuple[SceneFile | None, Any, list[Fault]]:
    """The model of a scene, the plain values behind it, and what is wrong with it.

    The values come back even where the model does not, so that the geometry in them can be
    checked in the same pass and all faults shown at once.

    Raises
    ------
    SceneError
        Where the text is not YAML at all, or no mapping.
    """
    values, faults = read_yaml(document)
    if not isinstance(values, dict):
        hint = "a scene begins with a title and two steps"
        message = "the scene is empty" if values is None else "expected a mapping (key: value)"
        raise SceneError([*faults, document.fault_at(1, 1, message, hint)])
    faults += _check_sources(document, values) + _check_times(document, values)
    model, found = validated(document, SceneFile, values)
    return model, values, faults + found


def validated(
    document: Document, model: type[Model], values: Any, at: Location = ()
) -> tuple[Model | None, list[Fault]]:
    """Plain values as a model, or what is wrong with them; ``at`` is where they stand."""
    try:
        return model.model_validate(values), []
    except ValidationError as error:
        return None, [_fault(document, dict(item), model, at) for item in error.errors()]


def check_transitions(
    document: Document, timing: Any, times: list[Any], place: Callable[[int], Location]
) -> list[Fault]:
    """Whether the timing fits the steps' times; None is a step without one.

    ``place`` says where a step stands in the scene.
    """
    transition, count = _as(_TRANSITION, timing.get("transition", "2")), len(times) - 1
    at: Location = ("timing", "transition")
    faults = []
    if isinstance(transition, tuple) and len(transition) != count:
        message = f"{len(transition)} transition times for {count} transitions"
        faults.append(document.fault(at, message, "list one for each pair of steps"))
    if transition == "proportional":
        for index, time in enumerate(times):
            if time is None:
                message = (
                    f"proportional timing needs a time for each step; step {index + 1} has none"
                )
                faults.append(document.fault(place(index), message))
        for number, (before, after) in enumerate(pairwise(times), start=1):
            if before is not None and before == after:
                message = f"proportional timing: steps {number} and {number + 1} have the same time"
                faults.append(document.fault((*place(number), "time"), message))
    elif transition is not None and _as(_SECONDS, timing.get("total")) is not None:
        message = '"total" goes with transition: proportional'
        faults.append(document.fault(("timing", "total"), message, at_key=True))
    return faults


def scene_schema() -> dict[str, Any]:
    """The JSON Schema of a scene file, for editors."""
    schema = SceneFile.model_json_schema(by_alias=True)
    schema["if"] = {"not": {"anyOf": [{"required": ["data"]}, {"required": ["hotspots"]}]}}
    schema["then"] = {
        "required": ["steps"],
        "properties": {"steps": {"minItems": 2, "items": {"required": ["polygons"]}}},
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "geotween scene",
        **{key: value for key, value in schema.items() if key != "title"},
    }


def _fault(
    document: Document, error: dict[str, Any], model: type[BaseModel], at: Location
) -> Fault:
    inside: Location = tuple(step for step in error["loc"] if step != "[key]")
    location = (*at, *inside)
    name = location[-1] if location else "scene"
    kind, context = error["type"], error.get("ctx", {})
    if kind == "extra_forbidden":
        hint = _meant(str(name), _known_keys(model, inside[:-1]))
        return document.fault(location, f'unknown key "{name}"', hint, at_key=True)
    if kind == "missing":
        message = f'{_called(location[:-1])} needs "{name}"'
        return document.fault(location[:-1], message, _EXAMPLES.get(str(name), ""))
    if kind == "too_short":
        least = context["min_length"]
        return document.fault(location, f'"{name}": expected at least {least}', at_key=True)
    if kind == "literal_error":
        known = [word.strip(" '") for word in context["expected"].replace(" or ", ",").split(",")]
        given = error["input"]
        message = f'"{name}" cannot be {_shown(given)}'
        return document.fault(location, message, did_you_mean(str(given), known))
    if kind == "string_pattern_mismatch":
        return document.fault(location, f'"{name}": expected a language code such as en or pt-BR')
    if kind == "value_error":
        return document.fault(location, f'"{name}": {context["error"]}')
    message = _EXPECTED.get(kind) or error["msg"].replace("Input should be", "expected a number")
    return document.fault(location, f"{_called(location)}: {message}, not {_shown(error['input'])}")


def _whole(values: dict[str, Any]) -> bool:
    """Whether the polygons of all steps come from one place."""
    return "data" in values or "hotspots" in values


def _check_sources(document: Document, values: dict[str, Any]) -> list[Fault]:
    """Whether there are polygons, and in one place: the steps, data, or hotspots."""
    steps = values.get("steps")
    if "data" in values and "hotspots" in values:
        message = "a scene has data or hotspots, not both"
        return [document.fault(("hotspots",), message, at_key=True)]
    if steps is None and not _whole(values):
        hint = f"{_EXAMPLES['steps']}; or name a file of all steps: data: fires.gpkg"
        return [document.fault((), 'the scene needs "steps"', hint)]
    if not isinstance(steps, list):
        return []
    if not _whole(values) and len(steps) < 2:
        message = f"a scene needs at least two steps, not {len(steps)}"
        return [document.fault(("steps",), message, _EXAMPLES["steps"], at_key=True)]
    faults = []
    for index, step in enumerate(steps):
        if not isinstance(step, dict):
            continue
        if _whole(values) and "polygons" in step:
            message = "polygons come from this step or from the whole scene's data, not from both"
            faults.append(document.fault(("steps", index, "polygons"), message, at_key=True))
        elif not _whole(values) and "polygons" not in step:
            message = f'step {index + 1} needs "polygons"'
            faults.append(document.fault(("steps", index), message, _EXAMPLES["polygons"]))
    return faults


def _check_times(document: Document, values: dict[str, Any]) -> list[Fault]:
    """What the model cannot see field by field: times that fit each other and the timing.

    Reads the plain values, so as to find these in a scene that has other faults too.
    """
    steps, timing = values.get("steps"), values.get("timing", {})
    if not isinstance(steps, list):
        return []
    written = [step.get("time") if isinstance(step, dict) else None for step in steps]
    times = [_as(_TIME, time) for time in written]
    faults = []
    kinds = {_kind(time) for time in times if time is not None}
    if len(kinds) > 1 and not _whole(values):  # words may say 2019 of a day
        odd = next(i for i, t in enumerate(times) if t is not None and _kind(t) != _kind_of(times))
        faults.append(
            document.fault(
                ("steps", odd, "time"),
                f"\"time\": one step's time is a {_kind(times[odd])}, another's is not",
                "write all times of a scene as dates, or as date-times, or as numbers",
            )
        )
    if isinstance(timing, dict) and not _whole(values):
        # A time that cannot be read is a fault of its own; here it counts as written.
        known = [text if time is None else time for time, text in zip(times, written, strict=True)]
        faults += check_transitions(document, timing, known, lambda index: ("steps", index))
    return faults


def _as(adapter: TypeAdapter[Any], value: object) -> Any:
    """A value as the model reads it; None where it is absent, or a fault by itself."""
    try:
        return None if value is None else adapter.validate_python(value)
    except ValidationError:
        return None


def _kind(time: object) -> str:
    if isinstance(time, datetime.datetime):
        return "date-time" if time.tzinfo is None else "date-time with a zone"
    return "date" if isinstance(time, datetime.date) else "number"


def _kind_of(times: list[Any]) -> str:
    return _kind(next(time for time in times if time is not None))


def _meant(word: str, here: list[str]) -> str:
    """A hint at the key that was meant: one that is known here, or in another part of a scene."""
    near = difflib.get_close_matches(word.lower(), here, n=1, cutoff=0.8)
    usual = _SYNONYMS.get(word.lower())
    if near or usual in here:
        return f'did you mean "{near[0] if near else usual}"?'
    parts = {name: _known_keys(SceneFile, (name,)) for name in _PARTS}
    for cutoff in (1.0, 0.9):
        for part, known in parts.items():
            elsewhere = difflib.get_close_matches(word.lower(), known, n=1, cutoff=cutoff)
            if elsewhere:
                return f'"{elsewhere[0]}" belongs under {part}'
    return did_you_mean(word, here)


def _known_keys(model: Any, location: Location) -> list[str]:
    """The keys that a model knows in the mapping at a location."""
    for step in location:
        if isinstance(step, int):
            continue
        known = getattr(model, "model_fields", {})
        field = next((f for n, f in known.items() if step in (n, f.alias)), None)
        if field is not None:
            model = _model_in(field.annotation)
    return [field.alias or name for name, field in model.model_fields.items()]


def _model_in(annotation: Any) -> Any:
    """The model inside an annotation such as ``tuple[Step, ...]`` or ``dict[str, StyleRule]``."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    inner = (_model_in(part) for part in getattr(annotation, "__args__", ()))
    return next((model for model in inner if model is not None), None)


def _called(location: Location) -> str:
    """What to call the value at a location: the scene, step 3, "fill"."""
    if not location:
        return "the scene"
    *_, holder, name = ("", *location)
    if isinstance(name, int):
        return f"{str(holder).removesuffix('s')} {name + 1}"
    return f'"{name}"'


def _shown(value: object) -> str:
    if value is None:
        return "nothing"
    if isinstance(value, dict):
        return "a mapping"
    if isinstance(value, list):
        return "a list"
    text = str(value)
    return f'"{text if len(text) <= 40 else text[:39] + "…"}"'
