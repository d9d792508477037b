"""The parts that coarse arrivals are made from, on pictures small enough to check by eye."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from shapely.geometry import Polygon, box

from geotween.motion.front.bands import bands_of, simplified
from geotween.motion.front.exact import turns
from geotween.motion.front.flaws import flaws
from geotween.motion.front.knots import Knots, below, divided
from geotween.motion.front.levels import Arrivals
from geotween.motion.front.meshes import Spans
from geotween.motion.front.plane import NOTHING, Change
from geotween.motion.front.skeleton import Skeleton
from geotween.motion.front.triangulate import triangulated
from tests.motion.front.test_levels import PICTURES, coarse, set_of

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


def polygons(*shapes: Polygon) -> NDArray[np.object_]:
    return np.array(shapes, dtype=object)


def skeleton(level: list[tuple[float, float]]) -> Skeleton:
    """The square from 0 to 4, parted by a level from (0, 2) to (4, 2) through further points."""
    rim = [(0.0, 0.0), (4.0, 0.0), (4.0, 2.0), (4.0, 4.0), (0.0, 4.0), (0.0, 2.0)]
    points = np.array(rim + level)
    around = [(i, (i + 1) % 6) for i in range(6)]
    chain = [5, *range(6, 6 + len(level)), 2]
    edges = np.array(around + list(pairwise(chain)))
    lower = [0, 1, 5]
    bands = [(0 if i in lower else 1, NOTHING) for i in range(6)] + [(1, 0)] * (len(chain) - 1)
    levels = np.append(np.full(6, NOTHING), np.ones(len(level), dtype=np.intp))
    lines = np.append(np.arange(6), np.full(len(chain) - 1, NOTHING))
    none = np.empty(0)
    return Skeleton(
        points, 6, none.astype(np.intp), none, none, levels, edges, lines, np.array(bands)
    )


TWO_BANDS = Spans(np.zeros(1), np.ones(1), np.array([2]), np.array([1024]))


def test_a_level_parts_a_square_into_two_bands() -> None:
    faces, band, broken = bands_of(skeleton([(2.0, 2.0)]))
    assert band.tolist() == [0, 1]
    assert faces[0].equals(box(0, 0, 4, 2))
    assert faces[1].equals(box(0, 2, 4, 4))
    assert not len(broken)


def test_lines_that_cross_are_told_of() -> None:
    _, _, broken = bands_of(skeleton([(3.0, 3.0), (3.0, -1.0), (1.0, 3.0)]))
    assert len(broken)


def test_a_level_that_is_all_but_straight_is_straightened() -> None:
    found = simplified(skeleton([(1.0, 2.05), (2.0, 1.95), (3.0, 2.0)]), TWO_BANDS, np.array([0.1]))
    assert np.sort(found.edges[6:]).tolist() == [[2, 5]]
    assert shapely.area(bands_of(found)[0]).tolist() == [8, 8]


def test_a_level_around_a_spike_of_the_outline_stays_around_it() -> None:
    spike = [(0.0, 0.0), (1.9, 0.0), (2.0, 2.04), (2.1, 0.0), (4.0, 0.0), (4.0, 2.0), (4.0, 4.0)]
    level = [(1.0, 2.0), (1.9, 2.08), (2.1, 2.08), (3.0, 2.0)]
    points = np.array([*spike, (0.0, 4.0), (0.0, 2.0), *level])
    around = [(i, (i + 1) % 9) for i in range(9)]
    chain = [8, 9, 10, 11, 12, 5]
    edges = np.array(around + list(pairwise(chain)))
    bands = [(0 if i in (0, 1, 2, 3, 4, 8) else 1, NOTHING) for i in range(9)] + [(1, 0)] * 5
    lines = np.append(np.arange(9), np.full(5, NOTHING))
    levels = np.append(np.full(9, NOTHING), np.ones(4, dtype=np.intp))
    none = np.empty(0)
    drawn = Skeleton(
        points, 9, none.astype(np.intp), none, none, levels, edges, lines, np.array(bands)
    )
    found = simplified(drawn, TWO_BANDS, np.array([0.1]))
    faces, band, broken = bands_of(found)
    assert not len(broken)
    assert band.tolist() == [0, 1]
    assert shapely.is_valid(faces).all()
    assert 9 < len(found.edges) < len(edges)


def test_a_square_is_two_triangles() -> None:
    points = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    triangles, face, sound = triangulated(
        polygons(Polygon(points)), points, np.empty((0, 2), dtype=np.intp)
    )
    assert len(triangles) == 2
    assert face.tolist() == [0, 0]
    assert sound.tolist() == [True]
    assert (turns(points, triangles) == 1).all()


def test_a_point_inside_is_a_corner() -> None:
    points = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.5, 0.4)])
    triangles, _, sound = triangulated(polygons(Polygon(points[:4])), points, np.array([[0, 4]]))
    assert sound.all()
    assert (triangles == 4).any(axis=1).all()
    assert turns(points, triangles).sum() == pytest.approx(2)


def test_points_on_a_straight_side_leave_no_flat_triangle() -> None:
    points = np.array([(float(x), 0.0) for x in range(9)] + [(4.0, 3.0)])
    triangles, _, sound = triangulated(
        polygons(Polygon(points)), points, np.empty((0, 2), dtype=np.intp)
    )
    assert sound.all()
    assert len(triangles) == 8


def test_an_outline_that_crosses_itself_is_not_sound() -> None:
    points = np.array([(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)])
    found = triangulated(polygons(Polygon(points)), points, np.empty((0, 2), dtype=np.intp))
    assert found[2].tolist() == [False]


Place = tuple[int, int]
corner = st.tuples(st.integers(-(2**53), 2**53), st.integers(-(2**53), 2**53))


@given(corner, corner, corner)
def test_turns_have_the_exact_sign(
    a: tuple[int, int], b: tuple[int, int], c: tuple[int, int]
) -> None:
    exact = (a[0] - c[0]) * (b[1] - c[1]) - (a[1] - c[1]) * (b[0] - c[0])
    found = turns(np.array([a, b, c], dtype=float), np.array([[0, 1, 2]]))[0]
    assert np.sign(found) == np.sign(exact)


def test_three_points_on_a_line_but_for_the_last_bit_turn() -> None:
    points = np.array([(0.5, 0.5), (12.0, 12.0), (24.0, np.nextafter(24.0, 25.0))])
    assert turns(points, np.array([[0, 1, 2], [0, 2, 1], [0, 0, 1]])).tolist()[2] == 0
    assert turns(points, np.array([[0, 1, 2]]))[0] > 0 > turns(points, np.array([[0, 2, 1]]))[0]


@given(st.lists(st.floats(0, 1), min_size=3, max_size=3), st.floats(0, 1))
def test_the_share_swept_is_that_of_the_part_cut_off(times: list[float], at: float) -> None:
    found = below(np.array([times]), np.array([at]))[0]
    grid = (np.arange(100) + 0.5) / 100
    x, y = np.meshgrid(grid, grid)
    inside = x + y < 1
    time = times[0] + (times[1] - times[0]) * x + (times[2] - times[0]) * y
    assert found == pytest.approx((time < at)[inside].mean(), abs=0.03)


def knots(
    triangles: list[tuple[int, ...]], points: list[tuple[float, ...]], high: set[int]
) -> Knots:
    """Triangles of one band whose corners are on the lower level but for some."""
    corners = np.array(triangles)
    share = np.isin(corners, list(high)).astype(float)
    zeros = np.zeros(len(corners), dtype=np.intp)
    return Knots(np.array(points), corners, zeros, zeros, share, np.zeros_like(corners))


def assert_graded(found: Knots, whole: Floats) -> None:
    """No triangle is swept at once, and none was lost or turned over."""
    shares = found.at(np.array([0.5]))
    assert (shares != shares[:, :1]).any(axis=1).all()
    areas = turns(found.points, found.triangles)
    assert (areas > 0).all()
    assert areas.sum() == pytest.approx(whole.sum())


def test_a_pocket_of_the_lower_level_is_divided_at_its_mouth() -> None:
    #  3---2
    #  |  /|     the triangle 0 1 2 has all corners on the lower level, 3 is on the upper one
    #  | / |
    #  0---1
    pocket = knots([(0, 1, 2), (0, 2, 3)], [(0, 0), (1, 0), (1, 1), (0, 1)], {3})
    found = divided(pocket)
    assert len(found.triangles) == 4
    assert found.points[4].tolist() == [0.5, 0.5]
    assert_graded(found, turns(pocket.points, pocket.triangles))


def test_where_three_pockets_meet_one_waits_for_the_others() -> None:
    around = [(np.cos(a), np.sin(a)) for a in np.arange(6) * np.pi / 3]
    star = knots([(0, 2, 4), (0, 1, 2), (2, 3, 4), (4, 5, 0)], around, {5})
    found = divided(star)
    assert found.delay.max() == 1
    assert_graded(found, turns(star.points, star.triangles))


def test_a_side_between_both_levels_is_left_whole() -> None:
    strip = knots([(0, 1, 2), (1, 3, 2)], [(0, 0), (1, 0), (0, 1), (1, 1)], {2, 3})
    assert np.array_equal(divided(strip).triangles, strip.triangles)


@pytest.fixture(scope="module")
def moved() -> tuple[Arrivals, Change]:
    change, _, arrivals = coarse(*map(set_of, PICTURES["a triple point moves"]))
    assert flaws(arrivals, change) == []
    return arrivals, change


def changed(array: Ints, row: int, value: object) -> Ints:
    found = array.copy()
    found[row] = value
    return found


FAULTS: dict[str, Callable[[Arrivals], Arrivals]] = {
    "turned over": lambda a: replace(a, triangles=changed(a.triangles, 0, a.triangles[0, ::-1])),
    "no key times": lambda a: replace(a, times=a.times + 1 / 3000),
    "another area": lambda a: replace(a, before=changed(a.before, 0, a.after[0])),
    "there twice": lambda a: replace(a, edges=changed(a.edges, 0, a.edges[1])),
    "on their sides": lambda a: replace(a, sides=changed(a.sides, 0, a.sides[0, ::-1])),
    "open ends": lambda a: replace(a, still=changed(a.still, -1, a.still[-1, ::-1])),
    "area of their faces": lambda a: replace(a, points=changed(a.points, 1, (0.1, 1.1))),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_found(fault: str, moved: tuple[Arrivals, Change]) -> None:
    arrivals, change = moved
    assert any(fault in flaw for flaw in flaws(FAULTS[fault](arrivals), change))
