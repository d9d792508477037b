"""Division by meshes: triangles go to whom most of them belongs, and seams can be smoothed."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from shapely.geometry import Polygon, box

import geotween
from geotween.mesh.fill import fill
from geotween.mesh.mesh import Mesh
from geotween.motion.divide.meshed import by_mesh
from tests.motion.divide.partitions import COMB, HARD, SQUARE, assert_partition
from tests.motion.shapes import star

MESHED = ("advancing-front", "quadtree")


def lattice(polygon: Polygon) -> Mesh:
    found = fill(np.array([polygon]), np.array([0.5]))
    return Mesh(found.points, found.triangles)


def two_triangles(polygon: Polygon) -> Mesh:
    """A rectangle's halves below and above its rising diagonal."""
    points = np.asarray(polygon.normalize().exterior.coords)[:4]
    return Mesh(points, np.array([[0, 1, 2], [0, 2, 3]]))


def test_a_triangle_goes_to_the_one_with_the_largest_share() -> None:
    below, above = box(1, 0, 8, 3), box(0, 6, 2, 8)
    pieces, _ = by_mesh(two_triangles, SQUARE, [above, below])
    assert pieces[0].contains(shapely.Point(1, 7))
    assert pieces[1].contains(shapely.Point(7, 1))


def test_a_triangle_that_meets_nobody_goes_to_the_nearest() -> None:
    far = [box(20, 0, 21, 1), box(0, 20, 1, 21)]
    right, upper = by_mesh(two_triangles, SQUARE, far)[0]
    assert right.contains(shapely.Point(7, 1))
    assert upper.contains(shapely.Point(1, 7))


def test_seams_run_along_the_mesh() -> None:
    mesh = lattice(SQUARE)
    pieces, _ = by_mesh(lattice, SQUARE, [box(0, 0, 3, 8), box(3.3, 0, 8, 8)])
    assert_partition(SQUARE, pieces)
    vertices = shapely.get_coordinates(pieces) @ [1, 1j]
    assert np.isin(vertices, mesh.points @ [1, 1j]).all()


@pytest.mark.parametrize("technique", MESHED)
@pytest.mark.parametrize("case", HARD)
def test_smooth_seams_make_a_partition(case: str, technique: str) -> None:
    polygon, others = HARD[case]()
    assert_partition(polygon, geotween.divide(polygon, others, technique, smooth=True))


@pytest.mark.parametrize("technique", MESHED)
def test_smoothing_takes_the_zigzag_away(technique: str) -> None:
    others = [box(0, 0, 3.3, 8), box(4.1, 0, 8, 8)]
    rough, smooth = (
        geotween.divide(SQUARE, others, technique, smooth=smooth) for smooth in (False, True)
    )
    lengths = [(one.length + other.length - SQUARE.length) / 2 for one, other in (rough, smooth)]
    assert 8 <= lengths[1] <= lengths[0]
    assert lengths[1] < 8.8


def test_smoothing_moves_no_end_of_a_seam_and_no_outline() -> None:
    polygon = star(30, 5, 6)
    others = [star(6, k, 2, *place) for k, place in enumerate([(3, 2), (-3, 2), (0, -3)])]
    rough, smooth = (
        geotween.divide(polygon, others, "advancing-front", smooth=smooth)
        for smooth in (False, True)
    )
    assert np.isin(corners(rough), corners(smooth)).all()
    outline = shapely.get_coordinates(polygon) @ [1, 1j]
    assert np.isin(outline, shapely.get_coordinates(smooth) @ [1, 1j]).all()


def corners(pieces: list[Polygon]) -> np.ndarray:
    """Where three pieces meet."""
    places = [np.unique(shapely.get_coordinates(piece) @ [1, 1j]) for piece in pieces]
    found, counts = np.unique(np.concatenate(places), return_counts=True)
    return np.asarray(found[counts >= 3])


def test_an_island_of_one_within_another_can_be_smoothed() -> None:
    inner = box(3, 3, 5, 5)
    for technique in MESHED:
        pieces = geotween.divide(SQUARE, [SQUARE - inner, inner], technique, smooth=True)
        assert_partition(SQUARE, pieces)
        assert len(pieces[0].interiors) == 1


def test_a_narrow_comb_keeps_its_teeth() -> None:
    for technique in MESHED:
        assert_partition(COMB, geotween.divide(COMB, [box(0, 3, 6, 7), box(6, 3, 9, 7)], technique))
