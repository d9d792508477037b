"""What flubber makes of a transition, as tracks that are measured and proved like ours.

Who becomes whom is what our default correspondence says, group by group, for flubber has no
opinion on it. A group is given to flubber as its README says:

    one to one      interpolate       many to one     combine        nobody to one   fromCircle
    one to many     separate          n to n          interpolateAll  one to nobody   toCircle

``interpolateAll`` takes shapes in order: the order of least squared ways between their centroids.
Where n shapes become m, which no function does, the more numerous go to the nearest of the others,
each of those to one at least. Circles are points, the centroids. Holes flubber does not know.

Coordinates are those of a map of ``WIDTH`` pixels, so that the default ``maxSegmentLength``, 10
pixels, means what it is meant to.
"""

from __future__ import annotations

import json
import shutil
import subprocess
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.polygons import Identity, PolygonSet, bounds_of, extent
from geotween.motion.correspond import correspond
from geotween.motion.groups import grouped
from geotween.motion.techniques import Techniques
from geotween.motion.tracks import Track

Floats = NDArray[np.float64]

WIDTH = 1000.0
# Flubber's vertices travel on straight lines; off them by this share of the width is rounding.
STRAIGHT = 1e-9
TIMES = (0.0, 0.3, 0.7, 1.0)

HERE = Path(__file__).parent


@dataclass(frozen=True, eq=False)
class Call:
    """A function of flubber, what it gets, and the identities at both ends of what comes back."""

    function: str
    arguments: list[Any]
    ends: list[tuple[Identity, Identity]]


@cache
def missing() -> str | None:
    """Why flubber cannot be asked, or None if it can."""
    if not shutil.which("node"):
        return "there is no node on the path"
    if not (HERE / "node_modules" / "flubber").is_dir():
        return "flubber is not installed; npm ci in benchmarks/ does it"
    return None


def flubber_tracks(
    origin: PolygonSet, target: PolygonSet, techniques: Techniques
) -> tuple[Track, ...]:
    """Flubber's motion of all layers; what it refuses is left out, and named on standard error.

    Its vertices are checked to travel on straight lines at an even pace, as ``interpolatePoint``
    in its source says: two key times hold the whole motion.
    """
    box = bounds_of([origin, target])
    scale = WIDTH / (extent(box) or 1.0)
    found = []
    for layer in dict.fromkeys([*origin.layers, *target.layers]):
        ends = origin.in_layer(layer), target.in_layer(layer)
        calls = list(_calls(*ends, techniques, box[:2], scale))
        for call, shapes in zip(calls, _asked(calls), strict=True):
            for who, rings in zip(call.ends, shapes, strict=True):
                found.append(_track(np.array(rings) / scale + box[:2], who, layer, 1 / scale))
    return tuple(found)


def _asked(calls: Sequence[Call]) -> list[list[Any]]:
    """The rings at TIMES of each shape of each call; none for a call that was refused."""
    asked = {"times": TIMES, "calls": [[call.function, call.arguments] for call in calls]}
    command = ["node", str(HERE / "flubber_frames.cjs")]
    done = subprocess.run(
        command, input=json.dumps(asked), stdout=subprocess.PIPE, text=True, check=True
    )
    answers = json.loads(done.stdout)
    for call, answer in zip(calls, answers, strict=True):
        if answer is None:
            call.ends.clear()
    return [answer or [] for answer in answers]


def _calls(
    origin: PolygonSet, target: PolygonSet, techniques: Techniques, corner: Floats, scale: float
) -> Iterator[Call]:
    related = correspond(origin, target, techniques.correspondence, techniques.radius)
    groups = grouped(related)
    here, there = (
        [(shapely.get_coordinates(p.exterior)[:-1] - corner) * scale for p in end.polygons]
        for end in (origin, target)
    )
    for group in range(groups.count):
        ones = np.flatnonzero(groups.of_origin == group).tolist()
        others = np.flatnonzero(groups.of_target == group).tolist()
        for these, those in _clusters([here[k] for k in ones], [there[k] for k in others]):
            yield _call(
                [here[ones[k]] for k in these],
                [there[others[k]] for k in those],
                [origin.identities[ones[k]] for k in these],
                [target.identities[others[k]] for k in those],
            )


def _call(
    here: list[Floats], there: list[Floats], whose: list[Identity], whom: list[Identity]
) -> Call:
    """The call for some rings that become some others: equally many, or one on either side."""
    from_, to = [ring.tolist() for ring in here], [ring.tolist() for ring in there]
    if not here:
        return Call("fromCircle", [*_centroid(there[0]), 0, to[0]], [(whom[0], whom[0])])
    if not there:
        return Call("toCircle", [from_[0], *_centroid(here[0]), 0], [(whose[0], whose[0])])
    if len(here) == len(there) == 1:
        return Call("interpolate", [from_[0], to[0]], [(whose[0], whom[0])])
    if len(here) == 1:
        return Call("separate", [from_[0], to], [(whose[0], one) for one in whom])
    if len(there) == 1:
        return Call("combine", [from_, to[0]], [(one, whom[0]) for one in whose])
    return Call("interpolateAll", [from_, to], list(zip(whose, whom, strict=True)))


def _clusters(here: list[Floats], there: list[Floats]) -> list[tuple[list[int], list[int]]]:
    """Which rings of a group go together into one call."""
    from scipy.optimize import linear_sum_assignment

    if len(here) < 2 or len(there) < 2:
        return [(list(range(len(here))), list(range(len(there))))]
    places, others = (np.array([_centroid(ring) for ring in end]) for end in (here, there))
    ways = ((places[:, None] - others[None]) ** 2).sum(axis=2)
    rows, columns = (k.tolist() for k in linear_sum_assignment(ways))
    if len(here) == len(there):
        return [(rows, columns)]
    if len(here) > len(there):
        return [(ones, others) for others, ones in _joined(ways.T, columns, rows)]
    return _joined(ways, rows, columns)


def _joined(ways: Floats, few: list[int], many: list[int]) -> list[tuple[list[int], list[int]]]:
    """Each of the few (rows) with its own one of the many (columns), and those nearest to it."""
    nearest = ways.argmin(axis=0)
    nearest[many] = few
    return [([k], np.flatnonzero(nearest == k).tolist()) for k in range(len(ways))]


def _centroid(ring: Floats) -> list[float]:
    centroid = shapely.centroid(shapely.Polygon(ring))
    return [centroid.x, centroid.y]


def _track(rings: Floats, ends: tuple[Identity, Identity], layer: str, pixel: float) -> Track:
    """A track from rings (times, n, 2); flubber's may run clockwise, as screens have y down."""
    share = np.array(TIMES)[:, None, None]
    straight = rings[0] * (1 - share) + rings[-1] * share
    assert np.abs(rings - straight).max() <= STRAIGHT * pixel * WIDTH
    x, y = np.moveaxis(rings[[0, -1]], -1, 0)
    if (x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum() < 0:
        rings = rings[:, ::-1]
    times, count = np.array([0.0, 1.0]), rings.shape[1]
    seams = np.zeros(count, dtype=np.uint8)
    return Track(ends[0], ends, layer, times, rings[[0, -1]], np.array([0, count]), seams)
