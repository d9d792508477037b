"""Moments by time, by place between steps, and all of a film."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from geotween.export.pictures.moments import (
    at_place,
    at_time,
    each_step,
    evenly,
    film,
    place_of,
    places,
    step_of,
    thinned,
)
from geotween.export.pictures.picture import Shown
from tests.export.pictures.conftest import GALLERY, gallery_scene


def test_the_clock_rests_one_second_moves_two_and_rests_one(squares: Shown) -> None:
    seen = [at_time(squares.frames, 1000 * s) for s in (0, 1, 1.5, 2, 2.5, 3, 4)]
    assert [place_of(squares.frames, moment) for moment in seen] == [0, 0, 0.25, 0.5, 0.75, 1, 1]
    assert [moment.step for moment in seen] == [0, 0, 0, 1, 1, 1, 1]


@pytest.mark.parametrize("name", GALLERY)
@given(share=st.floats(0, 1))
def test_a_time_and_its_place_are_one_moment(name: str, share: float) -> None:
    frames = gallery_scene(name).frames
    by_time = at_time(frames, share * frames.duration)
    by_place = at_place(frames, place_of(frames, by_time))
    if by_time.t in (0.0, 1.0):  # a transition's very ends look as the steps do
        return
    assert (by_place.span, by_place.t) == (by_time.span, pytest.approx(by_time.t))
    assert by_place.share == pytest.approx(by_time.share, abs=1e-6)


@pytest.mark.parametrize("place", [-0.1, 1.1, 7, float("nan")])
def test_a_place_beyond_the_steps_is_none(squares: Shown, place: float) -> None:
    with pytest.raises(ValueError, match="not a place between steps, which go from 0 to 1"):
        at_place(squares.frames, place)


@pytest.mark.parametrize(
    ("asked", "expected"),
    [
        ({}, [0, 1]),
        ({"at": "0, 0.5,1"}, [0, 0.5, 1]),
        ({"count": 5}, [0, 0.25, 0.5, 0.75, 1]),
        ({"count": 1}, [0]),
        ({"per_step": 4}, [0, 0.25, 0.5, 0.75, 1]),
    ],
)
def test_places_as_they_are_asked_for(
    squares: Shown, asked: dict[str, str | int], expected: list[float]
) -> None:
    assert places(squares.frames, **asked) == expected  # type: ignore[arg-type]


def test_each_step_is_among_the_places_of_a_scene() -> None:
    frames = gallery_scene("fire").frames
    assert each_step(frames) == list(range(6))
    assert set(range(6)) <= set(each_step(frames, 3))
    assert evenly(frames, 11) == each_step(frames, 2)


def test_a_step_by_label_and_by_number(squares: Shown) -> None:
    assert [step_of(squares.frames, name) for name in ("Before", "After", "0", "1")] == [0, 1, 0, 1]
    with pytest.raises(ValueError, match="no step '2'; there are Before, After"):
        step_of(squares.frames, "2")


@pytest.mark.parametrize("rate", [1, 4, 10, 30])
def test_a_film_is_as_long_as_the_map(squares: Shown, rate: float) -> None:
    runs = film(squares.frames, rate)
    assert sum(count for _, count in runs) == 4 * rate
    # What rests is drawn once.
    assert [count for moment, count in runs if moment.span == 0] == [rate + 1]
    assert all(one != other for (one, _), (other, _) in pairwise(runs))


@given(st.lists(st.tuples(st.integers(), st.integers(1, 9)), min_size=1), st.integers(1, 12))
def test_a_thinned_film_is_as_long(runs: list[tuple[int, int]], every: int) -> None:
    flat = [one for one, count in runs for _ in range(count)]
    fewer = [one for one, count in thinned(runs, every) for _ in range(count)]
    assert len(fewer) == len(flat)
    assert fewer[::every] == flat[::every]
