"""Identity in a step: one feature for a key, and a layer for each class where classes overlap."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import shapely
from shapely.geometry import MultiPolygon

from geotween.data.polygons import REGIONS, Feature, geometries_of
from geotween.data.problems import Problem
from geotween.data.tidy.overlaps import OVERLAPPING, overlapping
from geotween.scene.model import Map


class TwoClassesError(ValueError):
    """Features of one key and several classes."""


def merge_keys(
    features: Sequence[Feature], *, step: str = ""
) -> tuple[list[Feature], list[Problem]]:
    """Features with one key as one feature; geometries must be valid.

    Attributes on which they do not agree are left out.

    Raises
    ------
    TwoClassesError
        Where their classes differ.
    """
    groups: dict[object, list[Feature]] = {}
    for number, feature in enumerate(features):
        keyed = feature.key is not None
        groups.setdefault(("key", feature.key) if keyed else number, []).append(feature)
    merged = sum(len(group) > 1 for group in groups.values())
    if not merged:
        return list(features), []
    found = [_merged(group) for group in groups.values()]
    message = "features with the same key were merged into one"
    steps = (step,) if step else ()
    return found, [Problem("merged", "note", message, steps, "", float(merged), "keys")]


def class_layers(
    steps: Sequence[Sequence[Feature]], frame: Map
) -> tuple[list[list[Feature]], tuple[str, ...]]:
    """The layer of each feature, and the order of the layers, the lowest first.

    Without ``class_order`` a class lies above those that cover more in the steps that they are
    in, so that of nested classes the inner one is seen.
    """
    classes = dict.fromkeys(f.class_ for step in steps for f in step if f.class_ is not None)
    apart = frame.classes == "layers" or (
        frame.classes == "auto" and len(classes) > 1 and any(map(_overlapping, steps))
    )
    if not apart or not classes:
        return [list(step) for step in steps], (REGIONS,)
    covered: dict[str, list[float]] = {name: [] for name in classes}
    for step in steps:
        for name in {feature.class_ for feature in step} - {None}:
            areas = [f.geometry.area for f in step if f.class_ == name]
            covered[str(name)].append(math.fsum(areas))
    by_area = sorted(classes, key=lambda name: -math.fsum(covered[name]) / len(covered[name]))
    named = [name for name in frame.class_order if name in classes]
    order = [*named, *(name for name in by_area if name not in named)]
    unclassed = REGIONS if REGIONS not in classes else ""  # a class may be called so
    layered = [
        [replace(f, layer=unclassed if f.class_ is None else f.class_) for f in step]
        for step in steps
    ]
    lowest = [unclassed] if any(f.class_ is None for step in steps for f in step) else []
    return layered, tuple(lowest + order)


def _merged(group: list[Feature]) -> Feature:
    first = group[0]
    if len(group) == 1:
        return first
    classes = dict.fromkeys(feature.class_ for feature in group)
    if len(classes) > 1:
        names = " and ".join("none" if name is None else f'"{name}"' for name in classes)
        raise TwoClassesError(f'features with the key "{first.key}" have the classes {names}')
    parts = shapely.get_parts([feature.geometry for feature in group])
    geometry: Any = MultiPolygon(list(parts))
    if not geometry.is_valid:
        geometry = shapely.union_all(parts)
    agreed = {
        name: value
        for name, value in first.attributes.items()
        if all(feature.attributes.get(name) == value for feature in group[1:])
    }
    return replace(first, geometry=geometry, attributes=agreed)


def _overlapping(features: Sequence[Feature]) -> bool:
    """Whether polygons of different classes lie on each other by more than borders may."""
    classed = [feature for feature in features if feature.class_ is not None]
    if len({feature.class_ for feature in classed}) < 2:
        return False
    shapes = geometries_of(classed)
    pairs = overlapping(shapes, shapely.STRtree(shapes))
    return any(
        classed[one].class_ != classed[other].class_
        for one, other in pairs.indices[pairs.share > OVERLAPPING]
    )
