"""Which colours a region is drawn in: the scene's style, by key before class before all."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from geotween.data.polygons import Identity
from geotween.scene.model import Style, StyleRule

# Okabe and Ito, "Color Universal Design" (2008): told apart with any kind of colour vision. Their
# black is left for text and lines.
PALETTE = ("#0072b2", "#d55e00", "#009e73", "#e69f00", "#56b4e9", "#cc79a7", "#f0e442")
STROKE, WIDTH, OPACITY = "#ffffff", 0.75, 1.0
# From little to much: classes that lie on each other are degrees of one thing.
RAMP = ("#b3d7ec", "#0072b2", "#00304f")


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
    """The paint and opacity of each identity.

    Classes without a colour take the palette's in turn, or where they are ``layers`` of their own
    (the lowest first) the shades of a ramp.
    """

    def __init__(
        self, style: Style, identities: Iterable[Identity], layers: Sequence[str] = ()
    ) -> None:
        self.style = style
        classes = dict.fromkeys(i.class_ for i in identities if i.class_ is not None)
        self._palette = {c: PALETTE[n % len(PALETTE)] for n, c in enumerate(classes)}
        ordered = [layer for layer in layers if layer in classes]
        if len(ordered) > 1:
            self._palette = dict(zip(ordered, _shades(len(ordered)), strict=True))

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


def _shades(count: int) -> list[str]:
    """Colours along the ramp, from one end to the other in equal steps."""
    stops = np.array([[int(colour[i : i + 2], 16) for i in (1, 3, 5)] for colour in RAMP])
    places = np.linspace(0, len(RAMP) - 1, count)
    mixed = [np.interp(places, range(len(RAMP)), channel) for channel in stops.T]
    return ["#" + "".join(f"{round(part):02x}" for part in shade) for shade in np.transpose(mixed)]
