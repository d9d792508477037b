"""Time the certificate of one pair of outlines, beside its matching, and both beside flubber.

The pairs are those of pair.py, each by both matchings. Matching is all that makes the motion, from
two polygons to tracks; the certificate is what ``morph(...).certificate`` takes on top. All take
turns in one run, so that a busy machine slows all; each figure is the best. Prints Markdown.
"""

from __future__ import annotations

import argparse
import shutil
import time
from contextlib import nullcontext
from dataclasses import dataclass, field

import shapely

import geotween
from benchmarks.pair import FLUBBER, _ask, _flubber, _verdict
from benchmarks.shapes import Outline, outline_pair

COUNTS = (1_000, 10_000, 20_000)
MATCHINGS = ("rotation", "trajectory")
# The bars: at most so many times the matching's time at RATIO_COUNT vertices; and matching and
# certificate together faster than flubber's warm call at BESIDE_COUNT.
RATIO_COUNT, BAR_RATIO = 10_000, 3.0
BESIDE_COUNT = 20_000

Pair = tuple[Outline, Outline]


@dataclass
class Times:
    """What a pair took, in ms: the matching and the certificate on top of it."""

    count: int
    name: str
    matching: list[float] = field(default_factory=list)
    certificate: list[float] = field(default_factory=list)

    @property
    def ratio(self) -> float:
        return min(self.certificate) / min(self.matching)

    @property
    def both(self) -> float:
        return min(self.certificate) + min(self.matching)

    def run(self, pair: Pair) -> None:
        origin, target = ([shapely.Polygon(outline)] for outline in pair)
        start = time.perf_counter()
        motion = geotween.morph(origin, target, matching=self.name)
        matched = time.perf_counter()
        proved = motion.certificate.valid
        self.certificate.append((time.perf_counter() - matched) * 1e3)
        self.matching.append((matched - start) * 1e3)
        assert proved


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeat", type=int, default=5, metavar="N", help="runs of each")
    repeat = parser.parse_args().repeat
    beside = shutil.which("node") is not None and FLUBBER.exists()
    if not beside:
        print("Without flubber: it needs Node on the path, and npm ci in benchmarks/.\n")

    print("| vertices | matching | matching, ms | certificate, ms | ratio | flubber warm, ms |")
    print("|---:|---|---:|---:|---:|---:|")
    verdicts: list[str] = []
    for count in COUNTS:
        rows, flubber = measure(count, repeat, beside=beside)
        for row in rows:
            warm = f"{flubber:.1f}" if flubber else ""
            print(
                f"| {count:,} | {row.name} | {min(row.matching):.1f} "
                f"| {min(row.certificate):.1f} | {row.ratio:.2f} | {warm} |",
                flush=True,
            )
            verdicts += _bars(row, flubber)
    print("\n| bar | matching | measured | |")
    print("|---|---|---:|---|")
    print("\n".join(verdicts))


def measure(count: int, repeat: int, *, beside: bool) -> tuple[list[Times], float | None]:
    """Time a pair of ``count`` vertices by each matching and by flubber, in turns."""
    pair = outline_pair(count)
    rows = [Times(count, name) for name in MATCHINGS]
    for row in rows:
        Times(count, row.name).run(pair)  # imports, caches
    flubber: list[float] = []
    with _flubber() if beside else nullcontext() as node:
        if node:
            _ask(node, pair)  # the first call is slower
        for _ in range(repeat):
            for row in rows:
                row.run(pair)
                if node:
                    flubber.append(_ask(node, pair))
    return rows, min(flubber, default=None)


def _bars(row: Times, flubber: float | None) -> list[str]:
    found = []
    if row.count == RATIO_COUNT:
        bar = f"certificate at most {BAR_RATIO:.0f} times the matching, {row.count:,} vertices"
        met = _verdict(row.ratio <= BAR_RATIO)
        found.append(f"| {bar} | {row.name} | {row.ratio:.2f} | {met} |")
    if row.count == BESIDE_COUNT and flubber:
        bar = f"both together faster than flubber warm, {row.count:,} vertices"
        share = row.both / flubber
        found.append(f"| {bar} | {row.name} | {share:.2f} times | {_verdict(share < 1)} |")
    return found


if __name__ == "__main__":
    main()
