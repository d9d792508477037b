"""The quality of triangles: known shapes, bounds, and what does not change it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import geotween.mesh
from geotween.mesh import Mesh, histogram, quality, share_good

EQUILATERAL = [(0, 0), (1, 0), (0.5, 0.75**0.5)]
RIGHT_ISOSCELES = [(0, 0), (1, 0), (0, 1)]
THREE_FOUR_FIVE = [(0, 0), (3, 0), (0, 4)]
ONE_TO_TWO = [(0, 0), (1, 0), (0, 2)]
FLAT = [(0, 0), (1, 0), (2, 0)]
POINT = [(1, 1), (1, 1), (1, 1)]


def mesh_of(*triangles):
    corners = np.array(triangles, dtype=float).reshape(-1, 2)
    return Mesh(corners, np.arange(len(corners)).reshape(-1, 3))


@pytest.mark.parametrize(
    ("triangle", "expected"),
    [
        (EQUILATERAL, 1.0),
        (RIGHT_ISOSCELES, 2 * (2**0.5 - 1)),
        (THREE_FOUR_FIVE, 0.8),
        (ONE_TO_TWO, (6 - 2 * 5**0.5) / 5**0.5),
        (FLAT, 0.0),
        (POINT, 0.0),
    ],
)
def test_known_triangles(triangle, expected):
    assert quality(mesh_of(triangle)) == pytest.approx([expected], abs=1e-12)


def test_a_needle_is_nearly_nothing_and_exact_enough():
    # Its inscribed circle has half the height as radius, the circumscribed one 1 / (8 height).
    height = 1e-7
    assert quality(mesh_of([(0, 0), (1, 0), (0.5, height)])) == pytest.approx(
        [8 * height**2], rel=1e-6
    )


@given(
    st.lists(st.integers(-999, 999), min_size=6, max_size=6),
    st.floats(0, 6.3),
    st.sampled_from([1e-150, 1e-9, 1.0, 1e9, 1e150]),
)
def test_place_turn_side_and_scale_do_not_matter(numbers, turn, scale):
    triangle = np.array(numbers).reshape(3, 2)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    other = (triangle @ rotation * [1, -1])[::-1] * scale
    (one,), (two,) = quality(mesh_of(triangle)), quality(mesh_of(other))
    assert 0 <= one <= 1
    assert two == pytest.approx(one, abs=1e-6)


def test_the_histogram_counts_every_triangle_once():
    counts, edges = histogram(mesh_of(EQUILATERAL, RIGHT_ISOSCELES, ONE_TO_TWO, FLAT), bins=4)
    assert counts.tolist() == [1, 0, 1, 2]
    assert edges.tolist() == [0, 0.25, 0.5, 0.75, 1]
    with pytest.raises(ValueError, match="one range or more"):
        histogram(mesh_of(FLAT), bins=0)


def test_the_share_of_good_triangles_includes_the_limit():
    assert share_good(mesh_of(EQUILATERAL, THREE_FOUR_FIVE, ONE_TO_TWO, FLAT)) == 0.5
    assert share_good(mesh_of(EQUILATERAL, FLAT), good=0.9) == 0.5
    assert np.isnan(share_good(mesh_of()))


@pytest.mark.parametrize("name", ["advancing_front", "quadtree", "quality"])
def test_functions_that_are_named_as_their_files_stay_functions(name):
    __import__(f"geotween.mesh.{name}")
    assert callable(getattr(geotween.mesh, name))
