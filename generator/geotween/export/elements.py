"""SVG elements that still and moving maps are made of."""

from __future__ import annotations

from xml.etree.ElementTree import Element

import svgwrite.path
from svgwrite.base import BaseElement

from geotween.export.paint import Paint
from geotween.export.shapes import Slot


class SvgPath(svgwrite.path.Path):  # type: ignore[misc]  # svgwrite is untyped
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


def path_element(slot: Slot, paint: Paint, text: str) -> BaseElement:
    """The path of a slot; regions say which layer and key they are."""
    path = SvgPath(slot.kind, text, slot.key if slot.kind == "region" else None)
    if slot.kind == "region":
        path.attribs["data-layer"] = slot.group.layer
    path.attribs.update(paint_attributes(paint))
    return path


def paint_attributes(paint: Paint) -> dict[str, str]:
    """A paint as attributes; those of a stroke only where there is one."""
    attributes = {"fill": paint.fill}
    if paint.stroked:
        attributes |= {"stroke": paint.stroke, "stroke-width": px(paint.width)}
        attributes["stroke-linejoin"] = "round"
        if paint.dash:
            attributes["stroke-dasharray"] = paint.dash
    return attributes


def px(value: float) -> str:
    """A number as short as it can be said, to a millionth."""
    return f"{value:.6f}".rstrip("0").rstrip(".")
