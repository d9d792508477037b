"""When each step rests and each transition runs."""

from __future__ import annotations

import datetime
from dataclasses import dataclass
from itertools import pairwise

from geotween.data.load import Scene
from geotween.scene.model import Timing
from geotween.scene.values import Time


@dataclass(frozen=True)
class Span:
    """A rest at a step, or the transition after it: start and end in whole milliseconds."""

    start: int
    end: int
    step: int
    rest: bool

    @property
    def length(self) -> int:
        return self.end - self.start


def timeline(scene: Scene) -> tuple[Span, ...]:
    """Rests and transitions in turn, without gaps; a rest may have no length."""
    timing = scene.model.timing
    moves = _transitions(timing, [step.time for step in scene.steps])
    spans: list[Span] = []
    now = 0
    for index, step in enumerate(scene.steps):
        end = now + round(1000 * step.hold / timing.speed)
        spans.append(Span(now, end, index, rest=True))
        now = end
        if index < len(moves):
            end = now + max(1, round(1000 * moves[index] / timing.speed))
            spans.append(Span(now, end, index, rest=False))
            now = end
    return tuple(spans)


def _transitions(timing: Timing, times: list[Time | None]) -> list[float]:
    """Seconds of each transition."""
    count = len(times) - 1
    if isinstance(timing.transition, float):
        return [timing.transition] * count
    if isinstance(timing.transition, tuple):
        return list(timing.transition)
    gaps = [_gap(a, b) for a, b in pairwise(times)]
    total = 2.0 * count if timing.total is None else timing.total
    return [total * gap / sum(gaps) for gap in gaps]


def _gap(before: Time | None, after: Time | None) -> float:
    if isinstance(before, datetime.date) and isinstance(after, datetime.date):
        return abs((after - before).total_seconds())
    assert isinstance(before, float)
    assert isinstance(after, float)
    return abs(after - before)
