"""What signed distances make of a transition, as tracks that are measured like ours.

At t a key has all places where (1 - t) of their signed distance from where it is at first and t of
that from where it is at last are below 0 together: level sets, as painters of keyframes and of
medical slices take them. Each key goes by its own. What begins or ends has itself at the other end,
shrunk to its innermost point. The distances are sampled on a grid of ``NODES`` along its larger
side, and contoured.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely
from contourpy import FillType, contour_generator
from numpy.typing import NDArray

from geotween.data.polygons import Identity, PolygonSet, bounds_of, extent
from geotween.motion.rings import rings_of
from geotween.motion.tracks import Track
from tests.motion.front.fires import signed_distance
from tests.motion.front.tilings import Geometry, Transition

Floats = NDArray[np.float64]

NODES = 160

# The still of t = 1 is there from so long before on: a track that ends at 1 is there at 1.
LAST = 1e-9


def distance_tracks(transition: Transition, frames: int) -> tuple[Track, ...]:
    """A still of each key at each of ``frames`` evenly spaced times, until the next one."""
    moments = np.linspace(0, 1, frames)
    lives = [*pairwise([*moments[:-1].tolist(), 1 - LAST]), (1 - LAST, 1.0)]
    places = _places(bounds_of(transition))
    tracks: list[Track] = []
    for who in dict.fromkeys(name for end in transition for name in end.identities):
        before, after = _distances([_area_of(end, who) for end in transition], places)
        for t, life in zip(moments.tolist(), lives, strict=True):
            mixed = shapely.get_parts(_below((1 - t) * before + t * after, places, 0.0))
            tracks += [_still(part, who, life) for part in mixed if part.area > 0]
    return tuple(tracks)


def halfway(one: Geometry, other: Geometry) -> dict[str, Geometry]:
    """The shape half-way between two by their signed distances, and that of their mean area."""
    places = _places(shapely.total_bounds([one, other]))
    middle = np.mean(_distances([one, other], places), axis=0)
    cell = (places[0, 1, 0] - places[0, 0, 0]) ** 2
    level = float(np.quantile(middle, (one.area + other.area) / 2 / (middle.size * cell)))
    return {
        "signed distance": _below(middle, places, 0.0),
        "signed distance, mean area": _below(middle, places, level),
    }


def _area_of(end: PolygonSet, who: Identity) -> Geometry:
    return shapely.union_all(end.polygons[[identity == who for identity in end.identities]])


def _places(box: Floats) -> Floats:
    """Places (rows, columns, 2), evenly spaced, in a box (4,) and somewhat around it."""
    spacing = extent(box) / NODES
    low, high = box[:2] - 3 * spacing, box[2:] + 4 * spacing
    x, y = (np.arange(a, b, spacing) for a, b in zip(low, high, strict=True))
    return np.stack(np.meshgrid(x, y), axis=-1)


def _distances(shapes: Sequence[Geometry], places: Floats) -> list[Floats]:
    """The signed distances of places from two shapes, of which one may be empty."""
    one, other = (
        None
        if shape.is_empty
        else signed_distance(shape, places.reshape(-1, 2)).reshape(places.shape[:2])
        for shape in shapes
    )
    if one is None:
        assert other is not None
        return [other - other.min(), other]
    return [one, one - one.min() if other is None else other]


def _below(values: Floats, places: Floats, level: float) -> Geometry:
    """Where values on a grid are below a level."""
    x, y = np.moveaxis(places, -1, 0)
    lines = contour_generator(x=x, y=y, z=values, fill_type=FillType.OuterOffset)
    polygons = [
        shapely.Polygon(rings[0], rings[1:])
        for points, offsets in zip(*lines.filled(-np.inf, level), strict=True)
        for rings in [np.split(points, offsets[1:-1])]
    ]
    return shapely.union_all(shapely.make_valid(np.array(polygons, dtype=object)))


def _still(polygon: shapely.Polygon, who: Identity, life: tuple[float, float]) -> Track:
    rings = rings_of(np.array([shapely.orient_polygons(polygon)], dtype=object))
    vertices = np.stack([rings.vertices] * 2)
    seams = np.zeros(len(rings.vertices), dtype=np.uint8)
    return Track(who, (who, who), who.layer, np.array(life), vertices, rings.offsets, seams)
