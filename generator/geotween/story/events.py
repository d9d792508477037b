"""Events: what happened to each feature between two steps, with thresholds.

After C. Robertson, T. A. Nelson, B. Boots, M. A. Wulder, "STAMP: spatial-temporal analysis of
moving polygons", Journal of Geographical Systems 9, 2007. There, events are of the pieces of an
overlay; here of the features, of which one may have several in a transition.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Literal, get_args

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.load import Scene, Step
from geotween.data.polygons import Identity, PolygonSet
from geotween.motion.correspond import Correspondence, correspond
from geotween.motion.techniques import Techniques, resolve
from geotween.story.descent import Descent, Things, descent
from geotween.story.measure import Measure, measure_of
from geotween.story.moves import WAY, have_moved

Kind = Literal["appeared", "vanished", "split", "merged", "moved", "grew", "shrank", "stable"]
KINDS: tuple[Kind, ...] = get_args(Kind)

# An area changed where it did by this part of the larger one. Lines are drawn to a quarter of a
# pixel, which is 1% of the area of a square of a hundred pixels.
CHANGED = 0.01

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Event:
    """What happened to a feature in a transition.

    ``subject`` is what it happened to: for ``split`` the feature of the origin, else the target's
    where it lives on. ``partners`` are what it split into or merged from, the subject itself
    included where it lives on; for others the former identity, where that was another. Areas and
    distances are in m² and m, or in units of the data; those of the origin and the target, of all
    partners together where it split or merged. None is what there is not, or cannot be compared.
    ``bearing`` is in degrees, clockwise from north, or from what is up on the page. ``before`` and
    ``after`` are the places of the polygons in their sets.
    """

    kind: Kind
    subject: Identity
    partners: tuple[Identity, ...] = ()
    area_before: float | None = None
    area_after: float | None = None
    distance: float | None = None
    bearing: float | None = None
    before: tuple[int, ...] = ()
    after: tuple[int, ...] = ()

    @property
    def change(self) -> float | None:
        """The change of area as a part of the former one; None where one of them is missing."""
        if not self.area_before or self.area_after is None:
            return None
        return self.area_after / self.area_before - 1


@dataclass(frozen=True, eq=False)
class Transition:
    """The events between two steps; ``real`` tells that they are in m² and m.

    ``compass`` says that bearings count from north. ``descent`` tells the things of both steps.
    """

    origin: Step
    target: Step
    events: tuple[Event, ...]
    descent: Descent
    real: bool
    compass: bool


def scene_events(scene: Scene) -> tuple[Transition, ...]:
    """The events of each transition of a scene.

    Who corresponds is what its motion takes for it, from the polygons as they are drawn. What is
    measured are those before simplification.
    """
    measure = measure_of(scene)
    motion = scene.model.motion
    techniques = resolve(motion.method, motion.correspondence, radius=motion.radius)
    found = []
    for origin, target in pairwise(scene.steps):
        drawn = related_by_layer(origin.regions, target.regions, techniques)
        related = Correspondence(origin.exact, target.exact, drawn.pairs)
        who = descent(related)
        told = _Told(related, who, measure)
        real, compass = (measure is not None and getattr(measure, k) for k in ("real", "compass"))
        found.append(Transition(origin, target, told.sorted(), who, real, compass))
    return tuple(found)


def events(related: Correspondence, measure: Measure | None) -> tuple[Event, ...]:
    """What happened to the features of two sets that correspond.

    Without a ``measure`` sizes and places are not compared: nothing grows, shrinks, moves or is
    stable. Every feature is the subject or a partner of an event otherwise. The order is that of
    the target's features, then that of those which ended.
    """
    return _Told(related, descent(related), measure).sorted()


def related_by_layer(
    origin: PolygonSet, target: PolygonSet, techniques: Techniques
) -> Correspondence:
    """The correspondence of two sets as motion takes it: each layer on its own."""
    pairs = [np.empty((0, 2), dtype=np.intp)]
    for layer in dict.fromkeys([*origin.layers, *target.layers]):
        ends = [
            np.flatnonzero([identity.layer == layer for identity in end.identities])
            for end in (origin, target)
        ]
        found = correspond(
            origin.in_layer(layer),
            target.in_layer(layer),
            techniques.correspondence,
            techniques.radius,
        ).pairs
        pairs.append(np.column_stack([end[found[:, k]] for k, end in enumerate(ends)]))
    every = np.concatenate(pairs)
    return Correspondence(origin, target, every[np.lexsort((every[:, 1], every[:, 0]))])


@dataclass(frozen=True, eq=False)
class _Told:
    """Two sets, who becomes whom, and how they are measured."""

    related: Correspondence
    who: Descent
    measure: Measure | None

    def sorted(self) -> tuple[Event, ...]:
        """All events, in the order of their subjects, then of KINDS."""
        after = len(self.related.target)

        def place(event: Event) -> tuple[int, int]:
            ended = event.kind in ("vanished", "split")
            first = after + event.before[0] if ended else event.after[0]
            return first, KINDS.index(event.kind)

        found = [*self._ends(), *self._branches()]
        return tuple(sorted([*found, *self._lives()], key=place))

    def _ends(self) -> Iterator[Event]:
        """What appeared and what vanished."""
        met = [np.unique(self.who.pairs[:, side]) for side in (0, 1)]
        for i in np.setdiff1d(np.arange(len(self.who.origin)), met[0]).tolist():
            yield self._event("vanished", [i], [], self.who.origin.identities[i])
        for j in np.setdiff1d(np.arange(len(self.who.target)), met[1]).tolist():
            yield self._event("appeared", [], [j], self.who.target.identities[j])

    def _branches(self) -> Iterator[Event]:
        """What split and what merged."""
        here, there = self.who.origin.identities, self.who.target.identities
        for i, found in _several(self.who.pairs):
            yield self._event("split", [i], found, here[i], tuple(there[j] for j in found))
        for j, found in _several(self.who.pairs[:, ::-1]):
            yield self._event("merged", found, [j], there[j], tuple(here[i] for i in found))

    def _lives(self) -> Iterator[Event]:
        """What grew, shrank, moved, or is what it was, of the things that live on."""
        if self.measure is None:
            return
        pairs = self.who.pairs[self.who.lives]
        branched = {i for i, _ in _several(self.who.pairs)}
        joined = {j for j, _ in _several(self.who.pairs[:, ::-1])}
        ways, bearings = self._ways(pairs)
        moved = self._moved(pairs, ways)
        for k, (i, j) in enumerate(pairs.tolist()):
            one, other = self.who.origin.identities[i], self.who.target.identities[j]
            former = () if (one.called, one.class_) == (other.called, other.class_) else (one,)
            former = former if one.keyed or other.keyed or one.class_ != other.class_ else ()
            before, after = self._areas[0][i], self._areas[1][j]
            changed = abs(after - before) >= CHANGED * max(before, after)
            way = (float(ways[k]), float(bearings[k]))
            if moved[k]:
                yield self._event("moved", [i], [j], other, former, way)
            if changed:
                kind: Kind = "grew" if after > before else "shrank"
                yield self._event(kind, [i], [j], other, former)
            if not (moved[k] or changed or i in branched or j in joined):
                yield self._event("stable", [i], [j], other, former)

    def _event(
        self,
        kind: Kind,
        here: list[int],
        there: list[int],
        subject: Identity,
        partners: tuple[Identity, ...] = (),
        way: tuple[float | None, float | None] = (None, None),
    ) -> Event:
        before, after = (
            tuple(index for thing in end for index in things.polygons(thing))
            for things, end in ((self.who.origin, here), (self.who.target, there))
        )
        areas = self._area(0, here), self._area(1, there)
        return Event(kind, subject, partners, *areas, *way, before, after)

    def _area(self, side: int, things: list[int]) -> float | None:
        """The area of some things of one side together."""
        if self.measure is None or not things:
            return None
        return float(self._areas[side][things].sum())

    @cached_property
    def _areas(self) -> tuple[Floats, Floats]:
        """The areas of the things of both sets."""
        assert self.measure is not None
        here, there = (
            np.bincount(things.of, self.measure.areas(end.polygons), len(things)).astype(float)
            for end, things in self._sides()
        )
        return here, there

    def _ways(self, pairs: NDArray[np.intp]) -> tuple[Floats, Floats]:
        """How far (m,) the centroids of pairs of things went, and which way (degrees)."""
        assert self.measure is not None
        centres = []
        for side, (end, things) in enumerate(self._sides()):
            if not len(end):
                return np.empty(0), np.empty(0)
            weights = self.measure.areas(end.polygons)[:, None]
            parts = self.measure.centres(end.polygons)
            total = np.zeros((len(things), parts.shape[1]))
            np.add.at(total, things.of, parts * weights)
            centres.append(total[pairs[:, side]] / self._areas[side][pairs[:, side], None])
        return self.measure.ways(centres[0], centres[1])

    def _moved(self, pairs: NDArray[np.intp], ways: Floats) -> NDArray[np.bool_]:
        """Which pairs of things (m,) have left their place for another one."""
        found = np.zeros(len(pairs), dtype=bool)
        sizes = [areas[pairs[:, side]] for side, areas in enumerate(self._areas)]
        far = np.flatnonzero(ways >= WAY * np.sqrt((sizes[0] + sizes[1]) / 2))
        here, there = (
            np.array([_whole(end, things, k) for k in pairs[far, side].tolist()], dtype=object)
            for side, (end, things) in enumerate(self._sides())
        )
        found[far] = have_moved(here, there)
        return found

    def _sides(self) -> tuple[tuple[PolygonSet, Things], tuple[PolygonSet, Things]]:
        return (
            (self.related.origin, self.who.origin),
            (self.related.target, self.who.target),
        )


def _several(pairs: NDArray[np.intp]) -> Iterator[tuple[int, list[int]]]:
    """The things of the first column that meet more than one of the second, and those."""
    if not len(pairs):
        return
    order = np.lexsort((pairs[:, 1], pairs[:, 0]))
    firsts, starts = np.unique(pairs[order, 0], return_index=True)
    for first, found in zip(firsts, np.split(pairs[order, 1], starts[1:]), strict=True):
        if len(found) > 1:
            yield int(first), found.tolist()


def _whole(end: PolygonSet, things: Things, thing: int) -> shapely.Geometry:
    return shapely.union_all(end.polygons[list(things.polygons(thing))])
