"""Division: pieces that partition their polygon, one for each correspondent."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from shapely.geometry import MultiPolygon, Point, Polygon, box

from geotween.data.polygons import Feature, PolygonSet, polygon_set
from geotween.motion.correspond import correspond
from geotween.motion.divide import Division, divide
from geotween.motion.divide.voronoi import voronoi
from tests.motion.shapes import polygon_sets, star

SQUARE = box(0, 0, 8, 8)


def unkeyed(*polygons: Polygon) -> PolygonSet:
    return polygon_set(Feature(p) for p in polygons)


def division(origin: list[Polygon], target: list[Polygon]) -> Division:
    return divide(correspond(unkeyed(*origin), unkeyed(*target)), "voronoi")


def assert_partition(polygon: Polygon, pieces: list[Polygon]) -> None:
    assert all(isinstance(p, Polygon) and p.is_valid and p.area > 0 for p in pieces)
    assert sum(p.area for p in pieces) == pytest.approx(polygon.area, rel=1e-9)
    assert shapely.union_all(pieces).symmetric_difference(polygon).area <= 1e-9 * polygon.area


def test_one_to_one_is_not_divided() -> None:
    a, c = box(0, 0, 2, 2), box(1, 0, 3, 2)
    spl = division([a], [c])
    assert spl.indices.tolist() == [[0, 0]]
    assert spl.origin_pieces[0].equals(a)
    assert spl.target_pieces[0].equals(c)


def test_a_over_left_and_right_is_cut_between_them() -> None:
    spl = division([SQUARE], [box(0, 3, 1, 5), box(7, 3, 8, 5)])
    left, right = spl.origin_pieces
    assert spl.indices.tolist() == [[0, 0], [0, 1]]
    assert left.equals(box(0, 0, 4, 8))
    assert right.equals(box(4, 0, 8, 8))


def test_left_and_right_under_c_cut_c() -> None:
    spl = division([box(0, 3, 1, 5), box(7, 3, 8, 5)], [SQUARE])
    assert spl.indices.tolist() == [[0, 0], [1, 0]]
    assert [p.bounds for p in spl.target_pieces] == [(0, 0, 4, 8), (4, 0, 8, 8)]


def test_many_to_many_pairs_each_piece_with_its_counterpart() -> None:
    # A spans C and D, B lies in D alone: A is cut for C and D, D for A and B.
    a, b = box(0, 0, 6, 2), box(7, 0, 9, 2)
    c, d = box(0, 1, 2, 3), box(4, 1, 9, 3)
    spl = division([a, b], [c, d])
    assert spl.indices.tolist() == [[0, 0], [0, 1], [1, 1]]
    assert_partition(a, list(spl.origin_pieces[:2]))
    assert_partition(d, list(spl.target_pieces[1:]))
    assert spl.origin_pieces[2].equals(b)
    assert spl.target_pieces[0].equals(c)


def test_without_a_partner_it_goes_to_its_innermost_point_and_comes_from_it() -> None:
    spl = division([box(0, 0, 2, 2)], [Polygon([(10, 0), (14, 0), (10, 3)])])
    assert spl.indices.tolist() == [[-1, 0], [0, -1]]
    assert spl.origin_pieces[0].distance(Point(11, 1)) < 1e-12
    assert spl.target_pieces[1].distance(Point(1, 1)) < 1e-12


def test_by_centroid_only_what_lies_outside_goes_to_the_innermost_point() -> None:
    triangle = Polygon([(0, 0), (4, 0), (0, 3)])
    bow = Polygon([(20, 0), (29, 0), (29, 1), (21, 1), (21, 9), (20, 9)])
    related = correspond(unkeyed(triangle, bow), unkeyed())
    inside, outside = divide(related, births="centroid").target_pieces
    assert inside.equals(triangle.centroid)
    assert not bow.contains(bow.centroid)
    assert outside.equals(divide(related).target_pieces[1])
    assert bow.contains(outside)


@pytest.mark.parametrize(("origin", "target"), [([], [SQUARE]), ([SQUARE], []), ([], [])])
def test_empty_sets_give_births_deaths_or_nothing(
    origin: list[Polygon], target: list[Polygon]
) -> None:
    assert len(division(origin, target).indices) == len(origin) + len(target)


def test_the_seed_is_the_vertex_nearest_to_the_centroid() -> None:
    # Nearest vertices (3, 4) and (6, 4): the cut lies half-way, at x = 4.5.
    near, far = Polygon([(0, 0), (3, 4), (0, 8)]), Polygon([(6, 4), (8, 0), (8, 8)])
    pieces, mends = voronoi(SQUARE, [near, far])
    assert pieces[0].equals(box(0, 0, 4.5, 8))
    assert not mends


def test_two_seeds_at_one_vertex_the_later_takes_its_next_nearest() -> None:
    # Both have (4, 4); the later one's next vertex is (4, 6).
    first = Polygon([(4, 4), (4, 1), (1, 4)])
    later = Polygon([(4, 4), (9, 4), (4, 6)])
    pieces, mends = voronoi(SQUARE, [first, later])
    assert [(m.kind, m.cell) for m in mends] == [("coincident seeds", 1)]
    assert pieces[0].equals(box(0, 0, 8, 5))
    assert_partition(SQUARE, pieces)


def test_seeds_that_all_coincide_are_told_apart_along_the_edges() -> None:
    triangle = Polygon([(2, 2), (6, 2), (4, 5)])
    pieces, mends = voronoi(SQUARE, [triangle] * 5)
    assert len(pieces) == 5
    assert_partition(SQUARE, pieces)
    assert {m.kind for m in mends} >= {"coincident seeds"}


def test_a_cell_in_two_parts_keeps_the_larger() -> None:
    # A comb with teeth at both ends: the right seed's cell reaches into the bay on the left too.
    comb = Polygon([(0, 0), (9, 0), (9, 6), (8, 6), (8, 1), (5, 1), (5, 5), (4, 5), (4, 1), (0, 1)])
    low, high = box(3, -1, 4.2, 0.5), box(4.4, 4.5, 6, 6)
    pieces, mends = voronoi(comb, [low, high])
    assert_partition(comb, pieces)
    assert [m.kind for m in mends] == ["cell in parts"]
    assert mends[0].share > 0


def test_an_empty_cell_is_cut_from_its_neighbour() -> None:
    # The seed of the last lies far below the square, behind the other two.
    a, b = box(0, 0, 3, 3), box(5, 0, 8, 3)
    touching = Polygon([(4, 0), (-60, -90), (60, -90)])
    hidden = Polygon([(1, -5), (1.5, -50), (0.5, -50)])
    pieces, mends = voronoi(SQUARE, [a, b, touching, hidden])
    assert "empty cell" in {m.kind for m in mends}
    assert_partition(SQUARE, pieces)


def test_the_cell_of_a_seed_behind_a_corner_is_cut_whatever_the_noding_leaves() -> None:
    # A Voronoi line touches the square at a corner and leaves a face of rounding there.
    others = [
        Polygon([(4, 0), (0, 4), (2, 4), (4, 3), (5, 1)]),
        Polygon([(1, 0), (0, 2), (0, 3), (5, 1), (4, 0)]),
    ]
    assert_partition(box(2, 2, 3, 3), voronoi(box(2, 2, 3, 3), others)[0])


@pytest.mark.parametrize("count", [2, 30, 100])
def test_many_empty_cells_share_their_host_out(count: int) -> None:
    islands = [box(10 + 3 * i, 1, 11 + 3 * i, 2) for i in range(count)]
    pieces, mends = voronoi(SQUARE, islands)
    assert_partition(SQUARE, pieces)
    assert [m.kind for m in mends] == ["empty cell"] * (count - 1)
    assert min(p.area for p in pieces) > SQUARE.area / count / 10


@pytest.mark.parametrize("size", [8e-7, 8e-9, 1e-12])
def test_correspondents_too_small_for_seeds_of_their_own(size: float) -> None:
    tiny = Polygon([(4, 4), (4 + size, 4), (4, 4 + size)])
    assert_partition(SQUARE, voronoi(SQUARE, [tiny] * 6)[0])


def test_a_line_that_all_but_meets_vertices_loses_no_face() -> None:
    outer = Point(3, 3).buffer(2, quad_segs=3)
    ring = outer.difference(Point(3, 3).buffer(1, quad_segs=1))
    others = [
        Polygon([(0, 3), (3, 2), (5, 0), (2, 0)]),
        Polygon([(1, 3), (3, 4), (1.5, 2.5), (1, 8 / 3)]),
    ]
    assert_partition(ring, voronoi(ring, others)[0])


def test_an_exact_grid_of_squares_is_divided_without_a_mend() -> None:
    blocks = [box(i + 0.1, j + 0.1, i + 0.9, j + 0.9) for i in range(8) for j in range(8)]
    pieces, mends = voronoi(SQUARE, blocks)
    assert_partition(SQUARE, pieces)
    assert not mends
    assert all(piece.intersects(block) for piece, block in zip(pieces, blocks, strict=True))


def test_a_seam_through_a_hole_opens_it() -> None:
    ring = Polygon(SQUARE.exterior, [box(3, 3, 5, 5).exterior])
    pieces, _ = voronoi(ring, [box(0, 3, 1, 5), box(7, 3, 8, 5)])
    assert_partition(ring, pieces)
    assert not any(p.interiors for p in pieces)


def test_200_correspondents_of_a_rough_outline() -> None:
    outline = star(500, seed=3, radius=10)
    rng = np.random.default_rng(4)
    others = [star(5, i, 0.4, *rng.uniform(-6, 6, 2)) for i in range(200)]
    assert_partition(outline, voronoi(outline, others)[0])


def test_each_mend_is_a_problem_that_names_its_piece() -> None:
    first, later = Polygon([(4, 4), (4, 1), (1, 4)]), Polygon([(4, 4), (9, 4), (4, 6)])
    problems = division([SQUARE], [first, later]).problems
    assert [(p.kind, p.severity, p.piece) for p in problems] == [
        ("coincident seeds", "note", "polygon 1 for polygon 2")
    ]


@given(polygon_sets, polygon_sets)
def test_pieces_partition_their_polygons(origin: list[Polygon], target: list[Polygon]) -> None:
    spl = division(origin, target)
    sides = (spl.origin, spl.origin_pieces), (spl.target, spl.target_pieces)
    for column, (whole, pieces) in enumerate(sides):
        for index, polygon in enumerate(whole.polygons):
            mine = pieces[spl.indices[:, column] == index]
            assert_partition(polygon, list(mine))
    used = [i for i in spl.indices.tolist() if -1 not in i]
    assert used == correspond(spl.origin, spl.target).pairs.tolist()


@given(polygon_sets, polygon_sets)
def test_nobody_pairs_with_nobody(origin: list[Polygon], target: list[Polygon]) -> None:
    spl = division(origin, target)
    assert not (spl.indices == -1).all(axis=1).any()
    kinds = {type(p) for p in [*spl.origin_pieces, *spl.target_pieces]}
    assert kinds <= {Polygon, Point}
    assert MultiPolygon not in kinds
