"""The words of an SVG: title and step label above the map; legend, scale bar and source below."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass

import svgwrite
from svgwrite.base import BaseElement

from geotween.export.elements import px
from geotween.export.furniture.draw import draw_bar
from geotween.export.furniture.language import direction
from geotween.export.furniture.legend import Entry
from geotween.export.furniture.scale_bar import SIZE as BAR_SIZE
from geotween.export.furniture.text import FONT, LEADING, LETTER, text_width
from geotween.export.keyframes import Keyframes
from geotween.export.smil import show

MARGIN = 16  # px beside the words
TITLE, LABEL, SOURCE = 18.0, 16.0, 11.0  # px, the sizes of the words above and below the map
BOLD = 1.1  # the width of bold letters to that of others
ENTRY = 12.0  # px, the size of the legend's words
SWATCH, BESIDE, BETWEEN = 12.0, 6.0, 18.0  # px: a colour's square, the way to its words, and on
NO_STEP = -1
ROW = 20.0  # px, the height of a row of the legend, and of the scale bar


@dataclass(frozen=True)
class Words:
    """What the SVG says above and below the map, in lines that fit its width.

    ``entries`` are those of the legend, each with the place of its square: px from where lines
    begin, and the row.
    """

    title: tuple[str, ...]
    source: tuple[str, ...]
    entries: tuple[tuple[Entry, float, int], ...] = ()
    scale_bar: bool = False

    @property
    def header(self) -> float:
        return round(len(self.title) * TITLE * LEADING + LABEL * LEADING + MARGIN)

    @property
    def key(self) -> float:
        """The height of legend and scale bar."""
        rows = 1 + self.entries[-1][2] if self.entries else 0
        rows += self.scale_bar
        return rows * ROW + (MARGIN / 2 if rows else 0)

    @property
    def footer(self) -> float:
        below = len(self.source) * SOURCE * LEADING
        return round(self.key + below + (MARGIN if self.source or self.key else 0))


def words(frames: Keyframes, title: str, source: str) -> Words:
    """Title, source and legend in lines."""
    room = frames.page.width - 2 * MARGIN
    return Words(
        tuple(textwrap.wrap(title, max(1, int(room / (LETTER * TITLE * BOLD))))),
        tuple(textwrap.wrap(source, max(1, int(room / (LETTER * SOURCE))))),
        _flowed(frames.furniture.legend, room),
        frames.furniture.scale_bar is not None,
    )


def _flowed(entries: tuple[Entry, ...], room: float) -> tuple[tuple[Entry, float, int], ...]:
    """Entries in rows, as many in each as it has room for."""
    found: list[tuple[Entry, float, int]] = []
    left, row = 0.0, 0
    for entry in entries:
        width = SWATCH + BESIDE + text_width(entry.label, ENTRY)
        if left and left + width > room:
            left, row = 0.0, row + 1
        found.append((entry, left, row))
        left += width + BETWEEN
    return tuple(found)


def write_words(
    drawing: svgwrite.Drawing, frames: Keyframes, around: Words, only: int | None = None
) -> BaseElement:
    """Title and step label above the map, legend, scale bar and source below it.

    Step labels come and go as the map plays, or there is that of one step only, or of none.
    """
    ink = ink_on(frames.background)
    way = direction(frames.lang)
    line_start = MARGIN if way == "ltr" else frames.page.width - MARGIN
    group = drawing.g(class_="words", fill=ink)
    group.attribs |= {"font-family": FONT, "direction": way}
    top = -around.header + MARGIN / 2 + TITLE * (1 - LEADING)
    if only == NO_STEP:
        top += LABEL * LEADING
    for line in around.title:
        top += TITLE * LEADING
        group.add(_text(drawing, line, line_start, top, TITLE, weight="700"))
    room = frames.page.width - 2 * MARGIN
    for number, (label, times) in enumerate(step_times(frames)):
        if only not in (None, number):
            continue
        size = max(SOURCE / 2, min(LABEL, room / (LETTER * max(len(label), 1))))
        text = _text(drawing, label, line_start, -MARGIN / 2 - LABEL * (LEADING - 1), size)
        text.attribs["class"] = "step"
        if only is None:
            show(text, [times], frames)
        group.add(text)
    _write_legend(drawing, group, frames, around, ink)
    top = frames.page.height + around.key
    for line in around.source:
        top += SOURCE * LEADING
        group.add(_text(drawing, line, line_start, top, SOURCE))
    return group


def _write_legend(
    drawing: svgwrite.Drawing, group: BaseElement, frames: Keyframes, around: Words, ink: str
) -> None:
    """The rows of the legend, and the scale bar in a row of its own."""
    mirrored = direction(frames.lang) == "rtl"
    width, top = frames.page.width, frames.page.height + MARGIN / 2
    key = group.add(drawing.g(class_="legend"))
    for entry, left, row in around.entries:
        middle = top + (row + 0.5) * ROW
        x = MARGIN + left
        words_at = x + SWATCH + BESIDE
        if mirrored:
            x, words_at = width - x - SWATCH, width - words_at
        square = drawing.rect(
            (px(round(x, 1)), px(round(middle - SWATCH / 2, 1))), (px(SWATCH), px(SWATCH))
        )
        stroke = ink if entry.fill == entry.stroke == "none" else entry.stroke
        square.attribs |= {"fill": entry.fill, "stroke": stroke}
        key.add(square)
        key.add(_text(drawing, entry.label, words_at, middle + ENTRY * 0.36, ENTRY))
    bar = frames.furniture.scale_bar
    if bar is not None:
        bottom = frames.page.height + around.key - 4
        left = width - MARGIN - bar.width if mirrored else MARGIN
        scale = group.add(drawing.g(class_="scale-bar"))
        draw_bar(scale, bar, left, bottom, ink, None)
        beside = left - BESIDE if mirrored else left + bar.width + BESIDE
        scale.add(_text(drawing, bar.words, beside, bottom, BAR_SIZE))


def step_times(frames: Keyframes) -> list[tuple[str, tuple[int, int]]]:
    """Each step's label and when it is seen: from half-way before to half-way after."""
    halves = [(span.start + span.end) // 2 for span, _ in frames.spans if not span.rest]
    end = frames.duration if frames.loop else frames.duration + 1
    return [
        (label, (start, stop))
        for label, start, stop in zip(frames.labels, [0, *halves], [*halves, end], strict=True)
    ]


def _text(
    drawing: svgwrite.Drawing, line: str, x: float, y: float, size: float, weight: str = ""
) -> BaseElement:
    text = drawing.text(line, insert=(px(round(x, 1)), px(round(y, 1))))
    text.attribs["font-size"] = px(round(size, 1))
    if weight:
        text.attribs["font-weight"] = weight
    return text


def ink_on(background: str) -> str:
    """Dark words on a light background, light ones on a dark one."""
    if background == "none":
        return "#222222"
    red, green, blue = (int(background[i : i + 2], 16) for i in (1, 3, 5))
    return "#222222" if 0.299 * red + 0.587 * green + 0.114 * blue > 140 else "#f2f2f2"
