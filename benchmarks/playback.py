"""What a frame costs the script of a page, beside the same page with flubber's interpolators.

Run it from the project's folder, ``python -m benchmarks.playback``; it needs Chromium, and flubber
in benchmarks/node_modules (``make bench`` brings it). Rough outlines drift and change their shape;
each page is taken to the same moments, out of order, and the time that the script takes for each is
noted, in turns. Prints Markdown.
"""

from __future__ import annotations

import json
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from playwright.sync_api import Page, sync_playwright

import geotween
from tests.browser.chromium import find

FLUBBER = Path(__file__).parent / "node_modules" / "flubber" / "build" / "flubber.min.js"
VERTICES = (10_000, 100_000)
REGIONS, FRAMES, ROUNDS = 20, 60, 3

# Milliseconds of script that a frame may take, and the share of what flubber takes.
BARS = {10_000: (2.0, 1.0), 100_000: (18.0, 0.4)}

OURS = """(moments) => {
  const map = document.querySelector("geotween-map");
  map.pause();
  const [from, to] = [map.steps[0].end, map.steps[1].start];
  return moments.map((t) => {
    const start = performance.now();
    map.currentTime = from + (to - from) * t;
    return performance.now() - start;
  });
}"""

PREPARE = """([pairs, width, height]) => {
  document.body.innerHTML = `<svg viewBox="0 0 ${width} ${height}"></svg>`;
  window.drawn = pairs.map(([one, other]) => {
    const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
    document.querySelector("svg").append(path);
    return [path, flubber.interpolate(one, other, {maxSegmentLength: Infinity})];
  });
}"""

THEIRS = """(moments) => moments.map((t) => {
  const start = performance.now();
  for (const [path, at] of window.drawn) path.setAttribute("d", at(t));
  return performance.now() - start;
})"""


def rings(count: int, seed: int) -> list[list[list[float]]]:
    """Rough outlines of ``count`` vertices in all, in a grid."""
    random = np.random.default_rng(seed)
    angle = np.linspace(0, 2 * np.pi, count // REGIONS, endpoint=False)
    waves = np.arange(1, 30)[:, None]
    found = []
    for k in range(REGIONS):
        phase = random.uniform(0, 2 * np.pi, (29, 1))
        radius = 10 * (1 + (0.08 / waves * np.cos(waves * angle + phase)).sum(axis=0))
        shift = random.uniform(-3, 3, 2) + np.array(divmod(k, 5)) * 30
        ring = np.column_stack([np.cos(angle), np.sin(angle)]) * radius[:, None] + shift
        found.append(np.round(ring, 5).tolist())
    return found


def scene(one: list[Any], other: list[Any]) -> dict[str, Any]:
    steps = [
        {"label": label, "polygons": [{"key": f"k{i}", "polygon": r} for i, r in enumerate(rings)]}
        for label, rings in (("before", one), ("after", other))
    ]
    return {
        "title": "Many vertices",
        "map": {"simplify": "off", "projection": "none", "labels": "none"},
        "motion": {"method": "morph"},
        "steps": steps,
    }


def measured(pages: dict[str, tuple[Page, str]]) -> dict[str, list[float]]:
    """Milliseconds of script for each frame, by page; the pages take turns."""
    moments = [(37 * k % FRAMES + 0.5) / FRAMES for k in range(FRAMES)]
    found: dict[str, list[float]] = {name: [] for name in pages}
    for _ in range(ROUNDS):
        for name, (page, script) in pages.items():
            found[name] += page.evaluate(script, moments)
    return found


def main() -> None:
    print("| vertices | page | median ms | 95% ms | largest ms |\n|---:|---|---:|---:|---:|")
    verdicts = []
    with sync_playwright() as playwright, TemporaryDirectory() as folder:
        browser = playwright.chromium.launch(executable_path=find(), args=["--no-sandbox"])
        for count in VERTICES:
            one, other = rings(count, 1), rings(count, 2)
            path = Path(folder) / f"many{count}.yaml"
            path.write_text(json.dumps(scene(one, other)), encoding="utf-8")
            geotween.build(geotween.load(path), folder, formats=["html"])
            ours = browser.new_page()
            ours.goto(path.with_suffix(".html").as_uri())
            pages = {"geotween": (ours, OURS)}
            if FLUBBER.is_file():
                theirs = browser.new_page()
                theirs.add_script_tag(path=FLUBBER)
                theirs.evaluate(PREPARE, [list(zip(one, other, strict=True)), 960, 800])
                pages["flubber"] = (theirs, THEIRS)
            times = measured(pages)
            for name, values in times.items():
                middle, high = np.percentile(values, [50, 95])
                print(f"| {count:,} | {name} | {middle:.1f} | {high:.1f} | {max(values):.1f} |")
            medians = {name: float(np.median(values)) for name, values in times.items()}
            most, share = BARS[count]
            verdicts.append((f"{count:,}: ms of script", medians["geotween"], most))
            if "flubber" in medians:
                ratio = medians["geotween"] / medians["flubber"]
                verdicts.append((f"{count:,}: share of flubber's", ratio, share))
        browser.close()
    print("\n| bar | measured | at most | |\n|---|---:|---:|---|")
    for what, value, most in verdicts:
        print(f"| {what} | {value:.2f} | {most:g} | {'met' if value <= most else 'missed'} |")


if __name__ == "__main__":
    main()
