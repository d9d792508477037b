"""Sites that show a map: a folder served as a site is, and pages with frames in them."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest

from geotween.cli import main

# A story of two steps, with words of each kind.
SCENE = """
title: Two squares
subtitle: One goes to the right.
description: A square, and where it goes.
source: Nobody
credit: Somebody
map: {width: 300}
timing: {transition: 1, hold: 1}
steps:
  - label: one
    caption: to begin
    polygons: [{key: a, name: Aland, class: x, polygon: [[0, 0], [4, 0], [4, 4], [0, 4]]}]
  - label: two
    polygons: [{key: a, name: Aland, class: x, polygon: [[4, 0], [8, 0], [8, 4], [4, 4]]}]
"""


def build(folder: Path, *options: str, name: str = "squares", scene: str = SCENE) -> Path:
    """Build a scene by the command line, into a folder of its own."""
    folder.mkdir(exist_ok=True)
    path = folder / f"{name}.yaml"
    path.write_text(scene, encoding="utf-8")
    with pytest.raises(SystemExit) as exit_:
        main(["build", str(path), "-o", str(folder / "out"), "-q", *options])
    assert exit_.value.code == 0
    return folder / "out"


@contextmanager
def served(folder: Path) -> Iterator[str]:
    """The address of a folder, served until the end of the block."""
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(_Quiet, directory=str(folder)))
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_port}"
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


class _Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_: Any) -> None:
        pass


def host(folder: Path, content: str, name: str = "host.html") -> Path:
    """A page of someone else's with something in it."""
    path = folder / name
    head = '<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>Host</title></head>'
    path.write_text(
        f"{head}<body><main><h1>A site</h1>\n{content}\n</main></body></html>", encoding="utf-8"
    )
    return path
