"""The one exception for a scene that cannot be built, with every fault at its place."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

EXCERPT_WIDTH = 88  # characters of a line shown around a fault; fits a terminal of 100


@dataclass(frozen=True, order=True)
class Fault:
    """One thing wrong in a file: where, what, and how to mend it.

    ``line`` and ``column`` count from 1; ``text`` is the line itself.
    """

    file: str
    line: int
    column: int
    message: str
    hint: str = ""
    text: str = ""

    def __str__(self) -> str:
        parts = [f"{self.file}:{self.line}:{self.column}: {self.message}"]
        if self.text.strip():
            excerpt, caret = _excerpt(self.text, self.column)
            parts += [f"{self.line:>6} | {excerpt}", f"{'':>6} | {caret}"]
        if self.hint:
            parts.append(f"{'':>6} = {self.hint}")
        return "\n".join(parts)


class SceneError(Exception):
    """A scene that cannot be built; ``faults`` holds everything found wrong with it."""

    def __init__(self, faults: Iterable[Fault]) -> None:
        self.faults: tuple[Fault, ...] = tuple(dict.fromkeys(faults))
        super().__init__(self.faults)

    def __str__(self) -> str:
        count = len(self.faults)
        total = f"{count} error{'s' if count > 1 else ''}"
        return "\n\n".join([*map(str, self.faults), total])


def did_you_mean(word: str, known: Sequence[str]) -> str:
    """A hint that names the known word nearest to ``word``, or all of them where none is near."""
    near = difflib.get_close_matches(word.lower(), known, n=1, cutoff=0.6)
    return f'did you mean "{near[0]}"?' if near else f"known here: {', '.join(sorted(known))}"


def _excerpt(text: str, column: int) -> tuple[str, str]:
    """The part of a line around a column, and a caret under that column."""
    spaced = text.rstrip("\r\n").replace("\t", " ")
    line = "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in spaced)
    start = max(0, min(column - 1 - EXCERPT_WIDTH // 2, len(line) - EXCERPT_WIDTH))
    shown = line[start : start + EXCERPT_WIDTH]
    lead = "… " if start else ""
    tail = " …" if start + EXCERPT_WIDTH < len(line) else ""
    return f"{lead}{shown}{tail}", " " * (len(lead) + column - 1 - start) + "^"
