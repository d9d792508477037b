"""A folder of arrays by name, that builds share: what was planned once is not planned again.

Entries hold numbers and JSON, never pickled objects: reading one runs no code of whoever wrote it.
Each is written under a temporary name and then put in place, so that builds at the same time see
whole entries or none. What cannot be read counts as not there.
"""

from __future__ import annotations

import contextlib
import os
import tempfile
import zipfile
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from geotween.export.plans import Arrays

VARIABLE = "GEOTWEEN_CACHE"  # names the folder; empty for none

# Bytes of all entries: some hundred scenes of a thousand vertices a step. A map of 22 such steps
# takes about 20 MB.
LARGEST = 1 << 30

# What an entry that is not as it should be may raise.
BROKEN = (OSError, EOFError, KeyError, ValueError, MemoryError, zipfile.BadZipFile, zlib.error)


@dataclass(frozen=True)
class Cache:
    """A folder of entries, at most so many bytes of them in the end."""

    folder: Path
    largest: int = LARGEST

    def get(self, key: str) -> Arrays | None:
        """An entry, which is now the last to go; None where there is none that can be read."""
        path = self._path(key)
        try:
            with path.open("rb") as file, np.load(file, allow_pickle=False) as entry:
                found = dict(entry)
            os.utime(path)
        except BROKEN:
            return None
        return found

    def put(self, key: str, arrays: Arrays) -> None:
        """Keep an entry; nothing happens where the folder cannot be written to."""
        path = self._path(key)
        try:
            # Nobody else's business, and nobody else's to write into.
            self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            path.parent.mkdir(mode=0o700, exist_ok=True)
            handle, temporary = tempfile.mkstemp(prefix=".", suffix=".npz", dir=path.parent)
        except OSError:
            return
        try:
            with os.fdopen(handle, "wb") as file:
                np.savez(file, allow_pickle=False, **arrays)
            Path(temporary).replace(path)
        except OSError:
            with contextlib.suppress(OSError):
                Path(temporary).unlink()

    def prune(self) -> None:
        """Remove what has not been used for longest, until the entries are as small as allowed."""
        entries = []
        for path in self.folder.glob("??/*.npz"):
            with contextlib.suppress(OSError):
                found = path.stat()
                entries.append((found.st_mtime_ns, str(path), found.st_size))
        total = sum(size for *_, size in entries)
        for _, name, size in sorted(entries):
            if total <= self.largest:
                break
            with contextlib.suppress(OSError):
                Path(name).unlink()
            total -= size

    def _path(self, key: str) -> Path:
        return self.folder / key[:2] / f"{key}.npz"


def default_cache() -> Cache | None:
    """The user's cache, in the folder that GEOTWEEN_CACHE names if it is set; none if it is empty.

    The usual place is that of the platform: ``~/.cache/geotween`` on Linux.
    """
    from platformdirs import user_cache_path

    named = os.environ.get(VARIABLE)
    if named is None:
        return Cache(user_cache_path("geotween", appauthor=False))
    return Cache(Path(named)) if named else None
