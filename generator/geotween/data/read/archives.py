"""Archives: the table that is meant out of a zip, unpacked to where it can be looked at."""

from __future__ import annotations

import shutil
import zipfile
from collections.abc import Sequence
from pathlib import Path, PurePosixPath

from geotween.data.read.kinds import INCOMPLETE, PACKED, UnreadableError

_SHAPEFILE = (".shp", ".shx", ".dbf", ".prj", ".cpg")
LARGEST = 2**32  # bytes unpacked; a small archive can name far more than a disk holds


def unpacked(path: Path, layer: str | None, folder: Path) -> tuple[Path, str | None]:
    """A table of an archive, unpacked to a folder, and the layer of it that is meant.

    Of several tables ``layer`` names one by its stem, in whichever folder of the archive it lies.

    Raises
    ------
    UnreadableError
        Where there is none, or several and none is named, or the archive is broken.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            return _unpacked(archive, layer, folder)
    except UnreadableError:
        raise
    except Exception as error:  # zipfile raises many things on a broken archive
        reason = str(error).partition("'")[0].strip() or type(error).__name__
        raise UnreadableError(f"cannot be read: {reason}", INCOMPLETE) from None


def _unpacked(archive: zipfile.ZipFile, layer: str | None, folder: Path) -> tuple[Path, str | None]:
    members = {PurePosixPath(m.filename): m for m in archive.infolist() if not m.is_dir()}
    tables = [
        name
        for name in members
        if name.suffix.lower() in PACKED
        and "__MACOSX" not in name.parts
        and not name.name.startswith(".")
    ]
    chosen = _chosen(tables, layer)
    wanted = [chosen]
    if chosen.suffix.lower() == ".shp":
        stem = chosen.with_suffix("")
        wanted = [
            n for n in members if n.with_suffix("") == stem and n.suffix.lower() in _SHAPEFILE
        ]
    size = sum(members[name].file_size for name in wanted)
    if size > LARGEST:
        raise UnreadableError(f"cannot be read: it unpacks to {size:,} bytes", "unpack it")
    for name in wanted:
        place = folder / (chosen.stem + name.suffix.lower())
        with archive.open(members[name]) as source, place.open("wb") as target:
            shutil.copyfileobj(source, target)
    return folder / (chosen.stem + chosen.suffix.lower()), layer if len(tables) == 1 else None


def _chosen(tables: Sequence[PurePosixPath], layer: str | None) -> PurePosixPath:
    if not tables:
        raise UnreadableError(f"cannot be read: it holds none of {', '.join(PACKED)}")
    if len(tables) == 1:
        return tables[0]
    meant = [name for name in tables if layer in (name.stem, str(name))]
    if len(meant) == 1:
        return meant[0]
    stems = [name.stem for name in tables]
    names = [n.stem if stems.count(n.stem) == 1 else str(n) for n in tables]
    hint = f"there are {', '.join(names)}"
    if layer is None:
        raise UnreadableError("the archive has several files: name one with layer:", hint)
    raise UnreadableError(f'there is no one file "{layer}" in the archive', hint)
