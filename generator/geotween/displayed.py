"""What shows itself: the one look from scenes and motions up to what draws them, when asked."""

from __future__ import annotations

import os
from importlib import import_module
from pathlib import Path
from typing import Any


class Displayed:
    """Something that a notebook shows, and that saves itself; how, ``hosts.notebook`` knows."""

    __slots__ = ()

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write it to a file, as the suffix says.

        ``.html`` is a page that stands alone, ``.svg`` a picture that moves; ``.png``, ``.pdf``,
        ``.gif``, ``.mp4`` and others are pictures (docs/pictures.md); ``.keyframes.json``,
        ``.paths.json`` and ``.frames.geojson`` are for other programs.

        Raises
        ------
        ValueError
            For a suffix that says no format.
        OSError
            Where the file cannot be written.
        """
        saved: Path = _notebook().save(self, Path(path))
        return saved

    def _repr_html_(self) -> str:
        shown: str = _notebook().as_html(self)
        return shown

    def _repr_mimebundle_(self, include: object = None, exclude: object = None) -> dict[str, Any]:
        shown: dict[str, Any] = _notebook().as_mimebundle(self)
        return shown


def _notebook() -> Any:
    return import_module("geotween.hosts.notebook")
