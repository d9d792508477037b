"""Beyond the paper: fronts beside morphs."""

from __future__ import annotations

from functools import cache

import numpy as np

from docs.draw.experiments import pictures
from docs.draw.experiments.page import Page
from docs.draw.experiments.shapes import FAMILIES, IN_PLACE, Transition
from docs.draw.experiments.tables import table
from docs.draw.experiments.ways import (
    AUTO,
    FLUBBER,
    FRONT,
    MORPH,
    PAPER,
    WAYS,
    Moved,
    asked,
    compared,
    flubber_said,
)

SEED = 11


@cache
def transitions() -> dict[str, Transition]:
    own = {
        name: make(np.random.default_rng([SEED, k]))
        for k, (name, make) in enumerate(IN_PLACE.items())
    }
    return own | {"hotspots": FAMILIES["hotspots"](4), "one to four": FAMILIES["one to four"](0)}


@cache
def found() -> dict[str, dict[str, Moved]]:
    """All transitions, in all ways."""
    ways = asked((MORPH, FRONT, AUTO, PAPER, FLUBBER))
    return {
        name: {way: WAYS[way](transition) for way in ways}
        for name, transition in transitions().items()
    }


def page() -> Page:
    """Fronts beside morphs."""
    drawn = {
        f"4-{name.replace(' ', '-')}-{way}": pictures.frames(
            found()[name][way].tracks, transition, f"{name} by {way}, at five moments"
        )
        for name, transition in transitions().items()
        for way in (MORPH, FRONT)
    }
    chosen = table(["set", "auto takes"], [[k, v[AUTO].kinds] for k, v in found().items()], words=2)
    names = {name: name.replace(" ", "-") for name in transitions()}
    values = {"fronts": compared(found()), "chosen": chosen, "names": names, "ways": (MORPH, FRONT)}
    values["flubber"] = flubber_said()
    return Page("4-fronts", values, drawn)
