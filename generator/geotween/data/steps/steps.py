"""The steps of a scene: written one by one, or made of data or points, with words for them."""

from __future__ import annotations

import datetime
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from geotween.data.read.sources import Held, SourceReader
from geotween.data.steps.incidents import hotspot_steps
from geotween.data.steps.series import Member, series
from geotween.data.steps.times import words_of
from geotween.scene.document import Location
from geotween.scene.model import SceneFile, Step
from geotween.scene.values import Time


def members_of(reader: SourceReader, model: SceneFile, values: dict[str, Any]) -> list[Member]:
    """The steps of a scene and what their sources hold; what is wrong goes to the reader."""
    hold = model.timing.hold
    if model.data is None and model.hotspots is None:
        held = reader.members(values, "steps")
        return [
            _with_words(
                Member(
                    str(i + 1) if step.time is None else words_of(step.time),
                    step.time,
                    (held.get(i, Held([])),),
                ),
                step,
                hold,
            )
            for i, step in enumerate(model.steps)
        ]
    if model.data is not None:
        found = series(reader, model.data, values["data"])
    else:
        assert model.hotspots is not None
        found = hotspot_steps(reader, model.hotspots)
    found = [replace(member, hold=hold) for member in found]
    return _worded(reader, found, model.steps, hold) if found else []


def place_of(model: SceneFile) -> Location:
    """Where a scene says what its polygons are."""
    return ("data",) if model.data else ("hotspots",) if model.hotspots else ("steps",)


def _worded(
    reader: SourceReader, members: list[Member], words: Sequence[Step], hold: float
) -> list[Member]:
    """Steps with the words that the scene has for them, by time, or all in order."""
    found = list(members)
    by_order = all(step.time is None for step in words)
    if by_order and words and len(words) != len(members):
        message = f"there are words for {len(words)} steps, and {len(members)} steps"
        hint = "name the time of each: - {time: …, label: …}; " + _times(members)
        reader.faults.append(reader.document.fault(("steps",), message, hint, at_key=True))
        return members
    worded: dict[int, int] = {}  # which entry has the words of a step
    for number, step in enumerate(words):
        if by_order:
            found[number] = _with_words(found[number], step, hold)
            continue
        meant = [] if step.time is None else _at(members, step.time)
        if len(meant) == 1 and meant[0] not in worded:
            found[meant[0]] = _with_words(found[meant[0]], step, hold)
            worded[meant[0]] = number
            continue
        place: Location = ("steps", number)
        if step.time is None:
            message = f"step {number + 1} needs a time, as others have one"
        else:
            place = (*place, "time")
            count = f"{len(meant)} steps lie" if meant else "no step lies"
            message = f"{count} at {words_of(step.time)}"
            if len(meant) == 1:
                label = members[meant[0]].label
                message = f"{label} has words already, in entry {worded[meant[0]] + 1}"
        reader.faults.append(reader.document.fault(place, message, _times(members)))
    return found


def _with_words(member: Member, step: Step, hold: float) -> Member:
    return replace(
        member,
        label=member.label if step.label is None else step.label,
        caption=step.caption,
        hold=hold if step.hold is None else step.hold,
    )


def _at(members: Sequence[Member], time: Time) -> list[int]:
    """The steps at a time; a day also means the moments of it, a year its days."""
    exact = [i for i, member in enumerate(members) if member.time == time]
    return exact or [i for i, member in enumerate(members) if _within(member.time, time)]


def _within(moment: Time | None, time: Time) -> bool:
    if isinstance(moment, datetime.date) and isinstance(time, float):
        return moment.year == time
    if isinstance(moment, datetime.datetime) and not isinstance(time, datetime.datetime | float):
        return moment.date() == time
    return False


def _times(members: Sequence[Member]) -> str:
    labels = [member.label for member in members]
    if len(labels) > 6:
        labels = [*labels[:3], "…", *labels[-2:]]
    return f"the steps are {', '.join(labels)}"
