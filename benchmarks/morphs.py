"""How good morphs look, ours and flubber's: made transitions of each family, and real sets.

Run it from the project's folder, ``python -m benchmarks.morphs``. Each way of moving is a row: a
morph by each of our matchings, a front, our default, and flubber (flubber_tracks.py says how it is
asked). "Proved" counts the transitions in which the sweep over continuous time finds nothing wrong.
Invalid time and mean area are means over the transitions, all else is the worst of them; seconds
are those of planning, all transitions together. A set with ``:back`` after its name is played
backwards. Prints Markdown.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np

import geotween
from benchmarks.flubber_tracks import flubber_tracks, missing
from geotween.data.polygons import PolygonSet
from geotween.motion.measure import Measures, measure
from geotween.motion.plan import plan_layers
from geotween.motion.sweep import sweep
from geotween.motion.techniques import resolve
from geotween.motion.tracks import Track
from tests.motion.made import FAMILIES, KEYED, made
from tests.real_data import write_scene

FRAMES = 201
BACK = ":back"
FIG9 = "us_fig9_split-px"
SETS = (FIG9, FIG9 + BACK, "wildfire_creek2020", "us_regions")

SHOWN = ("overlap", "invalid_time", "area_mean", "lost", "boundary_moved", "inexact_ends")
AVERAGED = ("invalid_time", "area_mean")

Transition = tuple[PolygonSet, PolygonSet]
Way = Callable[[str, Transition], tuple[Track, ...]]


def ours(
    name: str, transition: Transition, method: str, matching: str | None = None
) -> tuple[Track, ...]:
    """A method's motion; by one matching and no other where that is named."""
    layers = plan_layers(*transition, resolve(method, _correspondence(name), matching=matching))
    return tuple(track for layer in layers for track in layer.tracks)


def flubber(name: str, transition: Transition) -> tuple[Track, ...]:
    return flubber_tracks(*transition, resolve("auto", _correspondence(name)))


def _correspondence(name: str) -> str | None:
    """By key where the polygons of both ends are the same things, else the default."""
    return "key" if name in KEYED else None


WAYS: Mapping[str, Way] = {
    "rotation": partial(ours, method="morph", matching="rotation"),
    "trajectory": partial(ours, method="morph", matching="trajectory"),
    "front": partial(ours, method="front"),
    "auto": partial(ours, method="auto"),
    "flubber": flubber,
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairs", type=int, default=20, metavar="N", help="of each family")
    parser.add_argument("--families", nargs="*", default=list(FAMILIES), choices=FAMILIES)
    parser.add_argument("--frames", type=int, default=FRAMES, metavar="N", help="of a transition")
    parser.add_argument("--sets", nargs="*", default=list(SETS), help="of the real ones")
    parser.add_argument("--ways", nargs="*", default=list(WAYS), choices=WAYS)
    options = parser.parse_args()
    ways = [way for way in options.ways if way != "flubber" or not missing()]
    if "flubber" in options.ways and missing():
        print(f"Without rows for flubber: {missing()}.\n")

    heads = [head.replace("_", " ") for head in SHOWN]
    print(f"| set | way | transitions | proved | {' | '.join(heads)} | s |")
    print("|---|---|" + "---:|" * (3 + len(heads)))
    for family in options.families if options.pairs else ():
        _report(family, [made(family, k) for k in range(options.pairs)], ways, options.frames)
    for name in options.sets:
        _report(name, list(_steps(name)), ways, options.frames)


def _report(name: str, transitions: list[Transition], ways: Iterable[str], frames: int) -> None:
    """A line for each way."""
    for way in ways:
        start = time.perf_counter()
        motions = [WAYS[way](name, transition) for transition in transitions]
        spent = time.perf_counter() - start
        proved = sum(map(_is_proved, motions))
        found = [
            measure(tracks, *transition, frames)
            for tracks, transition in zip(motions, transitions, strict=True)
        ]
        cells = " | ".join(_cells(found))
        print(f"| {name} | {way} | {len(found)} | {proved} | {cells} | {spent:.1f} |", flush=True)


def _is_proved(tracks: Iterable[Track]) -> bool:
    """Whether the sweep finds nothing wrong in any layer, and leaves nothing undecided."""
    layers: dict[str, list[Track]] = {}
    for track in tracks:
        layers.setdefault(track.layer, []).append(track)
    return all(sweep(mine).clean for mine in layers.values())


def _cells(found: list[Measures]) -> Iterator[str]:
    for name in SHOWN:
        column = np.array([getattr(one, name) for one in found])
        value = column.mean() if name in AVERAGED else column.max()
        yield f"{value:.2%}" if value >= 5e-5 else f"{value:.0e}" if value else "0"


def _steps(name: str) -> Iterator[Transition]:
    """The transitions of a real set, in order."""
    with tempfile.TemporaryDirectory() as folder:
        steps = geotween.load(write_scene(Path(folder), name.removesuffix(BACK))).steps
    for before, after in pairwise(reversed(steps) if name.endswith(BACK) else steps):
        yield before.regions, after.regions


if __name__ == "__main__":
    main()
