"""Paths: the files that a scene means by a name, a folder or a pattern, and where they may lie."""

from __future__ import annotations

import glob
import os
import re
from collections.abc import Sequence
from pathlib import Path

from geotween.data.read.kinds import JSON, TABLES, WKT

KNOWN = (*JSON, *WKT, *TABLES)
_PATTERN = re.compile(r"[*?\[]")


class ForbiddenError(Exception):
    """A name that the sandbox does not allow, or that no file can have; the message says why."""

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.hint = hint


def is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):  # a name that no file can have
        return False


def fixed_part(folder: Path, name: str) -> Path:
    """The path of a name, or the folder that a pattern's files lie under."""
    if not is_pattern(folder, name):
        return folder / name
    # Without the ".." that could lead out from behind a wildcard.
    parts = Path(os.path.normpath(name)).parts
    first = next((i for i, part in enumerate(parts) if _PATTERN.search(part)), len(parts))
    return folder.joinpath(*parts[:first])


def is_pattern(folder: Path, name: str) -> bool:
    """Whether a name has wildcards; a file may have brackets in its own."""
    return bool(_PATTERN.search(name)) and not os.path.lexists(folder / name)


def several(folder: Path, name: str) -> list[Path]:
    """The files of a folder, of its most frequent format, or those that fit a pattern.

    In the order of the numbers in their names: 2 before 10.

    Raises
    ------
    OSError
        Where the folder cannot be read.
    """
    if is_pattern(folder, name):
        # Path.glob refuses **.geojson, and a folder named .. behind a wildcard.
        names = glob.glob(name, root_dir=folder, recursive=True)  # noqa: PTH207
        found = [folder / one for one in names]
        return sorted(filter(is_file, found), key=_natural)
    there = [p for p in sorted((folder / name).iterdir()) if p.suffix.lower() in KNOWN]
    suffixes = [p.suffix.lower() for p in there]
    usual = max(dict.fromkeys(suffixes), key=suffixes.count, default="")
    return sorted((p for p in there if p.suffix.lower() == usual), key=_natural)


def check_inside(paths: Sequence[Path], sandbox: Path | None, name: str = "") -> None:
    """Whether files lie in the sandbox, where there is one, wherever their links lead.

    ``name`` is what the scene calls the one path there is.

    Raises
    ------
    ForbiddenError
        For the first that does not.
    """
    if sandbox is None:
        return
    for path in paths:
        shown = name or path.name
        try:
            inside = path.resolve().is_relative_to(sandbox.resolve())
        except RuntimeError:
            raise ForbiddenError(f"cannot read {shown}: its links go round in a circle") from None
        except (OSError, ValueError) as error:
            reason = str(getattr(error, "strerror", None) or error).lower()
            raise ForbiddenError(f"cannot read {shown}: {reason}") from None
        if not inside:
            hint = f"only files in {sandbox} may be read here"
            raise ForbiddenError(f"{shown} lies outside of the sandbox", hint)


def with_companions(path: Path) -> list[Path]:
    """A file and those beside it that are read with it: s.dbf with s.shp, a.gpkg-wal with a.gpkg.

    Raises
    ------
    OSError
        Where the folder cannot be read.
    """
    start = (f"{path.stem.lower()}.", f"{path.name.lower()}-")
    beside = [p for p in path.parent.iterdir() if p.name.lower().startswith(start)]
    return [path, *sorted(p for p in beside if p.suffix.lower() not in KNOWN)]


def _natural(path: Path) -> tuple[list[tuple[bool, int, str]], str]:
    parts = re.split(r"(\d+)", path.name)
    numbered = [(n % 2 == 1, int(part) if n % 2 else 0, part) for n, part in enumerate(parts)]
    return numbered, str(path)
