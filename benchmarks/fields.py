"""Arrival fields compared: how much a front half-way agrees with what had burnt by then.

Run it from the project's folder, ``python -m benchmarks.fields``. Seeded fires whose arrival times
are known (tests/motion/front/fires.py) are halved by both techniques of the field, and by signed
distances between both outlines, as they are and timed so that area grows evenly. Agreement is the
area of what both cover by that of what either covers, over sampled places. Prints Markdown.
"""

from __future__ import annotations

import argparse

import numpy as np
import shapely
from shapely.geometry import MultiPolygon

from geotween.data.polygons import Feature, PolygonSet, polygon_set
from geotween.motion.front.changes import changes
from geotween.motion.front.field import arrival
from tests.motion.front.fires import likeness, pair, signed_distance
from tests.motion.front.test_field_properties import places_in, sampled

TECHNIQUES = ("ratio", "harmonic")
ROWS = (*TECHNIQUES, "signed distance", "signed distance, timed by area")
HALVES = ("area", "time")
PLACES = 250  # along the longer side


def agreements(seed: int, half: str) -> list[float]:
    """The agreement (4,) of each row with the truth, of one fire."""
    origin, target, truth = pair(seed, halfway=half)
    places = places_in(target, PLACES)
    burnt, real = (shapely.contains_xy(area, *places.T) for area in (origin, truth))
    change = changes(_burnt(origin), _burnt(target))
    found = [
        likeness(burnt | (sampled(arrival(change, technique=technique), places) < 0.5), real)
        for technique in TECHNIQUES
    ]
    mean = signed_distance(origin, places) + signed_distance(target, places)
    share = (burnt.mean() + shapely.contains_xy(target, *places.T).mean()) / 2
    found += [likeness(mean < level, real) for level in (0, np.quantile(mean, share))]
    return found


def _burnt(area: MultiPolygon) -> PolygonSet:
    return polygon_set([Feature(area, key="fire")])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--fires", type=int, default=80, help="how many")
    count = parser.parse_args().fires
    means = [np.mean([agreements(seed, half) for seed in range(count)], axis=0) for half in HALVES]
    print("| technique | " + " | ".join(f"half the {half}" for half in HALVES) + " |")
    print("|---|" + "---:|" * len(HALVES))
    for row, *values in zip(ROWS, *means, strict=True):
        print(f"| {row} | " + " | ".join(f"{value:.3f}" for value in values) + " |")


if __name__ == "__main__":
    main()
