"""Tracks that last for a part of the transition: when they are drawn, and what is proved."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from numpy.typing import ArrayLike

from geotween.data.polygons import Identity
from geotween.motion.looks import polygons_at
from geotween.motion.measure import invalid_frames
from geotween.motion.sweep import Proof, sweep
from geotween.motion.tracks import Film, Track, frame

SQUARE = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)


def track(
    *keys: ArrayLike, times: Sequence[float], key: str = "a", offsets: Sequence[int] = ()
) -> Track:
    vertices = np.array(keys, dtype=float)
    count = vertices.shape[1]
    who = Identity(key, keyed=True)
    ends = np.array(offsets or [0, count])
    flags = np.zeros(count, dtype=np.uint8)
    return Track(who, (who, who), "regions", np.array(times), vertices, ends, flags)


def told(proof: Proof) -> list[tuple[str, tuple[int, ...], float, float]]:
    assert not proof.undecided
    return [(v.kind, v.tracks, v.start, v.end) for v in proof.violations]


# A square that grows for a quarter of the time, one that takes its place, and one for the rest.
RELAY = [
    track(SQUARE, 2 * SQUARE, times=[0, 0.25]),
    track(2 * SQUARE, SQUARE, 3 * SQUARE, times=[0.25, 0.5, 0.75]),
    track(3 * SQUARE, SQUARE, times=[0.75, 1]),
]


@pytest.mark.parametrize(
    ("t", "side"), [(0, 1), (0.125, 1.5), (0.25, 2), (0.5, 1), (0.625, 2), (0.75, 3), (1, 1)]
)
def test_where_one_gives_way_to_the_next_that_one_is_drawn(t: float, side: float) -> None:
    (polygon,) = frame(RELAY, t).polygons
    assert polygon.area == side * side
    assert sum(one.is_there(t) for one in RELAY) == 1
    assert sorted(polygon.area for polygon in polygons_at(RELAY, t)) == [0, 0, side * side]


def test_what_is_not_there_is_nowhere() -> None:
    late = track(SQUARE, 2 * SQUARE, times=[0.5, 0.75])
    assert [len(frame([late], t).polygons) for t in (0, 0.49, 0.5, 0.74, 0.75, 1)] == [
        0, 0, 1, 1, 0, 0,
    ]  # fmt: skip


def test_it_is_exact_at_key_times_and_rests_exactly_in_between() -> None:
    third = SQUARE / 3 + 0.1
    one = track(third, third, SQUARE, times=[0.1, 0.3, 0.7])
    for t in (0.1, 0.2, 0.23, 0.3):
        assert np.array_equal(one.at(t), third)
    assert np.array_equal(one.at(0.7), SQUARE)


def test_a_relay_is_proved() -> None:
    assert told(sweep(RELAY)) == []
    assert not invalid_frames(RELAY, np.linspace(0, 1, 41)).any()


def test_tracks_overlap_only_while_both_are_there() -> None:
    over = [track(SQUARE, SQUARE, times=[0, 0.6]), track(SQUARE, SQUARE, times=[0.4, 1])]
    ((kind, tracks, start, end),) = told(sweep(over))
    assert (kind, tracks) == ("overlap", (0, 1))
    assert (start, end) == pytest.approx((0.4, 0.6))


def test_a_ring_may_touch_itself_when_it_begins_or_ends_and_not_between() -> None:
    """An arrow whose notch comes to its tip and goes back."""
    arrow = np.array([[0, 0], [2, 0], [1, 1], [0, 2], [0, 1]], dtype=float)
    shut = arrow.copy()
    shut[4] = [1, 1]
    parts = [track(arrow, shut, times=[0, 0.5]), track(shut, arrow, times=[0.5, 1])]
    assert told(sweep(parts)) == []
    whole = track(arrow, shut, arrow, times=[0, 0.5, 1])
    assert [kind for kind, *_ in told(sweep([whole]))] == ["self-touch"]


def test_where_two_of_a_film_join_the_frame_has_both_parts() -> None:
    """A bow tie that is one ring from here on, and two squares at this moment."""
    waist = np.array([[0, 0], [1, 1], [2, 0], [2, 2], [1, 1], [0, 2]], dtype=float)
    wide = waist + np.array([[0, 0], [0, -0.5], [0, 0], [0, 0], [0, 0.5], [0, 0]])
    plain = track(waist, wide, times=[0.5, 1])
    nodes = np.arange(6, dtype=np.int32)
    lives = np.array([[0.5] * 6, [1.0] * 6])
    filmed = Track(
        plain.identity, plain.ends, plain.layer, plain.times, plain.vertices, plain.offsets,
        plain.seams, Film(lives), nodes,
    )  # fmt: skip
    assert [p.area for p in frame([filmed], 0.5).polygons] == [1, 1]
    assert [p.area for p in frame([filmed], 1).polygons] == [3]
    assert told(sweep([filmed])) == []


@pytest.mark.parametrize("turn", [np.eye(2), np.array([[0.8, 0.6], [-0.6, 0.8]])])
def test_an_island_in_a_hole_that_touches_the_rim_where_it_does(turn: np.ndarray) -> None:
    """What lies between rim and hole at that point belongs to neither."""
    hole = np.array([[0, 0.0], [0.2, 0.6], [0.6, 0.2]])
    both = np.vstack([SQUARE, hole]) @ turn
    lake = track(both, both, times=[0, 1], offsets=[0, 4, 7])
    island = track(hole[::-1] @ turn, hole[::-1] @ turn, times=[0, 1], key="b")
    assert told(sweep([lake, island])) == []
    larger = hole[::-1] @ turn * 1.5
    grown = track(hole[::-1] @ turn, larger, times=[0, 1], key="b")
    assert [kind for kind, *_ in told(sweep([lake, grown]))] == ["overlap"]
