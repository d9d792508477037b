"""Polygon sets: the polygons of one step, with the identity of each."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon, Polygon

Key = str | int

# Two places nearer than this share of the data's extent are the same place. Double precision
# leaves some 1e-16 of the coordinates; a map shows 1e-4 of its width.
RELATIVE_TOLERANCE = 1e-9

# Farther from the origin than this, in extents of the data, double precision no longer tells its
# places apart as finely as a page shows them.
FARTHEST = 1e10

REGIONS = "regions"  # the one layer that moves


@dataclass(frozen=True)
class Identity:
    """Who a polygon is: its feature's key and class.

    A feature without a key of its own has its position in the set as key, and is not ``keyed``:
    that position says nothing about other steps.
    """

    key: Key
    class_: str | None = None
    keyed: bool = False
    name: str = ""


@dataclass(frozen=True)
class Feature:
    """A (Multi)Polygon of a step as its source gives it, and its position there."""

    geometry: Polygon | MultiPolygon
    key: Key | None = None
    class_: str | None = None
    name: str = ""
    position: int | None = None


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


def polygon_set(features: Iterable[Feature]) -> PolygonSet:
    """Features as a polygon set, MultiPolygons taken apart; geometries must be valid."""
    listed = list(features)
    identities = []
    for index, feature in enumerate(listed):
        position = index if feature.position is None else feature.position
        keyed = feature.key is not None
        key = position if feature.key is None else feature.key
        identities.append(Identity(key, feature.class_, keyed, feature.name))
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
    if not len(polygons):
        return polygons
    box = polygons.bounds
    size, room = box[2:] - box[:2], frame[2:] - frame[:2]
    scale = (room / size).min()
    shift = (frame[:2] + frame[2:]) / 2 - scale * (box[:2] + box[2:]) / 2
    fitted = shapely.transform(polygons.polygons, lambda points: points * scale + shift)
    return PolygonSet(fitted, polygons.identities)
