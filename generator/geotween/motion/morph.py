"""The motion from one set of polygons to another, as Python code asks for it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from shapely.geometry import MultiPolygon, Point, Polygon

from geotween.data.polygons import (
    Feature,
    Key,
    PolygonSet,
    bounds_of,
    fit_into,
    polygon_set,
    too_far,
)
from geotween.data.problems import Problem
from geotween.data.tidy.repair import repair
from geotween.displayed import Displayed
from geotween.motion.certify import Certificate, LayerMotion, certify
from geotween.motion.divide import NOBODY, divide
from geotween.motion.plan import plan_layers
from geotween.motion.techniques import Techniques, resolve
from geotween.motion.tracks import Frame, Track, frame

LARGEST = 1e100  # squares of larger coordinates overflow

Shape = Polygon | MultiPolygon
Shapes = Sequence[Shape] | Mapping[str, Shape]


@dataclass(frozen=True)
class PiecePair:
    """An origin piece and the target piece it becomes; a Point where one of them is nothing.

    The keys are those of the polygons that the pieces are cut from, or their positions where
    they have no key; None where there is no polygon.
    """

    origin: Polygon | Point
    target: Polygon | Point
    origin_key: Key | None
    target_key: Key | None


@dataclass(frozen=True, eq=False)
class Morph(Displayed):
    """The motion from one set of polygons to another, layer by layer."""

    layers: tuple[LayerMotion, ...]
    problems: tuple[Problem, ...] = ()

    @cached_property
    def tracks(self) -> tuple[Track, ...]:
        """The moving regions of all layers."""
        return tuple(track for layer in self.layers for track in layer.tracks)

    def frame(self, t: float) -> Frame:
        """The regions drawn at t in [0, 1], after easing.

        Raises
        ------
        ValueError
            Where t is outside [0, 1].
        """
        return frame(self.tracks, t)

    @cached_property
    def pairs(self) -> tuple[PiecePair, ...]:
        """The paper's SPL: the list of one-to-one pairs of pieces.

        What a front moves is divided for this list only.
        """
        divisions = (d for layer in self.layers for d in (layer.division, divide(layer.swept)))
        return tuple(
            PiecePair(one, other, _key(division.origin, i), _key(division.target, j))
            for division in divisions
            for one, other, (i, j) in zip(
                division.origin_pieces, division.target_pieces, division.indices, strict=True
            )
        )

    @cached_property
    def certificate(self) -> Certificate:
        """What is proved and measured of this motion, over all t in [0, 1]."""
        return certify(self.layers, self.problems)


def morph(
    origin: Shapes,
    target: Shapes,
    method: str = "auto",
    *,
    correspondence: str | None = None,
    division: str | None = None,
    matching: str | None = None,
    path: str | None = None,
    radius: float | None = None,
    annexation: str | None = None,
    fit: str = "shared",
) -> Morph:
    """The motion that turns one set of polygons into another.

    Parameters
    ----------
    origin, target
        Polygons or MultiPolygons in planar coordinates, in a sequence, or by key. Equal keys are
        the same thing over time; the parts of a MultiPolygon move on their own.
    method
        ``paper``: correspondence by intersection, Voronoi division, rotation, straight lines.
        ``morph``: correspondence by keys that both sets have, else by shared area; matching by
        trajectory. What is not proved is moved in other ways, and at last as a front.
        ``front``: nothing travels; what changes is swept, place by place.
        ``auto``: what changes in place is a front, what travels is a morph.
    correspondence, division, matching, path
        Another technique for one stage of a morph; where a matching is named, no other is tried.
    radius
        How far polygons may lie apart that correspond, in their units; with ``within``.
    annexation
        ``sweep`` or ``in-place``: how a front takes over a neighbour as a whole.
    fit
        ``each`` scales the target uniformly and centres it in the origin's box first.

    Raises
    ------
    ValueError
        For an unknown name, and for coordinates that are not finite, or so far from the origin
        that double precision cannot tell the polygons' places apart.
    TypeError
        For anything but polygons.
    """
    techniques = resolve(method, correspondence, division, matching, path, radius, annexation)
    if fit not in ("shared", "each"):
        raise ValueError(f"fit is shared or each, not {fit!r}")
    origin_set, origin_problems = _read(origin, "origin")
    target_set, target_problems = _read(target, "target")
    if too_far(bounds_of([origin_set, target_set])):
        raise ValueError("the polygons lie too far from the origin for their size; shift them")
    if fit == "each" and len(origin_set):
        target_set = fit_into(target_set, origin_set.bounds)
    layers = plan_layers(origin_set, target_set, techniques)
    return Morph(layers, (*origin_problems, *target_problems))


def plan(
    origin: PolygonSet,
    target: PolygonSet,
    techniques: Techniques,
    resolution: float | None = None,
) -> Morph:
    """The motion between two polygon sets, as ``plan_layers`` makes it."""
    return Morph(plan_layers(origin, target, techniques, resolution))


def _read(shapes: Shapes, name: str) -> tuple[PolygonSet, list[Problem]]:
    """A polygon set from what ``morph`` was given; positions count in the sequence as given."""
    if isinstance(shapes, Polygon | MultiPolygon):
        what = type(shapes).__name__
        raise TypeError(f"{name} is a {what}; expected a sequence of polygons, or a mapping")
    keyed = isinstance(shapes, Mapping)
    features = []
    items: Iterable[tuple[Key, Shape]] = (
        shapes.items() if isinstance(shapes, Mapping) else enumerate(shapes)
    )
    for position, (key, shape) in enumerate(items):
        what = f"{name}[{key!r}]"
        if not isinstance(shape, Polygon | MultiPolygon):
            raise TypeError(
                f"{what} is a {type(shape).__name__}; expected a Polygon or MultiPolygon"
            )
        if not (np.abs(shapely.get_coordinates(shape)) < LARGEST).all():
            raise ValueError(f"{what} has coordinates that are not finite, or beyond {LARGEST:g}")
        if not shape.is_empty:
            flat = shapely.force_2d(shape)
            features.append(Feature(flat, key if keyed else None, position=position))
    kept, problems = repair(features, step=name)
    return polygon_set(kept), problems


def _key(polygons: PolygonSet, index: int) -> Key | None:
    return None if index == NOBODY else polygons.identities[index].key
