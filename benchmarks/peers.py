"""Peers: what others take of a processor to prepare a pair, from the outlines to any frame.

    flubber, polymorph-js, d3-interpolate-path      Node, pinned in package-lock.json (peers.cjs)
    signed distance                                 SciPy, on a grid (distance_tracks.py)
    transformr                                      R, where there is one (transformr.R)

None of them proves anything, and all but the grid lose holes or take none.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache, partial
from pathlib import Path

import numpy as np
import shapely
from numpy.typing import NDArray

from benchmarks.distance_tracks import halfway

Outline = NDArray[np.float64]
Ask = Callable[[Outline, Outline], float]  # the ms that it takes for a pair

HERE = Path(__file__).parent
NODE = ("flubber", "polymorph-js", "d3-interpolate-path")
R = "transformr"
DISTANCE = "signed distance"


@cache
def missing(peer: str) -> str | None:
    """Why a peer cannot be asked, or None if it can."""
    if peer == DISTANCE:
        return None
    if peer == R:
        return None if _has_transformr() else "there is no R with transformr"
    if not shutil.which("node"):
        return "there is no node on the path"
    folder = HERE / "node_modules" / peer.replace("separate", "flubber")
    return None if folder.is_dir() else "it is not installed; npm ci in benchmarks/ does it"


@contextmanager
def asked(peer: str) -> Iterator[Ask]:
    """A peer that is ready to be asked, those in Node in a process of their own."""
    if peer == DISTANCE:
        yield _distance
    elif peer == R:
        yield _transformr
    else:
        command = ["node", str(HERE / "peers.cjs")]
        pipe = subprocess.PIPE
        with subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True) as node:
            yield partial(_node, node, peer)


def _node(node: subprocess.Popen[str], peer: str, one: Outline, other: Outline) -> float:
    assert node.stdin
    assert node.stdout
    to = [ring.tolist() for ring in other] if isinstance(other, list) else other.tolist()
    node.stdin.write(json.dumps({"peer": peer, "from": one.tolist(), "to": to}) + "\n")
    node.stdin.flush()
    return float(node.stdout.readline())


def _distance(one: Outline, other: Outline) -> float:
    shapes = shapely.Polygon(one), shapely.Polygon(other)
    start = time.process_time()
    halfway(*shapes)
    return (time.process_time() - start) * 1e3


def _has_transformr() -> bool:
    if not shutil.which("Rscript"):
        return False
    asking = ["Rscript", "-e", "library(transformr)"]
    return subprocess.run(asking, capture_output=True, check=False).returncode == 0


def _transformr(one: Outline, other: Outline) -> float:
    with tempfile.TemporaryDirectory() as folder:
        names = []
        for name, ring in (("one", one), ("other", other)):
            names.append(str(Path(folder) / name))
            np.savetxt(names[-1], ring)
        command = ["Rscript", str(HERE / "transformr.R"), *names]
        return float(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
