"""Time a whole scene of US counties and states, read to simplified, beside a floor.

The floor is what it takes at least to look at such data: GDAL's read, repair, and one union. Both
run in turns, so that a busy machine slows both; each figure is a median. Prints Markdown.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

import numpy as np
import pyogrio
import shapely

import geotween

COUNTIES = Path(__file__).resolve().parents[2] / "shared" / "data" / "scale_us_counties"
SCENE = """title: Counties and states
data: {{file: {file}, key: id}}
map: {{clean: true}}
"""
BAR = 3  # times the floor


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", nargs="?", type=Path, default=COUNTIES)
    parser.add_argument("--repeat", type=int, default=7, metavar="N", help="runs, at least 3")
    options = parser.parse_args()
    files = sorted(options.folder.glob("*.geojson"))
    if not files:
        parser.error(f"no .geojson in {options.folder}: name a folder")
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / "scene.yaml"
        scene.write_text(SCENE.format(file=options.folder), encoding="utf-8")
        loaded = geotween.load(scene)  # imports, caches
        floor(files)
        runs = [(timed(scene), floor(files)) for _ in range(max(3, options.repeat))]
    ours, theirs = np.median(runs, axis=0)
    vertices = sum(shapely.get_num_coordinates(s.regions.polygons).sum() for s in loaded.steps)
    print(f"{len(files)} files; {vertices:,} vertices are left\n")
    print("| | ms |\n|---|---:|")
    print(f"| geotween.load: read, repaired, projected, cleaned, simplified | {1e3 * ours:.0f} |")
    print(f"| pyogrio's read and union_all of the repaired | {1e3 * theirs:.0f} |")
    verdict = "met" if ours <= BAR * theirs else "missed"
    print(f"\nratio {ours / theirs:.2f}; bar {BAR}: {verdict}")


def timed(scene: Path) -> float:
    start = time.perf_counter()
    geotween.load(scene)
    return time.perf_counter() - start


def floor(files: list[Path]) -> float:
    start = time.perf_counter()
    for file in files:
        _, _, binary, _ = pyogrio.raw.read(file)
        shapes = shapely.from_wkb(binary)
        shapely.union_all(shapely.make_valid(shapes, method="structure", keep_collapsed=False))
    return time.perf_counter() - start


if __name__ == "__main__":
    main()
