"""Interpolate matched pieces, and the whole way from two sets of polygons to their motion."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon, Point, Polygon

from geotween.data.polygons import (
    REGIONS,
    RELATIVE_TOLERANCE,
    Feature,
    Identity,
    Key,
    PolygonSet,
    bounds_of,
    extent,
    fit_into,
    moved,
    polygon_set,
    too_far,
)
from geotween.data.problems import Problem
from geotween.data.tidy.repair import repair
from geotween.motion import divide as divisions
from geotween.motion import match as matchings
from geotween.motion.certify import Certificate, LayerMotion, certify
from geotween.motion.correspond import check_technique, correspond
from geotween.motion.divide import NOBODY, divide
from geotween.motion.match import Matching, match
from geotween.motion.seams import share_vertices
from geotween.motion.tracks import Frame, Track, frame

LARGEST = 1e100  # squares of larger coordinates overflow

# Farther from the origin than this, in extents of the data, sets are planned near it.
NEAR = 1e3

Shape = Polygon | MultiPolygon
Shapes = Sequence[Shape] | Mapping[str, Shape]


@dataclass(frozen=True)
class Techniques:
    """The name of each stage's technique; ``radius`` is that of correspondence ``within``.

    ``retries`` are matchings for a layer that the first one does not prove.
    """

    correspondence: str
    division: str
    matching: str
    retries: tuple[str, ...] = ()
    radius: float | None = None


METHODS: Mapping[str, Techniques] = {
    "paper": Techniques("intersects", "voronoi", "rotation"),
    "auto": Techniques("auto", "voronoi", "rotation", ("trajectory",)),
}


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
class Morph:
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
        """The paper's SPL: the list of one-to-one pairs of pieces."""
        return tuple(
            PiecePair(one, other, _key(division.origin, i), _key(division.target, j))
            for division in (layer.division for layer in self.layers)
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
    radius: float | None = None,
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
        ``auto``: correspondence by keys that both sets have, else by shared area; matching by
        trajectory where polygons would cross by rotation, none is divided, and that proves it;
        the rest as in the paper.
    correspondence, division, matching
        Another technique for one stage.
    radius
        How far polygons may lie apart that correspond, in their units; with ``within``.
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
    techniques = resolve(method, correspondence, division, matching, radius)
    if fit not in ("shared", "each"):
        raise ValueError(f"fit is shared or each, not {fit!r}")
    origin_set, origin_problems = _read(origin, "origin")
    target_set, target_problems = _read(target, "target")
    if too_far(bounds_of([origin_set, target_set])):
        raise ValueError("the polygons lie too far from the origin for their size; shift them")
    if fit == "each" and len(origin_set):
        target_set = fit_into(target_set, origin_set.bounds)
    planned = plan(origin_set, target_set, techniques)
    return Morph(planned.layers, (*origin_problems, *target_problems))


def resolve(
    method: str,
    correspondence: str | None = None,
    division: str | None = None,
    matching: str | None = None,
    radius: float | None = None,
) -> Techniques:
    """The technique of each stage: the one named, else the method's.

    Raises
    ------
    ValueError
        For an unknown name, and for a radius where it does not belong.
    """
    default = METHODS[_known(method, METHODS, "method")]
    check_technique(correspondence or default.correspondence, radius)
    return Techniques(
        correspondence or default.correspondence,
        _known(division or default.division, divisions.TECHNIQUES, "division"),
        _known(matching or default.matching, matchings.TECHNIQUES, "matching"),
        () if matching else default.retries,
        radius,
    )


def plan(origin: PolygonSet, target: PolygonSet, techniques: Techniques) -> Morph:
    """Correspond, divide, match and interpolate two sets, each layer on its own.

    Sets far from the origin are planned near it, where coordinates have digits to spare.
    """
    box = bounds_of([origin, target])
    size, middle = extent(box), (box[:2] + box[2:]) / 2
    if np.abs(middle).max() > NEAR * size:
        near = _plan(moved(origin, -middle), moved(target, -middle), techniques, size)
        return _moved_back(near, origin, target, middle)
    return _plan(origin, target, techniques, size)


def _plan(origin: PolygonSet, target: PolygonSet, techniques: Techniques, size: float) -> Morph:
    layers = dict.fromkeys([*origin.layers, *target.layers]) or [REGIONS]
    return Morph(
        tuple(
            _plan_layer(origin.in_layer(layer), target.in_layer(layer), techniques, layer, size)
            for layer in layers
        )
    )


def _plan_layer(
    origin: PolygonSet, target: PolygonSet, techniques: Techniques, layer: str, size: float
) -> LayerMotion:
    """A layer's motion: by the first matching, or by another one that is proved where it is not.

    Pieces of a divided polygon stay with the first: other matchings can part their seams.
    """
    related = correspond(origin, target, techniques.correspondence, techniques.radius)
    divided = divide(related, techniques.division)

    def by(matching: str) -> LayerMotion:
        matched = match(divided, matching)
        tracks, problems = interpolate(matched, layer, RELATIVE_TOLERANCE * size)
        return LayerMotion(layer, tracks, divided, (*divided.problems, *problems), matching, tracks)

    first = by(techniques.matching)
    if not techniques.retries or first.proof.clean or any(t.seams.any() for t in first.tracks):
        return first
    others = (by(matching) for matching in techniques.retries)
    return next((other for other in others if other.proof.clean), first)


def _moved_back(
    morph: Morph, origin: PolygonSet, target: PolygonSet, way: NDArray[np.float64]
) -> Morph:
    back = partial(np.add, way)
    return Morph(
        tuple(
            replace(
                motion,
                division=replace(
                    motion.division,
                    origin=origin.in_layer(motion.layer),
                    target=target.in_layer(motion.layer),
                    origin_pieces=shapely.transform(motion.division.origin_pieces, back),
                    target_pieces=shapely.transform(motion.division.target_pieces, back),
                ),
                tracks=tuple(replace(t, vertices=t.vertices + way) for t in motion.tracks),
            )
            for motion in morph.layers
        )
    )


def interpolate(
    matching: Matching, layer: str, tolerance: float
) -> tuple[tuple[Track, ...], list[Problem]]:
    """Tracks on which matched vertices travel on straight lines.

    Both sides of a seam get the same vertices first; ``tolerance`` is in the data's units.
    """
    division = matching.division
    shared = share_vertices(matching.pieces, division.indices, tolerance)
    problems = []
    if shared.missing:
        message = "seams have vertices on one side only and may show as hairlines"
        problems.append(
            Problem("open seam", "note", message, measure=shared.missing, unit="vertices")
        )
    origin_keys = {i.key for i in division.origin.identities if i.keyed}
    target_keys = {i.key for i in division.target.identities if i.keyed}
    times = np.array([0.0, 1.0])
    tracks = []
    for (i, j), piece in zip(division.indices, shared.pieces, strict=True):
        here = division.origin.identities[i] if i != NOBODY else None
        there = division.target.identities[j] if j != NOBODY else None
        ends = (here or there, there or here)
        assert ends[0] is not None
        assert ends[1] is not None
        bearer = _bearer(ends[0], ends[1], origin_keys, target_keys)
        tracks.append(
            Track(
                bearer, (ends[0], ends[1]), layer, times, piece.vertices, piece.offsets, piece.seams
            )
        )
    return tuple(tracks), problems


def _bearer(
    origin: Identity, target: Identity, origin_keys: set[Key], target_keys: set[Key]
) -> Identity:
    """Whose key a piece bears: the target's where only the target's lives on, else the origin's.

    A key lives on where both sets have it.
    """
    origin_lives = origin.keyed and origin.key in target_keys
    target_lives = target.keyed and target.key in origin_keys
    return target if target_lives and not origin_lives else origin


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


def _known(name: str, table: Mapping[str, object], what: str) -> str:
    if name not in table:
        raise ValueError(f"unknown {what} {name!r}; expected one of {', '.join(sorted(table))}")
    return name
