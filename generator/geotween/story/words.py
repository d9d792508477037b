"""Words: numbers, amounts, times and messages in the language of a scene, as plain text."""

from __future__ import annotations

import datetime
import re
from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, replace
from decimal import ROUND_HALF_UP, Decimal
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from geotween.data.load import Scene, Step
from geotween.data.steps.times import words_of
from geotween.scene.document import Document, read_text
from geotween.scene.errors import SceneError
from geotween.scene.plain import read_yaml
from geotween.scene.read import validated
from geotween.story.templates import Days, Moments, Unit, WordsFile, compiled

if TYPE_CHECKING:
    from babel import Locale

DEFAULT = "en"
_FOLDER = Path(__file__).parent / "languages"
LANGUAGES = tuple(sorted(path.stem for path in _FOLDER.glob("*.yaml")))

# How many figures are told: more of an area than of a change, which says the same again.
FIGURES, FEW_FIGURES = 3, 2
_OPTIONAL = re.compile(r"\[([^\]]*)\]")


@dataclass(frozen=True, eq=False)
class Words:
    """The words of one language, and how a scene speaks in it.

    ``lang`` says which language it is, as in HTML; ``usual`` that things have the language's own
    noun, ``years`` that times need their year.
    """

    file: WordsFile
    lang: str
    usual: bool = True
    years: bool = True

    @cached_property
    def locale(self) -> Locale:
        """The locale of numbers and dates; that of the language where the region is unknown."""
        from babel import Locale
        from babel.core import UnknownLocaleError

        for lang in (self.lang, self.file.lang, DEFAULT):
            try:
                return Locale.parse(lang, sep="-")
            except (UnknownLocaleError, ValueError):
                continue
        raise AssertionError(DEFAULT)

    def say(self, message: str, count: int | None = None, **values: str | bool) -> str:
        """A message, in the form that goes with a count."""
        return compiled(self._form(self.file.says[message], count)).render(values)

    def noun(self, count: int) -> str:
        """What so many things are called."""
        return self._form(self.file.noun, count)

    def things(self, count: int, message: str = "things") -> str:
        """So many of them: two areas."""
        return self.say(message, count, n=self.number(count), noun=self.noun(count))

    def number(self, number: int) -> str:
        """A whole number, in letters where the language has them."""
        return self.file.numbers.get(number) or self._decimal(number)

    def percent(self, share: float) -> str:
        """A share in percent, to two figures, or to whole percents where these are more."""
        from babel.numbers import format_percent

        rounded = _rounded(share, FEW_FIGURES if share < 1 else FIGURES)
        return str(format_percent(rounded, locale=self.locale, decimal_quantization=False))

    def times(self, factor: float) -> str:
        """A factor, to two figures."""
        return self._decimal(_rounded(factor, FEW_FIGURES))

    def area(self, square_metres: float | None) -> str:
        """An area in the unit that suits it; empty for None."""
        return self._amount(square_metres, self.file.areas, FIGURES)

    def length(self, metres: float | None) -> str:
        """A length in the unit that suits it; empty for None."""
        return self._amount(metres, self.file.lengths, FEW_FIGURES)

    def direction(self, bearing: float, *, compass: bool) -> str:
        """One of eight directions, on the globe or on the page."""
        return (self.file.compass if compass else self.file.page)[round(bearing / 45) % 8]

    def row(self, texts: Sequence[str]) -> str:
        """Texts in a row: one, another and a third."""
        from babel.lists import format_list

        return str(format_list(texts, locale=self.locale)) if texts else ""

    def when(self, step: Step) -> str:
        """The time of a step, or what it is called."""
        time = _told(step)
        if time is None:
            return step.label
        moment = isinstance(time, datetime.datetime)
        return self._date(time, self.file.dates.moment if moment else self.file.dates.day)

    def period(self, origin: Step, target: Step) -> str:
        """The time between two steps."""
        first, last = _told(origin), _told(target)
        if first is None or last is None:
            return self.say("from_to", first=origin.label, last=target.label)
        dates = self.file.dates
        if isinstance(first, datetime.datetime) and isinstance(last, datetime.datetime):
            same_day = first.date() == last.date()
            near = dates.moments.same_day if same_day else None
            others: Days | Moments = dates.moments
        else:
            same_month = (first.year, first.month) == (last.year, last.month)
            near, others = dates.days.same_month if same_month else None, dates.days
        patterns = near or (others.same_year if first.year == last.year else others.apart)
        ends = [self._date(t, p) for t, p in zip((first, last), patterns, strict=True)]
        return self.say("between", first=ends[0], last=ends[1])

    def check(self) -> None:
        """Refuse units that CLDR does not have, and patterns that are none.

        Raises
        ------
        ValueError
            For the first of them.
        """
        dates, moment = self.file.dates, datetime.datetime(2020, 9, 10, 12)
        for unit in (*self.file.areas, *self.file.lengths):
            self._amount(unit.size, [unit], FIGURES)
        spans = (*dict(dates.days).values(), *dict(dates.moments).values())
        for pattern in (dates.day, dates.moment, *(p for pair in spans for p in pair)):
            try:
                self._date(moment, pattern)
            except (AttributeError, KeyError, ValueError):
                raise ValueError(f"{pattern!r} is no pattern of dates") from None

    def _form(self, forms: Mapping[str, str], count: int | None) -> str:
        form = "other" if count is None else self.locale.plural_form(count)
        return forms.get(form, forms["other"])

    def _date(self, time: datetime.date, pattern: str) -> str:
        from babel.dates import format_date, format_datetime

        told = _OPTIONAL.sub(r"\1" if self.years else "", pattern)
        write = format_datetime if isinstance(time, datetime.datetime) else format_date
        return str(write(time, told, locale=self.locale))

    def _decimal(self, number: float) -> str:
        from babel.numbers import format_decimal

        return str(format_decimal(number, locale=self.locale, decimal_quantization=False))

    def _amount(self, amount: float | None, units: Sequence[Unit], figures: int) -> str:
        from babel.units import format_unit

        if amount is None:
            return ""
        fitting = [unit for unit in units if _rounded(amount, figures) >= unit.least]
        unit = max(fitting or units, key=lambda unit: unit.least)
        number = _rounded(amount / unit.size, figures)
        return str(format_unit(number, unit.unit, "short", locale=self.locale))


def words_of_scene(scene: Scene) -> Words:
    """The words that a scene is told in: its language's, or English, with its own over them.

    Raises
    ------
    SceneError
        Where the scene's file of words has faults.
    """
    own = _values(scene.words) if scene.words else {}
    lang = str(own.get("lang", scene.model.lang))
    base = lang.split("-")[0].lower()
    known = base in LANGUAGES
    document = _document(base if known else DEFAULT)
    values = _values(document)
    if "lang" in own and not known:  # a language of its own: nothing is taken from another
        values = {name: values[name] for name in ("areas", "lengths")}
    values = _over(values, own)
    story = scene.model.story
    if story.noun is not None:
        values["noun"] = {"one": story.noun, "other": story.nouns or story.noun}
    file, faults = validated(scene.words or document, WordsFile, values)
    if file is None:
        raise SceneError(faults)
    usual = story.noun is None and "noun" not in own
    words = Words(file, lang if known or "lang" in own else file.lang, usual)
    try:
        words.check()
    except ValueError as error:
        raise SceneError([(scene.words or document).fault((), str(error))]) from None
    years = {time.year for time in map(_told, scene.steps) if time is not None}
    return replace(words, years=len(years) > 1)


def _document(name: str) -> Document:
    path = _FOLDER / f"{name}.yaml"
    return Document(str(path), path, read_text(path, str(path)))


def _values(document: Document) -> dict[str, Any]:
    """The plain values of a file of words."""
    values, faults = read_yaml(document)
    if not isinstance(values, dict):
        faults = [document.fault_at(1, 1, "expected a mapping (key: value)")]
    if faults:
        raise SceneError(faults)
    return dict(values)


def _over(base: dict[str, Any], own: Mapping[str, Any]) -> dict[str, Any]:
    """The words of a file, with those of another one in their places; whole messages and lists."""
    merged = deepcopy(base)
    for name, value in own.items():
        inner = name in ("dates", "says", "numbers") and isinstance(value, dict)
        merged[name] = {**merged.get(name, {}), **value} if inner else value
    return merged


def _told(step: Step) -> datetime.date | None:
    """The time of a step that is called by it."""
    dated = isinstance(step.time, datetime.date) and step.label == words_of(step.time)
    return step.time if dated and isinstance(step.time, datetime.date) else None


def _rounded(number: float, figures: int) -> float:
    """To so many figures, halves upwards; what double precision adds does not decide."""
    exact = Decimal(f"{number:.9g}")
    step = Decimal(1).scaleb(exact.adjusted() - figures + 1)
    return float(exact.quantize(step, ROUND_HALF_UP)) if exact else 0.0
