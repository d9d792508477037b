"""The speaker: names of things and clauses for what happened to them in one transition."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

from geotween.data.polygons import Identity
from geotween.story.events import KINDS, Event, Transition
from geotween.story.fates import Fate, fates_of, proper_name
from geotween.story.words import Words

MOST_NAMES = 4  # in a row; more are counted
MULTIPLE = 3.0  # from so many times its area on, growth is told as a multiple


@dataclass(frozen=True, eq=False)
class Speaker:
    """Tells one transition in the words of a scene."""

    transition: Transition
    words: Words

    @cached_property
    def fates(self) -> tuple[Fate, ...]:
        return fates_of(self.transition)

    def name(self, fate: Fate) -> str:
        """What a thing is called if that tells which one is meant, else nothing.

        Its own name; without one it is the largest of its class, or the only one.
        """
        proper = proper_name(fate.subject, self._counts[0 if fate.ended else 1])
        if proper:
            return proper
        alike = [f for f in self.fates if f.subject.class_ == fate.subject.class_]
        rivals = [f.size for f in alike if f is not fate]
        if rivals and fate.size <= max(rivals):
            return ""
        several = len({f.subject.class_ for f in self.fates}) > 1
        values = {"noun": self.words.noun(1), "class": fate.subject.class_ or "" if several else ""}
        message = "largest" if rivals else "the"
        return self.words.say(message, None, **values, usual=self.words.usual)

    def clause(self, fate: Fate) -> str:
        """What happened to one thing."""
        subject, done = self.name(fate), []
        if fate.renamed and fate.former is not None:
            done.append(self.words.say("became", name=subject))
            subject = proper_name(fate.former, self._counts[0]) or subject
        of_itself = [self._did(e) for e in fate.events if e.kind not in ("split", "merged")]
        of_others = [self._met(e, fate) for e in fate.events if e.kind in ("split", "merged")]
        done += [clause for clause in (*of_itself, *of_others) if clause]
        return self.words.say("clause", subject=subject, done=self.words.row(done))

    def summed(self, fates: Iterable[Fate], *, others: bool) -> list[str]:
        """What happened to several things, by kind; ``others`` says that some were told before."""
        events = [event for fate in fates for event in fate.telling]
        kinds = [kind for kind in KINDS if kind != "stable"]
        groups = [[event for event in events if event.kind == kind] for kind in kinds]
        message = "others" if others else "things"
        return [self._all(group, message) for group in groups if group]

    def summary(self, changed: int, clauses: Sequence[str]) -> str:
        """How many things changed, and how."""
        words, total = self.words, len(self.fates)
        told = "; ".join(clauses)
        values = {"n": words.number(changed), "total": words.number(total)}
        message = "everything" if changed == total else "summary"
        return words.say(message, changed, **values, noun=words.noun(total), told=told)

    def _all(self, events: Sequence[Event], message: str) -> str:
        """What one kind of event happened to."""
        kind, number, values = events[0].kind, len(events), {}
        partners = sum(len(event.partners) for event in events)
        if kind == "split":
            values["into"] = self.words.number(partners)
        elif kind == "merged":
            values["into"], number = self.words.number(number), partners
        elif kind in ("appeared", "vanished"):
            areas = [e.area_after if kind == "appeared" else e.area_before for e in events]
            known = [area for area in areas if area is not None]
            values["area"] = self._area(sum(known) if known else None)
        return self.words.say(
            f"all_{kind}", number, things=self.words.things(number, message), **values
        )

    def _did(self, event: Event) -> str:
        """What a thing did by itself; nothing where it stayed as it was."""
        words, kind = self.words, event.kind
        if kind == "moved" and event.distance is not None and event.bearing is not None:
            distance = words.length(event.distance) if self.transition.real else ""
            way = words.direction(event.bearing, compass=self.transition.compass)
            return words.say("moved", distance=distance, direction=way)
        area = self._area(event.area_before if kind == "vanished" else event.area_after)
        if event.change is not None and event.change + 1 >= MULTIPLE:
            return words.say("multiplied", times=words.times(event.change + 1), area=area)
        if event.change is not None and kind in ("grew", "shrank"):
            return words.say(kind, percent=words.percent(abs(event.change)), area=area)
        return words.say(kind, area=area) if kind in ("appeared", "vanished") else ""

    def _met(self, event: Event, fate: Fate) -> str:
        """What a thing split into or merged from; of one that lives on, what left or joined it."""
        others = fate.others(event)
        if fate.former is None:
            return self.words.say(event.kind, who=self._who(others, event))
        message = "left" if event.kind == "split" else "joined"
        return self.words.say(message, len(others), who=self._who(others, event, "others"))

    def _who(self, others: Sequence[Identity], event: Event, counted: str = "") -> str:
        """Some things by their names, or how many they are."""
        counts = self._counts[1 if event.kind == "split" else 0]
        names = [proper_name(identity, counts) for identity in others]
        if all(names) and len(names) <= MOST_NAMES:
            return self.words.row(names)
        if counted:
            return self.words.things(len(others), counted)
        message = "parts" if event.kind == "split" else "from_parts"
        return self.words.say(message, len(others), n=self.words.number(len(others)))

    def _area(self, area: float | None) -> str:
        return self.words.area(area) if self.transition.real else ""

    @cached_property
    def _counts(self) -> tuple[Counter[str], Counter[str]]:
        """How often each name is there, at both ends."""
        ends = (self.transition.descent.origin, self.transition.descent.target)
        here, there = (Counter(i.name for i in end.identities) for end in ends)
        return here, there
