"""Tidy sets: layers of disjoint polygons, as fine as the page can show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import shapely

from geotween.data.polygons import Feature, Shapes, geometries_of, with_geometries
from geotween.data.problems import Problem
from geotween.data.tidy.coverage import clean_coverage, coverage_faults, looks_like_coverage
from geotween.data.tidy.identity import class_layers
from geotween.data.tidy.overlaps import separate
from geotween.data.tidy.simplify import simplify
from geotween.data.tidy.small import drop_small
from geotween.scene.model import Map

# Widest gap along a common border that cleaning closes, in px: what is wider can be seen, and may
# be meant.
WIDEST_GAP = 2.0

SHOWN = 8  # steps listed in a message


@dataclass(frozen=True, eq=False)
class Tidied:
    """The features of each step and of each static layer, and the layers that move, in order.

    ``exact`` are the steps' features before they were simplified, for measures.
    """

    steps: list[list[Feature]]
    exact: list[list[Feature]]
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
    columns = _recurring(steps)
    problems: list[Problem] = []
    if frame.classes == "auto" and len(layers) > 1:
        message = f"classes lie on each other: each is a layer, from below {_listed(layers)}"
        hint = "map: {classes: together} cuts them apart, {class_order: […]} orders them"
        problems.append(Problem("layers", "note", message, hint=hint))
    parts: list[list[Feature]] = []  # those of the first step, layer by layer, then of the second
    for label, step in zip(labels, layered, strict=True):
        for layer in layers:
            of_layer = [feature for feature in step if feature.layer == layer]
            part, found = _disjoint(of_layer, label, frame, scale, columns)
            parts.append(part)
            problems += found
    problems = _told_once(problems)
    sets = [geometries_of(part) for part in parts]
    if frame.min_area:
        names = [label for label in labels for _ in layers]
        sets, found = _without_small(sets, names, frame.min_area / scale**2)
        problems += found
    ground = [_apart(geometries_of(features)) for features in static]
    beneath = [shapes for of_layer in ground for shapes in of_layer]
    simple = simplify([*sets, *beneath], frame.simplify / scale)
    steps_of = partial(_steps, parts, len(layers))
    rest = iter(simple[len(sets) :])
    return Tidied(
        steps_of(simple[: len(sets)]),
        steps_of(sets),
        [
            with_geometries(
                features, np.concatenate([np.empty(0, object), *(next(rest) for _ in shapes)])
            )
            for features, shapes in zip(static, ground, strict=True)
        ],
        layers,
        problems,
    )


def _steps(
    parts: Sequence[list[Feature]], layers: int, sets: Sequence[Shapes]
) -> list[list[Feature]]:
    """The features of each step, in other shapes, from those of each step and layer."""
    new = [with_geometries(part, shapes) for part, shapes in zip(parts, sets, strict=True)]
    return [
        [feature for part in new[i : i + layers] for feature in part]
        for i in range(0, len(new), layers)
    ]


def _disjoint(
    features: list[Feature], label: str, frame: Map, scale: float, columns: Sequence[str]
) -> tuple[list[Feature], list[Problem]]:
    if len(features) < 2:
        return features, []
    gap = WIDEST_GAP / scale
    if frame.clean and looks_like_coverage(geometries_of(features), gap_width=gap):
        return clean_coverage(features, gap_width=gap, snapping=-1, step=label)
    apart, problems = separate(features, step=label, pixel=1 / scale, columns=columns)
    shapes = geometries_of(apart)
    return apart, problems + coverage_faults(shapes, gap_width=gap, step=label)


def _recurring(steps: Sequence[Sequence[Feature]]) -> list[str]:
    """The attributes whose values recur from step to step, and are more than one, as levels are."""
    values: dict[str, list[str]] = {}
    for step in steps:
        for feature in step:
            for column, value in feature.attributes.items():
                values.setdefault(column, []).append(str(value))
    return [name for name, found in values.items() if 1 < len(set(found)) <= len(found) / 2]


def _told_once(problems: Sequence[Problem]) -> list[Problem]:
    """Problems; what befell overlapping features in several steps is told once, in the worst."""
    groups: dict[object, list[Problem]] = {}
    for number, problem in enumerate(problems):
        alike = problem.kind == "overlap" and not problem.piece
        name = (problem.message.partition(":")[0].partition(" of ")[2], problem.severity)
        groups.setdefault(name if alike else number, []).append(problem)
    return [group[0] if len(group) == 1 else _in_all(group) for group in groups.values()]


def _in_all(group: Sequence[Problem]) -> Problem:
    worst = max(group, key=lambda problem: problem.measure)
    others = [problem.steps[0] for problem in group if problem is not worst]
    names = _listed(others)
    count = "1 other step" if len(others) == 1 else f"{len(others)} other steps"
    total = sum(problem.measure for problem in group)
    message = f"{worst.message}, and less in {count}: {names}"
    return replace(worst, message=message, measure=total, unit=f"{worst.unit} in all")


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


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names[:SHOWN]) + (", …" if len(names) > SHOWN else "")
