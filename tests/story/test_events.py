"""Events of small pictures: what is told, of whom, by how much."""

from __future__ import annotations

from random import Random

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from geotween.data.polygons import Feature, Identity, Key, PolygonSet, polygon_set
from geotween.story.events import CHANGED, KINDS, Event
from geotween.story.measure import Plane
from tests.story.pictures import Box, boxes, events_of, keyed, told

Floats = NDArray[np.float64]

A: Box = (0, 0, 4, 4)
EMPTY = boxes()
BACK = {
    "appeared": "vanished",
    "vanished": "appeared",
    "split": "merged",
    "merged": "split",
    "grew": "shrank",
    "shrank": "grew",
}


def test_a_square_that_stays_is_stable() -> None:
    assert told(boxes(A), boxes(A)) == ["stable 1"]


def test_from_nothing_to_a_square_and_back_appears_and_vanishes() -> None:
    assert told(EMPTY, boxes(A)) == ["appeared 1"]
    assert told(boxes(A), EMPTY) == ["vanished 1"]
    assert told(EMPTY, EMPTY) == []


def test_growth_on_one_side_is_no_move() -> None:
    (event,) = events_of(boxes(A), boxes((0, 0, 8, 4)))
    assert (event.kind, event.change, event.distance) == ("grew", 1.0, None)
    assert (event.area_before, event.area_after) == (16, 32)


@pytest.mark.parametrize(("width", "kinds"), [(4 * 1.009, ["stable"]), (4 * 1.0102, ["grew"])])
def test_growth_counts_from_one_percent_of_the_larger_area(width: float, kinds: list[str]) -> None:
    assert CHANGED == 0.01
    assert [event.kind for event in events_of(boxes(A), boxes((0, 0, width, 4)))] == kinds


@pytest.mark.parametrize(("way", "kinds"), [(0.19, ["stable"]), (0.21, ["moved"])])
def test_a_move_counts_from_a_twentieth_of_the_width(way: float, kinds: list[str]) -> None:
    assert [event.kind for event in events_of(boxes(A), boxes((way, 0, 4 + way, 4)))] == kinds


@pytest.mark.parametrize(
    ("box", "bearing", "down"),
    [
        ((0, 2, 4, 6), 0, 180),
        ((2, 0, 6, 4), 90, 90),
        ((2, 2, 6, 6), 45, 135),
        ((-2, 0, 2, 4), 270, 270),
    ],
)
def test_bearings_are_clockwise_from_up(box: Box, bearing: float, down: float) -> None:
    (event,) = events_of(boxes(A), boxes(box))
    assert event.kind == "moved"
    assert event.bearing == pytest.approx(bearing)
    assert event.distance == pytest.approx(np.hypot(box[0], box[1]))
    (turned,) = events_of(boxes(A), boxes(box), Plane(down=True))
    assert turned.bearing == pytest.approx(down)


def test_what_moves_and_grows_has_both_events() -> None:
    assert told(boxes(A), boxes((2, 0, 7, 5))) == ["moved 1", "grew 1"]


def test_a_square_that_falls_apart_in_halves_splits() -> None:
    (event,) = events_of(boxes(A), boxes((0, 0, 1.8, 4), (2.2, 0, 4, 4)))
    assert (event.kind, event.before, event.after) == ("split", (0,), (0, 1))
    assert event.change == pytest.approx(-0.1)


def test_a_square_that_loses_a_corner_lives_on() -> None:
    assert told(boxes(A), boxes((0, 0, 3, 4), (3.5, 0, 4, 1))) == ["shrank 1", "split 1 1 2"]


def test_two_spots_that_a_fire_swallows_merge_with_it_and_it_grows() -> None:
    before = boxes(A, (5, 0, 6, 1), (5, 2, 6, 3))
    assert told(before, boxes((0, 0, 7, 4))) == ["merged 1 1 2 3", "grew 1"]


def test_two_halves_that_join_merge_and_nobody_lives_on() -> None:
    assert told(boxes((0, 0, 1.8, 4), (2.2, 0, 4, 4)), boxes(A)) == ["merged 1 1 2"]


def test_a_border_that_shifts_by_a_third_is_no_split() -> None:
    before, after = boxes((0, 0, 3, 3), (3, 0, 6, 3)), boxes((0, 0, 2, 3), (2, 0, 6, 3))
    assert told(before, after) == ["shrank 1", "grew 2"]


def test_two_that_exchange_a_piece_are_not_told_to_merge() -> None:
    before = boxes((0, 0, 3, 1), (3, 0, 6, 1))
    after = boxes((0, 0, 3.3, 1), (3.3, 0, 6, 1))
    assert told(before, after) == ["grew 1", "shrank 2"]


def test_neighbours_that_divide_a_third_are_told_so() -> None:
    before = keyed(a=(0, 0, 3, 1), b=(3, 0, 6, 1), c=(6, 0, 9, 1))
    after = keyed(a=(0, 0, 4.7, 1), c=(4.7, 0, 9, 1))
    assert told(before, after) == [
        "merged a a b", "grew a", "merged c b c", "grew c", "split b a c",
    ]  # fmt: skip


def test_a_new_key_inside_of_one_that_lives_on_splits_off() -> None:
    before, after = keyed(a=(0, 0, 9, 1)), keyed(a=(0, 0, 8, 1), n=(8, 0, 9, 1))
    assert told(before, after) == ["shrank a", "split a a n"]


def test_a_key_lives_on_where_most_of_it_went_to_another() -> None:
    before, after = keyed(a=(0, 0, 9, 1)), keyed(a=(8, 0, 9, 1), n=(0, 0, 8, 1))
    assert told(before, after) == ["shrank a", "split a a n"]


def test_a_new_name_in_place_has_the_former_one_as_partner() -> None:
    assert told(keyed(a=A), keyed(b=A)) == ["stable b a"]


def test_parts_of_a_key_are_one_thing() -> None:
    before, after = keyed(a=[A, (5, 0, 6, 1)]), keyed(a=[A, (5, 0, 6, 1), (5, 2, 6, 3)])
    (event,) = events_of(before, after)
    assert (event.kind, event.area_before, event.area_after) == ("grew", 17, 18)
    assert (event.before, event.after) == ((0, 1), (0, 1, 2))


def test_a_thing_that_travels_far_is_followed_by_its_key() -> None:
    assert told(keyed(a=A), keyed(a=(40, 0, 44, 4))) == ["moved a"]
    assert told(boxes(A), boxes((40, 0, 44, 4))) == ["appeared 1", "vanished 1"]
    assert told(boxes(A), boxes((40, 0, 44, 4)), correspondence="within", radius=50) == ["moved 1"]


def test_layers_have_nothing_to_do_with_each_other() -> None:
    here = polygon_set([Feature(shapely.box(*A), layer="low")])
    there = polygon_set([Feature(shapely.box(*A), layer="high")])
    assert told(here, there) == ["appeared 1", "vanished 1"]


def test_without_a_measure_nothing_is_compared() -> None:
    found = events_of(boxes(A, (9, 0, 10, 1)), boxes((0, 0, 1.9, 4), (2, 0, 4, 4)), None)
    assert [(e.kind, e.area_before, e.change) for e in found] == [
        ("split", None, None), ("vanished", None, None),
    ]  # fmt: skip


# Properties


@st.composite
def sets(draw: st.DrawFn) -> PolygonSet:
    """Up to six cells of a coarse board, some of them shifted, some with keys."""
    cells = draw(st.lists(st.tuples(st.integers(0, 2), st.integers(0, 2)), unique=True, max_size=6))
    features = []
    for x, y in cells:
        low, size = draw(st.integers(0, 2)), draw(st.integers(1, 3))
        box = shapely.box(6 * x + low, 6 * y, 6 * x + low + size, 6 * y + size + low)
        features.append(Feature(box, f"{x}{y}" if draw(st.booleans()) else None))
    return polygon_set(features)


@given(sets(), sets())
def test_everything_is_told_and_no_area_is_lost(origin: PolygonSet, target: PolygonSet) -> None:
    found = events_of(origin, target)
    assert {index for event in found for index in event.before} == set(range(len(origin)))
    assert {index for event in found for index in event.after} == set(range(len(target)))
    for event in found:
        for places, end, area in (
            (event.before, origin, event.area_before),
            (event.after, target, event.area_after),
        ):
            known = shapely.area(end.polygons[list(places)]).sum()
            assert known == pytest.approx(area or 0)


@given(sets(), sets())
def test_backwards_in_time_events_are_the_opposite_ones(
    origin: PolygonSet, target: PolygonSet
) -> None:
    there = {_place(e) for e in events_of(origin, target)}
    back = {_place(e) for e in events_of(target, origin)}
    assert back == {(BACK.get(kind, kind), after, before) for kind, before, after in there}


@given(sets(), sets(), st.sampled_from([1e-9, 1e9]), st.sampled_from([0, 1, 2, 3]), st.booleans())
def test_turned_mirrored_and_rescaled_it_is_the_same_story(
    origin: PolygonSet, target: PolygonSet, scale: float, quarters: int, mirrored: bool
) -> None:
    def other(points: Floats) -> Floats:
        turned = points * [-1, 1] if mirrored else points
        for _ in range(quarters):
            turned = turned[:, ::-1] * [-1, 1]
        return np.asarray(turned * scale)

    def changed(polygons: PolygonSet) -> PolygonSet:
        return polygon_set(
            [Feature(shapely.transform(p, other), _key(i)) for p, i in _parts(polygons)]
        )

    here = [_place(e) for e in events_of(origin, target)]
    assert here == [_place(e) for e in events_of(changed(origin), changed(target))]


@given(sets(), sets(), st.randoms(use_true_random=False))
def test_the_order_of_polygons_does_not_matter(
    origin: PolygonSet, target: PolygonSet, random: Random
) -> None:
    order = list(range(len(target)))
    random.shuffle(order)
    parts = _parts(target)
    shuffled = polygon_set([Feature(parts[k][0], _key(parts[k][1])) for k in order])
    found = {
        (e.kind, e.before, tuple(sorted(order[k] for k in e.after)))
        for e in events_of(origin, shuffled)
    }
    assert found == {_place(e) for e in events_of(origin, target)}


def _key(identity: Identity) -> Key | None:
    return identity.key if identity.keyed else None


def _parts(polygons: PolygonSet) -> list[tuple[shapely.Polygon, Identity]]:
    return list(zip(polygons.polygons, polygons.identities, strict=True))


def _place(event: Event) -> tuple[str, tuple[int, ...], tuple[int, ...]]:
    assert event.kind in KINDS
    return event.kind, event.before, event.after
