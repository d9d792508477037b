"""A scene's page for a site that frames it: what its builders have in common."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from markupsafe import Markup

from geotween.data.load import load
from geotween.data.problems import Problem
from geotween.export.build import render_scene
from geotween.export.cache import default_cache
from geotween.export.jobs import plan_scenes
from geotween.hosts.frame import on_site


@dataclass(frozen=True)
class Built:
    """A map as HTML of a frame; its words for where there is no HTML; what is wrong with it."""

    html: Markup
    title: str
    description: str
    problems: tuple[Problem, ...]


def built(path: Path, *, reads: set[Path] | None = None) -> Built:
    """A scene built for a site; ``reads`` gets the files that were looked at.

    Raises
    ------
    SceneError
        With every fault of the scene, at its place.
    """
    scene = load(path, reads=reads)
    (plans,) = plan_scenes([scene], cache=default_cache())
    rendered = render_scene(scene, ["html"], plans=plans)
    model = scene.model
    return Built(
        on_site(rendered, model.title),
        model.title,
        model.description or model.subtitle,
        tuple(problem for problem in rendered.problems if problem.severity != "note"),
    )
