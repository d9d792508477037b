"""The plan of a transition: each layer on its own, from two polygon sets to its tracks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.polygons import (
    REGIONS,
    RELATIVE_TOLERANCE,
    Identity,
    PolygonSet,
    bounds_of,
    extent,
    moved,
)
from geotween.motion.certify import LayerMotion
from geotween.motion.choose import swept_groups
from geotween.motion.correspond import correspond
from geotween.motion.divide import divide
from geotween.motion.front.fronts import front
from geotween.motion.groups import grouped, only
from geotween.motion.ladder import climb
from geotween.motion.sweep import in_other_order
from geotween.motion.techniques import FRONT, Techniques
from geotween.motion.tracks import Track

# Farther from the origin than this, in extents of the data, sets are planned near it.
NEAR = 1e3

# What nobody sees, as a share of the extent, where no page says it: half a pixel of a thousand.
RESOLUTION = 1 / 2000


def plan_layers(
    origin: PolygonSet,
    target: PolygonSet,
    techniques: Techniques,
    resolution: float | None = None,
) -> tuple[LayerMotion, ...]:
    """Correspond, divide, match and interpolate two sets, each layer on its own.

    Sets far from the origin are planned near it, where coordinates have digits to spare.
    ``resolution`` is the length that nobody sees, in the data's units.
    """
    box = bounds_of([origin, target])
    size, middle = extent(box), (box[:2] + box[2:]) / 2
    seen = resolution or RESOLUTION * size
    if np.abs(middle).max() > NEAR * size:
        near = _plan(moved(origin, -middle), moved(target, -middle), techniques, size, seen)
        return _moved_back(near, middle)
    return _plan(origin, target, techniques, size, seen)


def _plan(
    origin: PolygonSet, target: PolygonSet, techniques: Techniques, size: float, resolution: float
) -> tuple[LayerMotion, ...]:
    layers = dict.fromkeys([*origin.layers, *target.layers]) or [REGIONS]
    return tuple(
        _plan_layer(
            origin.in_layer(layer), target.in_layer(layer), techniques, layer, size, resolution
        )
        for layer in layers
    )


def _plan_layer(
    origin: PolygonSet,
    target: PolygonSet,
    techniques: Techniques,
    layer: str,
    size: float,
    resolution: float,
) -> LayerMotion:
    """A layer's motion: first what is swept, all of it together, then what travels."""
    related = correspond(origin, target, techniques.correspondence, techniques.radius)
    groups = grouped(related)
    by_front = swept_groups(related, groups, techniques)
    swept = only(related, groups, by_front)
    fronts = front(swept.origin, swept.target, layer, resolution, techniques.annexation)
    travelling = only(related, groups, ~by_front)
    divided = divide(travelling, techniques.division, techniques.births)
    climbed = climb(
        divided,
        grouped(travelling),
        (techniques.matching, *techniques.retries),
        techniques.path,
        layer,
        RELATIVE_TOLERANCE * size,
        resolution,
        fronts,
    )
    tracks = (*climbed.tracks, *fronts.tracks)
    ways = climbed.ways + (FRONT,) * len(fronts.tracks)
    order = _in_order(tracks, (*origin.identities, *target.identities))
    ranks = np.argsort(order)
    proof = climbed.proof and in_other_order(climbed.proof, ranks.tolist())
    ordered = tuple(tracks[k] for k in order)
    return LayerMotion(
        layer,
        ordered,
        tuple(ways[k] for k in order),
        divided,
        swept,
        (*divided.problems, *fronts.problems, *climbed.problems),
        ordered,
        proof,
    )


def _in_order(tracks: Sequence[Track], identities: Sequence[Identity]) -> NDArray[np.intp]:
    """The order in which tracks are drawn: that of the origin's features, then the target's."""
    places: dict[Identity, int] = {}
    for identity in identities:
        places.setdefault(identity, len(places))
    return np.argsort([places[track.ends[0]] for track in tracks], kind="stable")


def _moved_back(
    layers: tuple[LayerMotion, ...], way: NDArray[np.float64]
) -> tuple[LayerMotion, ...]:
    back = partial(np.add, way)
    return tuple(
        replace(
            motion,
            division=replace(
                motion.division,
                origin=moved(motion.division.origin, way),
                target=moved(motion.division.target, way),
                origin_pieces=shapely.transform(motion.division.origin_pieces, back),
                target_pieces=shapely.transform(motion.division.target_pieces, back),
            ),
            swept=replace(
                motion.swept,
                origin=moved(motion.swept.origin, way),
                target=moved(motion.swept.target, way),
            ),
            tracks=tuple(replace(t, vertices=t.vertices + way) for t in motion.tracks),
        )
        for motion in layers
    )
