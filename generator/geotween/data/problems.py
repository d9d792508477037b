"""Problems: what was found or mended on the way from a scene to its map, as records."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Severity = Literal["note", "warning", "error"]


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
        number = f"{self.measure:.2%}" if share else f"{self.measure:.3g}"
        amount = f" ({number} {self.unit})" if self.unit else ""
        hint = f"; {self.hint}" if self.hint else ""
        return f"{self.severity}: {subject + ': ' if subject else ''}{self.message}{amount}{hint}"
