"""Problems: what was found or mended on the way from a scene to its map, as records."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Literal

Severity = Literal["note", "warning", "error"]
LEAST_SHARE = 1e-4  # what is less is not told apart
LENGTH, AREA = "map units", "square map units"


@dataclass(frozen=True)
class Problem:
    """Something about a geometry or a motion that its author should be able to see.

    ``note`` is for what was settled without harm, ``warning`` for what changed the input or may
    show, ``error`` for what is wrong on the map. ``steps`` names the step, or the pair of steps.
    ``measure`` says how much, as ``unit`` names it.
    """

    kind: str
    severity: Severity
    message: str
    steps: tuple[str, ...] = ()
    piece: str = ""
    measure: float = 0.0
    unit: str = ""
    hint: str = ""

    def __str__(self) -> str:
        where = " → ".join(self.steps)
        subject = ", ".join(part for part in (where, self.piece) if part)
        share = self.unit.startswith("of ")
        number = f"{self.measure:.2%}" if share else f"{self.measure:,.4g}"
        if share and 0 < self.measure < LEAST_SHARE:
            number = f"less than {LEAST_SHARE:.2%}"
        amount = f" ({number} {self.unit})" if self.unit else ""
        hint = f"; {self.hint}" if self.hint else ""
        return f"{self.severity}: {subject + ': ' if subject else ''}{self.message}{amount}{hint}"


def condensed(problems: Iterable[Problem]) -> list[Problem]:
    """Problems; notes that were met in several steps are told once, with the sum of their measures.

    Warnings and errors stay apart: each may have to be mended in a step of its own.
    """
    groups: dict[object, list[Problem]] = {}
    for number, problem in enumerate(problems):
        alike = problem.severity == "note" and not problem.piece
        name = (problem.kind, problem.message, problem.unit) if alike else number
        groups.setdefault(name, []).append(problem)
    return [
        group[0]
        if len(group) == 1
        else replace(
            group[0],
            message=f"{group[0].message}, in {len(group)} steps",
            steps=(),
            measure=sum(problem.measure for problem in group),
        )
        for group in groups.values()
    ]


def in_kilometres(problem: Problem, metres: float | None) -> Problem:
    """A problem whose measure is in units of the map, in kilometres where these are known.

    ``metres`` is the length of a unit.
    """
    if metres is None:
        return problem
    for unit, name, factor in ((LENGTH, "km", metres / 1e3), (AREA, "km²", (metres / 1e3) ** 2)):
        if problem.unit.startswith(unit):
            measure, words = problem.measure * factor, problem.unit.replace(unit, name, 1)
            return replace(problem, measure=measure, unit=words)
    return problem
