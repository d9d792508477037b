"""Annotations on the page: words, the dot at their place and the line between."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass

import numpy as np

from geotween.data.notes import Note
from geotween.export.furniture.room import Box
from geotween.export.furniture.text import LEADING, LETTER, text_width
from geotween.export.page_grid import Page

SIZE = 13.0  # px, of the words
WIDEST = 22  # sizes of the words that a line is long at most
FAR = 34.0  # px from the place to the words, right and up, where a scene does not say
GAP = 4.0  # px between the line and the words
EDGE = 6.0  # px between the words and the page's edge


@dataclass(frozen=True)
class Callout:
    """Words at a place, in px: where the dot is, where the line ends, and where each line begins.

    ``anchor`` is that of SVG's text: ``start`` where the words are right of the place.
    """

    lines: tuple[str, ...]
    dot: tuple[float, float]
    elbow: tuple[float, float]
    words: tuple[float, float]
    anchor: str
    steps: tuple[int, ...]

    @property
    def box(self) -> Box:
        """What the words take."""
        width = max(text_width(line, SIZE) for line in self.lines)
        left = self.words[0] - {"start": 0, "middle": width / 2, "end": width}[self.anchor]
        top = self.words[1] - SIZE / 2
        bottom = top + SIZE * (1 + LEADING * (len(self.lines) - 1))
        return left, top, left + width, bottom


def callout(note: Note, page: Page) -> Callout:
    """A note on the page; its words stay within the page as far as they have room."""
    room = page.width - 2 * EDGE
    letters = int(min(room / SIZE, WIDEST) / LETTER)
    lines = tuple(textwrap.wrap(note.text, max(letters, 1))) or ("",)
    width = max(text_width(line, SIZE) for line in lines)
    height = SIZE * LEADING * (len(lines) - 1)
    dot = page.pixels(np.array([note.place]))[0]
    right, down = note.offset or (
        FAR if dot[0] + FAR + width < page.width - EDGE or dot[0] < page.width / 2 else -FAR,
        -FAR if dot[1] - FAR - height > EDGE + SIZE else FAR,
    )
    anchor = "middle" if abs(right) < GAP else "start" if right > 0 else "end"
    before = {"start": 0.0, "middle": width / 2, "end": width}[anchor]
    x = _within(dot[0] + right, EDGE + before, page.width - EDGE - width + before)
    first = dot[1] + down - (height if down < 0 else 0)
    first = _within(first, EDGE + SIZE / 2, page.height - EDGE - SIZE / 2 - height)
    nearest = first + height if down < 0 else first
    side = {"start": -GAP, "middle": 0.0, "end": GAP}[anchor]
    if anchor == "middle":
        nearest += (SIZE / 2 + GAP) * (1 if down < 0 else -1)
    dot_at = (float(dot[0]), float(dot[1]))
    elbow, words = _short((x + side, nearest)), _short((x, first))
    return Callout(lines, dot_at, elbow, words, anchor, note.steps)


def _within(value: float, low: float, high: float) -> float:
    """The nearest to a value between two others; the first of them where there is no room."""
    return float(max(low, min(value, high)))


def _short(place: tuple[float, float]) -> tuple[float, float]:
    return round(float(place[0]), 1), round(float(place[1]), 1)
