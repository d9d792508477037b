"""Valid features: what a source holds, mended, and what was left out of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from geotween.data.globe.longitudes import JUMP
from geotween.data.polygons import Feature
from geotween.data.problems import Problem
from geotween.data.read.sources import Held
from geotween.data.tidy.repair import repair


def valid_features(
    source: Held, *, step: str, geographic: bool
) -> tuple[list[Feature], list[Problem]]:
    """A source's features made valid, and what was mended or left out.

    A polygon across the antimeridian, whose longitudes jump there, is not yet what it seems: it
    is left for when it has been put in place (``mended``).
    """
    problems = list(source.problems)
    if source.skipped:
        message = "features without area (points, lines, null geometries) were left out"
        count = float(source.skipped)
        hint = "" if source.features else "nothing is left of it"
        problems.append(
            Problem("no area", "warning", message, (step,), "", count, "features", hint)
        )
    crossing = _jumps(source.features) if geographic else np.zeros(len(source.features), dtype=bool)
    whole = [f for f, jumps in zip(source.features, crossing, strict=True) if not jumps]
    left = [f for f, jumps in zip(source.features, crossing, strict=True) if jumps]
    kept, found = repair(whole, step=step, winding=source.wound)
    return kept + left, problems + found


def mended(features: Sequence[Feature], *, step: str) -> tuple[list[Feature], list[Problem]]:
    """Features of which those that are not valid are mended."""
    valid = shapely.is_valid([feature.geometry for feature in features])
    if np.all(valid):
        return list(features), []
    broken = [f for f, good in zip(features, valid, strict=True) if not good]
    kept, problems = repair(broken, step=step)
    return [f for f, good in zip(features, valid, strict=True) if good] + kept, problems


def _jumps(features: Sequence[Feature]) -> np.ndarray:
    """Which features have an edge of more than ``JUMP`` degrees of longitude."""
    geometries = np.array([f.geometry for f in features], dtype=object)
    points, owner = shapely.get_coordinates(geometries, return_index=True)
    far = (np.abs(np.diff(points[:, 0])) > JUMP) & (owner[1:] == owner[:-1])
    found = np.zeros(len(features), dtype=bool)
    found[owner[1:][far]] = True
    return found
