"""Which colours a region is drawn in: the scene's style, by key before class before all."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from geotween.data.polygons import Identity
from geotween.scene.model import Style, StyleRule

# Okabe and Ito, "Color Universal Design" (2008): told apart with any kind of colour vision. Their
# black is left for text and lines.
PALETTE = ("#0072b2", "#d55e00", "#009e73", "#e69f00", "#56b4e9", "#cc79a7", "#f0e442")
STROKE, WIDTH, OPACITY = "#ffffff", 0.75, 0.9


@dataclass(frozen=True)
class Paint:
    """How a path is drawn; ``fill`` and ``stroke`` are ``#rrggbb`` or ``none``."""

    fill: str
    stroke: str
    width: float
    dash: str = ""

    @property
    def stroked(self) -> bool:
        return self.stroke != "none" and self.width > 0

    def filled_only(self) -> Paint:
        return Paint(self.fill, "none", 0.0)

    def stroked_only(self) -> Paint:
        return Paint("none", self.stroke, self.width, self.dash)


GHOST = Paint("none", "#444444", 1.0, "4 3")


class Painter:
    """The paint and opacity of each identity; classes without a colour take the palette's."""

    def __init__(self, style: Style, identities: Iterable[Identity]) -> None:
        self.style = style
        classes = dict.fromkeys(i.class_ for i in identities if i.class_ is not None)
        self._palette = {c: PALETTE[n % len(PALETTE)] for n, c in enumerate(classes)}

    def paint(self, identity: Identity) -> Paint:
        rules = self._rules(identity)
        fill = next((rule.fill for rule in rules if rule.fill), None)
        return Paint(
            fill or self._palette.get(identity.class_ or "", PALETTE[0]),
            next((rule.stroke for rule in rules if rule.stroke), STROKE),
            next((rule.width for rule in rules if rule.width is not None), WIDTH),
        )

    def opacity(self, identity: Identity) -> float:
        rules = self._rules(identity)
        return next((rule.opacity for rule in rules if rule.opacity is not None), OPACITY)

    def _rules(self, identity: Identity) -> list[StyleRule]:
        """The rules that apply, the most particular first."""
        of_key = self.style.by_key.get(str(identity.key)) if identity.keyed else None
        of_class = self.style.by_class.get(identity.class_ or "")
        return [rule for rule in (of_key, of_class, self.style) if rule is not None]
