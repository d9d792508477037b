"""Timing: several ways in turns, so that whatever else the machine does falls on all of them."""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from importlib.metadata import version

import numpy as np

# Seconds of one measurement after which no more than LEAST runs are made.
PATIENCE, LEAST = 3.0, 3

PACKAGES = ("shapely", "numpy", "scipy", "pyproj", "pyogrio")


def in_turns(ways: Mapping[str, Callable[[], float]], repeat: int) -> dict[str, list[float]]:
    """What each of some ways says it took, run after run; the first run of each does not count."""
    print(f"timing {', '.join(ways)}", file=sys.stderr, flush=True)
    for way in ways.values():
        way()
    found: dict[str, list[float]] = {name: [] for name in ways}
    start = time.perf_counter()
    for run in range(repeat):
        if run >= LEAST and time.perf_counter() - start > PATIENCE:
            break
        for name, way in ways.items():
            found[name].append(way())
    return found


def spread(values: Sequence[float]) -> str:
    """The median of some times, and how far they reach."""
    low, middle, high = np.quantile(values, (0, 0.5, 1))
    return f"{_short(middle)} ({_short(low)}–{_short(high)})"


def growth(counts: Sequence[float], times: Sequence[float]) -> float:
    """The power of the counts with which times grow: least squares of the logarithms."""
    return float(np.polyfit(np.log(counts), np.log(times), 1)[0])


def machine() -> str:
    """The machine by its cores and versions, and by nothing else."""
    told = [f"{os.cpu_count()} cores", f"Python {platform.python_version()}"]
    if shutil.which("node"):
        node = subprocess.run(["node", "--version"], capture_output=True, text=True, check=True)
        told.append(f"Node {node.stdout.strip().removeprefix('v')}")
    return ", ".join([*told, *(f"{name} {version(name)}" for name in PACKAGES)])


def _short(value: float) -> str:
    return f"{value:,.0f}" if value >= 100 else f"{value:.3g}"
