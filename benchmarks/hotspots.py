"""Time points to hotspots, beside the Gaussian filter alone on the same grid.

Both run in turns, so that a busy machine slows both; each figure is a median. Prints Markdown.
"""

from __future__ import annotations

import argparse
import os
import platform
import time

import contourpy
import numpy as np
import scipy
import shapely
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from geotween.data.steps.hotspots import CELLS_PER_BANDWIDTH, Grid, Hotspots, grid_over, hotspots

POINTS, PERIODS, PLACES = 100_000, 12, 40
LEVELS = (0.1, 0.3, 0.6)
SIDE = 100.0  # map units in which the places lie
BANDWIDTH = 0.75
BAR = 5  # times what the filter takes


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeat", type=int, default=9, metavar="N", help="runs, at least 3")
    repeat = max(3, parser.parse_args().repeat)

    points, period = incidents()
    grid = grid_over(points, BANDWIDTH, PERIODS)
    assert min(grid.shape) >= 512  # the bar is for no smaller grid
    _, found = contour(points, period)  # imports, caches
    runs = [(contour(points, period)[0], filtered(grid)) for _ in range(repeat)]
    ours, theirs = np.median(runs, axis=0)

    print("| points | periods | grid | vertices | hotspots, ms | filter alone, ms | ratio |")
    print("|---:|---:|---:|---:|---:|---:|---:|")
    size = f"{grid.shape[1]} × {grid.shape[0]}"
    vertices = shapely.get_num_coordinates(np.array(found.polygons, dtype=object)).sum()
    print(
        f"| {POINTS:,} | {PERIODS} | {size} | {vertices:,} "
        f"| {ours:.0f} | {theirs:.0f} | {ours / theirs:.1f} |\n"
    )
    print(f"{len(LEVELS)} levels; medians of {repeat} runs in turns. {_versions()}.\n")
    verdict = "met" if ours < BAR * theirs else "missed"
    print(f"- at most {BAR} times the filter alone: {ours / theirs:.1f}, {verdict}")


def incidents() -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """Seeded points around places of different spread that come and go."""
    random = np.random.default_rng(20)
    centres = random.uniform(0, SIDE, (PLACES, 2))
    spreads = random.uniform(1, 5, PLACES)
    place, period = random.integers(0, PLACES, POINTS), random.integers(0, PERIODS, POINTS)
    place = (place * (period + 1) // PERIODS) % PLACES
    return centres[place] + spreads[place, None] * random.normal(size=(POINTS, 2)), period


def contour(points: NDArray[np.float64], period: NDArray[np.intp]) -> tuple[float, Hotspots]:
    """The ms from points to polygons, and these."""
    start = time.perf_counter()
    found = hotspots(points, period, PERIODS, levels=LEVELS, relative=True, bandwidth=BANDWIDTH)
    return (time.perf_counter() - start) * 1e3, found


def filtered(grid: Grid) -> float:
    """The ms of scipy's filter, as it comes, with the same kernel, once per period."""
    counts = np.random.default_rng(0).random((PERIODS, *grid.shape))
    start = time.perf_counter()
    for count in counts:
        gaussian_filter(count, CELLS_PER_BANDWIDTH, mode="constant")
    return (time.perf_counter() - start) * 1e3


def _versions() -> str:
    return (
        f"{os.cpu_count()} cores, Python {platform.python_version()}, numpy {np.__version__}, "
        f"scipy {scipy.__version__}, contourpy {contourpy.__version__}, "
        f"shapely {shapely.__version__}"
    )


if __name__ == "__main__":
    main()
