"""Keyframes: everything that is shown, when, and in which paint; what SVG and page are made of.

The timeline is a row of spans: a rest at each step, a transition between each two.
"""

from __future__ import annotations

import datetime
from collections.abc import Sequence
from dataclasses import dataclass

from geotween.data.load import Scene
from geotween.data.problems import Problem, Severity
from geotween.export.bundle import Member, shapes_of
from geotween.export.easing import EASINGS, Spline
from geotween.export.furniture.furniture import NO_FURNITURE, Furniture, furniture
from geotween.export.page_grid import GridTrack, Page, fit_page, on_grid, resting
from geotween.export.paint import GHOST, Paint, Painter
from geotween.export.plans import Plan
from geotween.export.shapes import DRAWN_IN_ORDER, Group, Shape, Slot
from geotween.export.timeline import Span, timeline
from geotween.motion.morph import Morph
from geotween.scene.values import Time


@dataclass(frozen=True, eq=False)
class Scenery:
    """A static layer under the regions, or above them."""

    name: str
    opacity: float
    paint: Paint
    tracks: tuple[GridTrack, ...]
    above: bool = False


@dataclass(frozen=True, eq=False)
class Keyframes:
    """A whole map: its page, its static layers, and the shapes of each span.

    ``times`` are those of the steps, as ISO texts where they are dates. ``layers`` are those that
    move, the lowest first; a ghost lies above them.
    """

    page: Page
    background: str
    scenery: tuple[Scenery, ...]
    layers: tuple[str, ...]
    easing: Spline | None
    loop: bool
    labels: tuple[str, ...]
    captions: tuple[str, ...]
    spans: tuple[tuple[Span, tuple[Shape, ...]], ...]
    problems: tuple[Problem, ...] = ()
    times: tuple[str | float | None, ...] = ()
    lang: str = "en"
    furniture: Furniture = NO_FURNITURE

    @property
    def duration(self) -> int:
        """Milliseconds of one pass."""
        return self.spans[-1][0].end

    @property
    def rests(self) -> list[Span]:
        return [span for span, _ in self.spans if span.rest]

    def slots(self) -> list[Slot]:
        """All slots in drawing order: by layer, then group and key by first appearance."""
        groups: dict[Group, None] = {}
        keys: dict[str, int] = {}
        slots: dict[Slot, None] = {}
        for _, shapes in self.spans:
            for shape in shapes:
                groups.setdefault(shape.slot.group)
                keys.setdefault(shape.slot.key, len(keys))
                slots.setdefault(shape.slot)
        places = {layer: place for place, layer in enumerate(self.layers)}
        lowest_first = sorted(groups, key=lambda group: places.get(group.layer, len(places)))
        order = {group: place for place, group in enumerate(lowest_first)}
        return sorted(
            slots,
            key=lambda s: (
                order[s.group],
                s.kind != "backing",
                keys[s.key],
                s.number,
                DRAWN_IN_ORDER.index(s.kind),
                s.code,
            ),
        )


def keyframes(scene: Scene, plans: Sequence[Plan | Morph]) -> Keyframes:
    """The keyframes of a scene whose transitions have been planned."""
    model = scene.model
    page = fit_page(model.map, [s.regions for s in scene.steps] + [s for _, s in scene.layers])
    everyone = (i for step in scene.steps for i in step.regions.identities)
    painter = Painter(model.style, everyone, scene.layer_order)
    rests = [resting(step.regions, page) for step in scene.steps]
    spans, moving = [], []
    for span in timeline(scene):
        if span.rest:
            identities = scene.steps[span.step].regions.identities
            members = [
                Member(i, (i, i), track)
                for i, track in zip(identities, rests[span.step], strict=True)
            ]
            shapes = shapes_of(members, painter)
        else:
            tracks = plans[span.step].tracks
            drawn = zip(tracks, on_grid(tracks, page), strict=True)
            members = [Member(t.identity, t.ends, track) for t, track in drawn]
            shapes = shapes_of(members, painter)
            if model.motion.ghost == "origin" and rests[span.step]:
                slot = Slot(Group("ghost", (1.0, 1.0)), "ghost", "")
                shapes.append(Shape(slot, tuple(rests[span.step]), (GHOST, GHOST)))
        spans.append((span, tuple(shapes)))
        moving.append(members)
    scenery = tuple(
        Scenery(
            layer.name,
            layer.opacity,
            Paint(layer.fill, layer.stroke, layer.width),
            tuple(resting(polygons, page)),
            layer.above,
        )
        for layer, polygons in scene.layers
    )
    return Keyframes(
        page,
        model.map.background,
        scenery,
        scene.layer_order,
        EASINGS[model.motion.easing],
        model.timing.loop,
        tuple(step.label for step in scene.steps),
        tuple(step.caption for step in scene.steps),
        tuple(spans),
        tuple(p for s, r in zip(scene.steps, rests, strict=True) for p in _too_small(s.label, r)),
        tuple(_plain(step.time) for step in scene.steps),
        model.lang,
        furniture(scene, page, painter, [span for span, _ in spans], moving),
    )


def _plain(time: Time | None) -> str | float | None:
    """A time as a page is told it: a date as ISO text, a number as it is."""
    if isinstance(time, datetime.datetime) and time.tzinfo is None:
        return f"{time.isoformat()}Z"  # no reader's summer time shifts the axis
    return time.isoformat() if isinstance(time, datetime.date) else time


def _too_small(label: str, tracks: list[GridTrack]) -> list[Problem]:
    """A problem for a step with polygons that the page's grid cannot show."""
    lost = sum(not track.vertices.shape[1] for track in tracks)
    if not lost:
        return []
    severity: Severity = "warning" if lost == len(tracks) else "note"
    message = "polygons smaller than a tenth of a pixel are not drawn"
    hint = "draw the map larger, or look for static layers that reach far beyond the data"
    return [Problem("too small", severity, message, (label,), "", float(lost), "polygons", hint)]
