"""Scenes of squares with times."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from shapely.geometry import box

from geotween.data.load import Scene
from tests.data.written import as_collection

FLAT = "map: {projection: none, simplify: off}"


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
