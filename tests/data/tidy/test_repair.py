"""Repairs: what is mended, and how it is told."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely.geometry import MultiPolygon, Polygon, box

from geotween.data.polygons import Feature, polygon_set
from geotween.data.problems import Problem
from geotween.data.tidy.repair import repair
from tests.data.shapes import PLACES

SQUARE = [(0, 0), (4, 0), (4, 4), (0, 4)]
SMALL = [(1, 1), (3, 1), (3, 3), (1, 3)]


def mended(
    *geometries: Polygon | MultiPolygon, winding: bool = False
) -> tuple[list[Polygon | MultiPolygon], list[Problem]]:
    kept, problems = repair([Feature(g) for g in geometries], step="1990", winding=winding)
    return [feature.geometry for feature in kept], problems


def kinds(problems: list[Problem]) -> list[tuple[str, str, str, float]]:
    return [(p.kind, p.severity, p.piece, p.measure) for p in problems]


def test_valid_polygons_pass_unchanged() -> None:
    given_polygons = [Polygon(SQUARE, [SMALL]), MultiPolygon([box(5, 0, 6, 1), box(7, 0, 8, 1)])]
    assert mended(*given_polygons) == (given_polygons, [])


def test_nothing_passes() -> None:
    assert mended() == ([], [])


def test_bow_tie_becomes_its_two_triangles() -> None:
    (shape,), problems = mended(Polygon([(0, 0), (4, 4), (4, 0), (0, 4)]))
    assert shape.is_valid
    assert shape.equals(MultiPolygon([Polygon([(0, 0), (2, 2), (0, 4)]),
                                      Polygon([(4, 0), (4, 4), (2, 2)])]))  # fmt: skip
    assert kinds(problems) == [("repaired", "warning", "polygon 1", 1.0)]
    assert problems[0].message == "invalid polygon (self-intersection at 2, 2), repaired"
    assert problems[0].steps == ("1990",)


def test_spike_is_cut_off_without_a_change_of_area() -> None:
    (shape,), problems = mended(Polygon([(0, 0), (4, 0), (9, 0), (4, 0), (4, 4), (0, 4)]))
    assert shape.equals(Polygon(SQUARE))
    assert kinds(problems) == [("repaired", "warning", "polygon 1", 0.0)]


@pytest.mark.parametrize("repeat", [1, 3])
def test_repeated_points_are_dropped(repeat: int) -> None:
    (shape,), problems = mended(Polygon([*SQUARE[:2], *[SQUARE[2]] * (1 + repeat), SQUARE[3]]))
    assert list(shape.exterior.coords) == [*SQUARE, SQUARE[0]]
    assert kinds(problems) == [("repeated points", "note", "polygon 1", repeat)]


def test_repeated_first_point_is_dropped() -> None:
    (shape,), problems = mended(Polygon([SQUARE[0], *SQUARE, SQUARE[0], SQUARE[0]]))
    assert len(shape.exterior.coords) == 5
    assert kinds(problems) == [("repeated points", "note", "polygon 1", 2)]


def test_polygon_that_begins_where_the_one_before_ends_repeats_no_point() -> None:
    assert mended(Polygon(SQUARE), Polygon([(0, 0), (-4, 0), (-4, -4)]))[1] == []


def test_hole_outside_its_shell_becomes_a_polygon() -> None:
    (shape,), problems = mended(Polygon(SQUARE, [[(6, 1), (7, 1), (7, 2)]]))
    assert shape.equals(MultiPolygon([Polygon(SQUARE), Polygon([(6, 1), (7, 1), (7, 2)])]))
    assert [(p.kind, p.severity) for p in problems] == [("repaired", "warning")]
    assert "hole lies outside shell" in problems[0].message


def test_hole_of_one_point_is_dropped() -> None:
    (shape,), problems = mended(Polygon(SQUARE, [[(1, 1)] * 3]))
    assert shape.equals(Polygon(SQUARE))
    assert [p.kind for p in problems] == ["repaired"]


def test_ring_of_one_point_is_left_out() -> None:
    shapes, problems = mended(Polygon([(1, 1)] * 3), Polygon(SQUARE))
    assert shapes == [Polygon(SQUARE)]
    assert [p.kind for p in problems] == ["repaired", "no area"]


def test_hole_that_crosses_its_shell_is_cut_out() -> None:
    (shape,), problems = mended(Polygon(SQUARE, [[(2, 1), (6, 1), (6, 3), (2, 3)]]))
    assert shape.equals(Polygon(SQUARE).difference(box(2, 1, 6, 3)))
    assert [p.kind for p in problems] == ["repaired"]


def test_overlapping_parts_become_one() -> None:
    (shape,), problems = mended(MultiPolygon([box(0, 0, 2, 1), box(1, 0, 3, 1)]))
    assert shape.equals(box(0, 0, 3, 1))
    assert [p.kind for p in problems] == ["repaired"]


def test_ring_on_one_line_is_left_out() -> None:
    shapes, problems = mended(Polygon([(0, 0), (1, 1), (2, 2)]), Polygon(SQUARE))
    assert shapes == [Polygon(SQUARE)]
    assert [(p.kind, p.severity, p.piece) for p in problems] == [
        ("repaired", "warning", "polygon 1"),
        ("no area", "warning", "polygon 1"),
    ]


def test_part_on_one_line_is_left_out_of_its_multipolygon() -> None:
    (shape,), problems = mended(MultiPolygon([Polygon(SQUARE), Polygon([(5, 0), (6, 1), (7, 2)])]))
    assert shape.geom_type in ("Polygon", "MultiPolygon")
    assert shape.equals(Polygon(SQUARE))
    assert [p.kind for p in problems] == ["repaired"]


def test_part_too_small_to_tell_is_left_out_of_its_multipolygon() -> None:
    (shape,), problems = mended(MultiPolygon([Polygon(SQUARE), box(9, 9, 9 + 1e-10, 9 + 1e-10)]))
    assert shape.equals(Polygon(SQUARE))
    assert [p.kind for p in problems] == ["no area"]


def test_sliver_thinner_than_numbers_can_tell_is_left_out() -> None:
    shapes, problems = mended(Polygon([(0, 0), (4, 4), (4, 4 + 1e-9)]), Polygon(SQUARE))
    assert shapes == [Polygon(SQUARE)]
    assert kinds(problems) == [("no area", "warning", "polygon 1", 0.0)]


def test_thin_polygon_stays() -> None:
    shapes, problems = mended(box(0, 0, 4, 1e-6), Polygon(SQUARE))
    assert (len(shapes), problems) == (2, [])


def test_hole_beside_its_shell_that_touches_it_is_dropped() -> None:
    (shape,), problems = mended(Polygon(SQUARE, [[(4, 0), (6, 0), (6, 4), (4, 4)]]))
    assert shape.equals(Polygon(SQUARE))
    assert [p.kind for p in problems] == ["repaired"]


def test_outline_that_runs_along_itself_is_one_area() -> None:
    there_and_back = [(0, 0), (4, 0), (4, 4), (0, 0), (0, 4), (4, 4)]
    (shape,), problems = mended(Polygon(there_and_back))
    assert shape.is_valid
    assert shape.equals(Polygon(SQUARE))
    assert [p.kind for p in problems] == ["repaired"]


def test_valid_sliver_beyond_what_numbers_can_tell_is_left_out() -> None:
    shapes, problems = mended(box(0, 0, 1e-11, 1e-11), Polygon(SQUARE))
    assert shapes == [Polygon(SQUARE)]
    assert kinds(problems) == [("no area", "warning", "polygon 1", 0.0)]


@pytest.mark.parametrize("size", [1e-9, 1.0, 1e9])
def test_what_is_small_depends_on_the_size_of_the_data(size: float) -> None:
    shapes, problems = mended(box(0, 0, size / 1000, size / 1000), box(0, 0, size, size))
    assert len(shapes) == 2
    assert problems == []


def test_problem_names_the_feature() -> None:
    line = Polygon([(0, 0), (1, 1), (2, 2)])
    named, keyed = Feature(line, "k", name="Aral Sea"), Feature(line, "k")
    _, problems = repair([named, keyed, Feature(line)], step="1990")
    assert [p.piece for p in problems if p.kind == "no area"] == ["Aral Sea", "k", "polygon 3"]


def test_identity_stays_with_a_repaired_feature() -> None:
    bow_tie = Feature(Polygon([(0, 0), (4, 4), (4, 0), (0, 4)]), "k", "lake", "Aral Sea")
    (kept,), _ = repair([bow_tie])
    assert (kept.key, kept.class_, kept.name) == ("k", "lake", "Aral Sea")


def test_shape_that_one_method_breaks_down_on_is_rebuilt_from_its_lines(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    make_valid = shapely.make_valid

    def breaks_down(geometry: Polygon, method: str, **options: bool) -> object:
        if method == "structure":
            raise shapely.errors.GEOSException("TopologyException: side location conflict")
        return make_valid(geometry, method=method, **options)

    monkeypatch.setattr(shapely, "make_valid", breaks_down)
    (shape,), _ = mended(Polygon([(0, 0), (4, 4), (4, 0), (0, 4)]))
    assert shape.is_valid
    assert shape.area == 8


# Winding


@pytest.mark.parametrize(
    ("outer", "inner", "wrong"),
    [(1, -1, 0), (-1, -1, 1), (1, 1, 1), (-1, 1, 2)],
    ids=["right", "outer wrong", "hole wrong", "both wrong"],
)
def test_winding_is_noted_where_it_is_asked_for(outer: int, inner: int, wrong: int) -> None:
    polygon = Polygon(SQUARE[::outer], [SMALL[::inner]])
    assert mended(polygon)[1] == []
    noted = [("winding", "note", "", wrong)] if wrong else []
    assert kinds(mended(polygon, winding=True)[1]) == noted


@pytest.mark.parametrize("outer", [1, -1])
@pytest.mark.parametrize("inner", [1, -1])
def test_winding_is_settled(outer: int, inner: int) -> None:
    (polygon,) = polygon_set([Feature(Polygon(SQUARE[::outer], [SMALL[::inner]]))]).polygons
    assert polygon.exterior.is_ccw
    assert not polygon.interiors[0].is_ccw


# Whatever comes in


@given(
    st.lists(
        st.lists(PLACES, min_size=3, max_size=8).map(Polygon)
        | st.builds(
            lambda shell, hole: Polygon(shell, [hole]),
            st.lists(PLACES, min_size=3, max_size=8),
            st.lists(PLACES, min_size=3, max_size=8),
        ),
        max_size=3,
    )
)
def test_whatever_comes_in_goes_out_valid(given_polygons: list[Polygon]) -> None:
    shapes, problems = mended(*given_polygons, winding=True)
    polygons = polygon_set([Feature(shape) for shape in shapes]).polygons
    assert shapely.is_valid(polygons).all()
    assert (shapely.area(polygons) > 0).all()
    assert (shapely.get_type_id(polygons) == shapely.GeometryType.POLYGON).all()
    assert shapely.is_ccw(shapely.get_exterior_ring(polygons)).all()
    left_out = {p.piece for p in problems if p.kind == "no area"}
    assert len(given_polygons) - len(left_out) <= len(shapes) <= len(given_polygons)
    if all(p.is_valid for p in given_polygons):
        assert not any(p.kind == "repaired" for p in problems)
        before = sum(p.area for p in given_polygons)
        assert np.isclose(shapely.area(polygons).sum(), before, rtol=1e-12)
