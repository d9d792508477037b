"""Events of a fire and a hurricane, checked against the files by overlaps and geodesic areas."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import shapely
from pyproj import Geod
from shapely.geometry import shape

from geotween.data.load import load
from geotween.story.events import Event, Transition, scene_events
from tests.real_data import files, needs_real_data, write_scene

pytestmark = needs_real_data

GEOD = Geod(ellps="WGS84")
FINE = 0.02  # degrees: edges are straight in longitude and latitude, not geodesics
CREEK, SANDY = "wildfire_creek2020", "hurricane_sandy_winds"

KNOWN = {
    (CREEK, 0): [
        "merged Creek Fire, spot 1, spot 2",
        "grew Creek Fire",
        "appeared spot 1",
        "appeared spot 2",
    ],
    (CREEK, 1): ["merged Creek Fire, spot 1, spot 2", "grew Creek Fire"],
    (CREEK, 3): [
        "merged Creek Fire, spot 2",
        "grew Creek Fire",
        "grew spot 1",
        "appeared spot 2",
        "stable spot 3",
        "appeared spot 4",
    ],
    (CREEK, 4): [
        "merged Creek Fire, spot 2, spot 4",
        "grew Creek Fire",
        "grew spot 1",
        "stable spot 2",
        "appeared spot 3",
    ],
    (CREEK, 13): [
        "merged Creek Fire, spot 1, spot 3, spot 4, spot 5, spot 6",
        "grew Creek Fire",
        "grew spot 1",
        "appeared spot 2",
    ],
    (SANDY, 1): ["moved 34kt", "grew 34kt"],
    (SANDY, 6): ["moved 34kt", "grew 34kt", "moved 50kt", "grew 50kt", "appeared 64kt"],
    (SANDY, 9): [
        "moved 34kt",
        "grew 34kt",
        "moved 50kt",
        "shrank 50kt",
        "moved 64kt",
        "shrank 64kt",
    ],
    (SANDY, 17): ["moved 34kt", "grew 34kt", "moved 50kt", "shrank 50kt", "vanished 64kt"],
    (SANDY, 28): ["shrank 34kt", "moved 50kt", "shrank 50kt", "moved 64kt", "shrank 64kt"],
}


@cache
def transitions(name: str) -> tuple[Transition, ...]:
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        path = write_scene(Path(folder), name)
        text = path.read_text(encoding="utf-8")
        path.write_text(text.replace("class: category}", "class: category, key: id}"))
        return scene_events(load(path))


@cache
def raw(name: str, step: int) -> dict[str, Any]:
    """The polygons of a file by what they are called, edges in short pieces."""
    found = json.loads(files(name)[step].read_text(encoding="utf-8"))["features"]
    called = "name" if name == CREEK else "category"
    return {f["properties"][called]: shapely.segmentize(shape(f["geometry"]), FINE) for f in found}


def area(polygon: Any) -> float:
    return abs(float(GEOD.geometry_area_perimeter(shapely.orient_polygons(polygon))[0]))


def called(event: Event) -> list[str]:
    who = [event.subject, *(event.partners[1:] if event.kind == "merged" else event.partners)]
    return [i.name if i.class_ is None else i.class_ for i in who]


@pytest.mark.parametrize(("name", "number"), KNOWN, ids=lambda v: str(v))
def test_every_event_is_one_in_the_files(name: str, number: int) -> None:
    events = transitions(name)[number].events
    assert [f"{e.kind} {', '.join(called(e))}" for e in events] == KNOWN[name, number]
    here, there = raw(name, number), raw(name, number + 1)
    for event in events:
        mine, *others = called(event)
        if event.kind == "vanished":
            assert event.area_before == pytest.approx(area(here[mine]), rel=1e-3)
            continue
        assert event.area_after == pytest.approx(area(there[mine]), rel=1e-3)
        overlapping = {k for k, p in here.items() if p.intersection(there[mine]).area > 0}
        if event.kind == "appeared":
            assert name == SANDY or not overlapping
        elif event.kind == "merged":
            assert overlapping == {mine, *others}
            together = sum(area(here[k]) for k in overlapping)
            assert event.area_before == pytest.approx(together, rel=1e-3)
        else:
            (former,) = [mine] if name == SANDY else _largest(overlapping, here)
            before, after = area(here[former]), area(there[mine])
            assert event.area_before == pytest.approx(before, rel=1e-3)
            assert event.change == pytest.approx(after / before - 1, abs=2e-3)
            if event.kind in ("grew", "shrank"):
                assert (after > before) == (event.kind == "grew")


@pytest.mark.parametrize("name", [CREEK, SANDY, "us_regions"])
def test_what_is_measured_is_what_is_drawn_but_for_simplification(
    name: str, tmp_path: Path
) -> None:
    for step in load(write_scene(tmp_path, name)).steps:
        drawn, exact = step.regions, step.exact
        assert drawn.identities == exact.identities
        common = shapely.area(shapely.intersection(drawn.polygons, exact.polygons))
        assert (common > 0.5 * shapely.area(exact.polygons)).all()


def _largest(names: set[str], polygons: dict[str, Any]) -> list[str]:
    return [max(names, key=lambda name: polygons[name].area)]
