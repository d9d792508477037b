"""Fates: the events of a transition, gathered by the thing that they happened to."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from dataclasses import dataclass

from geotween.data.polygons import Identity
from geotween.story.events import Event, Kind, Transition

BRANCHING: frozenset[Kind] = frozenset({"split", "merged", "appeared", "vanished"})
LONGEST_NAME = 80  # characters


@dataclass(frozen=True, eq=False)
class Fate:
    """All that happened to one thing.

    ``ended`` says that it is one of the origin, and not of the target; ``former`` is who it was at
    the origin, None where it was not there.
    """

    subject: Identity
    ended: bool
    former: Identity | None
    events: tuple[Event, ...]

    @property
    def changed(self) -> bool:
        return any(event.kind != "stable" for event in self.events)

    @property
    def branches(self) -> bool:
        """Whether it came or went, parted or joined."""
        return any(event.kind in BRANCHING for event in self.events)

    @property
    def size(self) -> float:
        """The larger of its areas; 0 where they are not known."""
        areas = [(e.area_before or 0.0, e.area_after or 0.0) for e in self.events]
        return max((area for pair in areas for area in pair), default=0.0)

    @property
    def renamed(self) -> bool:
        """Whether it is somebody else by now."""
        return any(e.partners and e.kind not in BRANCHING for e in self.events)

    @property
    def telling(self) -> tuple[Event, ...]:
        """The events that say most: where something came or went, its growth says little more."""
        branching = tuple(event for event in self.events if event.kind in BRANCHING)
        return branching or tuple(event for event in self.events if event.kind != "stable")

    def others(self, event: Event) -> list[Identity]:
        """Whom it split into or merged from, but for itself."""
        found = list(event.partners)
        if self.former is not None:
            found.remove(self.subject if event.kind == "split" else self.former)
        return found


def fates_of(transition: Transition) -> tuple[Fate, ...]:
    """The fates of all things, in the order of their first events."""
    who = transition.descent
    pairs = who.pairs[who.lives].tolist()
    later, former = dict(pairs), {j: i for i, j in pairs}
    groups: dict[tuple[bool, int], list[Event]] = {}
    for event in transition.events:
        ended = event.kind in ("vanished", "split")
        thing = int(who.origin.of[event.before[0]] if ended else who.target.of[event.after[0]])
        if ended and thing in later:
            ended, thing = False, later[thing]
        groups.setdefault((ended, thing), []).append(event)
    return tuple(
        Fate(
            (who.origin if ended else who.target).identities[thing],
            ended,
            who.origin.identities[former[thing]] if not ended and thing in former else None,
            tuple(events),
        )
        for (ended, thing), events in groups.items()
    )


def proper_name(identity: Identity, counts: Mapping[str, int]) -> str:
    """The name of one thing alone, or its key; empty where it has neither.

    ``counts`` tells how often each name is there.
    """
    named = identity.name and counts[identity.name] == 1
    name = identity.name if named else str(identity.key) if identity.keyed else ""
    return textwrap.shorten(name, LONGEST_NAME, placeholder=" …")
