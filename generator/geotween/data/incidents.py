"""Incidents: points with times out of a table, as steps of hotspots."""

from __future__ import annotations

import csv
import datetime
import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.columns import SelectionError, select
from geotween.data.parse import LARGEST_COORDINATE
from geotween.data.polygons import Feature
from geotween.data.problems import Problem
from geotween.data.series import MOST_STEPS, Member
from geotween.data.sources import Held, SourceReader, there_are
from geotween.data.times import alike, periods_between, start_of, time_of, words_of
from geotween.scene.document import Location, read_text
from geotween.scene.errors import SceneError
from geotween.scene.model import Hotspots
from geotween.scene.values import Time

if TYPE_CHECKING:
    from geotween.data.hotspots import Hotspots as Dense

PLACE: Location = ("hotspots",)
SHARE = "20%"  # of the highest density: what a hotspot is where the scene does not say
GEOGRAPHIC = "OGC:CRS84"
SQUARE_KILOMETRE = 1e6  # m²: densities on the globe are for one, as people count them


class UnusableError(Exception):
    """Something about the points that the author has to mend: the word that names it, and why."""

    def __init__(self, word: str, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.word = word
        self.message = message
        self.hint = hint


@dataclass(frozen=True, eq=False)
class Incidents:
    """Points (n, 2) as they are written, and the time of each."""

    points: NDArray[np.float64]
    times: list[Time]


def hotspot_steps(reader: SourceReader, wanted: Hotspots) -> list[Member]:
    """A step for each period, with the areas where points are dense; faults go to the reader."""
    path = reader.path(wanted.file, (*PLACE, "file"))
    if path is None:
        return []
    try:
        incidents = _incidents(reader, path, wanted)
        return _steps(incidents, wanted)
    except UnusableError as error:
        place = (*PLACE, error.word) if error.word else PLACE
        reader.faults.append(reader.document.fault(place, error.message, error.hint))
    except SceneError as error:
        reader.faults += error.faults
    return []


def _steps(incidents: Incidents, wanted: Hotspots) -> list[Member]:
    from geotween.data.hotspots import hotspots

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
        raise UnusableError("", "hotspots need the packages scipy and contourpy", hint) from None
    except ValueError as error:
        raise UnusableError("", str(error)) from None
    names = [str(t) if isinstance(t, str) else f"{t:.15g}" for t in thresholds]
    ordered = [names[i] for i in np.argsort(levels, kind="stable")]
    told: tuple[Problem, ...] = (_told(dense, ordered, words),)
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
    per, unit, area = (SQUARE_KILOMETRE, "m", "km²") if words else (1.0, "map units", "square unit")
    message = (
        f"hotspots: bandwidth {dense.bandwidth:.4g} {unit}, "
        f"highest density {dense.peak * per:.4g} points per {area} and step"
    )
    shares = [
        f"{name} is {threshold * per:.4g}"
        for name, threshold in zip(names, dense.thresholds, strict=True)
        if name.endswith("%")
    ]
    return Problem("hotspots", "note", "; ".join([message, *shares]))


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
    else:
        dates = [time for time in times if isinstance(time, datetime.date)]
        if len(dates) < len(times):
            message = f'"period": {period} needs dates, and the times are numbers'
            raise UnusableError("period", message, "leave it out: each number is a step")
        ordered = sorted(dates)
        starts = [*periods_between(ordered[0], ordered[-1], period)]
        of_each = [start_of(date, period) for date in dates]
    if len(starts) > MOST_STEPS:
        message = f"the times make {len(starts)} steps, more than {MOST_STEPS}"
        raise UnusableError("time", message, "name a longer period: month or year")
    places = {start: number for number, start in enumerate(starts)}
    return starts, np.array([places[time] for time in of_each], dtype=np.intp)


def _in_plane(
    points: NDArray[np.float64], wanted: Hotspots
) -> tuple[NDArray[np.float64], str | None, str]:
    """Points in a plane of equal areas, its system and the words for it."""
    if wanted.lon is None:
        return points, wanted.crs, ""
    lat = points[:, 1]
    if np.abs(lat).max() > 90:
        swapped = np.abs(points[:, 0]).max() <= 90
        hint = "are latitude and longitude swapped?" if swapped else ""
        message = f'the column "{wanted.lat}" has latitudes up to {max(lat, key=abs):g}'
        raise UnusableError("lat", message, hint)
    try:
        from pyproj import Transformer
    except ImportError:
        hint = "pip install 'geotween[geo]', or name planar columns x and y"
        raise UnusableError("lon", "longitude and latitude need the package pyproj", hint) from None
    from geotween.data.projection import fitting, read_crs

    try:
        system = read_crs(wanted.crs or GEOGRAPHIC)
    except ValueError as error:
        raise UnusableError("crs", str(error)) from None
    around = shapely.box(*(points.min(axis=0) - 0.01), *(points.max(axis=0) + 0.01))
    chosen = fitting(np.array([around], dtype=object), system)
    way = Transformer.from_crs(system, chosen.crs, always_xy=True)
    return np.column_stack(way.transform(*points.T)), chosen.crs.to_string(), chosen.words


def _incidents(reader: SourceReader, path: Path, wanted: Hotspots) -> Incidents:
    """The points and times of a CSV."""
    named_by = reader.document.fault((*PLACE, "file"), "")
    text = read_text(path, wanted.file, named_by=named_by, encoding=wanted.encoding)
    names, rows = _table(text, wanted.file)
    across, up = (wanted.x, wanted.y) if wanted.x else (wanted.lon, wanted.lat)
    words = ("x", "y") if wanted.x else ("lon", "lat")
    columns = dict(zip((*words, "time"), map(str, (across, up, wanted.time)), strict=True))
    for word, column in columns.items():
        if column not in names:
            message = f'{wanted.file} has no column "{column}"'
            raise UnusableError(word, message, there_are(names))
    numbers: Sequence[int] = range(len(rows))
    if wanted.where is not None:
        try:
            kept = select(
                [dict(zip(names, map(_typed, row), strict=True)) for row in rows], wanted.where
            )
        except SelectionError as error:
            raise UnusableError("where", f'"where": {error}', there_are(names)) from None
        numbers, rows = kept, [rows[i] for i in kept]
    if not rows:
        raise UnusableError("where" if wanted.where else "file", "no point is selected")
    values = [[row[names.index(c)] for row in rows] for c in columns.values()]
    points = np.column_stack(
        [_numbers(v, wanted.file, w, numbers) for v, w in zip(values[:2], words, strict=True)]
    )
    return Incidents(points, _times(values[2], wanted, numbers))


def _table(text: str, name: str) -> tuple[list[str], list[list[str]]]:
    """The head and the rows of a CSV, whichever of comma, semicolon and tab parts its columns."""
    head = text.partition("\n")[0]
    delimiter = max(",;\t", key=head.count)
    try:
        lines = [
            row for row in csv.reader(io.StringIO(text), delimiter=delimiter, strict=True) if row
        ]
    except csv.Error as error:
        raise UnusableError("file", f"{name} is not CSV: {error}") from None
    if not lines:
        raise UnusableError("file", f"{name} is empty")
    names, rows = [column.strip() for column in lines[0]], lines[1:]
    for number, row in enumerate(rows, start=2):
        if len(row) != len(names):
            message = f"{name}, row {number}, has {len(row)} values for {len(names)} columns"
            raise UnusableError("file", message)
    return names, rows


def _typed(text: str) -> float | str | None:
    try:
        return float(text)
    except ValueError:
        return text or None


def _numbers(texts: list[str], name: str, word: str, numbers: Sequence[int]) -> NDArray[np.float64]:
    try:
        found = np.array(texts, dtype=np.float64)
    except ValueError:
        found = np.array([_number(text) for text in texts])
    wild = np.flatnonzero(~(np.abs(found) <= LARGEST_COORDINATE))
    if len(wild):
        more = f" (and {len(wild) - 1} more rows)" if len(wild) > 1 else ""
        message = f'{name}, row {numbers[wild[0]] + 2}: "{texts[wild[0]]}" is no coordinate{more}'
        raise UnusableError(word, message, "select the rows that have one: where: …")
    return found


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return np.nan


def _times(texts: list[str], wanted: Hotspots, numbers: Sequence[int]) -> list[Time]:
    known: dict[str, Time | None] = {}
    for text in texts:
        if text not in known:
            try:
                known[text] = time_of(text, wanted.time_format)
            except ValueError:
                known[text] = None
    times = [known[text] for text in texts]
    wrong = [i for i, time in enumerate(times) if time is None]
    if wrong:
        more = f" (and {len(wrong) - 1} more rows)" if len(wrong) > 1 else ""
        row = f"{wanted.file}, row {numbers[wrong[0]] + 2}"
        hint = "expected 2024-01-05, 2024-01-05T12:30 or a number; for others name time_format"
        raise UnusableError("time", f'{row}: "{texts[wrong[0]]}" is no time{more}', hint)
    try:
        return alike([time for time in times if time is not None])
    except ValueError as error:
        raise UnusableError("time", f'"time": {error}') from None
