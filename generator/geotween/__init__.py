"""geotween: polygon sets at successive times, as an animated map that stands alone in one file."""

from __future__ import annotations

from importlib import import_module
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
    "build": "export.build",
    "load": "data.load",
    "morph": "motion.morph",
}
__all__ = sorted(_PUBLIC)

if TYPE_CHECKING:
    from geotween.data.load import Scene, load
    from geotween.data.problems import Problem
    from geotween.export.build import BuildReport, build
    from geotween.motion.certify import Certificate
    from geotween.motion.morph import Morph, PiecePair, morph
    from geotween.motion.tracks import Frame, Track
    from geotween.scene.errors import SceneError


def __getattr__(name: str) -> Any:
    if name not in _PUBLIC:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_PUBLIC[name]}"), name)


def __dir__() -> list[str]:
    return __all__
