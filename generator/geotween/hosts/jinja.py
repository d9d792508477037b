"""Jinja: a function for a site's own templates, ``{{ geotween("scene.yaml") }}``."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from markupsafe import Markup

from geotween.hosts.built import built


def maps(base: str | os.PathLike[str] = ".") -> Callable[[str], Markup]:
    """A function from the path of a scene, relative to a folder, to the HTML of its map.

    It raises SceneError with all that is wrong with a scene. Flask:
    ``app.jinja_env.globals["geotween"] = maps(app.root_path)``; Pelican:
    ``JINJA_GLOBALS = {"geotween": maps("content")}``.
    """

    def geotween(path: str) -> Markup:
        return built(Path(base) / path).html

    return geotween
