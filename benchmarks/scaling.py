"""How time grows: one pair of outlines, one polygon that becomes eight, many regions.

All times are those of a processor, of ours and of the peers', in ms.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
import shapely

import geotween
from benchmarks.peers import DISTANCE, NODE, R, asked, missing
from benchmarks.shapes import outline_pair, rough_star
from benchmarks.timing import in_turns
from geotween.motion.morph import plan
from geotween.motion.techniques import resolve
from tests.motion.front import tilings

PAIRS = (100, 300, 1_000, 3_000, 10_000, 20_000, 50_000, 100_000)
EIGHTS = (100, 300, 1_000, 3_000)
TILES = (10, 30, 100, 300, 1_000, 3_000)

# The largest pair that each is given: some grow with the square, some take seconds to begin with.
LARGEST = {
    "flubber": 20_000,
    "polymorph-js": 20_000,
    "d3-interpolate-path": 20_000,
    "separate": 1_000,
    "auto, certified": 20_000,
    DISTANCE: 1_000,
    R: 10_000,
}


@dataclass(frozen=True)
class Series:
    """What one way took, in ms, for each count that it was given; and whether all was proved."""

    way: str
    counts: tuple[int, ...]
    times: tuple[tuple[float, ...], ...]
    certified: bool | None = None

    def at(self, count: int) -> tuple[float, ...]:
        return self.times[self.counts.index(count)]

    def best(self, count: int) -> float:
        return min(self.at(count))


def pairs(repeat: int) -> list[Series]:
    """A pair by ``paper``, without a certificate, by ``auto`` with one, and by the peers."""

    def ways(count: int, found: _Found, stack: ExitStack) -> dict[str, Callable[[], float]]:
        one, other = outline_pair(count)
        ends = [shapely.Polygon(one)], [shapely.Polygon(other)]
        mine = {"paper": partial(_paper, ends)}
        if count <= LARGEST["auto, certified"]:
            mine["auto, certified"] = partial(_certified, ends, found)
        theirs = {
            peer: partial(stack.enter_context(asked(peer)), one, other)
            for peer in (*NODE, DISTANCE, R)
            if count <= LARGEST.get(peer, count) and not missing(peer)
        }
        return mine | theirs

    return _series(PAIRS, ways, repeat)


def eights(repeat: int) -> list[Series]:
    """An outline that becomes eight, which lie where its sectors are."""

    def ways(count: int, found: _Found, stack: ExitStack) -> dict[str, Callable[[], float]]:
        one, parts = eighths(count)
        ends = [shapely.Polygon(one)], [shapely.Polygon(part) for part in parts]
        mine = {
            "paper": partial(_paper, ends),
            "morph, certified": partial(_certified, ends, found, "morph"),
            "auto, certified": partial(_certified, ends, found),
        }
        if count <= LARGEST["separate"] and not missing("separate"):
            separate: Any = stack.enter_context(asked("separate"))
            mine["flubber, separate"] = partial(separate, one, parts)
        return mine

    return _series(EIGHTS, ways, repeat)


def eighths(count: int) -> tuple[np.ndarray, list[np.ndarray]]:
    """An outline of ``count`` vertices, and its eight sectors, somewhat shrunk."""
    ring = rough_star(count, np.random.default_rng([8, count]))
    whole = shapely.Polygon(ring)
    angles = np.arange(9) * np.pi / 4
    rim = 1e4 * np.column_stack([np.cos(angles), np.sin(angles)])
    parts = []
    for start, end in pairwise(rim):
        sector = shapely.Polygon([(0, 0), start, end]).intersection(whole)
        largest = max(shapely.get_parts(sector), key=shapely.area)
        places = shapely.get_coordinates(largest.exterior)[:-1]
        middle = shapely.get_coordinates(largest.centroid)
        parts.append(middle + 0.8 * (places - middle))
    return ring, parts


def regions(repeat: int) -> list[Series]:
    """A tiling of cells with keys, in which some are united, parted, annexed; certified."""

    def ways(count: int, found: _Found, _: ExitStack) -> dict[str, Callable[[], float]]:
        transition = tilings.keyed(0, count)
        return {"auto, certified": partial(_tiling, transition, found)}

    return _series(TILES, ways, repeat)


_Found = list[bool]  # what each certificate said
_Ways = Callable[[int, _Found, ExitStack], dict[str, Callable[[], float]]]


def _series(counts: Sequence[int], ways: _Ways, repeat: int) -> list[Series]:
    taken: dict[str, dict[int, tuple[float, ...]]] = {}
    proved: _Found = []
    for count in counts:
        with ExitStack() as stack:
            for way, times in in_turns(ways(count, proved, stack), repeat).items():
                taken.setdefault(way, {})[count] = tuple(times)
    return [
        Series(
            way,
            tuple(of_way),
            tuple(of_way.values()),
            all(proved) if "certified" in way else None,
        )
        for way, of_way in taken.items()
    ]


def _paper(ends: tuple[list[Any], list[Any]]) -> float:
    start = time.process_time()
    _ = geotween.morph(*ends, method="paper").tracks
    return (time.process_time() - start) * 1e3


def _certified(ends: tuple[list[Any], list[Any]], found: _Found, method: str = "auto") -> float:
    start = time.process_time()
    valid = geotween.morph(*ends, method=method).certificate.valid
    spent = (time.process_time() - start) * 1e3
    found.append(valid)
    return spent


def _tiling(transition: tilings.Transition, found: _Found) -> float:
    start = time.process_time()
    valid = plan(*transition, resolve("auto")).certificate.valid
    spent = (time.process_time() - start) * 1e3
    found.append(valid)
    return spent
