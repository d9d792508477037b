"""Triangle meshes of twenty polygons, real and made: their quality, sizes and speed.

Run it from the project's folder, ``python -m benchmarks.meshes``. The real outlines are the largest
parts of states and of a fire's perimeters (shared/data beside the project); without them only the
made ones are shown. Prints Markdown: quality of each polygon, then time against size. Seconds are
those of the processor.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Mapping
from functools import partial

import numpy as np
import shapely
from shapely.geometry import Polygon

from geotween.mesh.advancing_front import advancing_front
from geotween.mesh.mesh import Mesh
from geotween.mesh.quadtree import quadtree
from geotween.mesh.quality import GOOD, quality
from tests.mesh.outlines import blob, made, real

TECHNIQUES: Mapping[str, Callable[[Polygon], Mesh]] = {
    "advancing front": advancing_front,
    "quadtree": quadtree,
    "quadtree, depth 7": partial(quadtree, depth=7),
}

EDGES = (90, 180, 400, 900, 2_000)  # of the blobs whose times are compared


def _timed(technique: Callable[[Polygon], Mesh], polygon: Polygon) -> tuple[Mesh, float]:
    start = time.process_time()
    mesh = technique(polygon)
    return mesh, time.process_time() - start


def qualities(technique: Callable[[Polygon], Mesh], polygons: Mapping[str, Polygon]) -> None:
    """Print a row for each polygon, and what holds for all."""
    print(f"| polygon | edges | triangles | per edge | share ≥ {GOOD:g} | worst | seconds |")
    print("|---|" + "---:|" * 6)
    shares = []
    for name, polygon in polygons.items():
        mesh, seconds = _timed(technique, polygon)
        values = quality(mesh)
        shares.append(np.mean(values >= GOOD))
        edges = len(shapely.get_coordinates(polygon)) - 1 - len(polygon.interiors)
        count = len(mesh.triangles)
        print(
            f"| {name} | {edges:,} | {count:,} | {count / edges:.1f} "
            f"| {shares[-1]:.1%} | {values.min():.3f} | {seconds:.2f} |"
        )
    print(f"\nMean share {np.mean(shares):.1%}, least {min(shares):.1%}.\n")


def growth(technique: Callable[[Polygon], Mesh]) -> None:
    """Print how time grows with the number of triangles, for blobs of more and more edges."""
    print("| triangles | seconds |\n|---:|---:|")
    counts, times = [], []
    for edges in EDGES:
        mesh, seconds = _timed(technique, blob(edges, 0.35, 5))
        counts.append(len(mesh.triangles))
        times.append(seconds)
        print(f"| {counts[-1]:,} | {seconds:.2f} |")
    exponent = np.polyfit(np.log(counts), np.log(times), 1)[0]
    print(f"\nTime grows with the number of triangles to the power of {exponent:.2f}.\n")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("technique", nargs="?", choices=TECHNIQUES, default="advancing front")
    technique = TECHNIQUES[parser.parse_args().technique]
    technique(blob(20, 0.3, 3))  # imports are not what is timed
    qualities(technique, made() | real())
    growth(technique)


if __name__ == "__main__":
    main()
