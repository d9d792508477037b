"""Furniture as SVG elements: what lies on the map. What stands below it, see ``words.py``."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import svgwrite
from svgwrite.base import BaseElement

from geotween.export.elements import SvgPath, px
from geotween.export.furniture.annotations import SIZE as NOTE_SIZE
from geotween.export.furniture.annotations import Callout
from geotween.export.furniture.graticule import Line
from geotween.export.furniture.labels import SIZE as LABEL_SIZE
from geotween.export.furniture.labels import Label, Way
from geotween.export.furniture.language import direction
from geotween.export.furniture.scale_bar import SIZE as BAR_SIZE
from geotween.export.furniture.scale_bar import TICK, ScaleBar
from geotween.export.furniture.text import FONT, HALO, INK, LEADING
from geotween.export.page_grid import GRID

DOT = 2.5  # px, the radius of the dot at an annotation's place
HALO_WIDTH = 3.0  # px, of what parts words from the map under them

# The other way round, for a script that runs from right to left.
MIRRORED = {"start": "end", "end": "start", "middle": "middle"}


def draw_graticule(lines: Iterable[Line]) -> BaseElement:
    """All lines as one thin path, to be seen on light grounds and on dark ones."""
    path = SvgPath("graticule", "".join(map(_open_path, lines)))
    path.attribs.update(
        {"fill": "none", "stroke": "#808080", "stroke-width": "0.6", "stroke-opacity": "0.55"}
    )
    return path


def draw_labels(
    drawing: svgwrite.Drawing,
    labels: Iterable[Label],
    placed: Callable[[BaseElement, Label], bool],
) -> BaseElement:
    """The texts of labels; ``placed`` puts each in its place, or says that it is not seen."""
    group = _group(drawing, "labels")
    for label in labels:
        text = drawing.text(label.text)
        text.attribs |= {"class": "label", "font-size": px(LABEL_SIZE), "font-weight": "600"}
        text.attribs |= {"text-anchor": "middle", "dominant-baseline": "middle"}
        if placed(text, label):
            group.add(text)
    return group


def at_rest(span: int) -> Callable[[BaseElement, Label], bool]:
    """Puts labels where they are in a span that rests."""

    def placed(text: BaseElement, label: Label) -> bool:
        way: Way = label.spans.get(span, ())
        if way:
            text.attribs |= {"x": px(round(way[0][1], 1)), "y": px(round(way[0][2], 1))}
        return bool(way)

    return placed


def draw_callout(
    drawing: svgwrite.Drawing, callout: Callout, lang: str, size: float = NOTE_SIZE
) -> BaseElement:
    """Dot, line and words of an annotation."""
    group = _group(drawing, "annotation")
    group.attribs["data-steps"] = " ".join(map(str, callout.steps))
    (x, y), (end_x, end_y) = callout.dot, callout.elbow
    shape = f"M{px(round(x, 1))} {px(round(y, 1))}L{px(end_x)} {px(end_y)}"
    for colour, width in ((HALO, HALO_WIDTH), (INK, 1.0)):
        line = SvgPath("leader", shape)
        line.attribs |= {"fill": "none", "stroke": colour, "stroke-width": px(width)}
        group.add(line)
    dot = drawing.circle((px(round(x, 1)), px(round(y, 1))), px(DOT), fill=INK)
    dot.attribs |= {"stroke": HALO, "stroke-width": "1"}
    group.add(dot)
    way = direction(lang)
    text = drawing.text("")
    text.attribs |= {"font-size": px(size), "dominant-baseline": "middle", "direction": way}
    text.attribs["text-anchor"] = callout.anchor if way == "ltr" else MIRRORED[callout.anchor]
    for number, words_of_line in enumerate(callout.lines):
        words = drawing.tspan(words_of_line)
        place = {"dy": f"{LEADING}em"} if number else {"y": px(callout.words[1])}
        words.attribs |= {"x": px(callout.words[0]), **place}
        text.add(words)
    group.add(text)
    return group


def draw_scale_bar(drawing: svgwrite.Drawing, bar: ScaleBar) -> BaseElement:
    """The bar in its corner of the map, its words on it."""
    group = _group(drawing, "scale-bar")
    left, _, right, bottom = bar.box
    middle = (left + right) / 2
    draw_bar(group, bar, middle - bar.width / 2, bottom - 1, INK, HALO)
    text = drawing.text(bar.words, insert=(px(round(middle, 1)), px(round(bottom - TICK - 2, 1))))
    text.attribs |= {"font-size": px(BAR_SIZE), "text-anchor": "middle"}
    group.add(text)
    return group


def draw_bar(
    group: BaseElement, bar: ScaleBar, left: float, bottom: float, ink: str, halo: str | None
) -> None:
    """The line of a scale bar and its two ends."""
    shape = f"M{px(round(left, 2))} {px(round(bottom - TICK, 2))}v{px(TICK)}"
    shape += f"h{px(round(bar.width, 2))}v{px(-TICK)}"
    for colour, width in ((halo, HALO_WIDTH + 1), (ink, 1.5)):
        if colour is not None:
            line = SvgPath("bar", shape)
            line.attribs |= {"fill": "none", "stroke": colour, "stroke-width": px(width)}
            group.add(line)


def _open_path(line: Line) -> str:
    return "M" + "L".join(f"{px(x * GRID)} {px(y * GRID)}" for x, y in line.tolist())


def _group(drawing: svgwrite.Drawing, name: str) -> BaseElement:
    """A group for words on the map: dark, with a light halo, on whatever lies under them."""
    group = drawing.g(class_=name, fill=INK)
    group.attribs |= {"font-family": FONT, "stroke": HALO, "stroke-width": px(HALO_WIDTH)}
    group.attribs |= {"stroke-linejoin": "round", "paint-order": "stroke"}
    return group
