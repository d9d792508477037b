"""From the data to the page: fit, direction, rounding."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from shapely.geometry import Polygon, box

import geotween
from geotween.data.polygons import Feature, polygon_set
from geotween.export.page_grid import GRID, fit_page, moving, resting
from geotween.scene.model import Map
from tests.motion.shapes import polygon_sets

WIDE = polygon_set([Feature(box(100, 200, 300, 250))])


def frame(**values: object) -> Map:
    return Map.model_validate(values)


def test_the_height_follows_from_the_data() -> None:
    page = fit_page(frame(width=440, padding=20), [WIDE])
    assert (page.width, page.height) == (440, 140)


def test_up_is_up_unless_it_is_down() -> None:
    up = fit_page(frame(width=440, padding=20), [WIDE])
    down = fit_page(frame(width=440, padding=20, y="down"), [WIDE])
    corner = np.array([[100.0, 250.0]])
    assert up.pixels(corner).tolist() == [[20, 20]]
    assert down.pixels(corner).tolist() == [[20, 120]]


def test_a_given_height_centres_the_data() -> None:
    page = fit_page(frame(width=440, height=300, padding=20), [WIDE])
    assert page.pixels(np.array([[200.0, 225.0]])).tolist() == [[220, 150]]


def test_a_polygon_smaller_than_the_grid_has_no_ring() -> None:
    both = polygon_set([Feature(box(0, 0, 100, 100)), Feature(box(50, 50, 50.001, 50.001))])
    page = fit_page(frame(width=132), [both])
    assert [len(t.offsets) - 1 for t in resting(both, page)] == [1, 0]


def test_what_moves_less_than_the_grid_is_still() -> None:
    m = geotween.morph([box(0, 0, 100, 100)], [box(0, 0, 100, 100.01)], "morph")
    page = fit_page(frame(width=132), [polygon_set([Feature(box(0, 0, 100, 100))])])
    assert moving(m.tracks[0], page).still


@given(polygon_sets)
def test_rounding_moves_no_vertex_by_more_than_half_a_diagonal(polygons: list[Polygon]) -> None:
    assume(polygons)
    given_set = polygon_set(Feature(p) for p in polygons)
    page = fit_page(frame(), [given_set])
    for polygon, track in zip(given_set.polygons, resting(given_set, page), strict=True):
        exact = page.pixels(np.array(polygon.exterior.coords))
        for vertex in track.vertices[0, : track.offsets[1]] * GRID:
            assert np.hypot(*(exact - vertex).T).min() <= GRID / np.sqrt(2) + 1e-9


def test_the_page_is_the_same_whatever_the_units() -> None:
    large = polygon_set([Feature(box(1e11, 2e11, 3e11, 2.5e11))])
    one, other = (fit_page(frame(), [s]) for s in (WIDE, large))
    assert one.height == other.height
    assert one.pixels(np.array([[150.0, 220.0]])) == pytest.approx(
        other.pixels(np.array([[1.5e11, 2.2e11]]))
    )
