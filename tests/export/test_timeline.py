"""The timeline: rests and transitions in turn."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import geotween
from geotween.export.timeline import timeline

STEP = "polygons: [[0, 0], [1, 0], [1, 1]]"


def spans(write_scene: Callable[..., Path], timing: str, *steps: str) -> list[tuple[int, int]]:
    listed = "".join(f"  - {{{', '.join(filter(None, [step, STEP]))}}}\n" for step in steps)
    path = write_scene(f"title: t\ntiming: {timing}\nsteps:\n{listed}")
    return [(span.start, span.end) for span in timeline(geotween.load(path))]


def test_rest_move_rest(write_scene: Callable[..., Path]) -> None:
    assert spans(write_scene, "{transition: 2, hold: 1}", "", "") == [
        (0, 1000), (1000, 3000), (3000, 4000),
    ]  # fmt: skip


def test_a_step_may_rest_longer_and_no_time_at_all(write_scene: Callable[..., Path]) -> None:
    assert spans(write_scene, "{transition: 1, hold: 0}", "hold: 2", "") == [
        (0, 2000), (2000, 3000), (3000, 3000),
    ]  # fmt: skip


def test_a_list_names_each_transition(write_scene: Callable[..., Path]) -> None:
    found = spans(write_scene, "{transition: [1, 3], hold: 0}", "", "", "")
    assert [end - start for start, end in found] == [0, 1000, 0, 3000, 0]


def test_double_speed_halves_everything(write_scene: Callable[..., Path]) -> None:
    assert spans(write_scene, "{transition: 2, hold: 1, speed: 2}", "", "")[-1] == (1500, 2000)


@pytest.mark.parametrize(
    "times",
    [
        ("2020-01-01", "2020-01-04", "2020-01-05"),
        ("2020-01-01T00:00Z", "2020-01-01T03:00Z", "2020-01-01T04:00Z"),
        ("1900", "1903", "1904"),
    ],
)
def test_proportional_to_real_time(write_scene: Callable[..., Path], times: list[str]) -> None:
    timing = "{transition: proportional, total: 8, hold: 0}"
    found = spans(write_scene, timing, *(f"time: {time}" for time in times))
    assert [end - start for start, end in found] == [0, 6000, 0, 2000, 0]


def test_proportional_takes_two_seconds_a_transition_in_all(
    write_scene: Callable[..., Path],
) -> None:
    found = spans(
        write_scene, "{transition: proportional, hold: 0}", *(f"time: {t}" for t in "014")
    )
    assert [end - start for start, end in found] == [0, 1000, 0, 3000, 0]
