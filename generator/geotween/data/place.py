"""Places: every source's coordinates into the one plane that the map is drawn in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from geotween.data.polygons import Feature, Shapes, bounds, geometries_of, with_geometries
from geotween.data.problems import Problem
from geotween.data.sources import Held
from geotween.scene.document import Document, Location
from geotween.scene.errors import SceneError
from geotween.scene.model import Map

if TYPE_CHECKING:
    from pyproj import CRS

    from geotween.data.projection import Projection

GEOGRAPHIC = "OGC:CRS84"  # longitude, latitude on WGS 84: GeoJSON's own, by RFC 7946
_SWAPPED = "are latitude and longitude swapped? longitude (x) comes first"
_OR_PLANAR = "if they are planar, say map: {projection: none}"
_MAP_CRS: Location = ("map", "crs")
_PROJECTION: Location = ("map", "projection")


@dataclass(frozen=True, eq=False)
class Placed:
    """The features of each source in the map's plane, and how they came there.

    ``metres`` is the length of a unit of that plane, None where it is unknown.
    """

    features: list[list[Feature]]
    words: str
    metres: float | None = None
    projected: bool = False
    problems: tuple[Problem, ...] = ()


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
    if frame.projection == "none" and len({name for name in names if name}) < 2:
        return [None] * len(sources)  # without a need for pyproj
    bare = [i for i, s in enumerate(sources) if names[i] is None and s.lonlat and s.features]
    if bare and frame.projection != "none":
        _check_bare(document, [sources[i] for i in bare])
        if _lonlat(_bounds([sources[bare[0]]])):
            for i in bare:
                names[i] = GEOGRAPHIC
    first = next((name for s, name in zip(sources, names, strict=True) if s.name and name), None)
    for i, source in enumerate(sources):
        if names[i] is None and not source.name:
            names[i] = first
    known: dict[str, CRS] = {}
    found = []
    for source, name in zip(sources, names, strict=True):
        if name is not None and name not in known:
            known[name] = _read(document, source, frame, name)
        found.append(known[name] if name is not None else None)
    _check(document, frame, sources, found)
    return found


def place(
    document: Document,
    frame: Map,
    sources: Sequence[Held],
    systems: Sequence[CRS | None],
    features: Sequence[list[Feature]],
    owners: Sequence[int],
) -> Placed:
    """The features of several sources in the plane of the map.

    ``owners`` tell which step or static layer a source belongs to: with ``fit: each`` every one
    gets a projection of its own, as each is drawn in a frame of its own.

    Raises
    ------
    SceneError
        For a projection that does not exist.
    """
    first = next((system for system in systems if system is not None), None)
    if first is None:
        return Placed(list(features), "")
    shapes, problems = _in_one_system(sources, systems, features, first)
    if frame.projection == "none" or (frame.projection == "auto" and not first.is_geographic):
        known = next((s.words for s in sources if s.words), "")
        words = "" if frame.projection == "none" else known or f"{_called(first)}, as the data are"
        return Placed(_with(features, shapes), words, _metres(first), problems=tuple(problems))
    from geotween.data.reproject import project

    apart = frame.fit == "each" and frame.projection == "auto"
    groups: dict[int, list[int]] = {}
    for i, owner in enumerate(owners):
        groups.setdefault(owner if apart else 0, []).append(i)
    chosen: dict[str, Projection] = {}
    for group in groups.values():
        together = np.concatenate([shapes[i] for i in group])
        if not len(together):
            continue
        projection = _chosen(document, frame, together, first)
        projected, met = project(together, first, projection)
        starts = np.cumsum([len(shapes[i]) for i in group])[:-1]
        for i, part in zip(group, np.split(projected, starts), strict=True):
            shapes[i] = part
        chosen[projection.words] = projection
        problems += met
    if frame.y == "down":
        message = '"y: down" turns projected data upside down'
        problems.append(Problem("upside down", "warning", message, hint="leave it out"))
    units = {_metres(projection.crs) for projection in chosen.values()}
    metres = units.pop() if len(units) == 1 and not apart else None
    words = "; ".join(chosen)
    return Placed(_with(features, shapes), words, metres, projected=True, problems=tuple(problems))


def _in_one_system(
    sources: Sequence[Held],
    systems: Sequence[CRS | None],
    features: Sequence[list[Feature]],
    first: CRS,
) -> tuple[list[Shapes], list[Problem]]:
    """The geometries of each source in the first one's system."""
    from geotween.data.reproject import reproject

    shapes = [geometries_of(of_one) for of_one in features]
    problems = []
    for i, (source, system) in enumerate(zip(sources, systems, strict=True)):
        if system is not None and not system.equals(first, ignore_axis_order=True):
            shapes[i] = reproject(shapes[i], system, first)
            message = f"{source.name} was reprojected to {_called(first)}, as the first source is"
            problems.append(Problem("reprojected", "note", message))
    return shapes, problems


def _chosen(document: Document, frame: Map, shapes: Shapes, system: CRS) -> Projection:
    """The projection that the scene names, or that fits some shapes.

    Raises
    ------
    SceneError
        For one that does not exist.
    """
    from geotween.data.projection import fitting, named

    if frame.projection == "auto":
        return fitting(shapes, system)
    try:
        return named(frame.projection, shapes, system)
    except ValueError as error:
        hint = "auto, none, an EPSG code such as EPSG:3035, or a PROJ string"
        raise SceneError([document.fault(_PROJECTION, f'"projection": {error}', hint)]) from None


def _metres(system: CRS) -> float | None:
    """How long a unit of a system is; None for degrees."""
    axis = system.axis_info[0]
    return float(axis.unit_conversion_factor) if system.is_projected else None


def _with(features: Sequence[list[Feature]], shapes: Sequence[Shapes]) -> list[list[Feature]]:
    return [with_geometries(*of_one) for of_one in zip(features, shapes, strict=True)]


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
        from geotween.data.projection import read_crs

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
