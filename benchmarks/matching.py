"""Matching by trajectory beside matching by rotation: time, and what becomes of the frames.

Frames are counted invalid as shapely sees them; the area is compared with its linear way from end
to end. Prints Markdown.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import contourpy
import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon

from benchmarks.shapes import Outline, outline_pair
from geotween.motion.match import points_at, rotation
from geotween.motion.trajectory import trajectory

COUNTS = (50, 1_000, 10_000, 20_000)
FRAMES = 201
GRID = 300  # cells along each side of the field whose contours are fires
TECHNIQUES = {"rotation": rotation, "trajectory": trajectory}

Pair = tuple[Outline, Outline]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeat", type=int, default=3, metavar="N", help="runs of each")
    parser.add_argument("--pairs", type=int, default=20, metavar="N", help="pairs of each kind")
    options = parser.parse_args()

    print("| vertices | rotation, ms | trajectory, ms | matched vertices |")
    print("|---:|---:|---:|---:|")
    for count in COUNTS:
        pair = outline_pair(count)
        best = {name: _time(pair, name, options.repeat) for name in TECHNIQUES}
        matched = len(trajectory(*pair)[0])
        print(
            f"| {count:,} | {best['rotation']:.2f} | {best['trajectory']:.1f} | {matched:,} |",
            flush=True,
        )

    print("\n| pairs | matching | invalid frames | pairs without any | area off linear |")
    print("|---|---|---:|---:|---:|")
    for kind, make in KINDS.items():
        pairs = [make(seed) for seed in range(options.pairs)]
        vertices = round(float(np.mean([len(ring) for pair in pairs for ring in pair])))
        for name in TECHNIQUES:
            found = np.array([quality(pair, name) for pair in pairs])
            invalid, area = found.mean(axis=0)
            clean = int((found[:, 0] == 0).sum())
            print(
                f"| {kind} ({vertices:,}) | {name} | {invalid:.1%} "
                f"| {clean} of {len(pairs)} | {area:.2%} |",
                flush=True,
            )


def quality(pair: Pair, technique: str) -> tuple[float, float]:
    """The share of invalid frames, and the mean difference from linear area, of the mean area."""
    here, there = TECHNIQUES[technique](*pair)
    a, b = points_at(pair[0], here), points_at(pair[1], there)
    times = np.linspace(0, 1, FRAMES)
    rings = [(1 - t) * a + t * b for t in times]
    areas = np.array([_area(ring) for ring in rings])
    linear = (1 - times) * areas[0] + times * areas[-1]
    valid = shapely.is_valid(np.array([Polygon(ring) for ring in rings]))
    return float(1 - valid.mean()), float(np.abs(areas - linear).mean() / linear.mean())


def easy(seed: int) -> Pair:
    """Two smooth outlines of 20 to 50 vertices, somewhat concave, that overlap."""
    random = np.random.default_rng(seed)

    def outline(x: float, y: float) -> Outline:
        count = int(random.integers(20, 51))
        angle = (np.arange(count) + random.uniform(-0.3, 0.3, count)) / count * 2 * np.pi
        lobes = np.arange(2, 5)
        height, phase = random.uniform(0, 0.25, 3) / lobes, random.uniform(0, 2 * np.pi, 3)
        radius = np.exp((height * np.cos(np.outer(angle, lobes) + phase)).sum(axis=1))
        radius *= random.uniform(0.8, 1.2)
        return np.column_stack([x + radius * np.cos(angle), y + radius * np.sin(angle)])

    return outline(0, 0), outline(*random.uniform(-0.5, 0.5, 2))


def fire(seed: int) -> Pair:
    """A fire's perimeter, and the one it grows to on one side; most of the rest is common."""
    random = np.random.default_rng(seed)
    x, y = np.meshgrid(*[np.linspace(-2, 2, GRID)] * 2)
    field = 1 - np.hypot(x, y) + 0.28 * _noise(random, 3.9)
    wind = random.uniform(0, 2 * np.pi)
    ahead = x * np.cos(wind) + y * np.sin(wind)
    growth = 0.35 * np.clip(_noise(random, 4.5) + 0.8 * ahead - 0.2, 0, None)
    return _contour(x, y, field), _contour(x, y, field + growth)


KINDS: dict[str, Callable[[int], Pair]] = {"easy": easy, "fires": fire}


def _noise(random: np.random.Generator, roughness: float) -> NDArray[np.float64]:
    """A field whose power falls with this power of the frequency."""
    frequency = np.hypot(*np.meshgrid(*[np.fft.fftfreq(GRID)] * 2))
    frequency[0, 0] = np.inf
    spectrum = np.fft.fft2(random.normal(size=(GRID, GRID))) * frequency ** (-roughness / 2)
    field = np.fft.ifft2(spectrum).real
    return np.asarray((field - field.mean()) / field.std())


def _contour(x: Outline, y: Outline, field: NDArray[np.float64]) -> Outline:
    """The outer ring of the largest region where a field is positive."""
    generator = contourpy.contour_generator(x, y, field, fill_type="OuterOffset")
    points, offsets = generator.filled(0, np.inf)
    rings = [Polygon(part[: starts[1]]) for part, starts in zip(points, offsets, strict=True)]
    largest = shapely.orient_polygons(max(rings, key=lambda ring: ring.area))
    return np.array(largest.exterior.coords[:-1])


def _area(ring: Outline) -> float:
    x, y = ring.T
    return float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2)


def _time(pair: Pair, technique: str, repeat: int) -> float:
    """The best of some runs, in ms."""
    spent = []
    for _ in range(repeat + 1):
        start = time.perf_counter()
        TECHNIQUES[technique](*pair)
        spent.append(time.perf_counter() - start)
    return min(spent[1:]) * 1e3


if __name__ == "__main__":
    main()
