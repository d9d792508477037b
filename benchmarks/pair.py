"""Time the preparation of one pair of outlines, beside flubber on the same pair.

Both run in turns, so that a busy machine slows both; each figure is the best of the warm runs.
Prints Markdown.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import shapely

import geotween
from benchmarks.shapes import Outline, outline_pair

BESIDE_FLUBBER = (1_000, 2_000, 5_000, 10_000, 20_000)
ALONE = (50_000, 100_000)  # flubber's time grows with the square
# V8 reaches its best code for small pairs only after ten calls: go on for so long, in seconds.
WARM_UP = 1.0
# The bars: BAR_RATIO times as fast as flubber at BAR_COUNT vertices, and over BESIDE_FLUBBER a
# time that grows with at most this power of the count (1 is linear).
BAR_COUNT, BAR_RATIO, BAR_EXPONENT = 10_000, 50, 1.2

HERE = Path(__file__).parent
FLUBBER = HERE / "node_modules" / "flubber" / "package.json"


@dataclass
class Times:
    """What one pair took, in ms: warm runs of ours and of flubber, and flubber's first call."""

    count: int
    ours: list[float] = field(default_factory=list)
    flubber: list[float] = field(default_factory=list)
    first: float | None = None

    @property
    def ratio(self) -> float:
        return min(self.flubber) / min(self.ours)

    @property
    def row(self) -> str:
        """One row of the table."""
        start = f"| {self.count:,} | {min(self.ours):.2f} "
        if self.first is None:
            return f"{start}| | | |"
        return f"{start}| {self.first:.1f} | {min(self.flubber):.1f} | {self.ratio:.0f} |"


def main() -> None:
    repeat = _repeat()
    if not shutil.which("node"):
        sys.exit("there is no node on the path; flubber runs on Node.js")
    if not FLUBBER.exists():
        sys.exit("flubber is not installed; run make bench, or npm ci in benchmarks/")

    print("| vertices | ours, ms | flubber first call, ms | flubber warm, ms | ratio |")
    print("|---:|---:|---:|---:|---:|")
    results = []
    for count in BESIDE_FLUBBER + ALONE:
        times = measure(count, repeat, beside=count in BESIDE_FLUBBER)
        results.append(times)
        print(times.row, flush=True)

    compared, largest = results[: len(BESIDE_FLUBBER)], results[-4:]
    exponent = growth(compared)
    slowest = max(max(times.ours) / min(times.ours) for times in results)
    print(f"\nOur time grows with the vertices to the power {exponent:.2f} ({span(compared)}),")
    print(f"{growth(largest):.2f} ({span(largest)}). Best of {repeat} warm runs or more;")
    print(f"our slowest took up to {slowest:.1f} times the best.\n\n{_versions()}.\n")

    ratio = next(times.ratio for times in compared if times.count == BAR_COUNT)
    bar = f"at {BAR_COUNT:,} vertices at most 1/{BAR_RATIO} of flubber's warm time: 1/{ratio:.1f}"
    print(f"- {bar}, {_verdict(ratio >= BAR_RATIO)}")
    bar = f"growth exponent, {span(compared)}, at most {BAR_EXPONENT}: {exponent:.2f}"
    print(f"- {bar}, {_verdict(exponent <= BAR_EXPONENT)}")


def measure(count: int, repeat: int, *, beside: bool) -> Times:
    """Time a pair of ``count`` vertices; ``beside`` flubber, in turns, or alone."""
    pair = outline_pair(count)
    times = Times(count)
    prepare(pair)  # imports, caches
    if not beside:
        times.ours = [prepare(pair) for _ in range(repeat)]
        return times
    with _flubber() as node:
        times.first = _ask(node, pair)
        start = time.perf_counter()
        while len(times.ours) < repeat or time.perf_counter() - start < WARM_UP:
            times.ours.append(prepare(pair))
            times.flubber.append(_ask(node, pair))
    return times


def prepare(pair: tuple[Outline, Outline]) -> float:
    """The ms that geotween takes for a pair: all stages, and the check that it is valid."""
    origin, target = (shapely.Polygon(outline) for outline in pair)
    start = time.perf_counter()
    motion = geotween.morph([origin], [target], method="paper")
    spent = time.perf_counter() - start
    assert len(motion.tracks) == 1
    assert not motion.problems
    return spent * 1e3


def growth(results: list[Times]) -> float:
    """The power of the count with which our time grows: least squares in log-log."""
    counts, best = [t.count for t in results], [min(t.ours) for t in results]
    return float(np.polyfit(np.log(counts), np.log(best), 1)[0])


def span(results: list[Times]) -> str:
    return f"{results[0].count:,} to {results[-1].count:,}"


@contextmanager
def _flubber() -> Iterator[subprocess.Popen[str]]:
    """A Node process of its own, so that its first call is a first call."""
    command = ["node", str(HERE / "flubber.cjs")]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True) as node:
        yield node


def _ask(node: subprocess.Popen[str], pair: tuple[Outline, Outline]) -> float:
    """The ms that flubber takes for a pair."""
    assert node.stdin
    assert node.stdout
    node.stdin.write(json.dumps([outline.tolist() for outline in pair]) + "\n")
    node.stdin.flush()
    answer = node.stdout.readline()
    if not answer:
        sys.exit("flubber.cjs stopped without an answer")
    return float(answer)


def _verdict(met: bool) -> str:
    return "met" if met else "missed"


def _versions() -> str:
    node = subprocess.run(["node", "--version"], capture_output=True, text=True, check=True)
    return (
        f"{os.cpu_count()} cores, Python {platform.python_version()}, "
        f"Node {node.stdout.strip().removeprefix('v')}, "
        f"flubber {json.loads(FLUBBER.read_text())['version']}, "
        f"shapely {shapely.__version__}, numpy {np.__version__}"
    )


def _repeat() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeat", type=int, default=5, metavar="N", help="warm runs, 3 or more")
    repeat: int = parser.parse_args().repeat
    if repeat < 3:
        parser.error("--repeat: the best of at least 3 runs")
    return repeat


if __name__ == "__main__":
    main()
