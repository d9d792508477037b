"""Series: the steps of a whole scene, out of one file with times or of several files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from geotween.data.polygons import Feature
from geotween.data.problems import Problem
from geotween.data.read.sources import Held, SourceReader, there_are
from geotween.data.steps.file_names import UNDERSTOOD, looks_like_a_date, times_in_names
from geotween.data.steps.times import (
    CODES,
    alike,
    check_pattern,
    period_of,
    time_of,
    words_of,
    wrong_time,
)
from geotween.scene.document import Location
from geotween.scene.model import Data
from geotween.scene.values import Time

PLACE: Location = ("data",)
# More steps than anybody watches; a column of numbers that are no times makes thousands.
MOST_STEPS = 1000
SHOWN = 3  # names of files listed in a message


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
        return _by_name(reader, data, [path for path, _ in files], [held for _, held in files])
    known = dict.fromkeys(c for f in files[0][1].features for c in f.attributes)
    message = "one file with all steps needs the column of their times: time: …"
    _tell(reader, (), message, there_are(list(known)))
    return []


def _by_name(
    reader: SourceReader, data: Data, paths: Sequence[Path], held: Sequence[Held]
) -> list[Member]:
    """A step for each time in the names of files; a step for each file where they have none."""
    found = times_in_names([path.stem for path in paths])
    times = [time for time in found if time is not None]
    without = [path.name for path, time in zip(paths, found, strict=True) if time is None]
    if times and without:
        dated = next(path.name for path in paths if path.name not in without)
        message = f"{_listed(without)} has no time in its name, as {dated} has"
        _tell(reader, ("file",), message, f"rename it, or take it out of the files; {UNDERSTOOD}")
        return []
    if not times and data.times is not None:
        message = '"times" needs a time in the name of each file, such as 2024-01-05'
        _tell(reader, ("times",), message)
        return []
    if not times:
        first = replace(held[0], problems=(*held[0].problems, _without_times(without)))
        sources = [first, *held[1:]]
        return [Member(p.stem, None, (one,)) for p, one in zip(paths, sources, strict=True)]
    members = []
    for label, time, files in _kept(reader, data, times):
        together = [held[i] for i in files]
        if len(files) > 1 and data.times is None:
            message = (
                f"{_listed([paths[i].name for i in files])} are of one time: they are one step"
            )
            note = Problem("one time", "note", message, (label,))
            together[0] = replace(together[0], problems=(*together[0].problems, note))
        members.append(Member(label, time, tuple(together)))
    return members


def _without_times(names: Sequence[str]) -> Problem:
    """That files follow each other by their names; a warning where these seem to have dates."""
    dated = [name for name in names if looks_like_a_date(Path(name).stem)]
    if dated:
        message = f"no time can be read in the names of the files, such as {dated[0]}"
        return Problem("no times", "warning", message, hint=UNDERSTOOD)
    message = f"the steps follow each other as the names of the files do: {_listed(names)}"
    return Problem("no times", "note", message)


def _by_column(reader: SourceReader, data: Data, held: list[Held]) -> list[Member]:
    """A step for each distinct time of a column."""
    assert data.time is not None
    for one in held:
        if one.features:
            reader.check_columns(one, {"time": data.time})
    rows = [(number, feature) for number, one in enumerate(held) for feature in one.features]
    if not rows and not reader.faults:
        _tell_nothing(reader, held)
    if reader.faults:
        return []
    members = []
    for label, time, chosen in _kept(reader, data, _times(reader, data, held, rows)):
        members.append(Member(label, time, _part(held, [rows[i] for i in chosen])))
        held = [replace(one, skipped=0, problems=()) for one in held]  # told by the first step
    return members


def _tell_nothing(reader: SourceReader, held: Sequence[Held]) -> None:
    """That files hold no polygon, or that none of them is selected."""
    for one in held:
        for problem in one.problems:
            if problem.kind == "no selection":
                _tell(reader, ("where",), problem.message, problem.hint)
                return
    skipped = sum(one.skipped for one in held)
    message = f"no polygon is in {_listed([one.name for one in held])}"
    why = f": the {skipped} features are points, lines or empty" if skipped else ""
    _tell(reader, (), message + why)


def _times(
    reader: SourceReader, data: Data, held: Sequence[Held], rows: Sequence[tuple[int, Feature]]
) -> list[Time]:
    """The time of each row; empty where one cannot be read."""
    times: list[Time] = []
    wrong: list[tuple[str, Any]] = []
    try:
        check_pattern(data.time_format)
    except ValueError as error:
        _tell(reader, ("time_format",), str(error), CODES)
        return []
    for number, feature in rows:
        value = feature.attributes.get(str(data.time))
        try:
            times.append(time_of(value, data.time_format))
        except ValueError:
            wrong.append((f"{held[number].name}, row {(feature.position or 0) + 1}", value))
    if wrong:
        row, value = wrong[0]
        word, why, hint = wrong_time(value, data.time_format)
        more = f" (and {len(wrong) - 1} more rows)" if len(wrong) > 1 else ""
        _tell(reader, (word,), f"{row}: {why}{more}", hint)
        return []
    try:
        return alike(times)
    except ValueError as error:
        _tell(reader, ("time",), f'"time": {error}')
        return []


def _kept(
    reader: SourceReader, data: Data, times: Sequence[Time]
) -> list[tuple[str, Time, list[int]]]:
    """Label, time and rows of each step: of all times, or of those and the periods named."""
    rows_at: dict[Time, list[int]] = {}
    for row, time in enumerate(times):
        rows_at.setdefault(time, []).append(row)
    ordered = sorted(rows_at)
    if not ordered:
        return []
    if data.times is not None:
        return _named(reader, data.times, [(time, rows_at[time]) for time in ordered])
    if len(ordered) > MOST_STEPS:
        message = f"the times make {len(ordered)} steps, more than {MOST_STEPS}"
        _tell(reader, (), message, "name those to keep: times: […]")
        return []
    return [(words_of(time), time, rows_at[time]) for time in ordered]


def _named(
    reader: SourceReader, texts: Sequence[str], groups: Sequence[tuple[Time, list[int]]]
) -> list[tuple[str, Time, list[int]]]:
    """Label, time and rows of each time or period that a scene names."""
    first, last = groups[0][0], groups[-1][0]
    found: list[tuple[str, Time, list[int]]] = []
    for number, text in enumerate(texts):
        place = ("times", number)
        try:
            wanted = period_of(text)
        except ValueError:
            hint = "expected a time, or a period: 2020, 2020-09, 2020-09-01/2020-09-14"
            _tell(reader, place, f'"{text}" is no time and no period', hint)
            continue
        try:
            rows = [row for time, at_it in groups if wanted.holds(time) for row in at_it]
        except ValueError as error:
            _tell(reader, place, f'"{text}": {error}')
            continue
        if rows:
            found.append((text, wanted.start(first), rows))
        else:
            hint = f"they run from {words_of(first)} to {words_of(last)}"
            _tell(reader, place, f'there is nothing at "{text}"', hint)
    starts = alike([start for _, start, _ in found])
    return [(text, start, rows) for (text, _, rows), start in zip(found, starts, strict=True)]


def _part(held: list[Held], rows: list[tuple[int, Feature]]) -> tuple[Held, ...]:
    """Some features of some sources, each with the source it is from."""
    numbers = list(dict.fromkeys(number for number, _ in rows))
    return tuple(
        replace(held[n], features=[feature for number, feature in rows if number == n])
        for n in numbers
    )


def _listed(names: Sequence[str]) -> str:
    more = len(names) - SHOWN
    return ", ".join(names[:SHOWN]) + (f" and {more} more" if more > 0 else "")


def _tell(reader: SourceReader, at: Location, message: str, hint: str = "") -> None:
    reader.faults.append(reader.document.fault((*PLACE, *at), message, hint))
