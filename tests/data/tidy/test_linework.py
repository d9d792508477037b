"""Joint linework: nodes, arcs, and the polygons that they came from."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from shapely.affinity import translate
from shapely.geometry import MultiPolygon, Point, Polygon, box

from geotween.data.tidy.linework import Linework, Shapes, linework, polygons, spans


def a_set(*shapes: Polygon | MultiPolygon) -> Shapes:
    made = np.empty(len(shapes), dtype=object)
    made[:] = shapes
    return made


def arcs(lines: Linework) -> list[list[tuple[float, float]]]:
    """The vertices of each arc."""
    paths = np.split(lines.arc_path, lines.arcs[1:-1]) if len(lines.arcs) > 1 else []
    return sorted([tuple(p) for p in lines.vertices[path].tolist()] for path in paths)


def whole(lines: Linework) -> Shapes:
    kept = np.ones(len(lines.vertices), dtype=bool)
    return polygons(lines, kept, np.arange(len(lines.shapes)))


DISC = Point(5, 5).buffer(1, quad_segs=4)
PLATE = Polygon([(0, 0), (10, 0), (10, 10), (0, 10)], [DISC.exterior.coords])
DIAMOND = Polygon([(0, 0), (1, -1), (2, 0), (1, 1)])


def test_two_squares_side_by_side_have_two_nodes_and_two_long_arcs() -> None:
    lines = linework([a_set(box(0, 0, 1, 1), box(1, 0, 2, 1))])
    assert arcs(lines) == [
        [(1, 0), (0, 0), (0, 1), (1, 1)],
        [(1, 0), (2, 0), (2, 1), (1, 1)],
    ]
    assert lines.vertices[~lines.inner].tolist() == [[1, 0], [1, 1]]


def test_squares_of_two_sets_are_cut_where_their_outlines_part() -> None:
    lines = linework([a_set(box(0, 0, 1, 1)), a_set(Polygon([(0, 0), (1, 0), (1, 1)]))])
    assert arcs(lines) == [[(0, 0), (0, 1), (1, 1)], [(0, 0), (1, 0), (1, 1)]]


@pytest.mark.parametrize("other", [DISC, DISC.reverse(), MultiPolygon([box(9, 9, 10, 10), DISC])])
def test_a_ring_of_two_sets_is_one_closed_arc(other: Polygon | MultiPolygon) -> None:
    lines = linework([a_set(DISC), a_set(other)])
    closed = [arc for arc in arcs(lines) if len(arc) == 17]
    assert len(closed) == 1
    assert closed[0][0] == closed[0][-1]


def test_an_enclave_and_the_hole_it_fills_are_one_closed_arc() -> None:
    assert [len(arc) for arc in arcs(linework([a_set(PLATE, DISC)]))] == [5, 17]


def test_arcs_do_not_depend_on_start_and_direction_of_rings() -> None:
    points = list(DISC.exterior.coords)[:-1]
    turned = [Polygon(points[k:] + points[:k]) for k in range(len(points))]
    expected = arcs(linework([a_set(DISC)]))
    for polygon in turned:
        assert arcs(linework([a_set(polygon)])) == expected
        assert arcs(linework([a_set(polygon.reverse())])) == expected


def test_a_closed_arc_begins_far_from_the_middle_however_it_is_turned() -> None:
    kite = np.array([(0, 0), (3, -1), (9, 0), (3, 1)], dtype=float)
    for turn in range(4):
        turned = kite @ np.linalg.matrix_power(np.array([[0, 1], [-1, 0]]), turn)
        (arc,) = arcs(linework([a_set(Polygon(turned))]))
        assert arc[0] in [tuple(turned[0]), tuple(turned[2])]
        assert len(arc) == 5


def test_diamonds_that_touch_at_a_point_are_closed_arcs_from_there() -> None:
    (left, right) = arcs(linework([a_set(DIAMOND, translate(DIAMOND, 2))]))
    assert left[0] == left[-1] == right[0] == right[-1] == (2, 0)


def test_a_hole_that_touches_its_outer_ring_begins_there() -> None:
    hole = [(0, 5), (4, 4), (4, 6)]
    lines = linework([a_set(Polygon([(0, 0), (9, 0), (9, 9), (0, 9), (0, 5)], [hole]))])
    assert lines.vertices[~lines.inner].tolist() == [[0, 5]]
    assert [len(arc) for arc in arcs(lines)] == [6, 4]


def test_a_square_amid_others_with_nodes_at_all_its_corners_has_no_long_arc() -> None:
    around = [box(x, y, x + 1, y + 1) for x in range(3) for y in range(3)]
    lines = linework([a_set(*around)])
    assert lines.inner.sum() == 4  # the corners of the whole
    assert [len(arc) for arc in arcs(lines)] == [3, 3, 3, 3]


def test_signed_zeros_are_one_place() -> None:
    flat = Polygon([(-0.0, 0), (1, -0.0), (0.0, 1)])
    assert len(linework([a_set(flat), a_set(Polygon([(0, 0), (1, 0), (0, 1)]))]).vertices) == 3


@pytest.mark.parametrize("sets", [[], [a_set()], [a_set(), a_set(MultiPolygon())]])
def test_nothing_has_no_arcs(sets: list[Shapes]) -> None:
    lines = linework(sets)
    assert arcs(lines) == []
    assert lines.inner.tolist() == []
    assert [shape.is_empty for shape in lines.shapes] == [True] * sum(map(len, sets))


def test_polygons_come_back_as_they_were() -> None:
    sets = [
        a_set(PLATE, DISC),
        a_set(MultiPolygon([PLATE, DISC]), MultiPolygon([DIAMOND]), DIAMOND),
    ]
    lines = linework(sets)
    given = np.concatenate(sets)
    assert shapely.equals_identical(whole(lines), given).all()
    some = polygons(lines, np.ones(len(lines.vertices), dtype=bool), np.array([4, 1]))
    assert shapely.equals_identical(some, given[[4, 1]]).all()


def test_a_ring_that_loses_its_first_vertex_is_closed_at_the_next() -> None:
    lines = linework([a_set(box(0, 0, 1, 1))])
    first = box(0, 0, 1, 1).exterior.coords[0]
    kept = (lines.vertices != first).any(axis=1)
    (triangle,) = polygons(lines, kept, np.array([0]))
    assert list(triangle.exterior.coords) == [(1, 1), (0, 1), (0, 0), (1, 1)]


def test_shapes_and_vertices_find_each_other() -> None:
    lines = linework([a_set(box(0, 0, 1, 1), MultiPolygon()), a_set(box(5, 5, 6, 6), PLATE)])
    corner = (lines.vertices == [6, 6]).all(axis=1)
    assert lines.shapes_with(corner).tolist() == [False, False, True, False]
    assert lines.shapes_with((lines.vertices == 0).all(axis=1)).tolist() == [
        True,
        False,
        False,
        True,
    ]
    own = lines.vertices[lines.of_shapes(np.array([1, 2]))]
    assert own.tolist() == [[5, 5], [5, 6], [6, 5], [6, 6]]


def test_spans_are_ranges_one_after_the_other() -> None:
    assert spans(np.array([3, 7, 0]), np.array([5, 7, 3])).tolist() == [3, 4, 0, 1, 2]
    assert spans(np.array([], dtype=int), np.array([], dtype=int)).tolist() == []


# Random sets


def lattice(rng: np.random.Generator, size: int) -> Shapes:
    """The cells (size, size) of a grid whose corners were shaken."""
    corners = np.stack(np.mgrid[: size + 1, : size + 1], axis=-1) + rng.uniform(
        -0.24, 0.24, (size + 1, size + 1, 2)
    )
    quads = [corners[:-1, :-1], corners[1:, :-1], corners[1:, 1:], corners[:-1, 1:]]
    return shapely.polygons(np.stack(quads, axis=2))


def merged(cells: Shapes, labels: NDArray[np.int64]) -> Shapes:
    """The cells of each label as one shape; those labelled 0 are left out."""
    named = [cells[labels == label] for label in np.unique(labels[labels > 0])]
    return a_set(*(shapely.coverage_union_all(group) for group in named))


@st.composite
def tilings(draw: st.DrawFn) -> list[Shapes]:
    """Steps on the same shaken grid: regions around seeds, with exclaves, enclaves and gaps."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    size = draw(st.integers(3, 14))
    cells = lattice(rng, size)
    places = np.stack(np.mgrid[:size, :size], axis=-1)
    steps = []
    for _ in range(draw(st.integers(1, 3))):
        seeds = rng.uniform(0, size, (draw(st.integers(1, 6)), 2))
        distance = np.linalg.norm(places[:, :, None] - seeds, axis=-1)
        labels = distance.argmin(axis=2) + draw(st.integers(0, 1))
        flipped = rng.random((size, size)) < draw(st.sampled_from([0, 0.05, 0.3]))
        steps.append(merged(cells, np.where(flipped, rng.integers(0, 4, (size, size)), labels)))
    assume(all(shapely.is_valid(step).all() for step in steps))
    return steps


@st.composite
def islands(draw: st.DrawFn) -> list[Shapes]:
    """Steps of stars near each other, some hollow, some with a star within, some in one shape."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    steps = []
    for _ in range(draw(st.integers(1, 3))):
        stars = []
        for middle in np.ndindex(3, 3):
            angle = np.sort(rng.uniform(0, 2 * np.pi, rng.integers(5, 30)))
            assume(np.diff(angle, append=angle[0] + 2 * np.pi).max() < 3)
            radius = rng.uniform(0.1, 0.49, len(angle))
            rim = radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
            kind = rng.integers(4)
            stars.append(Polygon(rim + middle, [rim * 0.8 + middle] if kind else []))
            if kind > 1:
                stars.append(Polygon(rim * (0.8 if kind == 2 else 0.6) + middle))
        every_third = [k for k in range(len(stars)) if k % 3 == 0]
        loose = [star for k, star in enumerate(stars) if k not in every_third]
        joined = shapely.union_all([stars[k] for k in every_third])
        steps.append(a_set(joined, *loose))
    assume(all(shapely.is_valid(step).all() for step in steps))
    return steps


RANDOM = st.one_of(tilings(), islands(), st.tuples(tilings(), islands()).map(lambda t: t[0] + t[1]))


@settings(max_examples=40, deadline=None)
@given(RANDOM)
def test_random_polygons_come_back_and_every_arc_is_there_once(sets: list[Shapes]) -> None:
    lines = linework(sets)
    assert shapely.equals_identical(whole(lines), np.concatenate(sets)).all()
    within = np.delete(lines.arc_path, np.concatenate([lines.arcs[:-1], lines.arcs[1:] - 1]))
    assert sorted(within) == np.flatnonzero(lines.inner).tolist()


@settings(max_examples=40, deadline=None)
@given(RANDOM)
def test_arcs_do_not_depend_on_order_and_direction(sets: list[Shapes]) -> None:
    expected = arcs(linework(sets))
    assert arcs(linework([shapely.normalize(s[::-1]) for s in sets[::-1]])) == expected
    assert arcs(linework([shapely.reverse(s) for s in sets])) == expected
