"""The kinds of value a scene file holds, each with what it accepts and its JSON Schema."""

from __future__ import annotations

import datetime
import math
import re
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, Field, PlainValidator, WithJsonSchema
from pydantic_extra_types.color import Color

Time = datetime.date | datetime.datetime | float

_SCALAR: Any = ["string", "number", "boolean"]  # YAML editors type a bare 1984 or no
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_MONTH = re.compile(r"\d{4}-\d{2}")
SHORTEST, LONGEST = 0.05, 3600  # seconds of a transition: a frame or two, and an hour
# Beyond it, double precision no longer tells whole numbers apart.
LARGEST_TIME = 1e15
FINEST_GRATICULE = 0.001  # degrees between two meridians: a hundred metres
COARSEST = 100.0  # px of simplification: beyond it hardly a shape is left
# What XML cannot hold, or UTF-8 cannot write.
UNWRITABLE = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\ufffe\uffff\ud800-\udfff]")


def _text(value: str) -> str:
    bad = UNWRITABLE.search(value)
    if bad:
        raise ValueError(f"the character U+{ord(bad[0]):04X} cannot be shown; remove it")
    return value


def _colour(value: str) -> str:
    if value == "none":
        return value
    try:
        colour = Color(value)
    except ValueError:
        raise ValueError(
            f'expected a colour, a hex value like "#c1440e" (in quotes), a CSS name like '
            f'steelblue, or none, not "{value}"'
        ) from None
    shown = str(colour.as_hex(format="long"))
    if len(shown) != len("#rrggbb"):
        raise ValueError("a colour here is solid; use opacity for see-through")
    return shown


def read_time(value: Any) -> Time:
    """A date, a date-time or a number, from the text that was written.

    A month (2024-03) reads as its first day, a bare year as a number: both put steps in the same
    order.
    """
    if isinstance(value, datetime.date | float):
        return value
    text = value.strip() if isinstance(value, str) else ""
    if _NUMBER.fullmatch(text):
        number = float(text)
        if abs(number) > LARGEST_TIME:
            raise ValueError(f"expected a number of at most {LARGEST_TIME:g}, not {text}")
        return number
    if _MONTH.fullmatch(text):
        text += "-01"
    for read in (datetime.date.fromisoformat, datetime.datetime.fromisoformat):
        try:
            return read(text)
        except ValueError:
            continue
    raise ValueError("expected a date (2024-01-05), a date-time (2024-01-05T12:30) or a number")


def _transition(value: Any) -> float | tuple[float, ...] | str:
    if value == "proportional":
        return "proportional"
    try:
        if isinstance(value, list):
            seconds = tuple(_seconds(v) for v in value)
            if seconds:
                return seconds
        elif isinstance(value, str | float | int):
            return _seconds(value)
    except ValueError:
        pass
    raise ValueError(
        f"expected seconds from {SHORTEST:g} to {LONGEST:g}, a list of them (one for each "
        "transition), or proportional"
    )


def _seconds(value: Any) -> float:
    seconds = float(value)
    if not SHORTEST <= seconds <= LONGEST:
        raise ValueError
    return seconds


def _simplify(value: Any) -> float:
    try:
        pixels = 0.0 if value == "off" else float(value)
    except (TypeError, ValueError):
        pixels = -1.0
    if not 0 <= pixels <= COARSEST:
        raise ValueError(f"expected a tolerance in px from 0 to {COARSEST:g}, or off")
    return pixels


def _threshold(value: Any) -> float | str:
    """A density, or a share of the peak as it was written: ``20%``."""
    text = str(value).strip()
    share = text.endswith("%")
    try:
        number = float(text.removesuffix("%"))
    except ValueError:
        number = 0.0
    if not (0 < number < 100 if share else 0 < number < math.inf):
        raise ValueError("expected a density above 0, or a share of its peak such as 20%")
    return text if share else number


def _legend(value: Any) -> str | dict[str, str]:
    if value in ("auto", "none"):
        return str(value)
    if isinstance(value, dict) and all(isinstance(words, str) for words in value.values()):
        return {_text(name): _text(words) for name, words in value.items()}
    raise ValueError(
        "expected auto, none, or words for some classes, keys or layers, such as {burnt: Burnt}"
    )


def _graticule(value: Any) -> str | float:
    if value in ("auto", "none"):
        return str(value)
    try:
        degrees = float(value)
    except (TypeError, ValueError):
        degrees = 0.0
    if not FINEST_GRATICULE <= degrees <= 90:
        raise ValueError(f"expected auto, none, or degrees from {FINEST_GRATICULE:g} to 90")
    return degrees


def _tooltip(value: Any) -> str | tuple[str, ...]:
    if value in ("auto", "none"):
        return str(value)
    if isinstance(value, list) and all(isinstance(column, str) for column in value):
        return tuple(map(_text, value))
    raise ValueError("expected auto, none, or a list of columns, such as [area, owner]")


def _place(value: Any) -> tuple[float, float]:
    return _pair(value, "a place [x, y], or [longitude, latitude]")


def _offset(value: Any) -> tuple[float, float]:
    return _pair(value, "px to the right and down, such as [30, -20]")


def _pair(value: Any, meant: str) -> tuple[float, float]:
    try:
        x, y = map(float, value)
    except (TypeError, ValueError):
        x = y = math.nan
    if not (math.isfinite(x) and math.isfinite(y)):
        raise ValueError(f"expected {meant}")
    return x, y


Text = Annotated[str, AfterValidator(_text), WithJsonSchema({"type": _SCALAR})]
Colour = Annotated[
    str,
    AfterValidator(_colour),
    WithJsonSchema({"type": "string", "description": "a hex value, a CSS name, or none"}),
]
StepTime = Annotated[
    Time,
    PlainValidator(read_time),
    WithJsonSchema(
        {"type": ["string", "number"], "description": "a date, a date-time or a number"}
    ),
]
_TRANSITION_SCHEMA = {"type": "number", "minimum": SHORTEST, "maximum": LONGEST}
Transition = Annotated[
    float | tuple[float, ...] | str,
    PlainValidator(_transition),
    WithJsonSchema(
        {
            "description": "seconds per transition: one number, a list, or proportional",
            "anyOf": [
                _TRANSITION_SCHEMA,
                {"type": "array", "items": _TRANSITION_SCHEMA, "minItems": 1},
                {"const": "proportional"},
            ],
        }
    ),
]
Seconds = Annotated[float, Field(ge=0, le=LONGEST, allow_inf_nan=False)]
Pixels = Annotated[float, Field(ge=0, le=20_000, allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Simplify = Annotated[
    float,
    PlainValidator(_simplify),
    WithJsonSchema(
        {"anyOf": [{"type": "number", "minimum": 0, "maximum": COARSEST}, {"const": "off"}]}
    ),
]
Threshold = Annotated[
    float | str,
    PlainValidator(_threshold),
    WithJsonSchema(
        {"anyOf": [{"type": "number", "exclusiveMinimum": 0}, {"type": "string", "pattern": "%$"}]}
    ),
]
Legend = Annotated[
    str | dict[str, str],
    PlainValidator(_legend),
    WithJsonSchema(
        {
            "anyOf": [
                {"enum": ["auto", "none"]},
                {"type": "object", "additionalProperties": {"type": _SCALAR}},
            ]
        }
    ),
]
Graticule = Annotated[
    str | float,
    PlainValidator(_graticule),
    WithJsonSchema(
        {
            "anyOf": [
                {"enum": ["auto", "none"]},
                {"type": "number", "minimum": FINEST_GRATICULE, "maximum": 90},
            ]
        }
    ),
]
Tooltip = Annotated[
    str | tuple[str, ...],
    PlainValidator(_tooltip),
    WithJsonSchema(
        {"anyOf": [{"enum": ["auto", "none"]}, {"type": "array", "items": {"type": _SCALAR}}]}
    ),
]
_PAIR = WithJsonSchema({"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2})
Place = Annotated[tuple[float, float], PlainValidator(_place), _PAIR]
Offset = Annotated[tuple[float, float], PlainValidator(_offset), _PAIR]
Share = Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]

Polygons = Annotated[
    Any,
    BeforeValidator(lambda value: value),
    WithJsonSchema(
        {
            "description": (
                "a path to a file, {file: …, key: …, class: …}, a WKT text, inline GeoJSON, or a "
                "list of polygons: each a "
                "ring [[x, y], ...], a list of rings (the first the outer one, the others holes), "
                "a WKT text, or a feature {key, class, name, polygon}"
            ),
            "anyOf": [
                {"type": "string"},
                {"type": "object", "required": ["type"]},
                {"type": "object", "required": ["file"]},
                {
                    "type": "array",
                    "items": {
                        "anyOf": [
                            {"type": "array"},
                            {"type": "string"},
                            {"type": "object", "required": ["type"]},
                            {
                                "type": "object",
                                "required": ["polygon"],
                                "additionalProperties": False,
                                "properties": {
                                    "key": {"type": _SCALAR},
                                    "class": {"type": _SCALAR},
                                    "name": {"type": _SCALAR},
                                    "polygon": {"type": ["array", "string", "object"]},
                                },
                            },
                        ]
                    },
                },
            ],
        }
    ),
]
