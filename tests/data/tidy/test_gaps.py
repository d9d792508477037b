"""Gaps: strips between neighbours that are found, and openings that are meant."""

from __future__ import annotations

import json

import pytest
import shapely
from shapely.affinity import rotate
from shapely.geometry import MultiPolygon, Polygon, box

from geotween.data.polygons import extent, geometries_of
from geotween.data.read.parse import Parser
from geotween.data.tidy.gaps import gaps
from geotween.data.tidy.nodes import noded
from geotween.data.tidy.repair import repair
from tests.data.tidy.test_linework import PLATE, a_set
from tests.real_data import files, needs_real_data


def strips(*shapes: object, width: float = 0.2) -> list[Polygon]:
    found, takers = gaps(noded(a_set(*shapes)), width)
    assert all(0 <= taker < len(shapes) for taker in takers)
    return list(found)


SOUTH = box(0, 0, 20, 4)


@pytest.mark.parametrize(
    "north",
    [
        box(0, 4.1, 20, 8),
        Polygon([(0, 4), (1, 4), (20, 4.15), (20, 8), (0, 8)]),
        Polygon([(0, 4), (1, 4), (1, 4.1), (19, 4.1), (19, 4), (20, 4), (20, 8), (0, 8)]),
        Polygon([(0, 4.1), (10, 4.02), (20, 4.1), (22, 8), (-2, 8)]),
        MultiPolygon([box(0, 4.1, 20, 8), box(40, 0, 41, 1)]),
    ],
    ids=["open at both ends", "widening to one", "closed", "of changing width", "and an island"],
)
@pytest.mark.parametrize("angle", [0, 33])
def test_a_strip_between_two_is_a_gap(north: object, angle: float) -> None:
    shapes = [rotate(shape, angle, (0, 0)) for shape in (SOUTH, north)]
    (strip,) = strips(*shapes)
    between = rotate(box(0, 4, 20, 4.2), angle, (0, 0)) - shapes[1]
    assert strip.area == pytest.approx(between.area, rel=0.02)
    assert (strip ^ between).area < 0.02 * between.area


@pytest.mark.parametrize(
    "north",
    [
        box(0, 4.5, 20, 8),
        Polygon([(0, 4), (1, 4), (20, 5.5), (20, 8), (0, 8)]),
        Polygon([(0, 4), (18, 4), (20, 4.1), (20, 8), (0, 8)]),
        box(0, 4, 20, 8),
        box(0, 4.1, 2, 8),
    ],
    ids=["strait", "bay", "short notch", "none", "short strait"],
)
def test_what_is_wide_or_short_is_meant(north: object) -> None:
    assert strips(SOUTH, north) == []


def test_an_inlet_and_a_lake_of_one_polygon_are_its_own() -> None:
    inlet, lake = box(5, 0.5, 5.1, 20), box(10, 1, 10.1, 3)
    assert strips(box(0, 0, 20, 4) - inlet - lake, box(20, 0, 24, 4)) == []


def test_a_gap_goes_to_who_borders_it_most() -> None:
    shapes = [box(0, 4.1, 5, 8), box(5, 4.1, 20, 8), SOUTH]
    (strip,), (taker,) = gaps(a_set(*shapes), 0.2)
    assert strip.area == pytest.approx(2, rel=0.01)
    assert taker == 2


def test_a_width_that_no_page_has_finds_nothing() -> None:
    assert strips(SOUTH, box(0, 4.1, 20, 8), width=1e-9) == []


@pytest.mark.parametrize("sets", [[], [PLATE]])
def test_no_gaps(sets: list[object]) -> None:
    assert strips(*sets) == []


@needs_real_data
def test_real_inlets_are_no_gaps() -> None:
    for file in files("us_regions"):
        regions, _ = repair(Parser(lambda *_: None).features(json.loads(file.read_text("utf-8"))))
        shapes = geometries_of(regions)
        assert len(gaps(shapes, 2 * extent(shapely.total_bounds(shapes)) / 920)[0]) == 0
