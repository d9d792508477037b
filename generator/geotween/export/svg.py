"""A map as SVG: still at a step, or animated over the whole timeline."""

from __future__ import annotations

import json
from collections.abc import Iterable

import svgwrite
from svgwrite.base import BaseElement

from geotween.export.elements import SvgPath, paint_attributes, path_element, px
from geotween.export.keyframes import Keyframes
from geotween.export.paths import closed_path, path_texts
from geotween.export.shapes import Group, Slot
from geotween.export.smil import animated, fade
from geotween.export.words import Words, write_words


def still_svg(frames: Keyframes, title: str, step: int = 0, around: Words | None = None) -> str:
    """The map at rest at one step; without words, but with the room for them if asked."""
    drawing = _drawing(frames, around)
    drawing.attribs["class"] = "figure"
    drawing.attribs["role"] = "img"
    drawing.attribs["aria-label"] = title
    stage = drawing.g(class_="stage")
    shapes = next(s for span, s in frames.spans if span.rest and span.step == step)
    resting = {shape.slot: shape for shape in shapes}
    groups = _groups(drawing, stage, [slot for slot in frames.slots() if slot in resting])
    for slot, group in groups.items():
        shape = resting[slot]
        group.add(path_element(slot, shape.paints[0], path_texts(shape)[0][1]))
    drawing.add(stage)
    return str(drawing.tostring())


def animated_svg(frames: Keyframes, title: str, description: str, around: Words) -> str:
    """The whole map, playing by SMIL alone."""
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
        animation = fade(frames, group)
        if animation is not None:
            element.add(animation)
    for slot, elements in animated(frames, slots):
        for element in elements:
            groups[slot].add(element)
    drawing.add(stage)
    write_words(drawing, frames, around)
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
    for layer in frames.scenery:
        group = drawing.g(class_="layer static")
        group.attribs["data-layer"] = layer.name
        group.attribs.update(paint_attributes(layer.paint))
        if layer.opacity < 1:
            group.attribs["opacity"] = px(layer.opacity)
        group.add(SvgPath("scenery", closed_path(layer.tracks)))
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
                group.attribs["opacity"] = px(slot.group.opacity[0])
            made[slot.group] = stage.add(group)
        found[slot] = made[slot.group]
    return found
