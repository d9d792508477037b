"""A map as SVG elements: still at a step, or animated by SMIL over the whole timeline.

Animated values follow one scheme. A path that moves has an ``animate`` of its ``d`` that begins
with its transition and lasts as long as the whole map; the transition takes the first part of it,
and what follows is not seen. Visibility is animated from 0. So a loop needs no event, and no
value is written twice.
"""

from __future__ import annotations

import json
import textwrap
from collections.abc import Iterable
from dataclasses import dataclass
from xml.etree.ElementTree import Element

import svgwrite
import svgwrite.path
from svgwrite.base import BaseElement

from geotween.export.easing import Spline, segments
from geotween.export.keyframes import SEAM_FADE, Group, Keyframes, Shape, Slot
from geotween.export.paint import Paint
from geotween.export.paths import closed_path, path_texts
from geotween.export.timeline import Span

MARGIN = 16  # px beside the words
TITLE, LABEL, SOURCE = 18.0, 16.0, 11.0  # px, the sizes of the words above and below the map
LEADING = 1.4  # lines in sizes of their font
BOLD = 1.1  # the width of bold letters to that of others
LETTER = 0.56  # the width of a letter in sizes of its font; generous, as the font is the reader's
_FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, sans-serif"


class _Path(svgwrite.path.Path):  # type: ignore[misc]  # svgwrite is untyped
    """A path that keeps an empty key, which svgwrite would leave out."""

    def __init__(self, kind: str, text: str = "", key: str | None = None) -> None:
        super().__init__(d=text or None, debug=False)
        self.attribs["class"] = kind
        self.key = key

    def get_xml(self) -> Element:
        xml: Element = super().get_xml()
        if self.key is not None:
            xml.set("data-key", self.key)
        return xml


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


def still_svg(frames: Keyframes, title: str, step: int = 0, around: Words | None = None) -> str:
    """The map at rest at one step; without words, but with the room for them if asked."""
    drawing = _drawing(frames, around)
    drawing.attribs["class"] = "figure"
    drawing.attribs["role"] = "img"
    drawing.attribs["aria-label"] = title
    stage = drawing.g(class_="stage")
    shapes = next(s for span, s in frames.spans if span.rest and span.step == step)
    slots = [slot for slot in frames.slots() if any(s.slot == slot for s in shapes)]
    groups = _groups(drawing, stage, slots)
    for shape in sorted(shapes, key=lambda shape: slots.index(shape.slot)):
        groups[shape.slot].add(_path(shape.slot, shape.paints[0], path_texts(shape)[0][1]))
    drawing.add(stage)
    return str(drawing.tostring())


def animated_svg(frames: Keyframes, title: str, description: str, source: str = "") -> str:
    """The whole map, playing by SMIL alone."""
    around = words(frames, title, source)
    drawing = _drawing(frames, around)
    drawing.set_desc(title=title, desc=description or None)
    drawing.attribs["data-steps"] = json.dumps(
        [
            {"label": label, "start": rest.start / 1000, "end": rest.end / 1000}
            for label, rest in zip(frames.labels, frames.rests, strict=True)
        ],
        ensure_ascii=False,
    )
    slots = frames.slots()
    stage = drawing.g(class_="stage")
    groups = _groups(drawing, stage, slots)
    for group, element in {slot.group: groups[slot] for slot in slots}.items():
        fade = _fade(drawing, frames, group)
        if fade is not None:
            element.add(fade)
    for slot, elements in _animated(drawing, frames, slots):
        for element in elements:
            groups[slot].add(element)
    drawing.add(stage)
    _write(drawing, frames, around)
    return str(drawing.tostring())


def _drawing(frames: Keyframes, around: Words | None) -> svgwrite.Drawing:
    """An empty drawing with background and static layers; the map's corner is at 0, 0."""
    header, footer = (around.header, around.footer) if around else (0, 0)
    width, whole = frames.page.width, frames.page.height + header + footer
    drawing = svgwrite.Drawing(size=(_px(width), _px(whole)), debug=False)
    drawing.attribs["viewBox"] = f"0 {_px(-header)} {_px(width)} {_px(whole)}"
    drawing.elements.clear()  # svgwrite's empty defs
    if frames.background != "none":
        size = (_px(width), _px(whole))
        ground = drawing.rect((0, _px(-header)), size, fill=frames.background, class_="background")
        drawing.add(ground)
    for layer in frames.scenery:
        group = drawing.g(class_="layer static")
        group.attribs["data-layer"] = layer.name
        group.attribs.update(_paint_attributes(layer.paint))
        if layer.opacity < 1:
            group.attribs["opacity"] = _px(layer.opacity)
        group.add(_Path("scenery", closed_path(layer.tracks)))
        drawing.add(group)
    return drawing


def _groups(
    drawing: svgwrite.Drawing, stage: BaseElement, slots: Iterable[Slot]
) -> dict[Slot, BaseElement]:
    """A group element for each group of slots, in order; opacity sits on it."""
    made: dict[Group, BaseElement] = {}
    found = {}
    for slot in slots:
        if slot.group not in made:
            group = drawing.g(class_="layer")
            group.attribs["data-layer"] = slot.group.layer
            if slot.group.opacity != (1.0, 1.0):
                group.attribs["opacity"] = _px(slot.group.opacity[0])
            made[slot.group] = stage.add(group)
        found[slot] = made[slot.group]
    return found


def _fade(drawing: svgwrite.Drawing, frames: Keyframes, group: Group) -> BaseElement | None:
    """The opacity of a group over the whole timeline, if it changes."""
    start, end = (_px(value) for value in group.opacity)
    spans = [span for span, shapes in frames.spans if any(s.slot.group == group for s in shapes)]
    if start == end:
        return None
    times, values, splines = [0.0], [start], list[Spline | None]()
    for span in spans:
        times += [span.start / frames.duration, span.end / frames.duration]
        values += [start, end]
        splines += [None, frames.easing]
    element = _timed(drawing, "opacity", [*times, 1.0], [*values, end], frames)
    if any(splines):
        _bend(element, [*splines, None])
    return element


class _Elements:
    """Makes the paths of one slot over all spans, and joins those that are the same."""

    def __init__(self, drawing: svgwrite.Drawing, frames: Keyframes, slot: Slot) -> None:
        self.drawing, self.frames, self.slot = drawing, frames, slot
        self.total = frames.duration
        self.still: dict[tuple[str, Paint], BaseElement] = {}
        self.shown: dict[BaseElement, list[tuple[int, int]]] = {}

    def add(self, span: Span, shape: Shape) -> None:
        texts = path_texts(shape)
        times = _visible(span, shape, self.frames)
        if times is None:
            return
        one, other = shape.paints
        same = shape.still and one == other and not self.slot.code
        if same and (texts[0][1], one) in self.still:
            self.shown[self.still[texts[0][1], one]].append(times)
            return
        path = _path(self.slot, _solid(one, other), texts[0][1] if shape.still else "")
        self.shown[path] = [times]
        if not shape.still:
            path.add(self._animate(span, "d", texts, self.frames.easing))
        if same:
            self.still[texts[0][1], one] = path
        for name, start, end in _changes(one, other):
            path.add(self._animate(span, name, [(0.0, start), (1.0, end)], self.frames.easing))
        for name, start, end in _switches(one, other):
            path.attribs[name] = start
            half = segments(self.frames.easing, [0.0, 0.5, 1.0])[0][1]
            switch = [(0.0, start), (half, end), (1.0, end)]
            path.add(self._animate(span, name, switch, None, discrete=True))
        if self.slot.code:
            fade = [(0.0, "0"), (SEAM_FADE, "1")] if self.slot.code & 1 else [(0.0, "1")]
            fade += [(1 - SEAM_FADE, "1"), (1.0, "0")] if self.slot.code & 2 else [(1.0, "1")]
            path.add(self._animate(span, "stroke-opacity", fade, None))

    def finished(self) -> list[BaseElement]:
        """The paths, each visible in its spans only."""
        for path, times in self.shown.items():
            _show(self.drawing, path, times, self.frames)
        return list(self.shown)

    def _animate(
        self,
        span: Span,
        name: str,
        values: list[tuple[float, str]],
        easing: Spline | None,
        *,
        discrete: bool = False,
    ) -> BaseElement:
        """An animation that begins with the span, lasts as long as the map, and repeats."""
        share = span.length / self.total
        parts = segments(easing, [t for t, _ in values])
        times = [0.0, *(share * end for _, end, _ in parts)]
        texts = [text for _, text in values]
        splines = [spline for *_, spline in parts]
        if times[-1] < 1:  # unseen from here on, and SMIL wants a value for the end
            times.append(1.0)
            texts.append("M0 0" if name == "d" else texts[-1])
            splines.append(None)
        element = _timed(self.drawing, name, times, texts, self.frames, span.start)
        if discrete:
            element.attribs["calcMode"] = "discrete"
        elif any(splines):
            _bend(element, splines)
        return element


def _animated(
    drawing: svgwrite.Drawing, frames: Keyframes, slots: list[Slot]
) -> Iterable[tuple[Slot, list[BaseElement]]]:
    makers = {slot: _Elements(drawing, frames, slot) for slot in slots}
    for span, shapes in frames.spans:
        for shape in shapes:
            makers[shape.slot].add(span, shape)
    for slot in slots:
        yield slot, makers[slot].finished()


def _visible(span: Span, shape: Shape, frames: Keyframes) -> tuple[int, int] | None:
    """When a shape is seen, in ms; a last rest that does not loop lasts for ever."""
    last = span is frames.spans[-1][0] and not frames.loop
    if not span.length and not last:
        return None
    first, end = shape.show or (0.0, 1.0)
    stop = span.start + round(end * span.length)
    return span.start + round(first * span.length), max(stop, frames.duration + 1) if last else stop


def _show(
    drawing: svgwrite.Drawing, element: BaseElement, times: list[tuple[int, int]], frames: Keyframes
) -> None:
    """Make an element visible between some times and hidden otherwise."""
    changes: dict[int, str] = {}
    for start, end in sorted(times):
        if changes.get(start) == "hidden":
            del changes[start]
        else:
            changes[start] = "visible"
        if end < frames.duration or (end == frames.duration and not frames.loop):
            changes[end] = "hidden"
    if changes == {0: "visible"}:
        return
    if 0 not in changes:
        changes = {0: "hidden", **changes}
    if changes[0] == "hidden":
        element.attribs["visibility"] = "hidden"
    moments = [t / frames.duration for t in changes]
    animation = _timed(drawing, "visibility", moments, list(changes.values()), frames)
    animation.attribs["calcMode"] = "discrete"
    element.add(animation)


def _write(drawing: svgwrite.Drawing, frames: Keyframes, around: Words) -> None:
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
        _show(drawing, text, [times], frames)
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
    text = drawing.text(line, insert=(_px(MARGIN), _px(round(y, 1))))
    text.attribs["font-size"] = _px(round(size, 1))
    if weight:
        text.attribs["font-weight"] = weight
    return text


def _ink(background: str) -> str:
    """Dark words on a light background, light ones on a dark one."""
    if background == "none":
        return "#222222"
    red, green, blue = (int(background[i : i + 2], 16) for i in (1, 3, 5))
    return "#222222" if 0.299 * red + 0.587 * green + 0.114 * blue > 140 else "#f2f2f2"


def _path(slot: Slot, paint: Paint, text: str) -> BaseElement:
    path = _Path(slot.kind, text, slot.key if slot.kind == "region" else None)
    if slot.kind == "region":
        path.attribs["data-layer"] = slot.group.layer
    path.attribs.update(_paint_attributes(paint))
    return path


def _paint_attributes(paint: Paint) -> dict[str, str]:
    attributes = {"fill": paint.fill}
    if paint.stroked:
        attributes |= {"stroke": paint.stroke, "stroke-width": _px(paint.width)}
        attributes["stroke-linejoin"] = "round"
        if paint.dash:
            attributes["stroke-dasharray"] = paint.dash
    return attributes


def _solid(one: Paint, other: Paint) -> Paint:
    """The first of two paints, with the other's colour and stroke where it has none itself."""
    fill = other.fill if one.fill == "none" else one.fill
    stroke = one if one.stroked else other
    return Paint(fill, stroke.stroke, stroke.width, stroke.dash)


def _changes(one: Paint, other: Paint) -> list[tuple[str, str, str]]:
    """What goes from one paint to the other step by step: attribute, start, end."""
    start, end = (_paint_attributes(p) for p in (_solid(one, other), _solid(other, one)))
    return [(name, value, end[name]) for name, value in start.items() if value != end[name]]


def _switches(one: Paint, other: Paint) -> list[tuple[str, str, str]]:
    """What switches half-way, as SMIL knows no way between a colour and none."""
    found: list[tuple[str, str, str]] = []
    if "none" in (one.fill, other.fill) and one.fill != other.fill:
        start, end = ("0" if paint.fill == "none" else "1" for paint in (one, other))
        found.append(("fill-opacity", start, end))
    if one.stroked != other.stroked:
        start, end = (_px(paint.width) if paint.stroked else "0" for paint in (one, other))
        found.append(("stroke-width", start, end))
    return found


def _timed(
    drawing: svgwrite.Drawing,
    name: str,
    times: list[float],
    values: list[str],
    frames: Keyframes,
    begin: int = 0,
) -> BaseElement:
    """An animation as long as the map, that repeats as the map does."""
    attributes = {
        "attributeName": name,
        "dur": _seconds(frames.duration),
        "keyTimes": ";".join(_share(t) for t in times),
        "values": ";".join(values),
    }
    if begin:
        attributes["begin"] = _seconds(begin)
    return _with(drawing.animate(), {**attributes, **_repeat(frames)})


def _bend(element: BaseElement, splines: list[Spline | None]) -> None:
    """Ease an animation between each two of its key times."""
    element.attribs["calcMode"] = "spline"
    element.attribs["keySplines"] = ";".join(
        " ".join(_px(v) for v in spline or (0, 0, 1, 1)) for spline in splines
    )


def _with(element: BaseElement, attributes: dict[str, str]) -> BaseElement:
    element.attribs.update(attributes)
    return element


def _repeat(frames: Keyframes) -> dict[str, str]:
    return {"repeatCount": "indefinite"} if frames.loop else {"fill": "freeze"}


def _seconds(milliseconds: int) -> str:
    return f"{_px(milliseconds / 1000)}s"


def _share(value: float) -> str:
    return f"{value:.7f}".rstrip("0").rstrip(".")


def _px(value: float) -> str:
    return f"{value:.6f}".rstrip("0").rstrip(".")
