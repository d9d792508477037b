"""Words as outlines: a picture looks the same wherever it is seen, as no font is asked for.

Lines are set in Noto Sans by HarfBuzz. A line that the font has not all letters of, or that runs
from right to left, stays text: it is set in a font of the reader's or the renderer's.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, lru_cache
from importlib.resources import files
from typing import Any
from xml.etree.ElementTree import Element

from geotween.export.elements import px
from geotween.export.pictures.extras import needed

FONT = "NotoSans[wdth,wght].ttf"
# Attributes of words that outlines have no use for.
OF_LETTERS = frozenset(
    [
        "x",
        "y",
        "direction",
        "dominant-baseline",
        "font-family",
        "font-size",
        "font-weight",
        "text-anchor",
    ]
)
BEFORE = {"start": 0.0, "middle": 0.5, "end": 1.0}  # the share of a line that lies before its x


@dataclass(frozen=True)
class Line:
    """A line set in letters: their outlines as a path that begins at 0, 0; its width in px."""

    path: str
    width: float


def outlined(root: Element) -> int:
    """Put outlines in the place of an SVG's words; how many lines stayed text comes back.

    Raises
    ------
    MissingExtraError
        Where HarfBuzz or the font is not installed.
    """
    return _outline_children(root, "ltr")


def _outline_children(element: Element, direction: str) -> int:
    direction = element.get("direction", direction)
    left = 0
    for place, child in enumerate(element):
        if child.tag != "text":
            left += _outline_children(child, direction)
            continue
        drawn = _outlines(child, direction)
        if drawn is None:
            left += 1
        else:
            element[place] = drawn
    return left


def _outlines(text: Element, direction: str) -> Element | None:
    """The outlines of a text, or of its lines, as a group; None where they cannot be made."""
    if text.get("direction", direction) == "rtl":
        return None
    size, weight = float(text.get("font-size", 16)), int(text.get("font-weight", 400))
    share = BEFORE[text.get("text-anchor", "start")]
    group = Element("g", {n: value for n, value in text.attrib.items() if n not in OF_LETTERS})
    y = float(text.get("y", 0)) + (
        _middle(weight) * size if "dominant-baseline" in text.attrib else 0
    )
    for part in [*text] or [text]:
        line = _line(part.text or "", size, weight)
        if line is None:
            return None
        if part is not text:
            y += float(part.get("y", 0)) + size * float(part.get("dy", "0em").removesuffix("em"))
        x = float(part.get("x", 0)) - share * line.width
        place = f"translate({px(round(x, 2))} {px(round(y, 2))})"
        if line.path:
            group.append(Element("path", {"d": line.path, "transform": place}))
    return group


@lru_cache(maxsize=4096)
def _line(text: str, size: float, weight: int) -> Line | None:
    """A line in letters; None where the font lacks one of them."""
    hb = needed("uharfbuzz", "a picture's letters")
    font = _font(weight)
    if not all(font.get_nominal_glyph(ord(letter)) for letter in text):
        return None
    buffer = hb.Buffer()
    buffer.add_str(text)
    buffer.guess_segment_properties()
    hb.shape(font, buffer)
    unit = size / font.face.upem
    pen = _Pen(unit)
    for info, step in zip(buffer.glyph_infos, buffer.glyph_positions, strict=True):
        pen.at(step.x_offset, step.y_offset)
        font.draw_glyph_with_pen(info.codepoint, pen)
        pen.x += step.x_advance
    return Line("".join(pen.parts), pen.x * unit)


class _Pen:
    """Writes outlines as path data, in px; letters stand at ``x``, in units of the font."""

    def __init__(self, unit: float) -> None:
        self.unit = unit
        self.x = 0.0
        self.parts: list[str] = []
        self._shift = (0.0, 0.0)

    def at(self, right: float, up: float) -> None:
        self._shift = (self.x + right, up)

    def moveTo(self, point: tuple[float, float]) -> None:  # noqa: N802  # a pen's names
        self._write("M", point)

    def lineTo(self, point: tuple[float, float]) -> None:  # noqa: N802
        self._write("L", point)

    def qCurveTo(self, *points: tuple[float, float]) -> None:  # noqa: N802
        self._write("Q", *points)

    def curveTo(self, *points: tuple[float, float]) -> None:  # noqa: N802
        self._write("C", *points)

    def closePath(self) -> None:  # noqa: N802
        self.parts.append("Z")

    def endPath(self) -> None:  # noqa: N802
        """Outlines of letters are closed."""

    def _write(self, command: str, *points: tuple[float, float]) -> None:
        right, up = self._shift
        places = ((self.unit * (x + right), -self.unit * (y + up)) for x, y in points)
        self.parts.append(command + " ".join(f"{x:.2f} {y:.2f}" for x, y in places))


@cache
def _font(weight: int) -> Any:
    hb = needed("uharfbuzz", "a picture's letters")
    package = needed("fontpkg_noto_sans", "a picture's letters")
    face = hb.Face((files(package) / "files" / FONT).read_bytes())
    font = hb.Font(face)
    font.set_variations({"wght": float(weight)})
    return font


@cache
def _middle(weight: int) -> float:
    """How far below the middle of a line, in sizes, its letters stand: half the height of an x."""
    font = _font(weight)
    return float(
        font.get_glyph_extents(font.get_nominal_glyph(ord("x"))).y_bearing / font.face.upem / 2
    )
