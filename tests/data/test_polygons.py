"""Polygon sets: identity, extent, and fitting one into the frame of another."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from shapely.geometry import MultiPolygon, Polygon, box

from geotween.data.polygons import Feature, PolygonSet, bounds_of, extent, fit_into, polygon_set
from tests.data.shapes import polygons


def a_set(*shapes: Polygon) -> PolygonSet:
    return polygon_set(Feature(shape) for shape in shapes)


def test_parts_of_a_multipolygon_share_an_identity() -> None:
    lakes = Feature(MultiPolygon([box(0, 0, 1, 1), box(2, 0, 3, 1)]), "aral", "lake", "Aral Sea")
    found = polygon_set([lakes, Feature(box(4, 0, 5, 1))])
    assert [p.bounds for p in found.polygons] == [(0, 0, 1, 1), (2, 0, 3, 1), (4, 0, 5, 1)]
    first, second, other = found.identities
    assert first is second
    assert (first.key, first.class_, first.keyed, first.name) == ("aral", "lake", True, "Aral Sea")
    assert (other.key, other.class_, other.keyed, other.name) == (1, None, False, "")


def test_feature_without_a_key_has_its_position_as_key() -> None:
    found = polygon_set([Feature(box(0, 0, 1, 1)), Feature(box(2, 0, 3, 1), position=7)])
    assert [i.key for i in found.identities] == [0, 7]


def test_empty_set_has_no_polygons_and_no_bounds() -> None:
    assert len(a_set()) == 0
    assert np.isnan(a_set().bounds).all()


def test_extent_is_the_larger_side_of_the_box_around_all_sets() -> None:
    assert extent(bounds_of([a_set(box(0, 0, 2, 1)), a_set(), a_set(box(1, 0, 2, 7))])) == 7
    assert extent(bounds_of([a_set(box(-3, 0, 2, 1)), a_set(box(5, 0, 9, 7))])) == 12


def test_extent_of_nothing_is_nothing() -> None:
    assert extent(bounds_of([])) == 0
    assert extent(bounds_of([a_set(), a_set()])) == 0


@pytest.mark.parametrize(
    ("shape", "fitted"),
    [
        (box(10, 10, 12, 12), (0, 0, 8, 8)),
        (box(10, 10, 14, 12), (0, 2, 8, 6)),
        (box(10, 10, 12, 14), (2, 0, 6, 8)),
        (box(-50, 0, 50, 100), (0, 0, 8, 8)),
    ],
    ids=["square", "wide", "tall", "large"],
)
def test_set_is_scaled_evenly_and_centred(shape: Polygon, fitted: tuple[float, ...]) -> None:
    found = fit_into(a_set(shape), np.array([0.0, 0.0, 8.0, 8.0]))
    assert tuple(found.bounds) == fitted


def test_polygons_keep_their_places_to_each_other_and_their_identities() -> None:
    shapes = a_set(box(0, 0, 1, 1), box(3, 0, 4, 1))
    found = fit_into(shapes, np.array([0.0, 0.0, 8.0, 8.0]))
    assert [p.bounds for p in found.polygons] == [(0, 3, 2, 5), (6, 3, 8, 5)]
    assert found.identities == shapes.identities


def test_empty_set_fits_into_any_frame() -> None:
    assert len(fit_into(a_set(), np.array([0.0, 0.0, 8.0, 8.0]))) == 0


@given(polygons())
def test_set_fits_into_its_own_frame_unchanged(polygon: Polygon) -> None:
    shapes = a_set(polygon)
    (found,) = fit_into(shapes, shapes.bounds).polygons
    assert found.equals_exact(shapes.polygons[0], 1e-12)
