"""Holes: which go together, and that the others close and open within the other piece."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from shapely.affinity import affine_transform, translate
from shapely.geometry import Point, Polygon, box

import geotween
from geotween.motion.holes import plan_holes
from geotween.motion.morph import plan
from tests.motion.made import made, techniques
from tests.motion.shapes import blobs, seeds
from tests.motion.test_innermost import CHANGES

BIG = box(0, 0, 20, 10)


def holed(outline: Polygon, *holes: Polygon) -> Polygon:
    return Polygon(outline.exterior, [hole.exterior for hole in holes])


def square(x: float, y: float, half: float = 0.5) -> Polygon:
    return box(x - half, y - half, x + half, y + half)


def test_ab_that_overlap_with_ba_go_with_them() -> None:
    plan = plan_holes(
        holed(BIG, square(3, 5), square(9, 5)), holed(BIG, square(9.4, 5), square(3.4, 5))
    )
    assert sorted(plan.pairs) == [(0, 1), (1, 0)]
    assert not plan.closing
    assert not plan.opening


def test_a_hole_goes_with_one_beside_it() -> None:
    plan = plan_holes(holed(BIG, square(3, 5)), holed(BIG, square(4.5, 5)))
    assert plan.pairs == ((0, 0),)


def test_a_hole_that_would_travel_across_closes_and_another_opens() -> None:
    plan = plan_holes(holed(BIG, square(3, 5)), holed(BIG, square(16, 5)))
    assert plan.pairs == ()
    assert plan.closing[0] == pytest.approx([3, 5])
    assert plan.opening[0] == pytest.approx([16, 5])


def test_ab_go_with_the_two_that_are_nearest_together() -> None:
    # Alone, each would take the one at 5: b is nearer to it, and a has another one at 1.5.
    plan = plan_holes(
        holed(BIG, square(3.2, 5), square(6.3, 5)), holed(BIG, square(5, 5), square(1.5, 5))
    )
    assert sorted(plan.pairs) == [(0, 1), (1, 0)]


def test_a_hole_does_not_go_across_the_rim() -> None:
    bay = Polygon([(0, 0), (20, 0), (20, 10), (4.2, 10), (4, 2), (3.8, 10), (0, 10)])
    left, right = square(3, 6, 0.6), square(5, 6, 0.6)
    assert plan_holes(holed(BIG, left), holed(BIG, right)).pairs == ((0, 0),)
    assert plan_holes(holed(bay, left), holed(bay, right)).pairs == ()


def test_a_hole_does_not_go_across_another_one() -> None:
    wall = box(3.9, 1, 4.1, 9)
    left, right = square(3, 6, 0.6), square(5, 6, 0.6)
    plan = plan_holes(holed(BIG, wall, left), holed(BIG, wall, right))
    assert plan.pairs == ((0, 0),)
    assert set(plan.closing) == set(plan.opening) == {1}


def test_a_piece_that_travels_takes_its_hole_along() -> None:
    atoll = holed(Point(0, 0).buffer(2), square(0.8, 0))
    plan = plan_holes(atoll, translate(atoll, 50, 7))
    assert plan.pairs == ((0, 0),)


def test_the_hole_of_a_piece_that_travels_closes_where_it_would_be() -> None:
    atoll, island = holed(Point(0, 0).buffer(2), square(0.8, 0)), Point(50, 7).buffer(2)
    assert plan_holes(atoll, island).closing[0] == pytest.approx([50.8, 7])
    assert plan_holes(island, atoll).opening[0] == pytest.approx([50.8, 7])


def test_a_hole_closes_inside_the_partner_not_where_the_sea_comes_in() -> None:
    # The sea takes the right half, and with it the place where the lake lay.
    left = box(0, 0, 10, 10)
    lake = square(15, 5, 1)
    x, y = plan_holes(holed(BIG, lake), left).closing[0]
    assert [x, y] == pytest.approx([9.9, 5])


def test_a_hole_closes_beside_a_hole_that_opens_where_it_was_and_goes_elsewhere() -> None:
    # The small lake lies in what becomes part of the large one, whose partner is the large one.
    before = holed(BIG, box(4, 2, 8, 8), square(8.6, 5, 0.3))
    after = holed(BIG, box(4, 2, 9.5, 8))
    plan = plan_holes(before, after)
    assert plan.pairs == ((0, 0),)
    assert plan.closing[1] == pytest.approx([9.53, 5])


def test_a_moon_opens_from_its_thick_part() -> None:
    moon = Point(10, 5).buffer(2).difference(Point(10.8, 5).buffer(1.8))
    assert not moon.contains(moon.centroid)
    morph = geotween.morph([BIG], [holed(BIG, moon)], matching="rotation")
    for t, least in ((0.01, 1 - 1e-9), (0.5, 0.5), (0.99, 0.95)):
        (drawn,) = morph.frame(t).polygons
        (lake,) = (Polygon(ring) for ring in drawn.interiors)
        assert drawn.is_valid
        assert lake.intersection(moon).area >= least * lake.area


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_what_is_done_to_the_pieces_is_done_to_the_points(change: list[float]) -> None:
    piece = holed(BIG, square(3, 5), square(17, 3), square(8, 2, 0.2))
    partner = holed(box(0, 0, 15, 10), square(4.5, 5), Point(11, 6).buffer(1))
    before = plan_holes(piece, partner)
    after = plan_holes(*(affine_transform(end, change) for end in (piece, partner)))
    size = np.hypot(change[0], change[1])
    assert after.pairs == before.pairs == ((0, 0),)
    for one, other in ((before.closing, after.closing), (before.opening, after.opening)):
        assert one
        assert one.keys() == other.keys()
        for k, point in one.items():
            there = affine_transform(Point(point), change).coords[0]
            assert np.abs(other[k] - there).max() <= 1e-6 * size


@given(seeds)
def test_backwards_it_is_the_same(seed: int) -> None:
    one, other = (max(blobs(4, s, 4), key=lambda p: p.area) for s in (seed, seed + 1))
    there, back = plan_holes(one, other), plan_holes(other, one)
    assert sorted(there.pairs) == sorted((i, j) for j, i in back.pairs)
    for points, again in ((there.closing, back.opening), (there.opening, back.closing)):
        assert points.keys() == again.keys()
        assert all(np.allclose(points[k], again[k], atol=1e-9) for k in points)


@given(seeds)
def test_every_hole_has_one_partner_or_a_point_within_the_other_piece(seed: int) -> None:
    one, other = (max(blobs(4, s, 4), key=lambda p: p.area) for s in (seed, seed + 1))
    plan = plan_holes(one, other)
    for column, (piece, points) in enumerate(((one, plan.closing), (other, plan.opening))):
        holes = [pair[column] for pair in plan.pairs] + list(points)
        assert sorted(holes) == list(range(len(piece.interiors)))
    if one.intersection(other).area:
        assert all(other.contains(Point(point)) for point in plan.closing.values())
        assert all(one.contains(Point(point)) for point in plan.opening.values())


@pytest.mark.parametrize("family", ["holed", "nested"])
def test_made_transitions_with_holes_are_proved(family: str) -> None:
    proved = sum(plan(*made(family, k), techniques(family)).certificate.valid for k in range(12))
    assert proved == 12
