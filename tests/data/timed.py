"""Times, and scenes of squares with times."""

from __future__ import annotations

import datetime
import json
from collections.abc import Sequence
from typing import Any

from hypothesis import strategies as st
from shapely.geometry import box

from geotween.data.load import Scene
from tests.data.written import as_collection

DAYS = st.dates(datetime.date(1900, 1, 1), datetime.date(2100, 1, 1))
FLAT = "map: {projection: none, simplify: off}"


def day(text: str) -> datetime.date:
    return datetime.date.fromisoformat(text)


def moment(text: str) -> datetime.datetime:
    return datetime.datetime.fromisoformat(text)


def timed(times: Sequence[Any]) -> str:
    """GeoJSON: a square for each time, one beside the other, its number as key."""
    squares = [box(6 * i, 0, 6 * i + 4, 4) for i in range(len(times))]
    keys = [str(i) for i in range(len(times))]
    return json.dumps(as_collection(squares, {"t": list(times), "key": keys}))


def scene(data: str, more: str = "") -> str:
    return f"title: t\n{FLAT}\ndata: {data}\n{more}"


def steps_of(found: Scene) -> dict[str, list[Any]]:
    """The keys of each step, by its label."""
    return {step.label: [i.key for i in step.regions.identities] for step in found}
