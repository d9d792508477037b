"""Libraries that only pictures need: each with the extra that brings it."""

from __future__ import annotations

from importlib import import_module
from typing import Any

STILLS, VIDEO = "geotween[stills]", "geotween[video]"
_EXTRA_OF = {
    "fontpkg_noto_sans": STILLS,
    "imageio_ffmpeg": VIDEO,
    "PIL.Image": VIDEO,
    "resvg_py": STILLS,
    "typst": STILLS,
    "uharfbuzz": STILLS,
}


class MissingExtraError(Exception):
    """A library that a format needs is not installed; the message says what installs it."""


def needed(module: str, what: str) -> Any:
    """A module by name, for ``what`` is to be made.

    Raises
    ------
    MissingExtraError
        Where it is not installed.
    """
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        if error.name is None or not f"{module}.".startswith(f"{error.name}."):
            raise
        install = f"pip install '{_EXTRA_OF[module]}'"
        raise MissingExtraError(f"{what} needs {module.split('.')[0]}: {install}") from None
