"""The plane cut by both steps: nothing lost, nothing twice, nothing moved."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st
from shapely.geometry import Polygon, box

from geotween.data.polygons import RELATIVE_TOLERANCE, Feature, PolygonSet, polygon_set
from geotween.motion.front.plane import NOTHING, Plane, cut
from tests.motion.shapes import polygon_sets, tiles


def set_of(polygons: Sequence[Polygon]) -> PolygonSet:
    return polygon_set(Feature(polygon, key=key) for key, polygon in enumerate(polygons))


def transformed(polygons: Sequence[Polygon], degrees: float, scale: float) -> list[Polygon]:
    """Polygons turned about 0, 0, then scaled."""
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    matrix = scale * np.array([[cos, sin], [-sin, cos]])
    return list(shapely.transform(np.array(polygons, dtype=object), lambda p: p @ matrix))


def assert_sound(plane: Plane) -> None:
    """All edges of all faces, each once, with the faces that they are edges of."""
    assert shapely.is_valid(plane.faces).all()
    known = {tuple(point) for point in plane.points.tolist()}
    assert len(known) == len(plane.points)
    edges = {tuple(sorted(edge)) for edge in plane.edges.tolist()}
    assert len(edges) == len(plane.edges)
    found = set()
    ends = plane.points[plane.edges]
    for side, way in ((0, 1), (1, -1)):  # as the left face has it, and as the right one does
        beside = plane.sides[:, side] != NOTHING
        directed = ends[beside, ::way].reshape(-1, 4)
        found |= {
            (face, *edge)
            for face, edge in zip(
                plane.sides[beside, side].tolist(), directed.tolist(), strict=True
            )
        }
    wanted = set()
    for number, face in enumerate(plane.faces):
        for ring in (face.exterior, *face.interiors):
            points = list(ring.coords)
            wanted |= {(number, *p, *q) for p, q in pairwise(points)}
    assert {edge[1:3] for edge in wanted} == known
    assert found == wanted


def assert_covered(plane: Plane, cover: np.ndarray, sets: Sequence[PolygonSet], off: float) -> None:
    """Faces add up to the disjoint polygons of each set, but for some length along borders."""
    areas = shapely.area(plane.faces)
    for polygons, covering in zip(sets, cover, strict=True):
        there = covering != NOTHING
        sums = np.bincount(covering[there], weights=areas[there], minlength=len(polygons))
        error = np.abs(sums - shapely.area(polygons.polygons))
        lengths = shapely.length(polygons.polygons)
        assert (error <= 1e-12 * shapely.area(polygons.polygons) + off * lengths).all()


def test_squares_that_overlap_at_a_corner_make_three_faces() -> None:
    plane, cover = cut(set_of([box(0, 0, 2, 2)]), set_of([box(1, 1, 3, 3)]))
    assert_sound(plane)
    assert len(plane.points) == 10
    assert sorted(map(tuple, cover.T.tolist())) == [(NOTHING, 0), (0, NOTHING), (0, 0)]
    assert sorted(shapely.area(plane.faces)) == [1, 3, 3]


def test_left_of_an_edge_lies_its_left_face() -> None:
    plane, _ = cut(set_of([box(0, 0, 1, 1)]), set_of([box(1, 0, 2, 1)]))
    start, end = plane.points[plane.edges].transpose(1, 0, 2)
    left = np.column_stack([start[:, 1] - end[:, 1], end[:, 0] - start[:, 0]])
    beside = (start + end) / 2 + left / 4
    for (face, other), point in zip(plane.sides.tolist(), shapely.points(beside), strict=True):
        assert face == NOTHING or plane.faces[face].contains(point)
        assert other == NOTHING or not plane.faces[other].contains(point)


def test_of_polygons_that_overlap_in_a_set_the_last_one_covers() -> None:
    plane, cover = cut(set_of([box(0, 0, 2, 2), box(1, 0, 3, 2)]), set_of([]))
    areas = shapely.area(plane.faces)
    assert areas[cover[0] == 0].sum() == 2
    assert areas[cover[0] == 1].sum() == 4


def test_a_hole_is_outside_though_polygons_lie_all_around_it() -> None:
    ring = box(0, 0, 9, 9).difference(box(3, 3, 6, 6))
    plane, cover = cut(set_of([ring]), set_of([ring]))
    assert_sound(plane)
    assert cover.tolist() == [[0], [0]]
    assert plane.faces[0].equals(ring)


def test_an_island_in_a_lake_is_a_face_of_its_own() -> None:
    sea = box(0, 0, 9, 9).difference(box(2, 2, 7, 7))
    plane, cover = cut(set_of([sea, box(4, 4, 5, 5)]), set_of([box(0, 0, 9, 9)]))
    assert_sound(plane)
    assert sorted(map(tuple, cover.T.tolist())) == [(NOTHING, 0), (0, 0), (1, 0)]
    assert sorted(shapely.area(plane.faces)) == [1, 24, 56]


@pytest.mark.parametrize(
    "polygons",
    [
        pytest.param([box(0, 0, 1, 1), box(1, 1, 2, 2)], id="two squares at a corner"),
        pytest.param(
            [Polygon(box(0, 0, 4, 4).exterior, [[(0, 0), (2, 1), (1, 2)]])], id="hole at the rim"
        ),
        pytest.param(
            [
                Polygon(
                    box(0, 0, 9, 9).exterior,
                    [[(1, 4), (4, 4), (2, 6)], [(4, 4), (7, 2), (7, 5)]],
                )
            ],
            id="two holes at a point",
        ),
    ],
)
def test_touching_at_a_point(polygons: list[Polygon]) -> None:
    sets = set_of(polygons), set_of([box(0, 0, 9, 4.5)])
    plane, cover = cut(*sets)
    assert_sound(plane)
    assert_covered(plane, cover, sets, 0.0)


def test_without_polygons_there_is_no_face() -> None:
    plane, cover = cut(set_of([]), set_of([]))
    assert (len(plane.points), plane.edges.shape, cover.shape) == (0, (0, 2), (2, 0))


@given(polygon_sets, polygon_sets, st.sampled_from([0.0, 17.3, 90.0]), st.integers(-9, 9))
def test_any_two_sets_are_cut_to_the_bit(
    origin: list[Polygon], target: list[Polygon], degrees: float, exponent: int
) -> None:
    sets = tuple(set_of(transformed(s, degrees, 10.0**exponent)) for s in (origin, target))
    assume(all(shapely.is_valid(s.polygons).all() for s in sets))  # turning may break one
    plane, cover = cut(*sets)
    assert_sound(plane)
    assert_covered(plane, cover, sets, 1e-10 * 10.0**exponent)


@given(polygon_sets)
def test_a_tiling_with_itself_keeps_its_vertices_and_gets_no_others(
    polygons: list[Polygon],
) -> None:
    assume(shapely.coverage_is_valid(polygons))
    plane, _ = cut(set_of(polygons), set_of(polygons))
    assert plane.points.tolist() == np.unique(shapely.get_coordinates(polygons), axis=0).tolist()


@given(st.integers(0, 10_000), st.integers(6, 16))
def test_borders_that_differ_by_rounding_leave_no_face_without_width(
    seed: int, digits: int
) -> None:
    origin = tiles(8, seed)
    target = [shapely.transform(p, lambda points: points * (1 + 10.0**-digits)) for p in origin]
    plane, cover = cut(set_of(origin), set_of(target))
    assert_sound(plane)
    assert_covered(plane, cover, (set_of(origin), set_of(target)), 10 * RELATIVE_TOLERANCE)
    assert (2 * shapely.area(plane.faces) / shapely.length(plane.faces)).min() > 5e-13


@given(st.integers(0, 10_000))
def test_the_order_of_polygons_does_not_matter(seed: int) -> None:
    origin, target = tiles(8, seed), tiles(6, seed + 1)
    one, _ = cut(set_of(origin), set_of(target))
    other, _ = cut(set_of(origin[::-1]), set_of(target[::-1]))
    assert one.points.tolist() == other.points.tolist()
    assert one.edges.tolist() == other.edges.tolist()
