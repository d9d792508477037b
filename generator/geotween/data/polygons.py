"""Polygon sets: the polygons of one step, with the identity of each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon, Polygon

Key = str | int
Shapes = NDArray[np.object_]  # (Multi)Polygons

# Two places nearer than this share of the data's extent are the same place. Double precision
# leaves some 1e-16 of the coordinates; a map shows 1e-4 of its width.
RELATIVE_TOLERANCE = 1e-9

# Farther from the origin than this, in extents of the data, double precision no longer tells its
# places apart as finely as a page shows them.
FARTHEST = 1e10

REGIONS = "regions"  # the layer of what moves, unless its classes have layers of their own


@dataclass(frozen=True)
class Identity:
    """Who a polygon is: its feature's key and class, and the layer that it moves in.

    A feature without a key of its own has its position in the set as key, and is not ``keyed``:
    that position says nothing about other steps. ``attributes`` are the source's further columns.
    """

    key: Key
    class_: str | None = None
    keyed: bool = False
    name: str = ""
    layer: str = REGIONS
    attributes: Mapping[str, object] = field(default_factory=dict, compare=False)

    @property
    def called(self) -> str:
        """What it is called in problems: its name, its key, or its position in the set."""
        if self.name or self.keyed:
            return self.name or str(self.key)
        return f"polygon {int(self.key) + 1}"


@dataclass(frozen=True)
class Feature:
    """A (Multi)Polygon of a step as its source gives it, and its position there."""

    geometry: Polygon | MultiPolygon
    key: Key | None = None
    class_: str | None = None
    name: str = ""
    position: int | None = None
    layer: str = REGIONS
    attributes: Mapping[str, object] = field(default_factory=dict, compare=False)


@dataclass(frozen=True, eq=False)
class PolygonSet:
    """The polygons at one time: valid, outer rings counter-clockwise, holes clockwise.

    ``polygons`` is an object array of shape (n,); ``identities`` is parallel to it. The parts of
    a MultiPolygon are polygons of their own that share an identity.
    """

    polygons: NDArray[np.object_]
    identities: tuple[Identity, ...]

    def __len__(self) -> int:
        return len(self.identities)

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Smallest x, smallest y, largest x, largest y; NaN for an empty set."""
        return shapely.total_bounds(self.polygons) if len(self) else np.full(4, np.nan)

    @property
    def layers(self) -> list[str]:
        """The layers of its polygons, each once."""
        return list(dict.fromkeys(i.layer for i in self.identities))

    def in_layer(self, layer: str) -> PolygonSet:
        """The polygons of one layer."""
        return self.chosen(np.array([i.layer == layer for i in self.identities], dtype=bool))

    def chosen(self, mask: NDArray[np.bool_]) -> PolygonSet:
        """The polygons where a mask (n,) is True."""
        identities = tuple(i for i, kept in zip(self.identities, mask, strict=True) if kept)
        return PolygonSet(self.polygons[mask], identities)


def polygon_set(features: Iterable[Feature]) -> PolygonSet:
    """Features as a polygon set, MultiPolygons taken apart; geometries must be valid."""
    listed = list(features)
    identities = []
    for index, feature in enumerate(listed):
        position = index if feature.position is None else feature.position
        keyed = feature.key is not None
        key = position if feature.key is None else feature.key
        identities.append(
            Identity(key, feature.class_, keyed, feature.name, feature.layer, feature.attributes)
        )
    geometries = np.array([f.geometry for f in listed], dtype=object)
    parts, owners = shapely.get_parts(geometries, return_index=True)
    oriented = shapely.orient_polygons(parts, exterior_cw=False)
    return PolygonSet(oriented, tuple(identities[owner] for owner in owners))


def bounds_of(sets: Sequence[PolygonSet]) -> NDArray[np.float64]:
    """The bounds (4,) of some sets together; all 0 where all are empty."""
    boxes = np.array([s.bounds for s in sets if len(s)])
    if not len(boxes):
        return np.zeros(4)
    return np.concatenate([boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)])


def name_of(feature: Feature, index: int) -> str:
    """What a feature is called in problems: its name, its key, or its position in the set."""
    if feature.name or feature.key is not None:
        return feature.name or str(feature.key)
    position = index if feature.position is None else feature.position
    return f"polygon {position + 1}"


def geometries_of(features: Sequence[Feature]) -> Shapes:
    """The geometries (n,) of some features."""
    return np.array([feature.geometry for feature in features], dtype=object)


def with_geometries(features: Sequence[Feature], shapes: Shapes) -> list[Feature]:
    """Features in other shapes; those of which nothing is left are left out."""
    return [
        feature if shape is feature.geometry else replace(feature, geometry=shape)
        for feature, shape in zip(features, shapes, strict=True)
        if not shape.is_empty
    ]


def bounds(features: Sequence[Feature]) -> NDArray[np.float64]:
    """The bounds (4,) of some features together."""
    return np.asarray(shapely.total_bounds(geometries_of(features)))


def extent(bounds: NDArray[np.float64]) -> float:
    """The larger side of some bounds, in the data's units."""
    return float((bounds[2:] - bounds[:2]).max())


def too_far(bounds: NDArray[np.float64]) -> bool:
    """Whether data in some bounds lie too far from the origin for their size."""
    return bool(extent(bounds) * FARTHEST < np.abs(bounds).max())


def moved(polygons: PolygonSet, way: NDArray[np.float64]) -> PolygonSet:
    """A set moved by a vector (2,)."""
    return PolygonSet(
        shapely.transform(polygons.polygons, partial(np.add, way)), polygons.identities
    )


def fit_into(polygons: PolygonSet, frame: NDArray[np.float64]) -> PolygonSet:
    """A set scaled uniformly and centred into a frame (bounds), as in the paper's Figure 9."""
    return PolygonSet(fitted(polygons.polygons, frame), polygons.identities)


def fitted(geometries: Shapes, frame: NDArray[np.float64]) -> Shapes:
    """Geometries scaled uniformly, together, and centred into a frame."""
    if not len(geometries):
        return geometries
    box = shapely.total_bounds(geometries)
    size, room = box[2:] - box[:2], frame[2:] - frame[:2]
    scale = (room / size).min()
    shift = (frame[:2] + frame[2:]) / 2 - scale * (box[:2] + box[2:]) / 2
    return shapely.transform(geometries, lambda points: points * scale + shift)
