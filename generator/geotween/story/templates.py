"""Wording as data: what a file of words may say, and its templates, which can do nothing but say.

A template is Jinja, of text, names, conditions and a few filters. Whoever wrote it, it can neither
call nor loop nor reach into what it is given.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import TYPE_CHECKING, Annotated

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field

from geotween.scene.errors import did_you_mean
from geotween.scene.values import Text

if TYPE_CHECKING:
    from jinja2 import Template
    from jinja2.sandbox import SandboxedEnvironment

_COUNTED = frozenset({"n", "noun"})

# What each message may use.
MESSAGES: Mapping[str, frozenset[str]] = {
    "opening": frozenset({"when", "things", "area"}),
    "caption": frozenset({"period", "told"}),
    "further": frozenset({"told"}),
    "between": frozenset({"first", "last"}),
    "from_to": frozenset({"first", "last"}),
    "unchanged": frozenset(),
    "summary": frozenset({"total", "told"}) | _COUNTED,
    "everything": frozenset({"told"}) | _COUNTED,
    "the": frozenset({"noun", "class", "usual"}),
    "largest": frozenset({"noun", "class", "usual"}),
    "things": _COUNTED,
    "others": _COUNTED,
    "parts": frozenset({"n"}),
    "from_parts": frozenset({"n"}),
    "clause": frozenset({"subject", "done"}),
    "grew": frozenset({"percent", "area"}),
    "multiplied": frozenset({"times", "area"}),
    "shrank": frozenset({"percent", "area"}),
    "moved": frozenset({"distance", "direction"}),
    "became": frozenset({"name"}),
    "appeared": frozenset({"area"}),
    "vanished": frozenset({"area"}),
    "split": frozenset({"who"}),
    "merged": frozenset({"who"}),
    "joined": frozenset({"who"}),
    "left": frozenset({"who"}),
    "all_appeared": frozenset({"things", "area"}),
    "all_vanished": frozenset({"things", "area"}),
    "all_split": frozenset({"things", "into"}),
    "all_merged": frozenset({"things", "into"}),
    "all_moved": frozenset({"things"}),
    "all_grew": frozenset({"things"}),
    "all_shrank": frozenset({"things"}),
}

FORMS = ("zero", "one", "two", "few", "many", "other")  # of CLDR
_NODES = frozenset({
    "Template", "Output", "TemplateData", "Name", "Const", "Filter",
    "If", "CondExpr", "Compare", "Operand", "And", "Or", "Not",
})  # fmt: skip
_FILTERS = ("upfirst", "upper", "lower", "trim")
LONGEST = 2000  # characters of a template


def _forms(value: object) -> object:
    return {"other": value} if isinstance(value, str) else value


def _known_forms(value: dict[str, str]) -> dict[str, str]:
    unknown = [form for form in value if form not in FORMS]
    if unknown:
        raise ValueError(f"unknown form {unknown[0]!r}: {did_you_mean(unknown[0], FORMS)}")
    if "other" not in value:
        raise ValueError('needs the form "other"')
    return value


Forms = Annotated[dict[str, Text], BeforeValidator(_forms), AfterValidator(_known_forms)]
Pair = tuple[Text, Text]
Eight = Annotated[tuple[Text, ...], Field(min_length=8, max_length=8)]


def _complete(says: dict[str, dict[str, str]]) -> dict[str, dict[str, str]]:
    for name in MESSAGES:
        if name not in says:
            raise ValueError(f"the message {name} is missing")
    for name, forms in says.items():
        if name not in MESSAGES:
            raise ValueError(f"unknown message {name!r}: {did_you_mean(name, list(MESSAGES))}")
        for template in forms.values():
            check_template(name, template)
    return says


Messages = Annotated[dict[str, Forms], AfterValidator(_complete)]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Unit(_Part):
    """A unit of CLDR, such as area-hectare; its size and where it begins, in m² or m."""

    unit: Text
    size: Annotated[float, Field(gt=0, allow_inf_nan=False)]
    least: Annotated[float, Field(ge=0, allow_inf_nan=False, alias="from")] = 0.0


class Days(_Part):
    """Patterns of two days, by what they have in common."""

    same_month: Pair
    same_year: Pair
    apart: Pair


class Moments(_Part):
    """Patterns of two date-times, by what they have in common."""

    same_day: Pair
    same_year: Pair
    apart: Pair


class Dates(_Part):
    """Patterns of CLDR for times."""

    day: Text
    moment: Text
    days: Days
    moments: Moments


class WordsFile(_Part):
    """All words of a language; ``says`` has each of MESSAGES, in its forms."""

    lang: Annotated[str, Field(pattern=r"^[A-Za-z]{2,8}(-[A-Za-z0-9]{1,8})*$")]
    noun: Forms
    numbers: dict[int, Text]
    compass: Eight
    page: Eight
    dates: Dates
    areas: Annotated[tuple[Unit, ...], Field(min_length=1)]
    lengths: Annotated[tuple[Unit, ...], Field(min_length=1)]
    says: Messages


def check_template(name: str, text: str) -> None:
    """Refuse a template that does more than say what it is given.

    Raises
    ------
    ValueError
        For what is no template, is too long, or uses anything else.
    """
    from jinja2 import TemplateSyntaxError, nodes

    if len(text) > LONGEST:
        raise ValueError(f"the message {name} is longer than {LONGEST} characters")
    try:
        tree = _environment().parse(text)
    except TemplateSyntaxError as error:
        raise ValueError(f"the message {name} is no template: {error.message}") from None
    for node in [tree, *tree.find_all(nodes.Node)]:
        kind = type(node).__name__
        if kind not in _NODES:
            raise ValueError(f"the message {name} may not use {kind.lower()}: only text, names, if")
        if isinstance(node, nodes.Filter) and node.name not in _FILTERS:
            raise ValueError(f"the message {name} may not use the filter {node.name!r}")
        if isinstance(node, nodes.Name) and node.name not in MESSAGES[name]:
            known = ", ".join(sorted(MESSAGES[name])) or "nothing"
            raise ValueError(f"the message {name} knows no {node.name!r}, only {known}")


@cache
def compiled(text: str) -> Template:
    """A checked template, ready to be filled in."""
    return _environment().from_string(text)


@cache
def _environment() -> SandboxedEnvironment:
    from jinja2 import StrictUndefined
    from jinja2.sandbox import ImmutableSandboxedEnvironment

    environment = ImmutableSandboxedEnvironment(autoescape=False, undefined=StrictUndefined)
    environment.filters["upfirst"] = lambda text: text[:1].upper() + text[1:]
    return environment
