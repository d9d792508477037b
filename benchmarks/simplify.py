"""Time the simplification of polygon sets, beside shapely's, which takes each set on its own.

    python benchmarks/simplify.py counties.geojson states.geojson

Tolerances are pixels of a map 960 pixels wide. "In common" counts the edges that two sets share
afterwards: what one set's simplification does not know of another's, it tears apart. Each time is
the best of the runs. Prints Markdown.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.polygons import Feature
from geotween.data.tidy.repair import repair
from geotween.data.tidy.simplify import simplify

Shapes = NDArray[np.object_]
PIXELS = (0.25, 0.5, 1, 2, 5, 10, 20)
WIDTH = 960
BAR = 0.4  # seconds at any of the tolerances, for the 84,000 vertices of counties and states


def read(path: Path) -> Shapes:
    """The valid shapes of a GeoJSON file."""
    listed = json.loads(path.read_text(encoding="utf-8"))["features"]
    given = [Feature(shapely.from_geojson(json.dumps(f["geometry"]))) for f in listed]
    return np.array([feature.geometry for feature in repair(given)[0]], dtype=object)


def one_by_one(sets: Sequence[Shapes], tolerance: float) -> list[Shapes]:
    """Each set by shapely's coverage simplification, whose tolerance is the root of an area."""
    return [shapely.coverage_simplify(shapes, tolerance) for shapes in sets]


def best(call: Callable[[], list[Shapes]], repeat: int) -> tuple[float, list[Shapes]]:
    times = []
    for _ in range(repeat):
        start = time.perf_counter()
        result = call()
        times.append(time.perf_counter() - start)
    return min(times), result


def vertices(sets: Sequence[Shapes]) -> int:
    return int(shapely.get_num_coordinates(np.concatenate(sets)).sum())


def in_common(sets: Sequence[Shapes]) -> int:
    """How many undirected edges consecutive sets have in common."""
    found = []
    for shapes in sets:
        paths = [ring.coords[:] for ring in shapely.get_rings(shapely.get_parts(shapes))]
        found.append({frozenset(edge) for path in paths for edge in pairwise(path)})
    return sum(len(one & other) for one, other in pairwise(found))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("steps", nargs="+", type=Path, help="GeoJSON files, one per step")
    parser.add_argument("--repeat", type=int, default=5)
    options = parser.parse_args()
    sets = [read(path) for path in options.steps]
    box = shapely.total_bounds(np.concatenate(sets))
    print(f"{vertices(sets):,} vertices, {in_common(sets):,} edges in common\n")
    print("| px | ms | vertices | in common | shapely: ms | vertices | in common |")
    print("|" + "---:|" * 7)
    slowest = 0.0
    for pixels in PIXELS:
        tolerance = pixels * (box[2] - box[0]) / WIDTH
        cells = []
        for way in (simplify, one_by_one):
            seconds, result = best(lambda: way(sets, tolerance), options.repeat)  # noqa: B023
            cells += [f"{seconds * 1e3:.0f}", f"{vertices(result):,}", f"{in_common(result):,}"]
            slowest = max(slowest, seconds) if way is simplify else slowest
        print(f"| {pixels} | {' | '.join(cells)} |")
    met = "met" if slowest < BAR else "missed"
    print(f"\nBar: below {BAR:.1f} s at every tolerance: {met} ({slowest:.2f} s).")


if __name__ == "__main__":
    main()
