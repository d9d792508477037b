"""Moments of a map: by the time on its clock, by their place between steps, and all of a film."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from operator import itemgetter
from typing import TypeVar

import numpy as np

from geotween.export.easing import ease, share_at
from geotween.export.keyframes import Keyframes
from geotween.export.words import step_times

T = TypeVar("T")


@dataclass(frozen=True)
class Moment:
    """A moment of a span, by its number: ``t`` after easing, and the ``share`` of its duration.

    ``step`` is the one whose label and annotations are seen then.
    """

    span: int
    t: float
    share: float
    step: int


def at_time(frames: Keyframes, milliseconds: float) -> Moment:
    """What is shown at a time on the map's clock; a rest goes before what borders on it."""
    now = min(max(milliseconds, 0.0), float(frames.duration))
    spans = [span for span, _ in frames.spans]
    rests = (n for n, s in enumerate(spans) if s.rest and s.start <= now <= s.end)
    number = next(rests, None)
    if number is not None:
        return Moment(number, 0.0, 0.0, spans[number].step)
    number = next(n for n, s in enumerate(spans) if now < s.end)
    share = (now - spans[number].start) / spans[number].length
    seen = [times for _, times in step_times(frames)]
    step = max(n for n, (start, _) in enumerate(seen) if start <= now)
    return Moment(number, ease(frames.easing, share), share, step)


def at_place(frames: Keyframes, place: float) -> Moment:
    """What is shown at a place between steps: 0 is the first one, 1.5 half-way to the third.

    Raises
    ------
    ValueError
        For a place before the first step, or after the last one.
    """
    last = len(frames.labels) - 1
    if not 0 <= place <= last:
        raise ValueError(f"{place:g} is not a place between steps, which go from 0 to {last}")
    step, t = divmod(float(place), 1.0)
    number = next(
        n for n, (s, _) in enumerate(frames.spans) if s.step == int(step) and s.rest == (t == 0)
    )
    if t == 0:
        return Moment(number, 0.0, 0.0, int(step))
    share = share_at(frames.easing, t)
    return Moment(number, t, share, int(step) + (share >= 0.5))


def place_of(frames: Keyframes, moment: Moment) -> float:
    """The place of a moment between steps."""
    return frames.spans[moment.span][0].step + moment.t


def evenly(frames: Keyframes, count: int) -> list[float]:
    """Places from the first step to the last one, equally far apart."""
    return [float(place) for place in np.linspace(0, len(frames.labels) - 1, count)]


def each_step(frames: Keyframes, per_step: int = 1) -> list[float]:
    """The places of all steps, and for each more per step one in between."""
    last = len(frames.labels) - 1
    return [number / per_step for number in range(last * per_step + 1)]


def film(frames: Keyframes, rate: float) -> list[tuple[Moment, int]]:
    """The moments of one pass at a rate (frames a second), each with how many frames it lasts."""
    count = max(1, round(frames.duration / 1000 * rate))
    moments = [at_time(frames, 1000 * number / rate) for number in range(count)]
    return [(moment, len([*same])) for moment, same in groupby(moments)]


def thinned(runs: Sequence[tuple[T, int]], every: int) -> list[tuple[T, int]]:
    """Runs of frames with one of so many frames only, as long as before."""
    flat = [one for one, count in runs for _ in range(count)]
    kept = [(flat[n], min(every, len(flat) - n)) for n in range(0, len(flat), every)]
    return [
        (one, sum(count for _, count in same)) for one, same in groupby(kept, key=itemgetter(0))
    ]


def places(
    frames: Keyframes,
    at: str | None = None,
    count: int | None = None,
    per_step: int | None = None,
) -> list[float]:
    """The places that someone asks for: a list with commas, a count, or so many per step.

    Raises
    ------
    ValueError
        Where the list has something else than numbers.
    """
    if at is None:
        return evenly(frames, count) if count else each_step(frames, per_step or 1)
    found = []
    for text in at.split(","):
        try:
            found.append(float(text))
        except ValueError:
            raise ValueError(
                f"{text.strip()!r} is not a number; expected such as 0,0.5,1"
            ) from None
    return found


def step_of(frames: Keyframes, name: str) -> int:
    """The number of a step that is named by its label, or by its number from 0.

    Raises
    ------
    ValueError
        Where there is none.
    """
    if name in frames.labels:
        return frames.labels.index(name)
    if name.isdecimal() and int(name) < len(frames.labels):
        return int(name)
    known = ", ".join(frames.labels)
    raise ValueError(f"no step {name!r}; there are {known}")
