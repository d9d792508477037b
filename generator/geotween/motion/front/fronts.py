"""The front motion of one layer: cut, compare, time, coarsen, film."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from geotween.data.polygons import PolygonSet
from geotween.data.problems import Problem
from geotween.motion.front.changes import changes
from geotween.motion.front.field import arrival
from geotween.motion.front.film import tracks_of
from geotween.motion.front.flaws import flaws
from geotween.motion.front.levels import Arrivals, levels
from geotween.motion.looks import polygons_with
from geotween.motion.sweep import Proof, sweep
from geotween.motion.tracks import Track

NOTHING_WRONG = Proof((), (), 0, 0, 0.0)


@dataclass(frozen=True, eq=False)
class Fronts:
    """The tracks of a front motion, the arrivals that they were made from, and what is proved.

    Where the arrivals keep their contract (levels.py), and the tracks' polygons are simple, nothing
    overlaps by construction; else the tracks are swept.
    """

    tracks: tuple[Track, ...]
    arrivals: Arrivals
    problems: tuple[Problem, ...]
    proof: Proof


def front(
    origin: PolygonSet,
    target: PolygonSet,
    layer: str,
    resolution: float,
    annexation: str = "sweep",
) -> Fronts:
    """Move a layer by fronts: what is common rests, what changes is swept.

    ``resolution`` is what nobody sees, in the data's units: half a pixel.
    """
    if not len(origin) and not len(target):
        return Fronts((), _never(), (), NOTHING_WRONG)
    change = changes(origin, target, annexation=annexation)
    arrivals = levels(change, arrival(change), resolution)
    tracks = tracks_of(arrivals, change.things, layer)
    found = flaws(arrivals, change)
    if not found and _simple(tracks):
        return Fronts(tracks, arrivals, (), NOTHING_WRONG)
    hint = "look for slivers in the data"
    problems = tuple(Problem("front", "error", flaw, hint=hint) for flaw in found)
    return Fronts(tracks, arrivals, problems, sweep(tracks))


def _never() -> Arrivals:
    """The arrivals of a plane that is empty."""
    one, two, three = (np.empty((0, n), dtype=np.intp) for n in (1, 2, 3))
    places, times = np.empty((0, 2)), np.empty((0, 3))
    return Arrivals(places, three, times, one[:, 0], one[:, 0], two, two, two)


def _simple(tracks: Sequence[Track]) -> bool:
    """Whether all polygons are valid in the middle between two of their key times.

    Where arrivals have no flaw their structure is the same all the time in between.
    """
    for k in range(max((len(track.times) - 1 for track in tracks), default=0)):
        mine = [track for track in tracks if k + 1 < len(track.times)]
        middles = [(track.vertices[k] + track.vertices[k + 1]) / 2 for track in mine]
        if not shapely.is_valid(polygons_with(mine, middles)).all():
            return False
    return True
