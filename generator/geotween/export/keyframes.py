"""Keyframes: everything that is shown, when, and in which paint; what SVG and page are made of.

The timeline is a row of spans: a rest at each step, a transition between each two. In a span the
tracks of one key and one paint make a bundle, drawn as one region path; where a bundle has seams,
its stroke becomes paths of their own, so that a closed seam is not stroked.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
import shapely

from geotween.data.load import REGIONS, Scene
from geotween.data.polygons import Identity
from geotween.data.problems import Problem, Severity
from geotween.export.easing import EASINGS, Spline
from geotween.export.page_grid import GridTrack, Page, fit_page, moving, resting
from geotween.export.paint import GHOST, Paint, Painter
from geotween.export.timeline import Span, timeline
from geotween.motion.morph import Morph
from geotween.motion.rings import next_vertex
from geotween.motion.tracks import SEAM_AT_ORIGIN, SEAM_AT_TARGET

Kind = Literal["backing", "region", "border", "seam", "ghost"]
_DRAWN_IN_ORDER: tuple[Kind, ...] = ("backing", "region", "border", "seam", "ghost")

# Steps of the grid by which two edges on one line may part when their ends are rounded.
ROUNDING = 1.5

# The share of a transition in which the stroke of a seam appears, and in which it goes.
SEAM_FADE = 0.05


@dataclass(frozen=True)
class Group:
    """Paths that share an opacity, at the start and at the end of a span."""

    layer: str
    opacity: tuple[float, float]


@dataclass(frozen=True)
class Slot:
    """The place of a path in the drawing: the same in every span in which it is used."""

    group: Group
    kind: Kind
    key: str
    number: int = 0
    code: int = 0


@dataclass(frozen=True, eq=False)
class Shape:
    """A path in a span: its tracks, and its paint at the span's start and end.

    ``slot.code`` says which seams a path of kind ``seam`` draws. ``show`` limits it to a part of
    the span, in shares of its duration.
    """

    slot: Slot
    tracks: tuple[GridTrack, ...]
    paints: tuple[Paint, Paint]
    show: tuple[float, float] | None = None

    @property
    def still(self) -> bool:
        return all(track.still for track in self.tracks)


@dataclass(frozen=True, eq=False)
class Scenery:
    """A static layer under the regions."""

    name: str
    opacity: float
    paint: Paint
    tracks: tuple[GridTrack, ...]


@dataclass(frozen=True, eq=False)
class Keyframes:
    """A whole map: its page, its static layers, and the shapes of each span."""

    page: Page
    background: str
    scenery: tuple[Scenery, ...]
    easing: Spline | None
    loop: bool
    labels: tuple[str, ...]
    captions: tuple[str, ...]
    spans: tuple[tuple[Span, tuple[Shape, ...]], ...]
    problems: tuple[Problem, ...] = ()

    @property
    def duration(self) -> int:
        """Milliseconds of one pass."""
        return self.spans[-1][0].end

    @property
    def rests(self) -> list[Span]:
        return [span for span, _ in self.spans if span.rest]

    def slots(self) -> list[Slot]:
        """All slots in drawing order: by group, then key, both by first appearance."""
        groups: dict[Group, None] = {}
        keys: dict[str, int] = {}
        slots: dict[Slot, None] = {}
        for _, shapes in self.spans:
            for shape in shapes:
                groups.setdefault(shape.slot.group)
                keys.setdefault(shape.slot.key, len(keys))
                slots.setdefault(shape.slot)
        order = sorted(groups, key=lambda group: group.layer != REGIONS)
        return sorted(
            slots,
            key=lambda s: (
                order.index(s.group),
                s.kind != "backing",
                keys[s.key],
                s.number,
                _DRAWN_IN_ORDER.index(s.kind),
                s.code,
            ),
        )


def keyframes(scene: Scene, morphs: Sequence[Morph]) -> Keyframes:
    """The keyframes of a scene whose transitions have been planned."""
    model = scene.model
    page = fit_page(model.map, [s.regions for s in scene.steps] + [s for _, s in scene.layers])
    painter = Painter(model.style, (i for step in scene.steps for i in step.regions.identities))
    rests = [resting(step.regions, page) for step in scene.steps]
    spans = []
    for span in timeline(scene):
        if span.rest:
            identities = scene.steps[span.step].regions.identities
            members = [
                _Member(i, (i, i), track)
                for i, track in zip(identities, rests[span.step], strict=True)
            ]
            shapes = _shapes(members, painter)
        else:
            tracks = morphs[span.step].tracks
            members = [_Member(t.identity, t.ends, moving(t, page)) for t in tracks]
            shapes = _shapes(members, painter)
            if model.motion.ghost == "origin" and rests[span.step]:
                slot = Slot(Group("ghost", (1.0, 1.0)), "ghost", "")
                shapes.append(Shape(slot, tuple(rests[span.step]), (GHOST, GHOST)))
        spans.append((span, tuple(shapes)))
    scenery = tuple(
        Scenery(
            layer.name,
            layer.opacity,
            Paint(layer.fill, layer.stroke, layer.width),
            tuple(resting(polygons, page)),
        )
        for layer, polygons in scene.layers
    )
    return Keyframes(
        page,
        model.map.background,
        scenery,
        EASINGS[model.motion.easing],
        model.timing.loop,
        tuple(step.label for step in scene.steps),
        tuple(step.caption for step in scene.steps),
        tuple(spans),
        tuple(p for s, r in zip(scene.steps, rests, strict=True) for p in _too_small(s.label, r)),
    )


def _too_small(label: str, tracks: list[GridTrack]) -> list[Problem]:
    """A problem for a step with polygons that the page's grid cannot show."""
    lost = sum(not track.vertices.shape[1] for track in tracks)
    if not lost:
        return []
    severity: Severity = "warning" if lost == len(tracks) else "note"
    message = "polygons smaller than a tenth of a pixel are not drawn"
    hint = "draw the map larger, or look for static layers that reach far beyond the data"
    return [Problem("too small", severity, message, (label,), "", float(lost), "polygons", hint)]


@dataclass(frozen=True, eq=False)
class _Member:
    identity: Identity
    ends: tuple[Identity, Identity]
    track: GridTrack


@dataclass(eq=False)
class _Bundle:
    """The tracks of a span that are one path: one key, one paint and opacity at each end."""

    group: Group
    key: str
    number: int
    paints: tuple[Paint, Paint]
    tracks: list[GridTrack] = field(default_factory=list)

    @property
    def stroked(self) -> bool:
        return any(paint.stroked for paint in self.paints)


def _shapes(members: Iterable[_Member], painter: Painter) -> list[Shape]:
    """The paths of a span, its backings first."""
    bundles = _bundles(members, painter)
    shapes = _backings(bundles)
    for bundle in bundles:
        codes = np.unique(np.concatenate([track.seams for track in bundle.tracks]))
        tracks, paints = tuple(bundle.tracks), _of_one_width(*bundle.paints)
        if not bundle.stroked or not codes.any():
            shapes.append(Shape(_slot(bundle, "region"), tracks, paints))
            continue
        fill = (paints[0].filled_only(), paints[1].filled_only())
        stroke = (paints[0].stroked_only(), paints[1].stroked_only())
        shapes.append(Shape(_slot(bundle, "region"), tracks, fill))
        if (codes == 0).any():
            shapes.append(Shape(_slot(bundle, "border"), tracks, stroke))
        for code in codes[codes > 0]:
            shapes.append(Shape(_slot(bundle, "seam", int(code)), tracks, stroke))
    return shapes


def _of_one_width(one: Paint, other: Paint) -> tuple[Paint, Paint]:
    """Two paints; a stroke that comes or goes does so in its full width."""
    if one.stroked == other.stroked:
        return one, other
    if other.stroked:
        return replace(one, stroke="none", width=other.width), other
    return one, replace(other, stroke="none", width=one.width)


def _slot(bundle: _Bundle, kind: Kind, code: int = 0) -> Slot:
    return Slot(bundle.group, kind, bundle.key, bundle.number, code)


def _bundles(members: Iterable[_Member], painter: Painter) -> list[_Bundle]:
    found: dict[object, _Bundle] = {}
    numbers: dict[object, int] = {}
    for member in members:
        if not member.track.vertices.shape[1]:
            continue
        key = str(member.identity.key) if member.identity.keyed else ""
        one, other = member.ends
        paints = (painter.paint(one), painter.paint(other))
        group = Group(REGIONS, (painter.opacity(one), painter.opacity(other)))
        name = (group, key, paints)
        if name not in found:
            number = numbers.setdefault((group, key), 0)
            numbers[group, key] += 1
            found[name] = _Bundle(group, key, number, paints)
        found[name].tracks.append(member.track)
    return list(found.values())


def _backings(bundles: list[_Bundle]) -> list[Shape]:
    """Paths under bundles of one fill that touch without a stroke between them.

    Two paths that abut let the background through in a hairline; a path of both does not. Where
    the fills part on the way, it is there only while they are still, or already, the same.
    """
    contacts: dict[tuple[Group, Paint, Paint, tuple[float, float] | None], set[int]] = {}
    for end, flag in ((0, SEAM_AT_ORIGIN), (1, SEAM_AT_TARGET)):
        for i, j in _contacts(bundles, end, flag):
            one, other = bundles[i], bundles[j]
            fills = [(b.paints[0].fill, b.paints[1].fill) for b in (one, other)]
            if one.group != other.group or fills[0][end] != fills[1][end]:
                continue
            if fills[0][end] == "none":
                continue
            if fills[0] == fills[1]:
                paints = (one.paints[0].filled_only(), one.paints[1].filled_only())
                show = None
            else:
                paint = one.paints[end].filled_only()
                paints = (paint, paint)
                show = (1 - SEAM_FADE, 1.0) if end else (0.0, SEAM_FADE)
            contacts.setdefault((one.group, *paints, show), set()).update((i, j))
    shapes = []
    for number, ((group, start, end_paint, show), touching) in enumerate(contacts.items()):
        tracks = tuple(track for i in sorted(touching) for track in bundles[i].tracks)
        slot = Slot(group, "backing", "", number)
        shapes.append(Shape(slot, tracks, (start, end_paint), show))
    return shapes


def _contacts(bundles: list[_Bundle], end: int, flag: int) -> list[tuple[int, int]]:
    """Pairs of bundles that run along each other at one end of the span, with no stroke there.

    Edges meet where they lie on one line, but for the rounding, and overlap by more than that.
    """
    if len(bundles) < 2:
        return []
    starts, stops, owners = [], [], []
    for number, bundle in enumerate(bundles):
        for track in bundle.tracks:
            points = track.vertices[-end]  # the last key time at the end, the first at the start
            following = points[next_vertex(track.offsets)]
            bare = (points != following).any(axis=1)
            if bundle.paints[end].stroked:
                bare &= (track.seams & flag) > 0
            starts.append(points[bare])
            stops.append(following[bare])
            owners.append(np.full(int(bare.sum()), number))
    start, stop, owner = np.concatenate(starts), np.concatenate(stops), np.concatenate(owners)
    lines: Any = shapely.linestrings(np.stack([start, stop], axis=1).astype(float))
    one, other = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=ROUNDING)
    apart = owner[one] < owner[other]
    one, other = one[apart], other[apart]
    way = (stop - start)[one].astype(float)
    length = np.hypot(*way.T)
    way /= length[:, None]
    ends = np.stack([start[other] - start[one], stop[other] - start[one]], axis=1)
    along = np.sort((ends * way[:, None]).sum(axis=2), axis=1)
    aside = np.abs(ends[..., 0] * way[:, None, 1] - ends[..., 1] * way[:, None, 0]).max(axis=1)
    overlap = np.minimum(along[:, 1], length) - np.maximum(along[:, 0], 0)
    # The farther end of a longer edge may lie off by more, as the rounding turns its line.
    reach = np.maximum(1, (along[:, 1] - along[:, 0]) / length)
    touching = (aside <= ROUNDING * reach) & (overlap > 2 * ROUNDING)
    pairs = np.unique(np.column_stack([owner[one], owner[other]])[touching], axis=0)
    return [(int(i), int(j)) for i, j in pairs]
