"""A map as SVG: still at a step, or animated over the whole timeline."""

from __future__ import annotations

import json
from collections.abc import Iterable

import svgwrite
from svgwrite.base import BaseElement

from geotween.export.elements import SvgPath, paint_attributes, path_element, px
from geotween.export.furniture.draw import (
    at_rest,
    draw_callout,
    draw_graticule,
    draw_labels,
    draw_scale_bar,
)
from geotween.export.furniture.labels import Label
from geotween.export.keyframes import Keyframes
from geotween.export.paths import closed_path, path_texts
from geotween.export.shapes import Group, Slot
from geotween.export.smil import animated, fade, follow, show
from geotween.export.words import Words, step_times, write_words


def still_svg(frames: Keyframes, title: str, step: int = 0, around: Words | None = None) -> str:
    """The map at rest at one step; without words, but with the room for them if asked.

    It has all furniture of the map; what other steps show is hidden.
    """
    drawing = _drawing(frames, around)
    drawing.attribs["class"] = "figure"
    drawing.attribs["role"] = "img"
    drawing.attribs["aria-label"] = title
    stage = drawing.g(class_="stage")
    shapes = next(s for span, s in frames.spans if span.rest and span.step == step)
    resting = {shape.slot: shape for shape in shapes}
    groups = group_elements(drawing, stage, [slot for slot in frames.slots() if slot in resting])
    for slot, group in groups.items():
        shape = resting[slot]
        group.add(path_element(slot, shape.paints[0], path_texts(shape)[0][1]))
    drawing.add(stage)
    draw_scenery(drawing, drawing, frames, above=True)
    furniture = frames.furniture
    if furniture.scale_bar is not None and around is None:
        drawing.add(draw_scale_bar(drawing, furniture.scale_bar))
    if furniture.labels:
        span = next(n for n, (s, _) in enumerate(frames.spans) if s.rest and s.step == step)
        drawing.add(draw_labels(drawing, furniture.labels, at_rest(span)))
    for callout in furniture.callouts:
        element = draw_callout(drawing, callout, frames.lang)
        if step not in callout.steps:
            element.attribs["visibility"] = "hidden"
        drawing.add(element)
    return str(drawing.tostring())


def animated_svg(frames: Keyframes, title: str, description: str, around: Words) -> str:
    """The whole map, playing by SMIL alone."""
    drawing = _drawing(frames, around)
    drawing.set_desc(title=title, desc=description or None)
    drawing.attribs["lang"] = frames.lang
    drawing.attribs["data-steps"] = json.dumps(
        [
            {"label": label, "start": rest.start / 1000, "end": rest.end / 1000}
            for label, rest in zip(frames.labels, frames.rests, strict=True)
        ],
        ensure_ascii=False,
    )
    slots = frames.slots()
    stage = drawing.g(class_="stage")
    groups = group_elements(drawing, stage, slots)
    for group, element in {slot.group: groups[slot] for slot in slots}.items():
        animation = fade(frames, group)
        if animation is not None:
            element.add(animation)
    for slot, elements in animated(frames, slots):
        for element in elements:
            groups[slot].add(element)
    drawing.add(stage)
    draw_scenery(drawing, drawing, frames, above=True)
    if frames.furniture.labels:

        def moved(text: BaseElement, label: Label) -> bool:
            follow(text, label.spans, frames)
            return True

        drawing.add(draw_labels(drawing, frames.furniture.labels, moved))
    seen = [times for _, times in step_times(frames)]
    for callout in frames.furniture.callouts:
        element = draw_callout(drawing, callout, frames.lang)
        show(element, [seen[step] for step in callout.steps], frames)
        drawing.add(element)
    drawing.add(write_words(drawing, frames, around))
    return str(drawing.tostring())


def _drawing(frames: Keyframes, around: Words | None) -> svgwrite.Drawing:
    """An empty drawing with background and static layers; the map's corner is at 0, 0."""
    header, footer = (around.header, around.footer) if around else (0, 0)
    width, whole = frames.page.width, frames.page.height + header + footer
    drawing = svgwrite.Drawing(size=(px(width), px(whole)), debug=False)
    drawing.attribs["viewBox"] = f"0 {px(-header)} {px(width)} {px(whole)}"
    drawing.elements.clear()  # svgwrite's empty defs
    if frames.background != "none":
        size = (px(width), px(whole))
        ground = drawing.rect((0, px(-header)), size, fill=frames.background, class_="background")
        drawing.add(ground)
    draw_scenery(drawing, drawing, frames, above=False)
    if frames.furniture.graticule:
        drawing.add(draw_graticule(frames.furniture.graticule))
    return drawing


def draw_scenery(
    drawing: svgwrite.Drawing, into: BaseElement, frames: Keyframes, *, above: bool
) -> None:
    """The static layers under the regions, or those above them."""
    for layer in frames.scenery:
        if layer.above != above:
            continue
        group = drawing.g(class_="layer static")
        group.attribs["data-layer"] = layer.name
        group.attribs.update(paint_attributes(layer.paint))
        if layer.opacity < 1:
            group.attribs["opacity"] = px(layer.opacity)
        group.add(SvgPath("scenery", closed_path(layer.tracks)))
        into.add(group)


def group_elements(
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
                group.attribs["opacity"] = px(slot.group.opacity[0])
            made[slot.group] = stage.add(group)
        found[slot] = made[slot.group]
    return found
