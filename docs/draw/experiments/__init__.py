"""The paper's experiments beside ours: pages of tables and figures, written by the code they show.

``python -m docs.draw.experiments``, from the project's folder, writes them to ``docs/experiments``.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path

from docs.draw.experiments import fronts, pairs, sets, splits
from docs.draw.experiments.divisions import NAMES
from docs.draw.experiments.page import Page, written

TIMINGS = "timings.md"  # the one file that differs from run to run


def pages() -> list[Page]:
    """All pages: the experiments, and the one that sums them up."""
    two = splits.page()
    summary = Page("README", {"splits": two.told, "divisions": NAMES}, {})
    return [summary, pairs.page(), two, sets.page(), fronts.page()]


def write(folder: Path, found: Sequence[Page], start: float) -> None:
    """Write pages and figures to a folder, and how long it took; nothing else stays there."""
    folder.mkdir(parents=True, exist_ok=True)
    for old in [*folder.glob("*.svg"), *folder.glob("*.md")]:
        old.unlink()
    for page in found:
        (folder / f"{page.name}.md").write_text(page.text(), encoding="utf-8", newline="\n")
        for name, figure in page.figures.items():
            (folder / f"{name}.svg").write_text(figure, encoding="utf-8", newline="\n")
    times = {"divisions": next(page.times for page in found if page.times)}
    spent = f"{time.perf_counter() - start:.0f}"
    (folder / TIMINGS).write_text(
        written("timings", times | {"seconds": spent}), encoding="utf-8", newline="\n"
    )
