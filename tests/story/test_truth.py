"""A hundred generated scenes, of which every split, merger, move, birth and death is known."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
import shapely
from shapely.affinity import rotate, scale, translate

from geotween.data.polygons import Feature, PolygonSet, polygon_set
from tests.story.pictures import events_of

CELL = 10.0  # side of the square that one of the things lives in; nothing leaves its own
SIDE = 5  # cells of a board

Shapes = list[Any]


@dataclass
class Case:
    """What is in a cell at both ends, and the kinds of events that this makes."""

    kinds: set[str]
    here: Shapes = field(default_factory=list)
    there: Shapes = field(default_factory=list)


def blob(random: np.random.Generator, size: float) -> shapely.Polygon:
    """A star-shaped polygon about the origin, whose radius is about ``size``."""
    count = int(random.integers(8, 20))
    angles = np.arange(count) * 2 * np.pi / count
    radii = size * random.uniform(0.8, 1.2, count)
    return shapely.Polygon(
        np.column_stack([np.cos(angles) * radii, np.sin(angles) * radii])
    )  # fmt: skip


def halves(random: np.random.Generator, count: int) -> Shapes:
    """Strips beside each other with gaps, of nearly equal area."""
    width = 4.5 / count
    strips = [
        shapely.box(-2.25 + k * width, -2, -2.25 + (k + 0.9) * width, 2 + random.uniform(0, 0.2))
        for k in range(count)
    ]
    turn = random.uniform(0, 360)
    return [rotate(strip, turn, origin=(0, 0)) for strip in strips]


def blown_up(shape: Any, factor: float) -> Any:
    return scale(shape, factor, factor, origin=(0, 0))


def case(random: np.random.Generator, kind: str) -> Case:
    one = blob(random, random.uniform(1.0, 2.0))
    width = float(np.sqrt(one.area))
    angle = random.uniform(0, 2 * np.pi)
    way = random.uniform(0.15, 0.6) * width * np.array([np.cos(angle), np.sin(angle)])
    far = random.uniform(0.4, 0.6) * width * np.array([np.cos(angle), np.sin(angle)])
    wider = blown_up(one, random.uniform(1.02, 1.15))
    larger = blown_up(one, random.uniform(1.02, 1.4))
    count = int(random.integers(2, 5))
    parts = halves(random, count)
    hull = shapely.union_all(parts).convex_hull
    spot = translate(blob(random, 0.4), 3.2, 3.2)
    with_spot = shapely.union_all([larger, shapely.box(0, 0, 3.5, 3.5)])
    cases = {
        "stable": Case({"stable"}, [one], [one]),
        "grew": Case({"grew"}, [one], [larger]),
        "shrank": Case({"shrank"}, [larger], [one]),
        "moved": Case({"moved"}, [one], [translate(one, *way)]),
        "moved, grew": Case({"moved", "grew"}, [one], [translate(wider, *far)]),
        "appeared": Case({"appeared"}, [], [one]),
        "vanished": Case({"vanished"}, [one], []),
        "split": Case({"split"}, [hull], parts),
        "merged": Case({"merged"}, parts, [hull]),
        "merged, grew": Case({"merged", "grew"}, [one, spot], [with_spot]),
        "split, shrank": Case({"split", "shrank"}, [with_spot], [one, spot]),
    }
    return cases[kind]


KINDS = (
    "stable", "grew", "shrank", "moved", "moved, grew", "appeared", "vanished", "split", "merged",
    "merged, grew", "split, shrank",
)  # fmt: skip


@pytest.mark.parametrize("keys", [False, True], ids=["without keys", "with keys"])
@pytest.mark.parametrize("seed", range(50))
def test_events_are_those_that_the_scene_was_made_of(seed: int, keys: bool) -> None:
    random = np.random.default_rng([seed, keys])
    ends: tuple[list[Feature], list[Feature]] = ([], [])
    truth: set[tuple[str, frozenset[int], frozenset[int]]] = set()
    for cell in random.permutation(SIDE**2)[: int(random.integers(1, SIDE**2))].tolist():
        at = (CELL * (cell % SIDE), CELL * (cell // SIDE))
        made = case(random, KINDS[int(random.integers(len(KINDS)))])
        places = []
        for end, shapes in zip(ends, (made.here, made.there), strict=True):
            places.append([len(end) + k for k in range(len(shapes))])
            # Of several things in a cell the first one lives on, where one does.
            names = [f"{cell}"] + [f"{cell}, {len(ends[0])}, {k}" for k in range(1, len(shapes))]
            if {"split"} == made.kinds or {"merged"} == made.kinds:
                names = [f"{cell} of {len(shapes)}, {k}" for k in range(len(shapes))]
            end += [
                Feature(translate(shape, *at), name if keys else None)
                for shape, name in zip(shapes, names, strict=False)
            ]
        for kind in made.kinds:
            branching = kind in ("split", "merged", "appeared", "vanished")
            here, there = (p if branching else p[:1] for p in places)
            truth.add((kind, frozenset(here), frozenset(there)))
    found = [
        (event.kind, frozenset(event.before), frozenset(event.after))
        for event in events_of(*placed(ends, random))
    ]
    assert len(found) == len(set(found))
    assert set(found) == truth


def placed(
    ends: tuple[list[Feature], list[Feature]], random: np.random.Generator
) -> tuple[PolygonSet, PolygonSet]:
    """Both sets on a board that is turned and far from the origin."""
    turn, way = random.uniform(0, 360), random.uniform(-1e3, 1e3, 2)
    made = [
        polygon_set(
            Feature(translate(rotate(f.geometry, turn, origin=(0, 0)), *way), f.key) for f in end
        )
        for end in ends
    ]
    return made[0], made[1]
