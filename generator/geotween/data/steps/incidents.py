"""Incidents: points with times, as steps of hotspots."""

from __future__ import annotations

import datetime
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.polygons import Feature
from geotween.data.problems import Problem
from geotween.data.read.held import GEOGRAPHIC, Held
from geotween.data.read.sources import SourceReader
from geotween.data.steps.points import (
    PLACE,
    Incidents,
    UnusableError,
    coordinates,
    read_incidents,
)
from geotween.data.steps.series import MOST_STEPS, Member
from geotween.data.steps.times import periods_between, start_of, words_of
from geotween.scene.errors import SceneError
from geotween.scene.model import Hotspots
from geotween.scene.values import Time

if TYPE_CHECKING:
    from geotween.data.steps.hotspots import Hotspots as Dense

SHARE = "20%"  # of the highest density: what a hotspot is where the scene does not say
NEARBY = 0.01  # degrees, a kilometre: the cells around points that a projection has to fit
SQUARE_KILOMETRE = 1e6  # m²: densities on the globe are for one, as people count them
FARTHEST_EAST = 360  # degrees: some count longitudes from 0 up to here
_WORDS = re.compile(r"[A-Z]?[a-z]+|[A-Z]+")  # startLat, LAT_1 and gps.lat have a word "lat"


def hotspot_steps(reader: SourceReader, wanted: Hotspots) -> list[Member]:
    """A step for each period, with the areas where points are dense; faults go to the reader."""
    path = reader.path(wanted.file, (*PLACE, "file"))
    if path is None:
        return []
    reader.reads.add(path)
    try:
        return _steps(read_incidents(reader, path, wanted), wanted)
    except UnusableError as error:
        place = (*PLACE, error.word) if error.word else PLACE
        reader.faults.append(reader.document.fault(place, error.message, error.hint))
    except SceneError as error:
        reader.faults += error.faults
    return []


def _steps(incidents: Incidents, wanted: Hotspots) -> list[Member]:
    from geotween.data.steps.hotspots import hotspots

    doubts = _doubts(incidents.points, wanted)
    starts, number = _periods(incidents.times, wanted.period)
    points, crs, words = _in_plane(incidents.points, wanted)
    thresholds = wanted.levels or (wanted.threshold or SHARE,)
    relative = isinstance(thresholds[0], str)
    levels = [_level(threshold, per=SQUARE_KILOMETRE if words else 1.0) for threshold in thresholds]
    try:
        dense = hotspots(
            points, number, len(starts), levels=levels, relative=relative,
            bandwidth=wanted.bandwidth,
        )  # fmt: skip
    except ImportError:
        hint = "pip install 'geotween[hotspots]'"
        raise UnusableError("", "hotspots need the package contourpy", hint) from None
    except ValueError as error:
        raise UnusableError("", str(error)) from None
    names = [str(t) if isinstance(t, str) else f"{t:.15g}" for t in thresholds]
    ordered = [names[i] for i in np.argsort(levels, kind="stable")]
    too_high = _too_high(dense, ordered, wanted, words)
    told = (*incidents.problems, *doubts, _told(dense, ordered, words), *too_high)
    members = []
    for start, polygons in zip(starts, dense.polygons, strict=True):
        features = [
            Feature(shape, class_=name, name=f"above {name}", attributes={"level": name})
            for name, shape in zip(ordered, polygons, strict=True)
            if not shape.is_empty
        ]
        # Without a system the points are planar, as coordinates written in the scene are.
        name = wanted.file if crs else ""
        held = Held(features, (*PLACE, "file"), name, crs, words, problems=told)
        members.append(Member(words_of(start, wanted.period), start, (held,)))
        told = ()
    return members


def _told(dense: Dense, names: Sequence[str], words: str) -> Problem:
    """What was chosen, for those who want to name it: in metres and per km² on the globe."""
    unit = "m" if words else "map units"
    message = (
        f"hotspots: bandwidth {dense.bandwidth:.4g} {unit}, "
        f"highest density {_peak(dense, words)} and step"
    )
    per = SQUARE_KILOMETRE if words else 1.0
    shares = [
        f"{name} is {threshold * per:.4g}"
        for name, threshold in zip(names, dense.thresholds, strict=True)
        if name.endswith("%")
    ]
    return Problem("hotspots", "note", "; ".join([message, *shares]))


def _peak(dense: Dense, words: str) -> str:
    peak, area = (dense.peak * SQUARE_KILOMETRE, "km²") if words else (dense.peak, "square unit")
    return f"{peak:.4g} points per {area}"


def _too_high(dense: Dense, names: Sequence[str], wanted: Hotspots, words: str) -> list[Problem]:
    """Levels that no step has a place above.

    Raises
    ------
    UnusableError
        Where all are.
    """
    empty = [all(shape.is_empty for shape in level) for level in zip(*dense.polygons, strict=True)]
    lost = [name for name, none in zip(names, empty, strict=True) if none]
    if not lost:
        return []
    above, most = ", ".join(lost), _peak(dense, words)
    message = f"no step has a place above {above}: the highest density is {most}"
    shares = [f"{name}%" for name in lost if not name.endswith("%") and float(name) < 100]
    hint = f"a share of it is written {shares[0]}" if shares else ""
    if all(empty):
        raise UnusableError("levels" if wanted.levels else "threshold", message, hint)
    return [Problem("unused level", "warning", message, hint=hint)]


def _level(threshold: float | str, *, per: float) -> float:
    """A share, or a density in points per square unit of the plane."""
    if isinstance(threshold, str):
        return float(threshold.removesuffix("%")) / 100
    return threshold / per


def _periods(times: list[Time], period: str | None) -> tuple[list[Time], NDArray[np.intp]]:
    """The start of each step, and the step that each time belongs to."""
    if period is None:
        starts: list[Time] = sorted(set(times))
        of_each: Sequence[Time] = times
        message = f"the times make {len(starts)} steps, more than {MOST_STEPS}"
    else:
        dates = [time for time in times if isinstance(time, datetime.date)]
        if len(dates) < len(times):
            message = f'"period": {period} needs dates, and the times are numbers'
            raise UnusableError("period", message, "leave it out: each number is a step")
        of_each = dates = [start_of(date, period) for date in _one_clock(dates, period)]
        first, last = min(dates), max(dates)
        starts = [*periods_between(first, last, period, MOST_STEPS)]
        ends = f"from {words_of(first, period)} to {words_of(last, period)}"
        message = f"more than {MOST_STEPS} {period}s lie {ends}"
    if len(starts) > MOST_STEPS:
        raise UnusableError("time", message, "name a longer period: month or year")
    places = {start: number for number, start in enumerate(starts)}
    return starts, np.array([places[time] for time in of_each], dtype=np.intp)


def _one_clock(dates: list[datetime.date], period: str) -> list[datetime.date]:
    """Dates whose hours begin at once: in the zone of the first, whatever their own."""
    zones = [date.tzinfo for date in dates if isinstance(date, datetime.datetime)]
    if period != "hour" or not zones or zones[0] is None:
        return dates
    try:
        return [d.astimezone(zones[0]) for d in dates if isinstance(d, datetime.datetime)]
    except OverflowError:
        raise UnusableError("time", "some times lie beyond the years 1 to 9999") from None


def _doubts(points: NDArray[np.float64], wanted: Hotspots) -> list[Problem]:
    """Columns that seem to be longitude and latitude, where they are taken for something else.

    Raises
    ------
    UnusableError
        Where the one is given as the other.
    """
    (word, across), (other, up) = coordinates(wanted).items()
    meant = _meant(across), _meant(up)
    swapped = meant[0] == "lat" or meant[1] == "lon"
    lon, lat = (up, across) if swapped else (across, up)
    hint = f"lon: {lon}, lat: {lat}"
    if word == "lon":
        if swapped:
            odd, place = (across, word) if meant[0] == "lat" else (up, other)
            called = {"lon": "longitude", "lat": "latitude"}[place]
            raise UnusableError(place, f'the column "{odd}" is given as the {called}', hint)
        return []
    farthest = np.abs(points[:, ::-1] if swapped else points).max(axis=0)
    if any(meant) and (farthest <= (180, 90)).all():
        message = f'the columns "{across}" and "{up}" are drawn as planar coordinates, in degrees'
        return [Problem("degrees", "warning", message, hint=hint)]
    return []


def _meant(column: str) -> str:
    """Whether a column is called a longitude (lon) or a latitude (lat), or neither."""
    words = [word.lower() for word in _WORDS.findall(column)]
    lon = any(word in ("lon", "lng", "long") or word.startswith("longit") for word in words)
    lat = any(word == "lat" or word.startswith("latit") for word in words)
    return "" if lon == lat else "lon" if lon else "lat"


def _in_plane(
    points: NDArray[np.float64], wanted: Hotspots
) -> tuple[NDArray[np.float64], str | None, str]:
    """Points in a plane of equal areas, its system and the words for it."""
    if wanted.lon is None:
        return points, wanted.crs, ""
    _check_degrees(points, wanted)
    try:
        from pyproj import Transformer
    except ImportError:
        hint = "pip install 'geotween[geo]', or name planar columns x and y"
        raise UnusableError("lon", "longitude and latitude need the package pyproj", hint) from None
    from geotween.data.globe.projection import fitting, read_crs

    try:
        system = read_crs(wanted.crs or GEOGRAPHIC)
    except ValueError as error:
        raise UnusableError("crs", str(error)) from None
    # Not one box around all: points on both sides of the antimeridian lie near each other.
    low = np.unique(np.floor(points / NEARBY) * NEARBY, axis=0).clip([-np.inf, -90], [np.inf, 89])
    chosen = fitting(shapely.box(*low.T, *(low + NEARBY).T), system)
    way = Transformer.from_crs(system, chosen.crs, always_xy=True)
    return np.column_stack(way.transform(*points.T)), chosen.crs.to_string(), chosen.words


def _check_degrees(points: NDArray[np.float64], wanted: Hotspots) -> None:
    farthest = [float(max(column, key=abs)) for column in points.T]
    (lon, lat), most = np.abs(farthest), (FARTHEST_EAST, 90)
    if lon <= most[0] and lat <= most[1]:
        return
    hint = "planar columns are x and y, and their system crs"
    if lon <= 90 and lat <= FARTHEST_EAST:
        hint = "are latitude and longitude swapped?"
    elif lon <= FARTHEST_EAST and lat <= FARTHEST_EAST:
        hint = ""
    if lat > most[1]:
        message = f'the column "{wanted.lat}" has latitudes up to {farthest[1]:g}'
        raise UnusableError("lat", message, hint)
    message = f'the column "{wanted.lon}" has longitudes up to {farthest[0]:g}'
    raise UnusableError("lon", message, hint)
