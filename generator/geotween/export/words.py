"""The words of an SVG: title and step label above the map, source below it."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass

import svgwrite
from svgwrite.base import BaseElement

from geotween.export.elements import px
from geotween.export.keyframes import Keyframes
from geotween.export.smil import show

MARGIN = 16  # px beside the words
TITLE, LABEL, SOURCE = 18.0, 16.0, 11.0  # px, the sizes of the words above and below the map
LEADING = 1.4  # lines in sizes of their font
BOLD = 1.1  # the width of bold letters to that of others
LETTER = 0.56  # the width of a letter in sizes of its font; generous, as the font is the reader's
_FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, sans-serif"


@dataclass(frozen=True)
class Words:
    """What the SVG says above and below the map, in lines that fit its width."""

    title: tuple[str, ...]
    source: tuple[str, ...]

    @property
    def header(self) -> float:
        return round(len(self.title) * TITLE * LEADING + LABEL * LEADING + MARGIN)

    @property
    def footer(self) -> float:
        return round(len(self.source) * SOURCE * LEADING + MARGIN) if self.source else 0


def words(frames: Keyframes, title: str, source: str) -> Words:
    """A title and a source in lines."""
    room = frames.page.width - 2 * MARGIN
    return Words(
        tuple(textwrap.wrap(title, max(1, int(room / (LETTER * TITLE * BOLD))))),
        tuple(textwrap.wrap(source, max(1, int(room / (LETTER * SOURCE))))),
    )


def write_words(drawing: svgwrite.Drawing, frames: Keyframes, around: Words) -> None:
    """Title and step label above the map, source below it."""
    group = drawing.g(class_="words", fill=_ink(frames.background))
    group.attribs["font-family"] = _FONT
    top = -around.header + MARGIN / 2 + TITLE * (1 - LEADING)
    for line in around.title:
        top += TITLE * LEADING
        group.add(_text(drawing, line, top, TITLE, weight="700"))
    room = frames.page.width - 2 * MARGIN
    for label, times in _labels(frames):
        size = max(SOURCE / 2, min(LABEL, room / (LETTER * max(len(label), 1))))
        text = _text(drawing, label, -MARGIN / 2 - LABEL * (LEADING - 1), size)
        text.attribs["class"] = "step"
        show(text, [times], frames)
        group.add(text)
    top = frames.page.height
    for line in around.source:
        top += SOURCE * LEADING
        group.add(_text(drawing, line, top, SOURCE))
    drawing.add(group)


def _labels(frames: Keyframes) -> list[tuple[str, tuple[int, int]]]:
    """Each step's label and when it is seen: from half-way before to half-way after."""
    halves = [(span.start + span.end) // 2 for span, _ in frames.spans if not span.rest]
    end = frames.duration if frames.loop else frames.duration + 1
    return [
        (label, (start, stop))
        for label, start, stop in zip(frames.labels, [0, *halves], [*halves, end], strict=True)
    ]


def _text(
    drawing: svgwrite.Drawing, line: str, y: float, size: float, weight: str = ""
) -> BaseElement:
    text = drawing.text(line, insert=(px(MARGIN), px(round(y, 1))))
    text.attribs["font-size"] = px(round(size, 1))
    if weight:
        text.attribs["font-weight"] = weight
    return text


def _ink(background: str) -> str:
    """Dark words on a light background, light ones on a dark one."""
    if background == "none":
        return "#222222"
    red, green, blue = (int(background[i : i + 2], 16) for i in (1, 3, 5))
    return "#222222" if 0.299 * red + 0.587 * green + 0.114 * blue > 140 else "#f2f2f2"
