"""Quadtree meshes: exact, conforming, graded, and mostly of good triangles."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import affinity

from geotween.mesh import quadtree, quality, share_good
from geotween.mesh.cells import SLACK, Grid, crossed, graded, keys
from geotween.mesh.fill import doubled_areas
from geotween.mesh.templates import LENGTHS, TEMPLATES
from tests.mesh.outlines import comb, made, real, star
from tests.real_data import needs_real_data

SQUARE = shapely.box(0, 0, 1, 1)
RING = shapely.Point(0, 0).buffer(2).difference(shapely.Point(0.3, 0).buffer(1))
TOUCHING = shapely.Polygon(
    [(0, 0), (4, 0), (4, 4), (0, 4)], [[(1, 0), (1, 2), (2, 2), (2, 1)], [(2, 2), (3, 2), (3, 3)]]
)
COLLINEAR = shapely.segmentize(affinity.rotate(comb(3, 9), 33), 0.1)
SLIVER = affinity.rotate(shapely.box(0, 0, 1, 1e-6), 20)
ISLANDS = shapely.MultiPolygon([SQUARE, shapely.box(1, 1, 3, 2), shapely.box(5, 0, 5.01, 0.01)])
SHAPES = {
    "square": SQUARE,
    "ring": RING,
    "holes that touch": TOUCHING,
    "straight sides in many pieces": COLLINEAR,
    "sliver": SLIVER,
    "islands": ISLANDS,
    "spikes": star(24, 0.15, 9),
}
ANY_SHAPE = pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES.keys())
ANY_DEPTH = pytest.mark.parametrize("depth", [0, 1, 3, 6])


def sides(mesh):
    """Sides (s, 2) of triangles, from the lower to the higher point, and how many have each."""
    ends = np.stack([mesh.triangles, np.roll(mesh.triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    return np.unique(np.sort(ends, axis=1), axis=0, return_counts=True)


def assert_right(mesh, shape):
    """The mesh fills the shape and conforms; points on its rim are off by rounding at most."""
    slip = 1e-15 * np.abs(mesh.points).max()
    areas = doubled_areas(mesh.points, mesh.triangles) / 2
    assert areas.min() > 0
    assert areas.sum() == pytest.approx(shape.area, rel=1e-12, abs=slip * shape.length)
    vertices = {tuple(point) for point in shapely.get_coordinates(shape)}
    assert vertices <= {tuple(point) for point in mesh.points}
    ends, counts = sides(mesh)
    assert counts.max() <= 2
    # What only one triangle has is the boundary, all of it, and nothing hangs inside.
    rim = shapely.linestrings(mesh.points[ends[counts == 1]])
    assert shapely.length(rim).sum() == pytest.approx(shape.length, rel=1e-9)
    near = 1e-12 * max(np.ptp(mesh.points, axis=0)) + slip
    middles = shapely.line_interpolate_point(rim, 0.5, normalized=True)
    assert shapely.distance(shape.boundary, middles).max() <= near


@ANY_DEPTH
@ANY_SHAPE
def test_triangles_fill_the_polygon_and_conform(shape, depth):
    assert_right(quadtree(shape, depth), shape)


@ANY_SHAPE
def test_at_the_default_depth_too(shape):
    assert_right(quadtree(shape), shape)


@pytest.mark.parametrize("name", made())
def test_made_outlines_have_good_meshes(name):
    assert_good(made()[name])


@needs_real_data
@pytest.mark.parametrize("name", real())
def test_real_outlines_have_good_meshes(name):
    assert_good(real()[name])


def assert_good(outline):
    mesh, fine = quadtree(outline), quadtree(outline, 7)
    assert_right(mesh, outline)
    assert_right(fine, outline)
    assert share_good(mesh) >= 0.41
    assert share_good(fine) >= 0.6


def test_a_square_is_right_isosceles_triangles_that_grow_inwards():
    mesh = quadtree(SQUARE, 6)
    assert quality(mesh) == pytest.approx(np.full(len(mesh.triangles), 2 * (2**0.5 - 1)), abs=1e-4)
    ends, _ = sides(mesh)
    lengths = np.hypot(*(mesh.points[ends[:, 1]] - mesh.points[ends[:, 0]]).T)
    middle = np.abs(mesh.points[ends].mean(axis=1) - 0.5).max(axis=1)
    assert lengths[middle > 0.49].max() < 1.5 / 64
    assert lengths[middle < 0.1].min() > 3.9 / 64


def test_depth_halves_the_cells_on_the_boundary():
    counts = [len(quadtree(RING, depth).triangles) for depth in (5, 6, 7)]
    assert counts[0] < counts[1] / 1.8 < counts[2] / 1.8**2


def test_a_fine_boundary_has_a_deep_tree_by_default():
    coarse, fine = (quadtree(shapely.Point(0, 0).buffer(1, quad_segs=n)) for n in (4, 400))
    assert len(fine.triangles) > 10 * len(coarse.triangles)


def test_meshing_again_gives_the_same_bytes():
    one, other = (quadtree(RING, 5) for _ in range(2))
    assert one.points.tobytes() == other.points.tobytes()
    assert one.triangles.tobytes() == other.triangles.tobytes()


@pytest.mark.parametrize("scale", [2.0**40, 2.0**-40])
@ANY_SHAPE
def test_scaling_by_powers_of_two_scales_the_mesh_to_the_bit(shape, scale):
    mesh = quadtree(shape)
    scaled = quadtree(shapely.transform(shape, lambda points: points * scale))
    assert (scaled.points == mesh.points * scale).all()
    assert (scaled.triangles == mesh.triangles).all()


@pytest.mark.parametrize("scale", [1e9, 1e-9])
@ANY_SHAPE
def test_scale_does_not_matter(shape, scale):
    larger = shapely.transform(shape, lambda points: points * scale)
    mesh = quadtree(larger)
    assert_right(mesh, larger)
    assert share_good(mesh) == pytest.approx(share_good(quadtree(shape)), abs=0.02)


def test_far_from_the_origin_only_rounding_changes():
    far = affinity.translate(RING, 4e6, -4e6)
    mesh = quadtree(far)
    assert_right(mesh, far)
    assert len(mesh.triangles) == pytest.approx(len(quadtree(RING).triangles), rel=0.02)


@pytest.mark.parametrize("turn", [90, 180, 17.3])
def test_turned_and_reflected_polygons_have_meshes_as_good(turn):
    turned = affinity.rotate(affinity.scale(TOUCHING, -1, 1), turn)
    mesh = quadtree(turned, 6)
    assert_right(mesh, turned)
    assert share_good(mesh) == pytest.approx(share_good(quadtree(TOUCHING, 6)), abs=0.1)


@settings(max_examples=40, deadline=None)
@given(
    radii=st.lists(st.floats(0.05, 1.0), min_size=3, max_size=40),
    depth=st.integers(0, 6),
    turn=st.floats(0, 6.3),
)
def test_any_star_is_filled(radii, depth, turn):
    angles = turn + np.linspace(0, 2 * np.pi, len(radii), endpoint=False)
    points = np.column_stack([np.cos(angles), np.sin(angles)]) * np.array(radii)[:, None]
    outline = shapely.Polygon(points)
    assert_right(quadtree(outline, depth), outline)


@settings(max_examples=40, deadline=None)
@given(
    corners=st.lists(st.tuples(*[st.integers(0, 12)] * 2), min_size=1, max_size=10),
    turn=st.sampled_from([0, 45, 33]),
    depth=st.integers(0, 5),
)
def test_any_heap_of_boxes_is_filled(corners, turn, depth):
    heap = shapely.union_all([shapely.box(x, y, x + 2, y + 3) for x, y in corners])
    turned = affinity.rotate(heap, turn)
    if turned.is_valid:
        assert_right(quadtree(turned, depth), turned)


def test_repeated_points_do_not_matter():
    doubled = shapely.Polygon(np.repeat(shapely.get_coordinates(SQUARE), 2, axis=0))
    assert (quadtree(doubled, 3).points == quadtree(SQUARE, 3).points).all()


@pytest.mark.parametrize(
    ("shape", "depth", "words"),
    [
        (shapely.Polygon(), None, "not empty"),
        (shapely.Polygon([(0, 0), (1, 1), (1, 0), (0, 1)]), None, "valid"),
        (shapely.Point(0, 0), None, "Polygon or MultiPolygon"),
        (SQUARE, -1, "depth is from 0"),
        (SQUARE, 99, "depth is from 0"),
        (affinity.translate(SQUARE, 1e12, 0), None, "too far"),
    ],
)
def test_what_has_no_mesh_is_refused_in_words(shape, depth, words):
    with pytest.raises(ValueError, match=words):
        quadtree(shape, depth)


def test_an_edge_crosses_the_cells_it_passes_and_those_it_touches():
    grid = Grid(np.zeros(2), 4.0, 2)
    cells, _ = crossed(np.array([[(0.5, 0.5), (2.5, 1.5)]]), grid)
    assert {tuple(cell) for cell in cells} == {(0, 0), (1, 0), (1, 1), (2, 1)}
    cells, _ = crossed(np.array([[(1.0, 0.5), (1.0, 0.6)]]), grid)
    assert {tuple(cell) for cell in cells} == {(0, 0), (1, 0)}


@settings(max_examples=30, deadline=None)
@given(st.lists(st.floats(0, 8), min_size=4, max_size=40).filter(lambda x: len(x) % 4 == 0))
def test_crossed_cells_are_those_that_meet_the_edges(numbers):
    edges = np.array(numbers).reshape(-1, 2, 2)
    cells, which = crossed(edges, Grid(np.zeros(2), 8.0, 3))
    columns, rows = np.mgrid[:8, :8].reshape(2, -1)
    lines = shapely.linestrings(edges)
    found = np.zeros((len(edges), 8, 8), dtype=bool)
    found[which, *cells.T] = True
    assert found.sum() == len(cells)
    away = shapely.distance(
        lines[:, None], shapely.box(columns, rows, columns + 1, rows + 1)
    ).reshape(-1, 8, 8)
    assert (away[found] < 2**0.5 * SLACK + 1e-9).all()
    assert (away[~found] > 0).all()


@pytest.mark.parametrize("layers", [1, 2, 3])
def test_leaves_tile_the_square_and_neighbours_differ_by_one_level(layers):
    leaves = graded(np.array([(5, 9), (40, 41), (63, 0)]), 6, layers)
    assert (leaves.size**2).sum() == 128**2
    low, high = leaves.low, leaves.low + leaves.size[:, None]
    boxes = shapely.box(*low.T, *high.T)
    one, other = shapely.STRtree(boxes).query(boxes, predicate="touches")
    ratio = leaves.size[one] / leaves.size[other]
    assert ratio.max() == 2
    # A side is halved where a smaller neighbour touches it in more than a point.
    beside = (ratio == 2) & (shapely.length(shapely.intersection(boxes[one], boxes[other])) > 0)
    assert set(one[beside]) == set(np.flatnonzero(leaves.halved.any(axis=1)))
    assert keys(leaves.low).size == np.unique(keys(leaves.low)).size


def test_sixteen_templates_of_four_to_eight_triangles():
    assert sorted(LENGTHS) == sorted(4 + mask.bit_count() for mask in range(16))
    assert TEMPLATES.shape == (16, 8, 3)
