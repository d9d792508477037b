"""Small drawings: panels in a row, a title over each, shapes in the coordinates of the data."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import shapely
import svgwrite
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Box = tuple[float, float, float, float]  # least x and y, greatest x and y

INK, FAINT, PAPER = "#333333", "#9a9a9a", "#ffffff"
FONT = "system-ui, sans-serif"
TITLE, GAP, EDGE, FOOT = 24, 16, 10, 26  # px: over a panel, between two, around all, under all


class Canvas:
    """A row of panels, each a window on a box of the data that is ``width`` px wide.

    ``legend`` has pairs of a colour and what it means; they stand under the panels.
    """

    def __init__(
        self,
        box: Box,
        titles: Sequence[str],
        width: float,
        legend: Sequence[tuple[str, str]] = (),
        label: str = "",
        ground: str = PAPER,
    ) -> None:
        self.box, self.scale = box, width / (box[2] - box[0])
        self.width, self.height = width, (box[3] - box[1]) * self.scale
        whole = 2 * EDGE + len(titles) * width + (len(titles) - 1) * GAP
        tall = TITLE + self.height + (FOOT if legend else EDGE)
        self.drawing = svgwrite.Drawing(size=(_px(whole), _px(tall)), debug=False)
        self.drawing.elements.clear()
        self.drawing.attribs |= {"viewBox": f"0 0 {_px(whole)} {_px(tall)}", "role": "img"}
        self.drawing.attribs |= {"aria-label": label, "font-family": FONT, "font-size": "12"}
        self.drawing.add(self.drawing.rect((0, 0), (_px(whole), _px(tall)), fill=PAPER, rx=4))
        self.panels = [self._panel(k, title, ground) for k, title in enumerate(titles)]
        self._legend(legend, tall)

    def _panel(self, number: int, title: str, ground: str) -> Any:
        left = EDGE + number * (self.width + GAP)
        words = self.drawing.text(title, (_px(left), 16), fill=INK)
        self.drawing.add(words)
        panel = self.drawing.svg(
            (_px(left), TITLE), (_px(self.width), _px(self.height)), stroke_linejoin="round"
        )
        if ground != PAPER:
            panel.add(self.drawing.rect((0, 0), ("100%", "100%"), fill=ground))
        return self.drawing.add(panel)

    def _legend(self, legend: Sequence[tuple[str, str]], tall: float) -> None:
        left = float(EDGE)
        for colour, meaning in legend:
            place = (_px(left), _px(tall - 15))
            self.drawing.add(self.drawing.rect(place, (14, 7), fill=colour))
            place = (_px(left + 19), _px(tall - 8))
            self.drawing.add(self.drawing.text(meaning, place, fill=INK))
            left += 34 + 6.6 * len(meaning)

    def area(self, panel: int, geometry: Any, fill: str, **style: Any) -> None:
        """Polygons, holes left out."""
        rings = shapely.get_rings(shapely.get_parts(geometry))
        text = "".join(self._text(shapely.get_coordinates(ring)[:-1]) + "z" for ring in rings)
        self._path(panel, text, fill=fill, **style)

    def lines(self, panel: int, lines: Iterable[Any], stroke: str, width: float = 1) -> None:
        """Lines, each an array (n, 2) or a geometry."""
        text = "".join(
            self._text(shapely.get_coordinates(line) if hasattr(line, "geom_type") else line)
            for line in lines
        )
        self._path(panel, text, fill="none", stroke=stroke, stroke_width=width)

    def dots(self, panel: int, places: Floats, fill: str = INK, radius: float = 2) -> None:
        for x, y in self._pixels(places).tolist():
            self.panels[panel].add(self.drawing.circle((_px(x), _px(y)), radius, fill=fill))

    def circle(self, panel: int, place: Floats, radius: float, stroke: str) -> None:
        """A circle whose radius is in the data's units."""
        x, y = self._pixels(place[None])[0].tolist()
        size = _px(radius * self.scale)
        self.panels[panel].add(
            self.drawing.circle((_px(x), _px(y)), size, fill="none", stroke=stroke)
        )

    def words(self, panel: int, text: str, place: Sequence[float], fill: str = INK) -> None:
        x, y = self._pixels(np.array([place]))[0].tolist()
        at = (_px(x), _px(y + 4))
        self.panels[panel].add(self.drawing.text(text, at, fill=fill, text_anchor="middle"))

    def svg(self) -> str:
        return str(self.drawing.tostring()) + "\n"

    def _path(self, panel: int, text: str, **style: Any) -> None:
        if text:
            self.panels[panel].add(self.drawing.path(d=text, **style))

    def _pixels(self, places: Floats) -> Floats:
        low, high = np.array(self.box[:2]), np.array(self.box[2:])
        x, y = ((places - low) * self.scale).T
        return np.column_stack([x, (high - low)[1] * self.scale - y])

    def _text(self, places: Floats) -> str:
        return path_text(self._pixels(places))


def path_text(pixels: Floats) -> str:
    """A line through places in px, in tenths, as path data."""
    tenths = np.rint(pixels * 10).astype(int)
    steps = np.diff(tenths, axis=0)
    steps = steps[steps.any(axis=1)]
    start = " ".join(_px(v / 10) for v in tenths[0].tolist())
    way = " ".join(_px(v / 10) for v in steps.ravel().tolist())
    return f"M{start}" + (f"l{way}".replace(" -", "-") if way else "")


def _px(value: float) -> str:
    return f"{value:.1f}".removesuffix(".0")


def mixed(one: str, other: str, share: float) -> str:
    """A colour on the way from one to another, both #rrggbb."""
    parts = [[int(colour[i : i + 2], 16) for i in (1, 3, 5)] for colour in (one, other)]
    return "#" + "".join(f"{round(a + (b - a) * share):02x}" for a, b in zip(*parts, strict=True))
