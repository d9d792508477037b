"""A map as SVG elements: still at a step, or animated by SMIL over the whole timeline.

Animated values follow one scheme. A path that moves has an ``animate`` of its ``d`` that begins
with its transition and lasts as long as the whole map; the transition takes the first part of it,
and what follows is not seen. Visibility is animated from 0. So a loop needs no event, and no
value is written twice.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from xml.etree.ElementTree import Element

import svgwrite
import svgwrite.path
from svgwrite.base import BaseElement

from geotween.export.easing import Spline, segments
from geotween.export.keyframes import SEAM_FADE, Keyframes, Shape, Slot
from geotween.export.paint import Paint
from geotween.export.paths import closed_path, path_texts
from geotween.export.timeline import Span

HEADER, FOOTER = 64, 28  # px above and below the map for its words, where there are any
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


def still_svg(frames: Keyframes, title: str, step: int = 0, *, margins: bool = False) -> str:
    """The map at rest at one step, without words; with the animated one's margins if asked."""
    drawing = _drawing(frames, HEADER * margins, FOOTER * margins, "", "")
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


def animated_svg(
    frames: Keyframes, title: str, description: str, subtitle: str = "", source: str = ""
) -> str:
    """The whole map, playing by SMIL alone."""
    drawing = _drawing(frames, HEADER, FOOTER, title, description or subtitle)
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
    for slot, elements in _animated(drawing, frames, slots):
        for element in elements:
            groups[slot].add(element)
    drawing.add(stage)
    _words(drawing, frames, title, subtitle, source)
    return str(drawing.tostring())


def _drawing(
    frames: Keyframes, header: int, footer: int, title: str, description: str
) -> svgwrite.Drawing:
    """An empty drawing with background and static layers; the map's corner is at 0, 0."""
    width, height = frames.page.width, frames.page.height
    whole = height + header + footer
    drawing = svgwrite.Drawing(size=(_px(width), _px(whole)), debug=False)
    drawing.attribs["viewBox"] = f"0 {-header} {_px(width)} {_px(whole)}"
    drawing.elements.clear()  # svgwrite's empty defs
    if title:
        drawing.set_desc(title=title, desc=description or None)
    if frames.background != "none":
        drawing.add(
            drawing.rect(
                (0, -header), (_px(width), _px(whole)), fill=frames.background, class_="background"
            )
        )
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
    made: dict[object, BaseElement] = {}
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
        path = _path(self.slot, one, texts[0][1] if shape.still else "")
        self.shown[path] = [times]
        if not shape.still:
            path.add(self._animate(span, "d", texts, self.frames.easing))
        if same:
            self.still[texts[0][1], one] = path
        for name, start in _paint_attributes(one).items():
            end = _paint_attributes(other).get(name, "")
            if start != end:
                easing = self.frames.easing
                path.add(self._animate(span, name, [(0.0, start), (1.0, end)], easing))
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
        self, span: Span, name: str, values: list[tuple[float, str]], easing: Spline | None
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
        attributes = {
            "attributeName": name,
            "begin": _seconds(span.start),
            "dur": _seconds(self.total),
            "keyTimes": ";".join(_share(t) for t in times),
            "values": ";".join(texts),
        }
        if any(splines):
            attributes["calcMode"] = "spline"
            attributes["keySplines"] = ";".join(
                " ".join(_px(v) for v in spline or (0, 0, 1, 1)) for spline in splines
            )
        return _with(self.drawing.animate(), {**attributes, **_repeat(self.frames)})


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
    element.attribs["visibility"] = "hidden"
    attributes = {
        "attributeName": "visibility",
        "calcMode": "discrete",
        "dur": _seconds(frames.duration),
        "keyTimes": ";".join(_share(t / frames.duration) for t in changes),
        "values": ";".join(changes.values()),
    }
    element.add(_with(drawing.animate(), {**attributes, **_repeat(frames)}))


def _words(
    drawing: svgwrite.Drawing, frames: Keyframes, title: str, subtitle: str, source: str
) -> None:
    """Title, step label and source, in the margins above and below the map."""
    ink = _ink(frames.background)
    words = drawing.g(class_="words", fill=ink)
    words.attribs["font-family"] = _FONT
    left, room = 16, frames.page.width - 32
    words.add(_text(drawing, title, left, -HEADER + 26, _fitting(18, title, room), weight="700"))
    halves = [0]
    for span, _ in frames.spans:
        if not span.rest:
            halves.append((span.start + span.end) // 2)
    halves.append(frames.duration)
    for label, start, end in zip(frames.labels, halves[:-1], halves[1:], strict=True):
        text = _text(drawing, label, left, -12, _fitting(16, label, room))
        text.attribs["class"] = "step"
        final = end == frames.duration and not frames.loop
        _show(drawing, text, [(start, end + 1 if final else end)], frames)
        words.add(text)
    if source:
        y = frames.page.height + FOOTER - 10
        words.add(_text(drawing, source, left, y, _fitting(11, source, room)))
    drawing.add(words)


def _text(
    drawing: svgwrite.Drawing, words: str, x: float, y: float, size: float, weight: str = ""
) -> BaseElement:
    text = drawing.text(words, insert=(_px(x), _px(y)))
    text.attribs["font-size"] = _px(size)
    if weight:
        text.attribs["font-weight"] = weight
    return text


def _fitting(size: float, words: str, room: float) -> float:
    """A font size at which a line most likely fits: letters are about 0.6 of it wide."""
    return round(min(size, room / (0.6 * max(len(words), 1))), 1)


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
