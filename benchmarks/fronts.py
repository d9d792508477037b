"""What fronts promise, and what they cost: tilings, fires whose arrival is known, and real sets.

Run it from the project's folder, ``python -m benchmarks.fronts``. Each way of moving is a row: ours
as ``front`` and as ``auto``, flubber (flubber_tracks.py says how it is asked) and signed distances
(distance_tracks.py). The first table has the figures of front_looks.py, of a set's worst
transition; the second compares half-way shapes with what had burnt by then; the third is about
time. Then the bars, for ours. Prints Markdown.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import astuple, dataclass, fields
from functools import cache, partial
from itertools import pairwise
from pathlib import Path

import numpy as np
import shapely
from shapely.geometry import MultiPolygon

import geotween
from benchmarks.distance_tracks import distance_tracks, halfway
from benchmarks.flubber_tracks import flubber_tracks, missing
from benchmarks.front_looks import FRAMES, Look, look
from geotween.data.polygons import Feature, polygon_set
from geotween.motion.morph import plan
from geotween.motion.techniques import resolve
from geotween.motion.tracks import Track
from tests.motion.front import tilings
from tests.motion.front.fires import fire
from tests.motion.front.tilings import Geometry, Transition, polygons_at
from tests.real_data import SETS, write_scene

Bar = tuple[str, str, bool]

FEW = 5  # frames of large tilings
MANY = 20  # more polygons are too many for signed distances

CLOSED, CLOSED_ON_GRID = 1e-9, 1e-6
LINEAR = 0.005
FLASH, FLASH_OF_KEY = 3.0, 4.0
BETTER, BETTER_CLEAR = 0.005, 0.012
CREEK, COUNTIES, TILING, POWER = 30.0, 60.0, 60.0, 1.3  # s, and cells to the power of
TILES = (750, 1_500, 3_000)


@dataclass(frozen=True)
class Set:
    """Transitions, in how many frames they are looked at, and whether they are tilings."""

    name: str
    transitions: list[Transition]
    frames: int = FRAMES
    tiled: bool = False


def sets(pairs: int) -> Mapping[str, Callable[[], Set]]:
    """What may be looked at, by name."""

    def tiled(make: Callable[[int, int], Transition], count: int) -> Set:
        name, number = f"{make.__name__}, {count:,} cells", max(1, pairs * 14 // count)
        frames = FRAMES if count <= 100 else FEW
        return Set(name, [make(k, count) for k in range(number)], frames, tiled=True)

    found: dict[str, Callable[[], Set]] = {
        f"{make.__name__}-{count}": partial(tiled, make, count)
        for count in (14, 100, 1_000, 3_000)
        for make in (tilings.moving, tilings.keyed)
    }
    found["fires"] = lambda: Set("fires", [_keyed(*halves(k).ends) for k in range(pairs)])
    found["creek"] = lambda: Set("Creek", list(_steps("wildfire_creek2020")))
    return found


def ours(transition: Transition, method: str) -> Sequence[Track]:
    return plan(*transition, resolve(method)).tracks


WAYS: Mapping[str, Callable[[Transition], Sequence[Track]]] = {
    "front": partial(ours, method="front"),
    "auto": partial(ours, method="auto"),
    "flubber": lambda transition: flubber_tracks(*transition, resolve("auto")),
    "signed distance": partial(distance_tracks, frames=FRAMES),
}
OURS, DISTANCE = ("front", "auto"), "signed distance"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairs", type=int, default=10, metavar="N", help="of each small set")
    parser.add_argument("--fires", type=int, default=80, metavar="N", help="to compare half-way")
    parser.add_argument("--sets", nargs="*", help="by name; or halfway, or time")
    parser.add_argument("--ways", nargs="*", default=list(WAYS), choices=WAYS)
    options = parser.parse_args()
    known = sets(options.pairs)
    every = [*known, "halfway", "time"]
    chosen = options.sets or every
    if not set(chosen) <= set(every):
        parser.error(f"sets are {', '.join(every)}")
    ways = [way for way in options.ways if way != "flubber" or not missing()]
    if "flubber" in options.ways and missing():
        print(f"Without flubber: {missing()}.\n")
    if not SETS.is_dir():
        print("Without the real sets: they are not beside the project.\n")
        chosen = [name for name in chosen if name != "creek"]

    bars: list[Bar] = []
    looked = [known[name] for name in chosen if name in known]
    if looked:
        bars += _looks(looked, ways)
    if "halfway" in chosen:
        bars += _halfway(options.fires, ways)
    if "time" in chosen:
        bars += _times([way for way in ways if way in OURS])
    print("| bar | measured | |\n|---|---:|---|")
    for text, measured, met in bars:
        print(f"| {text} | {measured} | {'met' if met else 'missed'} |")


# Looks at frames.


def _looks(chosen: Iterable[Callable[[], Set]], ways: Iterable[str]) -> list[Bar]:
    heads = [one.name.replace("_", " ") for one in fields(Look)]
    print(f"| set | way | transitions | frames | {' | '.join(heads)} | s |")
    print("|---|---|" + "---:|" * (3 + len(heads)))
    bars: list[Bar] = []
    for make in chosen:
        of = make()
        for way in ways:
            if way == DISTANCE and of.tiled and len(of.transitions[0][0]) > MANY:
                continue
            start = time.perf_counter()
            given = [_one(t) if way == DISTANCE and not of.tiled else t for t in of.transitions]
            motions = [WAYS[way](transition) for transition in given]
            spent = time.perf_counter() - start
            found = [
                look(*both, of.frames, tiled=of.tiled, stills=way == DISTANCE)
                for both in zip(motions, given, strict=True)
            ]
            worst = Look(*np.max([astuple(one) for one in found], axis=0).tolist())
            cells = " | ".join(map(_cell, astuple(worst)))
            row = f"| {of.name} | {way} | {len(found)} | {of.frames} | {cells} | {spent:.1f} |"
            print(row, flush=True)
            bars += _bars(of, way, worst) if way in OURS else []
    print()
    return bars


def _bars(of: Set, way: str, worst: Look) -> Iterator[Bar]:
    def bar(what: str, value: float, most: float) -> Bar:
        return f"{of.name}, {way}: {what}", _cell(value), bool(value <= most)

    exact = [worst.overlap, worst.gap, worst.ends, worst.lost, worst.moved]
    yield bar(f"overlap to moved at most {CLOSED:g}", float(np.nanmax(exact)), CLOSED)
    yield bar(f"on the grid at most {CLOSED_ON_GRID:g}", worst.on_grid, CLOSED_ON_GRID)
    yield bar(f"area off at most {LINEAR:.1%}", worst.area_off, LINEAR)
    yield bar(f"group off at most {LINEAR:.1%}", worst.group_off, LINEAR)
    if of.frames == FRAMES:
        most = FLASH_OF_KEY if of.tiled else FLASH
        yield bar(f"retreat at most {CLOSED:g}", worst.retreat, CLOSED)
        yield bar("no islands", worst.islands, 0.0)
        yield bar(f"flash at most {most:g}", worst.flash, most)


# Half-way shapes and the truth.


@dataclass(frozen=True, eq=False)
class Halves:
    """Perimeters of a fire at both ends, and between: at half the time, at half the area."""

    ends: tuple[Geometry, Geometry]
    truths: tuple[Geometry, Geometry]


def halves(seed: int, *, clear: bool = True) -> Halves:
    """As ``pair`` of tests/motion/front/fires.py; or large ones that may reach the map's edge."""
    burning, random = _fire(seed), np.random.default_rng([seed, 1])
    rim = np.concatenate([burning.arrival[[0, -1]].ravel(), burning.arrival[:, [0, -1]].ravel()])
    most = float((burning.arrival < 0.98 * rim.min()).mean()) if clear else 1.0
    last = min(most, random.uniform(0.2, 0.5))
    first = last * random.uniform(0.4, 0.8)
    begin, end = (burning.when_burnt(share) for share in (first, last))
    times = (begin, end, (begin + end) / 2, burning.when_burnt((first + last) / 2))
    one, other, *truths = (_shape(burning.perimeter(t)) for t in times)
    return Halves((one, other), (truths[0], truths[1]))


_fire = cache(fire)


def _halfway(count: int, ways: Iterable[str]) -> list[Bar]:
    """How much half-way shapes have in common with the truth, as a share of both together."""
    found: dict[str, list[list[float]]] = {}
    for seed in range(count):
        for clear in (False, True):
            of = halves(seed, clear=clear)
            shapes = halfway(*of.ends)
            for way in ways:
                if way != DISTANCE:
                    drawn, _ = polygons_at(WAYS[way](_keyed(*of.ends)), 0.5)
                    shapes[way] = shapely.union_all(drawn)
            for way, shape in shapes.items():
                found.setdefault(way, []).append([_likeness(shape, t) for t in of.truths])
    which = ("all, half the time", "all, half the area", "clear, half the time")
    heads = (*which, "clear, half the area")
    print(f"| half-way IoU, mean of {count} fires | {' | '.join(heads)} |")
    print("|---|" + "---:|" * len(heads))
    means = {way: np.reshape(rows, (count, 4)).mean(axis=0) for way, rows in found.items()}
    for way, row in means.items():
        print(f"| {way} | {' | '.join(f'{value:.4f}' for value in row)} |")
    print()
    plain = np.max([row for way, row in means.items() if way.startswith(DISTANCE)], axis=0)
    least = (BETTER, BETTER, BETTER_CLEAR, BETTER_CLEAR)
    return [
        (f"{head}: {way} above signed distance by {bar}", f"{more:.4f}", bool(more >= bar))
        for way in means
        if way in OURS
        for head, more, bar in zip(heads, means[way] - plain, least, strict=True)
    ]


def _likeness(one: Geometry, other: Geometry) -> float:
    return float(shapely.intersection(one, other).area / shapely.union(one, other).area)


# Time.


def _times(ways: Sequence[str]) -> list[Bar]:
    """What plan, tracks and certificate take together."""
    print("| planned, tracked, certified | way | s | of a processor, s | certified |")
    print("|---|---|---:|---:|---:|")
    tasks: list[tuple[str, Callable[[], Iterable[Transition]], float]] = [
        (f"keyed, {count:,} cells", partial(_keyed_tiling, count), TILING) for count in TILES
    ]
    if SETS.is_dir():
        tasks.append(("Creek", partial(_steps, "wildfire_creek2020"), CREEK))
        tasks.append(("counties to states", partial(_steps, "scale_us_counties"), COUNTIES))
    bars: list[Bar] = []
    for way in ways:
        taken = []
        for name, transitions, most in tasks:
            given = list(transitions())
            start, work = time.perf_counter(), time.process_time()
            motions = [plan(*transition, resolve(way)) for transition in given]
            proved = sum(len(m.tracks) > 0 and m.certificate.valid for m in motions)
            taken.append(time.perf_counter() - start)
            worked = time.process_time() - work
            figures = f"{taken[-1]:.1f} | {worked:.1f} | {proved} of {len(given)}"
            print(f"| {name} | {way} | {figures} |", flush=True)
            bars.append((f"{name}, {way}: in {most:g} s", f"{taken[-1]:.1f} s", taken[-1] < most))
        power = np.log(taken[len(TILES) - 1] / taken[0]) / np.log(TILES[-1] / TILES[0])
        what = f"keyed, {way}: grows with at most the power {POWER} of the cells"
        bars.append((what, f"{power:.2f}", bool(power <= POWER)))
    print()
    return bars


def _keyed_tiling(count: int) -> list[Transition]:
    return [tilings.keyed(0, count)]


def _steps(name: str) -> Iterator[Transition]:
    """The transitions of a real set."""
    with tempfile.TemporaryDirectory() as folder:
        scene = geotween.load(write_scene(Path(folder), name))
    return pairwise(step.regions for step in scene.steps)


def _one(transition: Transition) -> Transition:
    """A set whose polygons are one thing."""
    one, other = (shapely.union_all(end.polygons) for end in transition)
    return _keyed(one, other)


def _keyed(one: Geometry, other: Geometry) -> Transition:
    """A thing at both ends."""
    before, after = (polygon_set([Feature(_shape(end), key="fire")]) for end in (one, other))
    return before, after


def _shape(geometry: shapely.Geometry) -> MultiPolygon:
    return MultiPolygon([part for part in shapely.get_parts(geometry) if part.area > 0])


def _cell(value: float) -> str:
    if np.isnan(value):
        return ""
    if value >= 1:
        return f"{value:.2f}"
    return f"{value:.2%}" if value >= 5e-5 else f"{value:.0e}" if value else "0"


if __name__ == "__main__":
    main()
