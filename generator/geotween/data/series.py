"""Series: the steps of a whole scene, out of one file with times or of several files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from geotween.data.polygons import Feature
from geotween.data.sources import Held, SourceReader, there_are
from geotween.data.times import (
    Period,
    alike,
    period_of,
    time_of,
    times_in_names,
    words_of,
    year,
)
from geotween.scene.document import Location
from geotween.scene.model import Data
from geotween.scene.values import Time

PLACE: Location = ("data",)
# More steps than anybody watches; a column of numbers that are no times makes thousands.
MOST_STEPS = 1000


@dataclass(frozen=True, eq=False)
class Member:
    """A step of a series: its time, what it is called by that, and what its sources hold."""

    label: str
    time: Time | None
    held: tuple[Held, ...]
    caption: str = ""
    hold: float = 0.0


def series(reader: SourceReader, data: Data, values: Any) -> list[Member]:
    """The steps that ``data`` makes, in the order of their times; faults go to the reader."""
    at: Location = (*PLACE, "file") if isinstance(values, dict) else PLACE
    before = len(reader.faults)
    files = reader.files(data, at)
    if len(reader.faults) > before or not files:
        return []
    if data.time is not None:
        return _by_column(reader, data, [held for _, held in files])
    if len(files) > 1:
        return _by_name(reader, data, [(path.stem, held) for path, held in files])
    fault = reader.document.fault
    known = dict.fromkeys(c for f in files[0][1].features for c in f.attributes)
    message = "one file with all steps needs the column of their times: time: …"
    reader.faults.append(fault(PLACE, message, there_are(list(known))))
    return []


def _by_name(reader: SourceReader, data: Data, files: list[tuple[str, Held]]) -> list[Member]:
    """A step for each file; its time is in its name, else the names tell the order."""
    times = times_in_names([stem for stem, _ in files])
    if times is None:
        if data.times is not None:
            message = '"times" needs a time in the name of each file, such as 2024-01-05'
            reader.faults.append(reader.document.fault((*PLACE, "times"), message))
        return [Member(stem, None, (held,)) for stem, held in files]
    order = sorted(range(len(files)), key=lambda i: times[i])
    members = _kept(reader, data, times, [[i] for i in order])
    return [Member(label, time, tuple(files[i][1] for i in rows)) for label, time, rows in members]


def _by_column(reader: SourceReader, data: Data, held: list[Held]) -> list[Member]:
    """A step for each distinct time of a column."""
    assert data.time is not None
    for one in held:
        if one.features:
            reader.check_columns(one, {"time": data.time})
    rows = [(number, feature) for number, one in enumerate(held) for feature in one.features]
    if not rows:
        message = "no feature is selected" if data.where else "the file has no polygon"
        reader.faults.append(reader.document.fault(PLACE, message))
    if reader.faults or not rows:
        return []
    times: list[Time] = []
    wrong: list[str] = []
    for number, feature in rows:
        value = feature.attributes.get(data.time)
        try:
            times.append(time_of(value, data.time_format))
        except ValueError:
            row = f"{held[number].name}, row {(feature.position or 0) + 1}"
            wrong.append(f"{row}: " + ("no time" if value is None else f'"{value}" is no time'))
    if wrong:
        _tell_wrong_times(reader, wrong)
        return []
    try:
        times = alike(times)
    except ValueError as error:
        reader.faults.append(reader.document.fault((*PLACE, "time"), f'"time": {error}'))
        return []
    moments: dict[Time, list[int]] = {}
    for index, time in enumerate(times):
        moments.setdefault(time, []).append(index)
    ordered = [moments[time] for time in sorted(moments)]
    members = []
    for label, time, chosen in _kept(reader, data, times, ordered):
        members.append(Member(label, time, _part(held, [rows[i] for i in chosen])))
        held = [replace(one, skipped=0, problems=()) for one in held]  # told by the first step
    return members


def _tell_wrong_times(reader: SourceReader, wrong: list[str]) -> None:
    more = f" (and {len(wrong) - 1} more rows)" if len(wrong) > 1 else ""
    hint = "expected 2024-01-05, 2024-01-05T12:30 or a number; for others name time_format"
    reader.faults.append(reader.document.fault((*PLACE, "time"), wrong[0] + more, hint))


def _kept(
    reader: SourceReader, data: Data, times: Sequence[Time], groups: list[list[int]]
) -> list[tuple[str, Time, list[int]]]:
    """Label, time and rows of each step: of all times, or of those and the periods named."""
    if data.times is None:
        if len(groups) > MOST_STEPS:
            message = f"the times make {len(groups)} steps, more than {MOST_STEPS}"
            hint = "name those to keep: times: […]"
            reader.faults.append(reader.document.fault(PLACE, message, hint))
            return []
        return [(words_of(times[rows[0]]), times[rows[0]], rows) for rows in groups]
    found = []
    for number, text in enumerate(data.times):
        place = (*PLACE, "times", number)
        try:
            wanted = period_of(text)
        except ValueError:
            hint = "expected a time, or a period: 2020, 2020-09, 2020-09-01/2020-09-14"
            message = f'"{text}" is no time and no period'
            reader.faults.append(reader.document.fault(place, message, hint))
            continue
        if isinstance(wanted, float) and not isinstance(times[0], float):
            wanted = year(wanted)
        rows = [i for group in groups for i in group if _meant(wanted, times[i])]
        if not rows:
            ends = (
                f"they run from {words_of(times[groups[0][0]])} to {words_of(times[groups[-1][0]])}"
            )
            message = f'there is nothing at "{text}"'
            reader.faults.append(reader.document.fault(place, message, ends))
            continue
        first = wanted.first if isinstance(wanted, Period) else wanted
        found.append((text, first, rows))
    return found


def _meant(wanted: Period | Time, time: Time) -> bool:
    if isinstance(wanted, Period):
        return wanted.holds(time)
    if type(wanted) is type(time):
        return wanted == time
    day = Period("", wanted, wanted, closed=True)  # a date among date-times is all of that day
    return day.holds(time)


def _part(held: list[Held], rows: list[tuple[int, Feature]]) -> tuple[Held, ...]:
    """Some features of some sources, each with the source it is from."""
    numbers = list(dict.fromkeys(number for number, _ in rows))
    return tuple(
        replace(held[n], features=[feature for number, feature in rows if number == n])
        for n in numbers
    )
