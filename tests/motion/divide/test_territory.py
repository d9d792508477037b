"""Territory: what a correspondent covers is its own, the rest goes to the nearest."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely import affinity
from shapely.geometry import MultiPolygon, Polygon, box

import geotween
from geotween.motion.divide.territory import territory
from tests.motion.divide.partitions import SQUARE, areas, assert_partition, wedges
from tests.motion.shapes import star, tiles


def test_the_seam_runs_along_the_border_that_is_there() -> None:
    border = [(3, -1), (3, 4), (5, 4), (5, 9)]
    left, right = Polygon([(-1, -1), *border, (-1, 9)]), Polygon([*border, (9, 9), (9, -1)])
    one, other = geotween.divide(SQUARE, [left, right])
    assert one.equals(SQUARE & left)
    assert other.equals(SQUARE & right)


def test_a_cross_roads_keeps_its_four_corners() -> None:
    quarters = [box(x, y, x + 4, y + 4) for x in (0, 4) for y in (0, 4)]
    pieces = geotween.divide(SQUARE, quarters)
    for piece, quarter in zip(pieces, quarters, strict=True):
        assert piece.equals(quarter)
        assert len(piece.exterior.coords) == 5


def test_a_gap_is_shared_in_its_middle() -> None:
    left, right = geotween.divide(SQUARE, [box(0, 0, 3, 8), box(4, 0, 8, 8)])
    assert left.symmetric_difference(box(0, 0, 3.5, 8)).area < 1e-6
    assert right.symmetric_difference(box(3.5, 0, 8, 8)).area < 1e-6


def test_between_a_point_and_a_line_the_seam_is_a_parabola() -> None:
    tiny = Polygon([(3.999, 6), (4.001, 6), (4, 6.001)])
    near, _ = geotween.divide(SQUARE, [tiny, box(0, 0, 8, 2)])
    x = np.linspace(0.5, 7.5, 15)
    parabola = shapely.points(np.column_stack([x, 4 + (x - 4) ** 2 / 8]))
    assert shapely.distance(near.exterior, parabola).max() < 8e-3


def test_a_seam_begins_where_two_areas_part() -> None:
    # They touch up to (4, 4), then gape: the seam halves the angle from there.
    left, right = (
        Polygon([(0, 0), (4, 0), (4, 4), (0, 8)]),
        Polygon([(8, 0), (4, 0), (4, 4), (8, 8)]),
    )
    one, other = geotween.divide(SQUARE, [left, right])
    assert one.symmetric_difference(box(0, 0, 4, 8)).area < 1e-3
    assert other.covers(right)


def test_stable_parts_do_not_move() -> None:
    cells = tiles(7, 3)
    moved = [affinity.translate(cell, 0.3, 0.1) for cell in cells]
    for cell in cells:
        mine = [other for other in moved if (other & cell).area > 0.01]
        for piece, other in zip(geotween.divide(cell, mine), mine, strict=True):
            assert (piece & other).area == pytest.approx((cell & other).area, rel=0.05)


def test_where_some_overlap_it_goes_to_the_nearest_of_what_each_covers_alone() -> None:
    left, right = geotween.divide(SQUARE, [box(0, 0, 5, 8), box(3, 0, 8, 8)])
    assert left.symmetric_difference(box(0, 0, 4, 8)).area < 1e-6
    assert right.area == pytest.approx(32)


def test_one_that_lies_within_another_keeps_its_own() -> None:
    inner = box(3, 3, 5, 5)
    around, within = geotween.divide(SQUARE, [box(1, 1, 7, 7), inner])
    assert within.equals(inner)
    assert around.equals(SQUARE - inner)


def test_one_that_is_near_nothing_is_cut_from_the_nearest_piece() -> None:
    pieces, mends = territory(SQUARE, [box(0, 0, 4, 8), box(4, 0, 8, 8), box(20, 3, 21, 4)])
    assert_partition(SQUARE, pieces)
    assert [(mend.kind, mend.cell) for mend in mends] == [("empty cell", 2)]
    assert pieces[2].centroid.x > 4


def test_the_same_area_many_times_is_shared_out() -> None:
    pieces, mends = territory(SQUARE, [box(2, 2, 6, 6)] * 8)
    assert_partition(SQUARE, pieces)
    assert min(areas(pieces)) > SQUARE.area / 80
    assert len(mends) == 7


def test_wedges_around_a_vertex_share_the_square_alike() -> None:
    assert areas(geotween.divide(SQUARE, wedges(8))) == pytest.approx([8] * 8)


def test_both_parts_of_a_multipolygon_are_one_correspondent() -> None:
    ends = MultiPolygon([box(0, 0, 1, 8), box(7, 0, 8, 8)])
    around, middle = geotween.divide(SQUARE, [ends, box(3, 0, 5, 8)], connected=False)
    assert shapely.get_num_geometries(around) == 2
    assert middle.symmetric_difference(box(2, 0, 6, 8)).area < 1e-6


def test_crumbs_are_no_parts() -> None:
    # A speck of the first one's land in the second's.
    speck = MultiPolygon([box(0, 0, 4, 8), box(6, 6, 6.01, 6.01)])
    rest = box(4, 0, 8, 8) - speck
    one, _ = geotween.divide(SQUARE, [speck, rest], connected=False)
    assert one.equals(box(0, 0, 4, 8))


@pytest.mark.parametrize("off", [1e-15, 1e-13, 1e-11, 1e-9, 1e-7, 1e-5])
def test_outlines_drawn_twice_leave_no_hairs(off: float) -> None:
    cells = [affinity.rotate(cell, off, origin=(3, 1), use_radians=True) for cell in tiles(6, 4)]
    whole = box(0, 0, 10, 10)
    pieces = geotween.divide(whole, cells)
    assert_partition(whole, pieces)
    for piece in pieces:
        opened = piece.buffer(-3e-3, join_style="mitre").buffer(4e-3, join_style="mitre")
        assert (piece - opened).length < 0.1


@given(st.integers(0, 500), st.integers(2, 8))
def test_every_place_goes_to_what_covers_it_else_to_the_nearest(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    polygon = star(20, seed, 8)
    grid = [(x, y) for x in (-3, 0, 3) for y in (-3, 0, 3)]
    others = [star(6, seed + k, 1.4, *grid[at]) for k, at in enumerate(rng.permutation(9)[:count])]
    others = [other for other in others if (other & polygon).area > 0.05]
    if len(others) < 2:
        return
    pieces = geotween.divide(polygon, others, connected=False)
    places = shapely.points(rng.uniform(-6, 6, (200, 2)))
    gaps = np.sort(shapely.distance(places[:, None], np.array(others)), axis=1)
    sure = shapely.contains(polygon, places) & (gaps[:, 1] - gaps[:, 0] > 0.1)
    for place in places[sure]:
        owner = int(np.argmin(shapely.distance(others, place)))
        assert shapely.distance(pieces[owner], place) < 0.02


def test_weights_give_each_its_share() -> None:
    others = [star(6, k, 1.2, *place) for k, place in enumerate([(2, 2), (6, 2), (2, 6), (6, 6)])]
    wanted = [1.0, 2.0, 3.0, 4.0]
    pieces = geotween.divide(SQUARE, others, weights=wanted)
    assert_partition(SQUARE, pieces)
    assert np.array(areas(pieces)) / 64 == pytest.approx(np.array(wanted) / 10, rel=0.03)


def test_weights_by_area() -> None:
    others = [box(0, 0, 1, 1), box(5, 5, 8, 8)]
    assert areas(geotween.divide(SQUARE, others, weights="area")) == pytest.approx(
        [6.4, 57.6], rel=0.03
    )


def test_a_region_grows_with_its_weight() -> None:
    others = [box(1, 1, 2, 2), box(6, 6, 7, 7)]
    sizes = [geotween.divide(SQUARE, others, weights=[w, 1])[0].area for w in (0.25, 0.5, 1, 2, 4)]
    assert all(small < large for small, large in pairwise(sizes))
