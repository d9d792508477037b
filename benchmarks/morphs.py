"""How good morphs look: the measures for made transitions of each family, and for real sets.

Run it from the project's folder, ``python -m benchmarks.morphs``. "No violation" counts what the
sweep over continuous time calls clean, "sound" what is without an invalid frame. Invalid time and
mean area are means over the transitions, all else is the worst of them. Prints Markdown.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Iterable, Iterator
from dataclasses import astuple, fields
from itertools import pairwise
from pathlib import Path

import numpy as np

import geotween
from geotween.data.polygons import PolygonSet
from geotween.motion.measure import Measures, measure
from geotween.motion.morph import plan
from geotween.motion.sweep import sweep
from geotween.motion.tracks import Track
from tests.motion.made import FAMILIES, made, techniques
from tests.real_data import SCENES, write_scene

MATCHINGS = ("rotation", "trajectory")
FRAMES = 201
AVERAGED = ("invalid_time", "area_mean")
HEADS = [field.name.replace("_", " ") for field in fields(Measures)]

Transition = tuple[PolygonSet, PolygonSet]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairs", type=int, default=20, metavar="N", help="of each family")
    parser.add_argument("--frames", type=int, default=FRAMES, metavar="N", help="of a transition")
    parser.add_argument("--sets", nargs="*", default=list(SCENES), help="of the real ones")
    options = parser.parse_args()

    print(f"| set | matching | transitions | no violation | sound | {' | '.join(HEADS)} | s |")
    print("|---|---|" + "---:|" * (4 + len(HEADS)))
    for family in FAMILIES if options.pairs else ():
        _report(family, [made(family, seed) for seed in range(options.pairs)], options.frames)
    for name in options.sets:
        _report(name, list(_steps(name)), options.frames)


def _report(name: str, transitions: list[Transition], frames: int) -> None:
    """A line for each matching."""
    for matching in MATCHINGS:
        start = time.perf_counter()
        chosen = techniques(name, matching)
        motions = [plan(*transition, chosen).tracks for transition in transitions]
        clean = sum(_is_clean(tracks) for tracks in motions)
        found = [
            measure(tracks, *transition, frames)
            for tracks, transition in zip(motions, transitions, strict=True)
        ]
        sound = sum(one.invalid_time == 0 for one in found)
        counts = f"{len(found)} | {clean} | {sound}"
        cells = " | ".join(_cells(found))
        spent = time.perf_counter() - start
        print(f"| {name} | {matching} | {counts} | {cells} | {spent:.0f} |", flush=True)


def _is_clean(tracks: Iterable[Track]) -> bool:
    """Whether the sweep finds nothing wrong in any layer, and leaves nothing undecided."""
    layers: dict[str, list[Track]] = {}
    for track in tracks:
        layers.setdefault(track.layer, []).append(track)
    proofs = [sweep(mine) for mine in layers.values()]
    return not any(proof.violations or proof.undecided for proof in proofs)


def _cells(found: list[Measures]) -> Iterator[str]:
    table = np.array([astuple(one) for one in found])
    for field, column in zip(fields(Measures), table.T, strict=True):
        value = column.mean() if field.name in AVERAGED else column.max()
        yield f"{value:.2%}" if value >= 5e-5 else f"{value:.0e}" if value else "0"


def _steps(name: str) -> Iterator[Transition]:
    """The transitions of a real set, in order."""
    with tempfile.TemporaryDirectory() as folder:
        steps = geotween.load(write_scene(Path(folder), name)).steps
    for before, after in pairwise(steps):
        yield before.regions, after.regions


if __name__ == "__main__":
    main()
