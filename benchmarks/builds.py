"""Whole builds: the gallery and the real sets, beside their floors; jobs, cache and start-up.

Each build has a process of its own, so that its peak of memory is its own. Times of builds and
floors are seconds of a processor, medians of warm runs; jobs, cache and start-up are seconds of
the clock, the best of their runs, from the command line to its end.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tests.real_data import SETS, files, write_scene

ROOT = Path(__file__).resolve().parents[1]
GALLERY = tuple(sorted((ROOT / "scenes").glob("*.yaml")))
REAL = (
    "us_fig9_split-px",
    "wildfire_creek2020",
    "hurricane_sandy_winds",
    "us_regions",
    "scale_us_counties",
)
METHODS = ("paper", "auto")
LONG = "wildfire_creek2020"  # a scene of 22 steps


@dataclass(frozen=True)
class Built:
    """A scene that was built by a method, and what that took; sizes in bytes."""

    scene: str
    method: str
    times: tuple[float, ...]
    floors: tuple[float, ...]
    memory: float
    certified: str
    sizes: Mapping[str, int]

    @property
    def ratio(self) -> float:
        """How many floors it takes."""
        return float(np.median(self.times) / np.median(self.floors))

    @property
    def weight(self) -> float:
        """The page without its player beside the TopoJSON of the same steps, both packed."""
        return self.sizes["data_packed"] / self.sizes["topology_packed"]

    @property
    def svg_weight(self) -> float:
        return self.sizes["svg_packed"] / self.sizes["topology_packed"]


def builds(runs: int, names: Sequence[str] = ()) -> Iterator[Built]:
    """All scenes, or those named, by both methods."""
    scenes: list[tuple[str, Path | None]] = [(path.stem, path) for path in GALLERY]
    scenes += [(name, None) for name in REAL if SETS.is_dir()]
    for name, path in scenes:
        if names and name not in names:
            continue
        for method in METHODS:
            with tempfile.TemporaryDirectory() as folder:
                yield _built(name, method, path, Path(folder), runs)


def _built(name: str, method: str, path: Path | None, folder: Path, runs: int) -> Built:
    head = f"motion: {{method: {method}}}\n"
    given: list[str] = []
    if path is None:
        scene = write_scene(folder, name, head)
        given = [str(file) for file in files(name.removesuffix("-px"))]
        if name.endswith("-px"):
            given = []
    else:
        scene = Path(shutil.copytree(path.parent, folder / "scenes")) / path.name
        scene.write_text(_with_method(path.read_text(encoding="utf-8"), method), encoding="utf-8")
    command = [sys.executable, "-m", "benchmarks.one_build", str(scene), str(runs), *given]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True, cwd=ROOT)
    told: dict[str, Any] = json.loads(done.stdout)
    return Built(
        name,
        method,
        tuple(told.pop("times")),
        tuple(told.pop("floors")),
        told.pop("memory"),
        f"{told.pop('certified')} of {told.pop('transitions')}",
        told,
    )


def _with_method(text: str, method: str) -> str:
    """A scene's text with a method, whatever its motion says beside."""
    import yaml

    held = yaml.load(text, Loader=yaml.BaseLoader)
    held["motion"] = {**held.get("motion", {}), "method": method}
    return yaml.safe_dump(held, allow_unicode=True, sort_keys=False)


def from_the_command_line(runs: int) -> dict[str, list[float]]:
    """Seconds of the clock: start-up, jobs, and what is built again after one caption."""
    found: dict[str, list[float]] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        lake = str(ROOT / "scenes" / "lake.yaml")
        for _ in range(runs):
            timed = {
                "geotween --version": _ran(["--version"]),
                "geotween check scenes/lake.yaml": _ran(["check", "--no-cache", lake], ok=(0, 1)),
            }
            if SETS.is_dir():
                timed |= _long(folder)
            for what, seconds in timed.items():
                found.setdefault(what, []).append(seconds)
    return found


def _long(folder: Path) -> dict[str, float]:
    """A scene of 22 steps: by one and by two processes, afresh, and again after a caption."""
    scene, out = write_scene(folder, LONG), str(folder / "out")
    build = ["build", str(scene), "-o", out, "-q"]
    timed = {
        "22 steps, --jobs 1": _ran([*build, "--no-cache", "--jobs", "1"]),
        "22 steps, --jobs 2": _ran([*build, "--no-cache", "--jobs", "2"]),
    }
    with tempfile.TemporaryDirectory(dir=folder) as cache:
        timed["22 steps, into an empty cache"] = _ran([*build, "--jobs", "1"], cache)
        text = scene.read_text(encoding="utf-8")
        scene.write_text(text.replace("The first day.", "A first day."), encoding="utf-8")
        timed["22 steps, after one caption"] = _ran([*build, "--jobs", "1"], cache)
    return timed


def _ran(arguments: Sequence[str], cache: str = "", *, ok: Sequence[int] = (0,)) -> float:
    start = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-m", "geotween", *arguments],
        env={**os.environ, "GEOTWEEN_CACHE": cache},
        capture_output=True,
        check=False,
    )
    spent = time.perf_counter() - start
    if done.returncode not in ok:
        raise RuntimeError(done.stderr.decode())
    return spent
