"""Build one scene in a process of its own, and print what it took as JSON.

``python -m benchmarks.one_build SCENE RUNS FILE...``: the files are those of the scene's steps,
for the floor; none where the scene has them written in itself.
"""

from __future__ import annotations

import gzip
import json
import re
import resource
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.floor import floor, sources
from benchmarks.topology import topojson
from geotween.data.load import load
from geotween.export.build import Rendered, render_scene

PATIENCE = 10.0  # seconds of a processor after which no run begins

# What every page has in common: the player, its style, and icons.
PLAYER = re.compile(rb"<script(?![^>]*json)[^>]*>.*?</script>|<style[^>]*>.*?</style>", re.DOTALL)


def main() -> None:
    path, runs = Path(sys.argv[1]), int(sys.argv[2])
    given = [Path(name) for name in sys.argv[3:]]
    scene = load(path)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        files = sources(scene, given, folder)
        times, floors = [], []
        made = render_scene(scene)  # imports, caches
        floor(files, scene, folder, own=not given)
        for _ in range(runs):
            if sum(times) > PATIENCE:
                break
            start = time.process_time()
            made = render_scene(load(path))
            times.append(time.process_time() - start)
            floors.append(floor(files, scene, folder, own=not given))
    print(
        json.dumps(
            {
                "times": times,
                "floors": floors,
                "memory": _peak(),
                "certified": sum(t.valid for t in made.transitions),
                "transitions": len(made.transitions),
                **_sizes(made, topojson(scene).encode()),
            }
        )
    )


def _peak() -> float:
    """The most memory in MiB that this process has had; rusage would count its parent's, too."""
    status = Path("/proc/self/status")
    if status.exists():
        return float(re.findall(r"VmHWM:\s+(\d+) kB", status.read_text())[0]) / 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1 << 20)


def _sizes(made: Rendered, topology: bytes) -> dict[str, int]:
    page, svg = made.files[f"{made.name}.html"], made.files[f"{made.name}.svg"]
    kinds = {"page": page, "data": PLAYER.sub(b"", page), "svg": svg, "topology": topology}
    sizes = {name: len(content) for name, content in kinds.items()}
    packed = {f"{name}_packed": len(gzip.compress(of, 9, mtime=0)) for name, of in kinds.items()}
    return sizes | packed


if __name__ == "__main__":
    main()
