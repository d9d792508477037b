"""Places: every source's coordinates into the one plane that the map is drawn in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from geotween.data.polygons import Feature, Shapes, bounds, geometries_of, with_geometries
from geotween.data.problems import Problem
from geotween.data.read.held import GEOGRAPHIC, Held
from geotween.scene.document import Document, Location
from geotween.scene.errors import SceneError
from geotween.scene.model import Map

if TYPE_CHECKING:
    from pyproj import CRS

    from geotween.data.globe.projection import Projection

_SWAPPED = "are latitude and longitude swapped? longitude (x) comes first"
_OR_PLANAR = "if they are planar, say map: {projection: none}"
_MAP_CRS: Location = ("map", "crs")
_PROJECTION: Location = ("map", "projection")


@dataclass(frozen=True, eq=False)
class Placed:
    """The features of each source in the map's plane, and how they came there.

    ``metres`` is the length of a unit of that plane, None where it is unknown. ``plane`` is its
    system and ``written`` that of coordinates in the scene: with ``fit: each`` as for the step
    whose frame is the map's, None where nothing tells.
    """

    features: list[list[Feature]]
    words: str
    metres: float | None = None
    problems: tuple[Problem, ...] = ()
    plane: CRS | None = None
    written: CRS | None = None


def crs_of_all(document: Document, frame: Map, sources: Sequence[Held]) -> list[CRS | None]:
    """The coordinate reference system of each source; None for planar coordinates without one.

    That of the file, else that which the scene names, else longitude and latitude where the
    format says so and all such files' coordinates can be. Coordinates written in the scene itself
    are those of the first file where the scene names none.

    Raises
    ------
    SceneError
        Where it is unknown and needed, or cannot be the one that is named.
    """
    names = [source.crs or frame.crs for source in sources]
    others = any(s.lonlat and name is None for s, name in zip(sources, names, strict=True))
    known = {name for name in names if name is not None}
    if frame.projection == "none" and len(known) + bool(known and others) < 2:
        return [None] * len(sources)  # without a need for pyproj
    bare = [i for i, s in enumerate(sources) if names[i] is None and s.lonlat and s.features]
    if bare and (frame.projection != "none" or any(names)):
        _check_bare(document, [sources[i] for i in bare])
        if _lonlat(_bounds([sources[bare[0]]])):
            for i in bare:
                names[i] = GEOGRAPHIC
    first = next((name for s, name in zip(sources, names, strict=True) if s.name and name), None)
    for i, source in enumerate(sources):
        if names[i] is None and not source.name:
            names[i] = first
    read: dict[str, CRS] = {}
    found = []
    for source, name in zip(sources, names, strict=True):
        if name is not None and name not in read:
            read[name] = _read(document, source, frame, name)
        found.append(read[name] if name is not None else None)
    _check(document, frame, sources, found)
    return found


def place(
    document: Document,
    frame: Map,
    sources: Sequence[Held],
    systems: Sequence[CRS | None],
    features: Sequence[list[Feature]],
    owners: Sequence[int],
    steps: int,
) -> Placed:
    """The features of several sources in the plane of the map.

    ``owners`` tell which step (the first ``steps`` of them) or static layer a source belongs to.
    With ``fit: each`` every step gets a projection of its own, as it is drawn in a frame of its
    own; static layers get that of the first step with polygons, whose frame is the map's.

    Raises
    ------
    SceneError
        For a projection that does not exist.
    """
    first = next((system for system in systems if system is not None), None)
    if first is None:
        return Placed(list(features), "")
    shapes = [geometries_of(of_one) for of_one in features]
    filled = [i for i, of_one in enumerate(shapes) if len(of_one)]
    apart = frame.fit == "each" and frame.projection == "auto" and first.is_geographic
    leader = min((owners[i] for i in filled if owners[i] < steps), default=0)
    groups: dict[int, list[int]] = {}
    for i in filled:
        own = apart and owners[i] < steps
        groups.setdefault(owners[i] if own else leader if apart else 0, []).append(i)
    problems = _told_apart(sources, systems, first)
    words, metres, plane = [], set(), None
    for owner, group in groups.items():
        deciding = [i for i in group if not apart or owners[i] == owner]
        chosen = _projection(document, frame, sources, systems, shapes, deciding, first)
        for i, placed in _onto(chosen, systems, shapes, group, problems):
            shapes[i] = placed
        words.append("" if frame.projection == "none" else chosen.words)
        metres.add(_metres(chosen.crs))
        if not apart or owner == leader:
            plane = chosen.crs
    if frame.y == "down" and frame.projection != "none" and first.is_geographic:
        message = '"y: down" turns projected data upside down'
        problems.append(Problem("upside down", "warning", message, hint="leave it out"))
    return Placed(
        [with_geometries(*of_one) for of_one in zip(features, shapes, strict=True)],
        "; ".join(dict.fromkeys(filter(None, words))),
        metres.pop() if len(metres) == 1 and not apart else None,
        tuple(problems),
        plane,
        first,
    )


def _projection(
    document: Document,
    frame: Map,
    sources: Sequence[Held],
    systems: Sequence[CRS | None],
    shapes: Sequence[Shapes],
    deciding: Sequence[int],
    first: CRS,
) -> Projection:
    """The projection of a map: the one named, that of the first source, or one that fits."""
    from geotween.data.globe.projection import fitting, named
    from geotween.data.globe.reproject import reproject

    together = np.concatenate([reproject(shapes[i], systems[i] or first, first) for i in deciding])
    if frame.projection == "none" or (frame.projection == "auto" and not first.is_geographic):
        own = named(first.to_wkt(), together, first)
        words = next((s.words for s in sources if s.words), "")
        return replace(own, crs=first, words=words or f"{_called(first)}, as the data are")
    if frame.projection == "auto":
        return fitting(together, first)
    try:
        return named(frame.projection, together, first)
    except ValueError as error:
        hint = "auto, none, an EPSG code such as EPSG:3035, or a PROJ string"
        raise SceneError([document.fault(_PROJECTION, f'"projection": {error}', hint)]) from None


def _onto(
    chosen: Projection,
    systems: Sequence[CRS | None],
    shapes: Sequence[Shapes],
    group: Sequence[int],
    problems: list[Problem],
) -> list[tuple[int, Shapes]]:
    """The geometries of some sources on a map, those of one system together."""
    from geotween.data.globe.reproject import project

    of_system: dict[str, list[int]] = {}
    for i in group:
        system = systems[i]
        of_system.setdefault(system.to_wkt() if system is not None else "", []).append(i)
    found: list[tuple[int, Shapes]] = []
    for members in of_system.values():
        system = systems[members[0]]
        together = np.concatenate([shapes[i] for i in members])
        if system is not None and not system.equals(chosen.crs, ignore_axis_order=True):
            together, met = project(together, system, chosen)
            problems += met
        starts = np.cumsum([len(shapes[i]) for i in members])[:-1]
        found += zip(members, np.split(together, starts), strict=True)
    return found


def _told_apart(
    sources: Sequence[Held], systems: Sequence[CRS | None], first: CRS
) -> list[Problem]:
    """A note for each source in another system than the first."""
    plane = next((source.words for source in sources if source.words), _called(first))
    return [
        Problem(
            "reprojected", "note",
            f"{source.name or 'what is written in the scene'} was reprojected to {plane}, "
            "as the first source is",
        )
        for source, system in zip(sources, systems, strict=True)
        if source.features
        and system is not None
        and not system.equals(first, ignore_axis_order=True)
    ]  # fmt: skip


def _metres(system: CRS) -> float | None:
    """How long a unit of a system is; None for degrees."""
    axis = system.axis_info[0]
    return float(axis.unit_conversion_factor) if system.is_projected else None


def _check_bare(document: Document, sources: Sequence[Held]) -> None:
    """Raise where coordinates without a system can be longitudes and latitudes in some files only.

    Those are planar in all of them, or in none.
    """
    boxes = [_bounds([source]) for source in sources]
    odd = [i for i, box in enumerate(boxes) if not _lonlat(box)]
    if not odd:
        return
    source, box = sources[odd[0]], boxes[odd[0]]
    if any(map(_swapped, boxes)):
        message = f"{source.name} has latitudes up to {_highest(box):g}"
        raise SceneError([document.fault(source.at, message, f"{_SWAPPED}; {_OR_PLANAR}")])
    if len(odd) < len(sources):
        message = f"{source.name} is not in longitude and latitude, as other files seem to be"
        hint = f"name its system: {{file: …, crs: …}}; {_OR_PLANAR}"
        raise SceneError([document.fault(source.at, message, hint)])


def _read(document: Document, source: Held, frame: Map, name: str) -> CRS:
    """A system by its name.

    Raises
    ------
    SceneError
        Where pyproj is missing, or knows no such system.
    """
    own = (*source.at[:-1], "crs") if source.at[-1:] == ("file",) else source.at
    at = own if source.crs else _MAP_CRS if frame.crs is not None else source.at
    try:
        from geotween.data.globe.projection import read_crs

        return read_crs(name)
    except ImportError:
        what = source.name or "the scene"
        message = f"{what} is in longitude and latitude: projecting it needs the package pyproj"
        if name != GEOGRAPHIC:
            message = f"{what} is in {name}: reading that needs the package pyproj"
        hint = "pip install 'geotween[geo]', or draw it as it is: map: {projection: none}"
        raise SceneError([document.fault(at, message, hint)]) from None
    except ValueError as error:
        raise SceneError([document.fault(at, f'"crs": {error}')]) from None


def _check(document: Document, frame: Map, sources: Sequence[Held], systems: Sequence[Any]) -> None:
    """Raise where a source's coordinates cannot be what they are said to be."""
    faults = []
    some = any(system is not None for system in systems)
    for source, system in zip(sources, systems, strict=True):
        if not source.features:
            continue
        box = _bounds([source])
        what = source.name or "the scene"
        if system is None:
            told = not source.name or source.lonlat or not _lonlat(box)
            if frame.projection != "none" and (frame.projection != "auto" or some or not told):
                hint = f"say what its coordinates are: map: {{crs: EPSG:4326}}; {_OR_PLANAR}"
                message = f"{what} names no coordinate reference system"
                faults.append(document.fault(source.at, message, hint))
        elif system.is_geographic and np.abs(box[[1, 3]]).max() > 90 + 1e-9:
            said = f"it is said to be in {_called(system)}: correct that"
            hint = _SWAPPED if _swapped(box) else f"{said}; {_OR_PLANAR}"
            message = f"{what} has latitudes up to {_highest(box):g}"
            faults.append(document.fault(source.at, message, hint))
    if faults:
        raise SceneError(faults)


def _bounds(sources: Sequence[Held]) -> NDArray[np.float64]:
    return bounds([feature for source in sources for feature in source.features])


def _lonlat(box: NDArray[np.float64]) -> bool:
    """Whether bounds may be of longitudes (of one turn, wherever it begins) and latitudes."""
    return bool(np.abs(box[[1, 3]]).max() <= 90 and box[0] >= -360 and box[2] <= 360)


def _swapped(box: NDArray[np.float64]) -> bool:
    return bool(np.abs(box[[0, 2]]).max() <= 90 and 90 < np.abs(box[[1, 3]]).max() <= 180)


def _highest(box: NDArray[np.float64]) -> float:
    return float(max(box[[1, 3]], key=abs))


def _called(system: CRS) -> str:
    return system.to_string() if len(system.to_string()) <= 40 else str(system.name)
