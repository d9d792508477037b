"""Triangle meshes of polygons: exact, well oriented, and with the polygons' own boundaries."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from geotween.mesh.fill import doubled_areas, fill, twins

SQUARE = shapely.box(0, 0, 1, 1)
RING = shapely.Point(0, 0).buffer(2).difference(shapely.Point(0.3, 0).buffer(1))
TOUCHING = shapely.Polygon(
    [(0, 0), (4, 0), (4, 4), (0, 4)], [[(1, 0), (1, 2), (2, 2), (2, 1)], [(2, 2), (4, 2), (3, 3)]]
)
COLLINEAR = shapely.segmentize(shapely.Polygon([(0, 0), (1, 0), (0.3, 0.8)]), 0.07)
SLIVER = shapely.segmentize(shapely.box(0, 0, 1, 1e-6), 0.01)


def filled(*polygons, spacing):
    shapes = np.array(polygons, dtype=object)
    return shapes, fill(shapes, np.full(len(shapes), spacing))


def rim(mesh, owner):
    """The sides, as pairs of points, that only one triangle of an owner has."""
    triangles = mesh.triangles[mesh.owner == owner]
    pairs, _ = twins(triangles, np.zeros(len(triangles), dtype=int))
    sides = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    return np.delete(sides, pairs.ravel(), axis=0)


@pytest.mark.parametrize("spacing", [0.02, 0.1, 10.0])
@pytest.mark.parametrize("shape", [SQUARE, RING, TOUCHING, COLLINEAR, SLIVER])
def test_triangles_tile_the_polygon_and_keep_its_boundary(shape, spacing):
    _, mesh = filled(shape, spacing=spacing)
    areas = doubled_areas(mesh.points, mesh.triangles) / 2
    assert areas.min() > 0
    assert areas.sum() == pytest.approx(shape.area, rel=1e-12)
    ends = mesh.points[rim(mesh, 0)]
    assert shapely.equals(
        shapely.union_all(shapely.normalize(shapely.linestrings(ends))), shape.boundary
    )
    corners = {tuple(point) for point in shapely.get_coordinates(shape)}
    assert {tuple(point) for point in ends.reshape(-1, 2)} == corners


def test_the_lattice_is_as_fine_as_asked_for():
    _, mesh = filled(SQUARE, spacing=0.05)
    inner = ~np.isin(np.arange(len(mesh.points)), rim(mesh, 0))
    assert 300 < inner.sum() < 1 / (0.05**2 * 3**0.5 / 2)
    tree = shapely.STRtree(shapely.points(mesh.points[inner]))
    _, away = tree.query_nearest(
        shapely.points(mesh.points[inner]), exclusive=True, return_distance=True
    )
    assert away == pytest.approx(np.full(len(away), 0.05))


def test_neighbours_share_the_vertices_of_their_common_edge():
    left = shapely.Polygon([(0, 0), (1, 0), (1, 1 / 3), (1, 1), (0, 1)])
    right = shapely.Polygon([(1, 0), (2, 0), (2, 1), (1, 1), (1, 1 / 3)])
    _, mesh = filled(left, right, spacing=0.1)
    _, same = twins(mesh.triangles, mesh.owner)
    assert (~same).sum() == 2


def test_nothing_to_fill():
    _, mesh = filled(spacing=1.0)
    assert mesh.triangles.shape == (0, 3)
    assert len(mesh.owner) == 0


def test_filling_again_gives_the_same_bytes():
    one, other = (filled(RING, SQUARE, spacing=0.1)[1] for _ in range(2))
    assert one.points.tobytes() == other.points.tobytes()
    assert one.triangles.tobytes() == other.triangles.tobytes()


@pytest.mark.parametrize("scale", [1e9, 1e-9])
def test_scale_does_not_matter(scale):
    _, mesh = filled(RING, spacing=0.2)
    _, scaled = filled(shapely.transform(RING, lambda points: points * scale), spacing=0.2 * scale)
    assert len(mesh.triangles) == len(scaled.triangles)
    assert doubled_areas(scaled.points, scaled.triangles).min() > 0


@settings(max_examples=40, deadline=None)
@given(
    radii=st.lists(st.floats(0.05, 1.0), min_size=3, max_size=40),
    spacing=st.floats(0.03, 0.5),
    turn=st.floats(0, 6.3),
)
def test_any_star_is_tiled(radii, spacing, turn):
    angles = turn + np.linspace(0, 2 * np.pi, len(radii), endpoint=False)
    points = np.column_stack([np.cos(angles), np.sin(angles)]) * np.array(radii)[:, None]
    star = shapely.Polygon(points)
    _, mesh = filled(star, spacing=spacing)
    areas = doubled_areas(mesh.points, mesh.triangles) / 2
    assert areas.min() > 0
    assert areas.sum() == pytest.approx(star.area, rel=1e-12)
