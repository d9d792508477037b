"""Tidy sets: layers of disjoint polygons, as fine as the page can show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from geotween.data.coverage import clean_coverage, coverage_faults, looks_like_coverage
from geotween.data.identity import class_layers
from geotween.data.overlaps import separate
from geotween.data.polygons import Feature, Shapes, geometries_of, with_geometries
from geotween.data.problems import Problem
from geotween.data.simplify import simplify
from geotween.data.small import drop_small
from geotween.scene.model import Map

# Widest gap along a common border that cleaning closes, in px: what is wider can be seen, and may
# be meant.
WIDEST_GAP = 2.0


@dataclass(frozen=True, eq=False)
class Tidied:
    """The features of each step and of each static layer, and the layers that move, in order."""

    steps: list[list[Feature]]
    static: list[list[Feature]]
    layers: tuple[str, ...]
    problems: list[Problem]


def tidy(
    steps: Sequence[Sequence[Feature]],
    static: Sequence[Sequence[Feature]],
    labels: Sequence[str],
    frame: Map,
    scale: float,
) -> Tidied:
    """Disjoint, clean and simplified features; ``scale`` is in px for a unit of the data."""
    layered, layers = class_layers(steps, frame)
    problems: list[Problem] = []
    parts: list[list[Feature]] = []  # those of the first step, layer by layer, then of the second
    for label, step in zip(labels, layered, strict=True):
        for layer in layers:
            of_layer = [feature for feature in step if feature.layer == layer]
            part, found = _disjoint(of_layer, label, frame, scale)
            parts.append(part)
            problems += found
    sets = [geometries_of(part) for part in parts]
    if frame.min_area:
        names = [label for label in labels for _ in layers]
        sets, found = _without_small(sets, names, frame.min_area / scale**2)
        problems += found
    ground = [_apart(geometries_of(features)) for features in static]
    beneath = [shapes for of_layer in ground for shapes in of_layer]
    simple = simplify([*sets, *beneath], frame.simplify / scale)
    moving = [with_geometries(part, shapes) for part, shapes in zip(parts, simple, strict=False)]
    rest = iter(simple[len(sets) :])
    return Tidied(
        [
            [feature for part in moving[i : i + len(layers)] for feature in part]
            for i in range(0, len(moving), len(layers))
        ],
        [
            with_geometries(
                features, np.concatenate([np.empty(0, object), *(next(rest) for _ in shapes)])
            )
            for features, shapes in zip(static, ground, strict=True)
        ],
        layers,
        problems,
    )


def _disjoint(
    features: list[Feature], label: str, frame: Map, scale: float
) -> tuple[list[Feature], list[Problem]]:
    if len(features) < 2:
        return features, []
    if frame.clean and looks_like_coverage(geometries_of(features)):
        gap = WIDEST_GAP / scale
        return clean_coverage(features, gap_width=gap, snapping=-1, step=label)
    apart, problems = separate(features, step=label)
    return apart, problems + coverage_faults(geometries_of(apart), step=label)


def _without_small(
    sets: list[Shapes], labels: Sequence[str], area: float
) -> tuple[list[Shapes], list[Problem]]:
    kept, counts, areas = drop_small(sets, area)
    message = "parts and holes too small to matter were left out"
    return kept, [
        Problem(
            "small parts",
            "note",
            f"{message}: {count} of them",
            (label,),
            "",
            lost,
            "square map units",
        )
        for label, count, lost in zip(labels, counts, areas, strict=True)
        if count
    ]


def _apart(shapes: Shapes) -> list[Shapes]:
    """Static shapes as sets without overlaps: all in one where they are disjoint, else one each."""
    if len(shapes) == 0:
        return []
    return (
        [shapes]
        if shapely.coverage_is_valid(shapes)
        else [shapes[i : i + 1] for i in range(len(shapes))]
    )
