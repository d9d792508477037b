"""The transitions of Experiment 2 by all divisions, and where territory is worse than others."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

from docs.draw.experiments.divisions import (
    LOSSES,
    NAMES,
    TERRITORY,
    THINNED,
    Figures,
    figures,
    moved,
)
from docs.draw.experiments.shapes import FAMILIES

SEEDS = range(6)
OURS, PAPERS = "trajectory", "rotation"
ONE_TO_MANY = ("one to four", "archipelago", "drifted")
LEAST = 1e-5  # what a figure must be worse by to be a loss

WORDS = {
    "overlap": "overlap",
    "given_away": "given away",
    "lost": "laid bare",
    "roughness": "seam roughness",
}


@dataclass(frozen=True)
class Loss:
    """A transition in which territory is worse than another division, and by how much."""

    figure: str
    rival: str
    family: str
    seed: int
    ours: float
    theirs: float

    @property
    def by(self) -> float:
        return self.ours - self.theirs


Found = Mapping[tuple[str, int, str], Figures]  # by family, seed, division


@cache
def found(matching: str) -> Found:
    """The figures of all transitions by all divisions."""
    names = NAMES if matching == OURS else (*NAMES, THINNED)
    return {
        (family, seed, name): figures(moved(make(seed), name, matching))
        for family, make in FAMILIES.items()
        for seed in SEEDS
        for name in names
    }


def losses(matching: str) -> list[Loss]:
    """Where territory is worse, the worst first."""
    of = found(matching)
    every = [
        Loss(figure, rival, family, seed, getattr(ours, figure), getattr(theirs, figure))
        for (family, seed, rival), theirs in of.items()
        if rival not in (TERRITORY, THINNED)
        for ours in [of[family, seed, TERRITORY]]
        for figure in LOSSES
    ]
    return sorted((loss for loss in every if loss.by > LEAST), key=lambda loss: -loss.by)
