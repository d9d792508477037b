"""Ways to move one set into another, side by side: the paper's, ours, flubber's."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import geotween
from benchmarks.flubber_tracks import flubber_tracks, missing
from docs.draw.experiments.divisions import FRAMES
from docs.draw.experiments.shapes import Polygons, Transition
from docs.draw.experiments.tables import percent, table, yes
from geotween.data.polygons import Feature, PolygonSet, polygon_set
from geotween.motion.measure import Measures, measure
from geotween.motion.sweep import sweep
from geotween.motion.techniques import resolve
from geotween.motion.tracks import Track

PAPER, MORPH, FRONT, AUTO, FLUBBER = "paper", "morph", "front", "auto", "flubber"
LOCK = Path(__file__).parents[3] / "benchmarks" / "package-lock.json"


@dataclass(frozen=True, eq=False)
class Moved:
    """A motion, its measures, whether it is proved for all t, and the motions that it consists of.

    ``kinds`` says by which motions the tracks were made; nothing where it is not ours.
    """

    tracks: Sequence[Track]
    seen: Measures
    proved: bool
    kinds: str = ""


def sets_of(transition: Transition) -> tuple[PolygonSet, PolygonSet]:
    """Both ends as sets without keys."""
    origin, target = (polygon_set(map(Feature, end)) for end in transition)
    return origin, target


def ours(transition: Transition, method: str, matching: str | None = None) -> Moved:
    """A motion of ours; with a matching named, nothing else is tried."""
    found = geotween.morph(*transition, method, matching=matching)
    names = found.certificate.ways.values()
    fronts = sum(way.get(FRONT, 0) for way in names)
    whole = sum(sum(way.values()) for way in names)
    kinds = MORPH if not fronts else FRONT if fronts == whole else f"{FRONT}, {MORPH}"
    return _moved(found.tracks, transition, kinds)


def flubbers(transition: Transition) -> Moved:
    """Flubber's motion; ``missing`` says whether it can be asked."""
    return _moved(flubber_tracks(*sets_of(transition), resolve(AUTO)), transition, "")


def _moved(tracks: Sequence[Track], transition: Transition, kinds: str) -> Moved:
    seen = measure(tracks, *sets_of(transition), FRAMES)
    return Moved(tracks, seen, sweep(tracks).clean, kinds)


WAYS: Mapping[str, Callable[[Transition], Moved]] = {
    PAPER: partial(ours, method=PAPER),
    MORPH: partial(ours, method=MORPH, matching="trajectory"),
    FRONT: partial(ours, method=FRONT),
    AUTO: partial(ours, method=AUTO),
    FLUBBER: flubbers,
}


def asked(names: Sequence[str]) -> list[str]:
    """The ways that can be gone here: flubber needs Node."""
    return [name for name in names if name != FLUBBER or not missing()]


def flubber_said() -> str:
    """Which flubber was run; or why none was."""
    reason = missing()
    if reason:
        return f"flubber was not run when this page was made: {reason}."
    lock = json.loads(LOCK.read_text(encoding="utf-8"))
    version = lock["packages"]["node_modules/flubber"]["version"]
    return f"flubber {version} was run for this page, as `benchmarks/flubber_tracks.py` asks it."


def compared(cases: Mapping[str, Mapping[str, Moved]]) -> str:
    """A table of motions, by case and way."""
    rows = [
        [
            case,
            way,
            *map(percent, (moved.seen.overlap, moved.seen.invalid_time, moved.seen.lost)),
            *map(percent, (moved.seen.boundary_moved, moved.seen.area_mean)),
            *map(percent, (moved.seen.inexact_ends,)),
            yes(moved.proved),
        ]
        for case, ways in cases.items()
        for way, moved in ways.items()
    ]
    heads = ["set", "way", "overlap", "invalid frames", "laid bare", "common boundary moved"]
    return table([*heads, "area off", "ends missed", "proved"], rows, words=2)


def reversed_(transition: Transition) -> Transition:
    """Time backwards."""
    origin: Polygons
    origin, target = transition
    return target, origin
