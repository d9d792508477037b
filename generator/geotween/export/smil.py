"""Animation by SMIL: what moves, turns and is shown, over a timeline that may repeat.

Animated values follow one scheme. A path that moves has an ``animate`` of its ``d`` that begins
with its transition and lasts as long as the whole map; the transition takes the first part of it,
and what follows is not seen. Visibility is animated from 0. So a loop needs no event, and no
animation writes a value twice.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from svgwrite.animate import Animate, AnimateTransform
from svgwrite.base import BaseElement

from geotween.export.easing import Spline, segments, share_at
from geotween.export.elements import paint_attributes, path_element, px
from geotween.export.keyframes import Keyframes
from geotween.export.paint import Paint
from geotween.export.paths import path_texts
from geotween.export.shapes import SEAM_FADE, Group, Shape, Slot
from geotween.export.timeline import Span


class PathMaker:
    """Makes the paths of one slot over all spans, and joins those that are the same."""

    def __init__(self, frames: Keyframes, slot: Slot) -> None:
        self.frames, self.slot = frames, slot
        self.total = frames.duration
        self.still: dict[tuple[str, Paint], BaseElement] = {}
        self.shown: dict[BaseElement, list[tuple[float, float]]] = {}

    def add(self, span: Span, shape: Shape) -> None:
        """Draw a shape of this slot in a span, unless it is seen at no time.

        Where tracks come and go, each part of the time has a path of its own.
        """
        for life, tracks in shape.parts():
            times = _visible(span, shape, life, self.frames)
            if times is not None:
                self._draw(span, replace(shape, tracks=tracks), life, times)

    def _draw(
        self, span: Span, shape: Shape, life: tuple[float, float], times: tuple[float, float]
    ) -> None:
        texts = path_texts(shape, life)
        one, other = shape.paints
        still = len(texts) == 1
        same = still and one == other and not self.slot.code
        if same and (texts[0][1], one) in self.still:
            self.shown[self.still[texts[0][1], one]].append(times)
            return
        path = path_element(self.slot, _solid(one, other), texts[0][1] if still else "")
        self.shown[path] = [times]
        if not still:
            if life[0] > 0:
                texts = [(0.0, texts[0][1]), *texts]
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
            show(path, times, self.frames)
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
        element = _timed(name, times, texts, self.frames, span.start)
        if discrete:
            element.attribs["calcMode"] = "discrete"
        elif any(splines):
            _bend(element, splines)
        return element


def animated(frames: Keyframes, slots: list[Slot]) -> Iterable[tuple[Slot, list[BaseElement]]]:
    """The paths of each slot over the whole timeline."""
    makers = {slot: PathMaker(frames, slot) for slot in slots}
    for span, shapes in frames.spans:
        for shape in shapes:
            makers[shape.slot].add(span, shape)
    for slot in slots:
        yield slot, makers[slot].finished()


def _visible(
    span: Span, shape: Shape, life: tuple[float, float], frames: Keyframes
) -> tuple[float, float] | None:
    """When a shape is seen for a part of its span, in ms; at no time for None.

    A last rest that does not loop lasts for ever. Where one part gives way to the next both say
    the same moment.
    """
    last = span is frames.spans[-1][0] and not frames.loop
    if not span.length and not last:
        return None
    first, end = shape.show or (0.0, 1.0)
    first, end = (
        max(first, share_at(frames.easing, life[0])),
        min(end, share_at(frames.easing, life[1])),
    )
    start, stop = (round(span.start + part * span.length, 3) for part in (first, end))
    if last:
        return start, max(stop, frames.duration + 1)
    return (start, stop) if start < stop else None


def show(element: BaseElement, times: Sequence[tuple[float, float]], frames: Keyframes) -> None:
    """Make an element visible between some times and hidden otherwise."""
    changes: dict[float, str] = {}
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
    animation = _timed("visibility", moments, list(changes.values()), frames)
    animation.attribs["calcMode"] = "discrete"
    element.add(animation)


def follow(
    element: BaseElement,
    ways: Mapping[int, Sequence[tuple[float, float, float]]],
    frames: Keyframes,
) -> None:
    """Move an element along ways, (t, x, y) in px for spans by number; it is hidden in others."""
    times, values, splines = [0.0], [""], list[Spline | None]()
    for number, way in sorted(ways.items()):
        span = frames.spans[number][0]
        parts = segments(frames.easing, [t for t, *_ in way])
        shares = [0.0, *(end for _, end, _ in parts)]
        times += [(span.start + share * span.length) / frames.duration for share in shares]
        values += [f"{px(round(x, 1))} {px(round(y, 1))}" for _, x, y in way]
        splines += [None, *(spline for *_, spline in parts)]
    values[0] = values[1]
    show(element, [(frames.spans[n][0].start, frames.spans[n][0].end) for n in ways], frames)
    element.attribs["transform"] = f"translate({values[0]})"
    if len(set(values)) == 1:
        return
    animation = AnimateTransform("translate", debug=False)
    plain = _timed("transform", [*times, 1.0], [*values, values[-1]], frames)
    animation.attribs.update(plain.attribs)
    if any(splines):
        _bend(animation, [*splines, None])
    element.add(animation)


def fade(frames: Keyframes, group: Group) -> BaseElement | None:
    """The opacity of a group over the whole timeline, if it changes."""
    start, end = (px(value) for value in group.opacity)
    if start == end:
        return None
    spans = [span for span, shapes in frames.spans if any(s.slot.group == group for s in shapes)]
    times, values, splines = [0.0], [start], list[Spline | None]()
    for span in spans:
        times += [span.start / frames.duration, span.end / frames.duration]
        values += [start, end]
        splines += [None, frames.easing]
    element = _timed("opacity", [*times, 1.0], [*values, end], frames)
    if any(splines):
        _bend(element, [*splines, None])
    return element


def _solid(one: Paint, other: Paint) -> Paint:
    """The first of two paints, with the other's colour and stroke where it has none itself."""
    fill = other.fill if one.fill == "none" else one.fill
    stroke = one if one.stroked else other
    return Paint(fill, stroke.stroke, stroke.width, stroke.dash)


def _changes(one: Paint, other: Paint) -> list[tuple[str, str, str]]:
    """What goes from one paint to the other step by step: attribute, start, end."""
    start, end = (paint_attributes(p) for p in (_solid(one, other), _solid(other, one)))
    return [(name, value, end[name]) for name, value in start.items() if value != end[name]]


def _switches(one: Paint, other: Paint) -> list[tuple[str, str, str]]:
    """What switches half-way, as SMIL knows no way between a colour and none."""
    found: list[tuple[str, str, str]] = []
    if "none" in (one.fill, other.fill) and one.fill != other.fill:
        start, end = ("0" if paint.fill == "none" else "1" for paint in (one, other))
        found.append(("fill-opacity", start, end))
    if one.stroked != other.stroked:
        start, end = (px(paint.width) if paint.stroked else "0" for paint in (one, other))
        found.append(("stroke-width", start, end))
    return found


def _timed(
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
    element = Animate(debug=False)
    element.attribs.update({**attributes, **_repeat(frames)})
    return element


def _bend(element: BaseElement, splines: list[Spline | None]) -> None:
    """Ease an animation between each two of its key times."""
    element.attribs["calcMode"] = "spline"
    element.attribs["keySplines"] = ";".join(
        " ".join(px(v) for v in spline or (0, 0, 1, 1)) for spline in splines
    )


def _repeat(frames: Keyframes) -> dict[str, str]:
    return {"repeatCount": "indefinite"} if frames.loop else {"fill": "freeze"}


def _seconds(milliseconds: int) -> str:
    return f"{px(milliseconds / 1000)}s"


def _share(value: float) -> str:
    return f"{value:.7f}".rstrip("0").rstrip(".")
