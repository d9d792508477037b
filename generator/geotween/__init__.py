"""geotween: polygon sets at successive times, as an animated map that stands alone in one file."""

from __future__ import annotations

from importlib import import_module as _import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

# Loaded when first used, so that the command line starts at once.
_PUBLIC = {
    "BuildReport": "export.build",
    "Certificate": "motion.certify",
    "Frame": "motion.tracks",
    "Morph": "motion.morph",
    "PiecePair": "motion.morph",
    "Problem": "data.problems",
    "Scene": "data.load",
    "SceneError": "scene.errors",
    "Track": "motion.tracks",
    "animate": "hosts.geodata",
    "build": "export.build",
    "divide": "motion.divide.one",
    "load": "data.load",
    "mesh": "mesh",
    "morph": "motion.morph",
}
__all__ = sorted(_PUBLIC)

if TYPE_CHECKING:
    from geotween import mesh as mesh
    from geotween.data.load import Scene as Scene
    from geotween.data.load import load as load
    from geotween.data.problems import Problem as Problem
    from geotween.export.build import BuildReport as BuildReport
    from geotween.export.build import build as build
    from geotween.hosts.geodata import animate as animate
    from geotween.motion.certify import Certificate as Certificate
    from geotween.motion.divide.one import divide as divide
    from geotween.motion.morph import Morph as Morph
    from geotween.motion.morph import PiecePair as PiecePair
    from geotween.motion.morph import morph as morph
    from geotween.motion.tracks import Frame as Frame
    from geotween.motion.tracks import Track as Track
    from geotween.scene.errors import SceneError as SceneError


def __getattr__(name: str) -> Any:
    if name not in _PUBLIC:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module = _import_module(f"{__name__}.{_PUBLIC[name]}")
    value = globals()[name] = module if _PUBLIC[name] == name else getattr(module, name)
    return value


def __dir__() -> list[str]:
    return __all__
