"""The loop: look at the files, build what is stale, serve it, until somebody stops it."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from threading import Thread

from geotween.export.site import Site
from geotween.hosts.watch.scenes import Watched, errors_of, files_of, stamps
from geotween.hosts.watch.server import ADDRESS, Shelf, serve

# Seconds between two looks: some stats of files, on any file system and without a library. One
# that is being written is given as long to become still.
LOOK = 0.25

Tell = Callable[[Watched, float], None]


def watch(
    paths: Sequence[Path],
    site: Site,
    sandbox: Path | None,
    port: int,
    started: Callable[[str], None],
    tell: Tell,
) -> None:
    """Serve scenes and build them anew until KeyboardInterrupt, which ends it without a word.

    Everything is kept in memory. ``started`` gets the address; ``tell`` each scene that was built,
    and in how many seconds.

    Raises
    ------
    OSError
        Where the port is taken.
    """
    scenes = [Watched(path) for path in paths]
    with _serving(Shelf(), port) as (shelf, address):
        if len(scenes) == 1:
            shelf.first = f"{scenes[0].name}.html"
        try:
            _rebuild(scenes, site, sandbox, shelf, tell)
            started(address)
            while True:
                time.sleep(LOOK)
                stale = [scene for scene in scenes if scene.is_stale()]
                if stale:
                    _settle(stale)
                    _rebuild(stale, site, sandbox, shelf, tell, scenes)
        except KeyboardInterrupt:
            return


@contextmanager
def _serving(shelf: Shelf, port: int) -> Iterator[tuple[Shelf, str]]:
    server = serve(shelf, port)
    thread = Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        yield shelf, f"http://{ADDRESS}:{server.server_port}/"
    finally:
        shelf.close()
        server.shutdown()
        server.server_close()


def _rebuild(
    stale: Sequence[Watched],
    site: Site,
    sandbox: Path | None,
    shelf: Shelf,
    tell: Tell,
    scenes: Sequence[Watched] | None = None,
) -> None:
    """Build scenes, and serve what there is of all."""
    for scene in stale:
        since = time.perf_counter()
        scene.rebuild(site, sandbox)
        tell(scene, time.perf_counter() - since)
    every = stale if scenes is None else scenes
    shelf.put(files_of(every, site), errors_of(every))


def _settle(scenes: Sequence[Watched]) -> None:
    """Wait until no file changes from one look to the next."""
    paths = [path for scene in scenes for path in scene.stamps]
    seen = stamps(paths)
    while True:
        time.sleep(LOOK / 2)
        now = stamps(paths)
        if now == seen:
            return
        seen = now
