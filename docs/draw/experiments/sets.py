"""Experiment 3: one to many, many to one, many to many; hotspots of two periods."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from docs.draw.experiments import pictures
from docs.draw.experiments.page import Page
from docs.draw.experiments.shapes import FAMILIES, Transition, parts
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
    reversed_,
)

HOTSPOTS = "hotspots"
SEED = 5
# The way of ours that is drawn, beside flubber.
DRAWN = MORPH


@cache
def transitions() -> dict[str, Transition]:
    islands = FAMILIES["archipelago"](2)
    return {
        "one to many": islands,
        "many to two": (islands[1], parts(np.random.default_rng(SEED), islands[0][0], 2)),
        "many to one": reversed_(islands),
        "many to many": FAMILIES["many to many"](0),
        HOTSPOTS: FAMILIES["hotspots"](4),
    }


@cache
def found() -> dict[str, dict[str, Moved]]:
    """All sets, moved in all ways."""
    ways = asked((PAPER, MORPH, AUTO, FLUBBER))
    return {
        name: {way: WAYS[way](transition) for way in ways}
        for name, transition in transitions().items()
    }


def page() -> Page:
    """All of Experiment 3."""
    drawn = {}
    ways = asked((PAPER, DRAWN, FLUBBER))
    for name, transition in transitions().items():
        for way in ways:
            drawn[f"3-{_plain(name)}-{way}"] = pictures.frames(
                found()[name][way].tracks,
                transition,
                f"{name} by {way}, at five moments",
                titles=_titles(name),
            )
    both = transitions()[HOTSPOTS]
    drawn["3-superposed"] = pictures.superposed(*both, "Hotspots of two periods over each other")
    values: dict[str, Any] = {
        "sets": compared(found()),
        "names": {name: _plain(name) for name in transitions() if name != HOTSPOTS},
        "ways": ways,
        "hotspots": HOTSPOTS,
        "flubber": flubber_said(),
    }
    return Page("3-sets", values, drawn)


def _titles(name: str) -> list[str]:
    """Figure 11 of the paper calls its frames A1 to A5."""
    if name != HOTSPOTS:
        return []
    return [f"A{k + 1}, t = {t:g}" for k, t in enumerate(pictures.MOMENTS)]


def _plain(name: str) -> str:
    return name.replace(" ", "-")
