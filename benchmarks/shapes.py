"""Rough outlines for benchmarks: seeded, so that every run and every program gets the same."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

SEED = 2024
RADIUS = 100.0  # of the mean circle, in pixels of a map
LOBES = (2, 3, 5, 8, 13, 34, 89)  # waves around the outline, each lower as it gets shorter
RELIEF = 0.5  # the height of a wave, in radii, times its number of lobes
# Vertices stray by up to this share of the mean way between two of them: an outline is rough at
# the scale at which it was digitised, however many vertices it has.
STRAY = 0.4
SHIFT = (30.0, 20.0)  # from the first outline to the second, which still overlap
FEWER = 0.9  # vertices of the second outline for each of the first

Outline = NDArray[np.float64]


def outline_pair(count: int) -> tuple[Outline, Outline]:
    """Two open, counter-clockwise outlines (count, 2) and (0.9 count, 2) that overlap."""
    random = np.random.default_rng([SEED, count])
    return rough_star(count, random), rough_star(round(FEWER * count), random) + SHIFT


def rough_star(count: int, random: np.random.Generator) -> Outline:
    """A star about (0, 0) with ``count`` vertices; simple, as its angles rise all the way round."""
    step = 2 * np.pi / count
    angle = (np.arange(count) + random.uniform(-STRAY, STRAY, count)) * step
    phase = random.uniform(0, 2 * np.pi, len(LOBES))
    height = RELIEF / np.array(LOBES) * random.uniform(0.3, 1, len(LOBES))
    radius = np.exp((height * np.sin(np.outer(angle, LOBES) + phase)).sum(axis=1))
    radius += random.uniform(-STRAY, STRAY, count) * step
    return np.asarray(RADIUS * radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]))
