"""The front motion of one layer: cut, compare, time, coarsen, film."""

from __future__ import annotations

from dataclasses import dataclass

from geotween.data.polygons import PolygonSet
from geotween.data.problems import Problem
from geotween.motion.front.changes import changes
from geotween.motion.front.field import arrival
from geotween.motion.front.film import tracks_of
from geotween.motion.front.flaws import flaws
from geotween.motion.front.levels import Arrivals, levels
from geotween.motion.sweep import Proof, sweep
from geotween.motion.tracks import Track


@dataclass(frozen=True, eq=False)
class Fronts:
    """The tracks of a front motion, the arrivals that they were made from, and what is proved.

    Where the arrivals keep their contract (levels.py) nothing overlaps by construction.
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
    change = changes(origin, target, annexation=annexation)
    arrivals = levels(change, arrival(change), resolution)
    tracks = tracks_of(arrivals, change.things, layer)
    found = flaws(arrivals, change)
    if not found:
        return Fronts(tracks, arrivals, (), Proof((), (), 0, 0, 0.0))
    hint = "look for slivers in the data"
    problems = tuple(Problem("front", "error", flaw, hint=hint) for flaw in found)
    return Fronts(tracks, arrivals, problems, sweep(tracks))
