"""Experiment 1: pairs of arbitrary geometry; and the five kinds of correspondence."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from docs.draw.experiments import pictures
from docs.draw.experiments.page import Page
from docs.draw.experiments.shapes import PAIRS, Transition, kinds
from docs.draw.experiments.tables import percent, table, yes
from docs.draw.experiments.ways import (
    AUTO,
    FLUBBER,
    MORPH,
    PAPER,
    WAYS,
    Moved,
    asked,
    compared,
    flubber_said,
    sets_of,
)
from geotween.motion.areas import area_over_time
from geotween.motion.correspond import correspond

SEED = 7


@cache
def transitions() -> dict[str, Transition]:
    return {
        name: make(np.random.default_rng([SEED, k])) for k, (name, make) in enumerate(PAIRS.items())
    }


@cache
def found() -> dict[str, dict[str, Moved]]:
    """All pairs, moved in all ways."""
    ways = asked((PAPER, MORPH, AUTO, FLUBBER))
    return {
        name: {way: WAYS[way](transition) for way in ways}
        for name, transition in transitions().items()
    }


def page() -> Page:
    """All of Experiment 1."""
    drawn = {}
    for name, transition in transitions().items():
        for way in (PAPER, MORPH):
            label = f"{name}: {way}, at five moments"
            drawn[f"1-{_plain(name)}-{way}"] = pictures.frames(
                found()[name][way].tracks, transition, label
            )
    for kind, transition in five().items():
        tracks = WAYS[AUTO](transition).tracks
        drawn[f"1-kind-{_plain(kind)}"] = pictures.frames(
            tracks, transition, f"{kind}, at five moments"
        )
    values: dict[str, Any] = {
        "pairs": compared(found()),
        "names": {name: _plain(name) for name in transitions()},
        "kinds": _kinds(),
        "kind_names": {kind: _plain(kind) for kind in five()},
        "flubber": flubber_said(),
        "ways": (PAPER, MORPH),
    }
    return Page("1-pairs", values, drawn)


@cache
def five() -> dict[str, Transition]:
    return dict(kinds(np.random.default_rng([SEED, 99])))


def _kinds() -> str:
    rows = []
    for kind, transition in five().items():
        moved = WAYS[AUTO](transition)
        related = correspond(*sets_of(transition), "auto")
        area = area_over_time(moved.tracks)
        off = max(map(abs, area.extremes(linear=True))) / max(area.ends)
        numbers = [str(len(end)) for end in transition]
        pairs = str(len(related.pairs))
        rows.append([kind, moved.kinds, *numbers, pairs, percent(off), yes(moved.proved)])
    heads = ["kind", "motion", "before", "after", "pairs", "area off, at most", "proved"]
    return table(heads, rows, words=2)


def _plain(name: str) -> str:
    return name.replace(",", "").replace(" ", "-")
