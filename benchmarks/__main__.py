"""Run all benchmarks, and write one page of results with plots into docs/benchmarks.

``python -m benchmarks --parts pairs eights regions builds command`` runs some of them only, and
prints what the page would say.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from benchmarks.builds import Built, builds, from_the_command_line
from benchmarks.peers import DISTANCE, NODE, R, missing
from benchmarks.plots import log_log
from benchmarks.scaling import Series, eights, pairs, regions
from benchmarks.timing import growth, machine, spread

FOLDER = Path(__file__).resolve().parents[1] / "docs" / "benchmarks"

# The bars. Those of pairs are beside flubber's best warm run.
FIFTIETH, HUNDREDTH, POWER = 10_000, 20_000, 1.15
FLOORS = {"paper": 5.0, "auto": 25.0}
WEIGHTS = {"paper": 1.5, "auto": 3.0}
SVG_WEIGHT = 3.0
MEMORY = 1024.0  # MiB
AGAIN, JOBS = 0.1, 1.7
STARTS = {"geotween --version": 0.2, "geotween check scenes/lake.yaml": 1.0}

Bar = tuple[str, str, bool]
Part = Callable[[int], Iterator[str]]

BARS: list[Bar] = []


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--parts", nargs="*", choices=PARTS)
    parser.add_argument("--repeat", type=int, default=5, metavar="N", help="warm runs")
    options = parser.parse_args()
    chosen = options.parts or list(PARTS)
    body = [line for name in chosen for line in PARTS[name](options.repeat)]
    peers = [f"{peer}: {missing(peer)}" for peer in (*NODE, DISTANCE, R) if missing(peer)]
    head = [
        "# Benchmarks",
        "",
        "Written by `make bench`; [benchmarks/](../../benchmarks/README.md) says what is timed.",
        "Ways of one workload take turns; times are medians of warm runs, with the least and the",
        "greatest in brackets, in ms of a processor unless it says otherwise.",
        "",
        f"Machine: {machine()}.",
        *([f"Left out: {'; '.join(peers)}."] if peers else []),
        "",
        *_bars(),
        *body,
    ]
    text = "\n".join(head) + "\n"
    if options.parts:
        print(text)
    else:
        (FOLDER / "README.md").write_text(text, encoding="utf-8")
        print(f"{FOLDER / 'README.md'} is written")


def _bars() -> list[str]:
    rows = [f"| {bar} | {found} | {'met' if met else '**missed**'} |" for bar, found, met in BARS]
    return ["| bar | measured | |", "|---|---:|---|", *rows, ""]


def _pairs(repeat: int) -> Iterator[str]:
    found = {series.way: series for series in pairs(repeat)}
    yield from _told("One pair of outlines", "pairs", "vertices", list(found.values()))
    paper, auto = found["paper"], found["auto, certified"]
    exponent = growth(paper.counts, [min(t) for t in paper.times])
    BARS.append(
        (f"pair, `paper`: growth at most {POWER}", f"{exponent:.2f}", bool(exponent <= POWER))
    )
    if "flubber" not in found:
        return
    for count, share in ((FIFTIETH, 50), (HUNDREDTH, 100)):
        ratio = found["flubber"].best(count) / paper.best(count)
        what = f"pair of {count:,}, `paper`: at most 1/{share} of flubber"
        BARS.append((what, f"1/{ratio:.0f}", bool(ratio >= share)))
    ratios = [found["flubber"].best(n) / auto.best(n) for n in (FIFTIETH, HUNDREDTH)]
    what = f"pair from {FIFTIETH:,} on, `auto`, certified: faster than flubber, which is not"
    met = bool(auto.certified and min(ratios) > 1)
    BARS.append((what, " and ".join(f"{ratio:.1f} times" for ratio in ratios), met))


def _eights(repeat: int) -> Iterator[str]:
    yield from _told("One that becomes eight", "eights", "vertices", eights(repeat))


def _regions(repeat: int) -> Iterator[str]:
    yield from _told("Tilings", "regions", "regions", regions(repeat))


def _told(title: str, name: str, what: str, found: Sequence[Series]) -> Iterator[str]:
    """A table and a plot of some series."""
    FOLDER.mkdir(exist_ok=True)
    lines = {
        series.way: [
            (count, float(np.median(times)))
            for count, times in zip(series.counts, series.times, strict=True)
        ]
        for series in found
    }
    plot = log_log(lines, (what, f"{title}: ms"), f"{title}: how time grows with {what}")
    (FOLDER / f"{name}.svg").write_text(plot, encoding="utf-8")
    counts = sorted({count for series in found for count in series.counts})
    yield f"## {title}\n\n![Time in ms for a number of {what}, both logarithmic.]({name}.svg)\n"
    yield f"| {what} | {' | '.join(series.way for series in found)} |"
    yield "|---:|" + "---:|" * len(found)
    for count in counts:
        cells = [spread(s.at(count)) if count in s.counts else "" for s in found]
        yield f"| {count:,} | {' | '.join(cells)} |"
    powers = [f"{growth(s.counts, [min(t) for t in s.times]):.2f}" for s in found]
    yield f"| growth | {' | '.join(powers)} |"
    proved = ["" if s.certified is None else "yes" if s.certified else "no" for s in found]
    yield f"| certified | {' | '.join(proved)} |\n"


def _builds(repeat: int) -> Iterator[str]:
    yield "## Whole builds\n"
    yield "Seconds of a processor in one process that has built the scene before, without a cache;"
    yield "the floor reads, projects and writes the same geometry (pyogrio, pyproj, shapely). Sizes"
    yield "in kB, raw and gzipped: the page, the page without its player, the SVG, and TopoJSON of"
    yield "the same steps on the same grid.\n"
    heads = ("scene", "method", "s", "floor, s", "times", "MiB", "certified", "page")
    yield f"| {' | '.join((*heads, 'without player', 'SVG', 'TopoJSON', 'to it', 'SVG to it'))} |"
    yield "|---|---|" + "---:|" * (len(heads) + 3)
    for built in builds(min(repeat, 3)):
        yield _row(built)
        name = f"{built.scene}, `{built.method}`"
        most = FLOORS[built.method]
        what = f"{name}: at most {most:g} floors"
        BARS.append((what, f"{built.ratio:.1f}", bool(built.ratio <= most)))
        most = WEIGHTS[built.method]
        what = f"{name}: page without player at most {most:g} times TopoJSON"
        BARS.append((what, f"{built.weight:.2f}", bool(built.weight <= most)))
        if built.method == "paper":
            what = f"{name}: SVG at most {SVG_WEIGHT:g} times TopoJSON"
            BARS.append((what, f"{built.svg_weight:.2f}", bool(built.svg_weight <= SVG_WEIGHT)))
        if built.scene == "scale_us_counties":
            what = f"{name}: at most {MEMORY:g} MiB"
            BARS.append((what, f"{built.memory:.0f}", bool(built.memory <= MEMORY)))
    yield ""


def _row(built: Built) -> str:
    sizes = [
        f"{built.sizes[kind] / 1e3:,.0f} / {built.sizes[f'{kind}_packed'] / 1e3:,.0f}"
        for kind in ("page", "data", "svg", "topology")
    ]
    cells = [built.scene, built.method, spread(built.times), spread(built.floors)]
    cells += [f"{built.ratio:.1f}", f"{built.memory:.0f}", built.certified, *sizes]
    return f"| {' | '.join([*cells, f'{built.weight:.2f}', f'{built.svg_weight:.2f}'])} |"


def _command(repeat: int) -> Iterator[str]:
    found = from_the_command_line(min(repeat, 3))
    yield "## From the command line\n\nSeconds of the clock, imports and all.\n"
    yield "| | s |\n|---|---:|"
    for what, times in found.items():
        yield f"| {what} | {spread(times)} |"
    yield ""
    for what, most in STARTS.items():
        least = min(found[what])
        BARS.append((f"`{what}` under {most:g} s", f"{least:.2f} s", bool(least < most)))
    one, two = (found.get(f"22 steps, --jobs {jobs}") for jobs in (1, 2))
    if one and two:
        gain = min(one) / min(two)
        what = f"22 steps: `--jobs 2` at least {JOBS:g} times as fast as one"
        BARS.append((what, f"{gain:.2f}", bool(gain >= JOBS)))
        share = min(found["22 steps, after one caption"]) / min(one)
        what = f"22 steps: after one caption at most {AGAIN:g} of a full build"
        BARS.append((what, f"{share:.2f}", bool(share <= AGAIN)))


PARTS: dict[str, Part] = {
    "pairs": _pairs,
    "eights": _eights,
    "regions": _regions,
    "builds": _builds,
    "command": _command,
}

if __name__ == "__main__":
    main()
