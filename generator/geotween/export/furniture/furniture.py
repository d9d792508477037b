"""All furniture of a map, put together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from geotween.data.load import Scene
from geotween.export.bundle import Member
from geotween.export.furniture.annotations import Callout, callout
from geotween.export.furniture.graticule import Line, graticule
from geotween.export.furniture.labels import Label, labels
from geotween.export.furniture.legend import Entry, legend
from geotween.export.furniture.room import Box
from geotween.export.furniture.scale_bar import ScaleBar, scale_bar
from geotween.export.furniture.tips import Tip, tips
from geotween.export.page_grid import Page
from geotween.export.paint import Painter
from geotween.export.timeline import Span


@dataclass(frozen=True, eq=False)
class Furniture:
    """What helps to read a map; places in px of the page."""

    legend: tuple[Entry, ...] = ()
    scale_bar: ScaleBar | None = None
    graticule: tuple[Line, ...] = ()
    callouts: tuple[Callout, ...] = ()
    labels: tuple[Label, ...] = ()
    tips: tuple[dict[str, Tip], ...] = ()


NO_FURNITURE = Furniture()


def furniture(
    scene: Scene,
    page: Page,
    painter: Painter,
    spans: Sequence[Span],
    members: Sequence[Sequence[Member]],
) -> Furniture:
    """The furniture of a map whose spans have these tracks."""
    callouts = tuple(callout(note, page) for note in scene.notes)
    rests = [m for span, of in zip(spans, members, strict=True) if span.rest for m in of]
    bar = scale_bar(scene, page, [member.track for member in rests])
    bars = [] if bar is None else [bar.box]

    def taken(number: int) -> list[Box]:
        span = spans[number]
        steps = {span.step} if span.rest else {span.step, span.step + 1}
        return [one.box for one in callouts if steps & set(one.steps)] + bars

    found = labels(scene.model, spans, members, scene.layer_order, taken)
    entries = legend(scene, painter, labelled=bool(found))
    called = {entry.class_: entry.label for entry in entries if entry.class_ is not None}
    return Furniture(
        entries, bar, graticule(scene, page), callouts, found, tuple(tips(scene, called))
    )
