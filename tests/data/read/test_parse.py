"""Every way to write a polygon, and what is told of a wrong one."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely.geometry import MultiPolygon, Polygon

from geotween.data.read.parse import is_wkt
from tests.data.shapes import as_geojson, as_rings, parse, parsed, polygons, rings

# As YAML gives them: all numbers are texts.
SQUARE = [["0", "0"], ["9", "0"], ["9", "9"], ["0", "9"]]
HOLE = [["3", "3"], ["3", "6"], ["6", "6"], ["6", "3"]]
FAR = [["20", "0"], ["29", "0"], ["29", "9"]]

square = [(0, 0), (9, 0), (9, 9), (0, 9)]
hole = [(3, 3), (3, 6), (6, 6), (6, 3)]
far = [(20, 0), (29, 0), (29, 9)]


def feature(geometry: Any, **properties: Any) -> dict[str, Any]:
    return {"type": "Feature", "properties": properties, "geometry": geometry}


@pytest.mark.parametrize(
    ("value", "polygons"),
    [
        ([], []),
        (SQUARE, [[square]]),
        ([*SQUARE, SQUARE[0]], [[square]]),
        ([SQUARE], [[square]]),
        ([SQUARE, FAR], [[square], [far]]),
        ([[SQUARE, HOLE]], [[square, hole]]),
        ([[SQUARE, HOLE], FAR], [[square, hole], [far]]),
        ([[[SQUARE, HOLE], [FAR]]], [[square, hole], [far]]),
        ([{"polygon": SQUARE}, FAR], [[square], [far]]),
        ([{"polygon": [SQUARE, HOLE]}], [[square, hole]]),
        ([{"polygon": [[SQUARE, HOLE], [FAR]]}], [[square, hole], [far]]),
        ("POLYGON ((0 0, 9 0, 9 9, 0 9, 0 0))", [[square]]),
        ("srid=4326; polygon Z((0 0 5, 9 0 5, 9 9 5, 0 9 5, 0 0 5))", [[square]]),
        ("MULTIPOLYGON (((0 0, 9 0, 9 9, 0 9, 0 0)), ((20 0, 29 0, 29 9, 20 0)))",
         [[square], [far]]),
        ("POLYGON EMPTY", []),
        (["POLYGON ((0 0, 9 0, 9 9, 0 9, 0 0), (3 3, 3 6, 6 6, 6 3, 3 3))", FAR],
         [[square, hole], [far]]),
        ([{"polygon": "POLYGON ((0 0, 9 0, 9 9, 0 9, 0 0))"}], [[square]]),
        ({"type": "Polygon", "coordinates": [SQUARE, HOLE]}, [[square, hole]]),
        ({"type": "Polygon", "coordinates": []}, []),
        ({"type": "MultiPolygon", "coordinates": [[SQUARE], [FAR]]}, [[square], [far]]),
        (feature({"type": "Polygon", "coordinates": [SQUARE]}), [[square]]),
        ({"type": "FeatureCollection", "features": [
            feature({"type": "Polygon", "coordinates": [SQUARE]}),
            feature({"type": "Polygon", "coordinates": [FAR]}),
        ]}, [[square], [far]]),
        ({"type": "GeometryCollection", "geometries": [
            {"type": "Polygon", "coordinates": [SQUARE]},
            {"type": "GeometryCollection", "geometries": [
                {"type": "Polygon", "coordinates": [FAR]},
            ]},
        ]}, [[square], [far]]),
        ([{"type": "Polygon", "coordinates": [SQUARE]}, FAR], [[square], [far]]),
        ([{"polygon": {"type": "Polygon", "coordinates": [SQUARE]}}], [[square]]),
    ],
)  # fmt: skip
def test_form_of_polygons(value: Any, polygons: Any) -> None:
    assert rings(parsed(value)) == polygons


def test_largest_coordinate_is_read() -> None:
    ring = [["0", "0"], ["1e12", "0"], ["0", "-1e12"]]
    assert rings(parsed([ring])) == [[[(0, 0), (1e12, 0), (0, -1e12)]]]


def test_heights_are_dropped_even_where_only_some_points_have_one() -> None:
    ring = [["0", "0", "7"], ["9", "0"], ["9", "9", "8", "1"], ["0", "9"]]
    assert rings(parsed([ring])) == [[square]]


def test_parts_of_one_value_are_one_feature() -> None:
    (one,) = parsed([{"key": "a", "polygon": [[SQUARE], [FAR]]}])
    assert isinstance(one.geometry, MultiPolygon)


@given(st.lists(polygons(), max_size=3))
def test_every_form_gives_the_same_polygons(given_polygons: list[Polygon]) -> None:
    members = [feature(as_geojson(p)) for p in given_polygons]
    forms: list[Any] = [
        [as_rings(p) for p in given_polygons],
        [{"polygon": as_rings(p)} for p in given_polygons],
        [p.wkt for p in given_polygons],
        [as_geojson(p) for p in given_polygons],
        {"type": "FeatureCollection", "features": members},
    ]
    if given_polygons:
        whole = MultiPolygon(given_polygons)
        forms += [whole.wkt, as_geojson(whole), [[as_rings(p) for p in given_polygons]]]
    wanted = [[ring.coords[:-1] for ring in (p.exterior, *p.interiors)] for p in given_polygons]
    assert [rings(parsed(form)) for form in forms] == [wanted] * len(forms)


# Identity


@pytest.mark.parametrize("where", ["inline", "properties"])
def test_key_class_and_name_come_with_the_feature(where: str) -> None:
    names = {"key": "a", "class": "lake", "name": "Aral Sea"}
    value: dict[str, Any] = {**names, "polygon": SQUARE}
    if where == "properties":
        value = feature({"type": "Polygon", "coordinates": [SQUARE]}, **names)
    (one,) = parsed([value])
    assert (one.key, one.class_, one.name) == ("a", "lake", "Aral Sea")


def test_feature_without_names_has_none() -> None:
    (one,) = parsed([{"polygon": SQUARE}])
    assert (one.key, one.class_, one.name) == (None, None, "")


@pytest.mark.parametrize(
    ("given_key", "key"), [(7, "7"), (7.5, "7.5"), (True, "true"), ("017", "017"), (None, None)]
)
def test_key_of_geojson_becomes_a_text(given_key: Any, key: str | None) -> None:
    (one,) = parsed(feature({"type": "Polygon", "coordinates": [SQUARE]}, key=given_key))
    assert one.key == key


def test_feature_may_have_null_properties() -> None:
    value = {**feature({"type": "Polygon", "coordinates": [SQUARE]}), "properties": None}
    assert len(parsed(value)) == 1


# Without area


@pytest.mark.parametrize(
    ("value", "skipped"),
    [
        ({"type": "Point", "coordinates": [0, 0]}, 1),
        ({"type": "LineString", "coordinates": [[0, 0], [1, 1]]}, 1),
        ({"type": "MultiPoint", "coordinates": []}, 1),
        ({"type": "MultiLineString", "coordinates": []}, 1),
        (feature(None), 1),
        ({"type": "FeatureCollection", "features": [feature(None), feature(None)]}, 2),
        ({"type": "GeometryCollection", "geometries": [
            {"type": "Point", "coordinates": [0, 0]},
            {"type": "Point", "coordinates": [0, 0]},
        ]}, 2),
        ("POINT (0 0)", 1),
        ("GEOMETRYCOLLECTION (POINT (0 0), LINESTRING (0 0, 1 1))", 2),
    ],
)  # fmt: skip
def test_points_and_lines_are_counted_and_left_out(value: Any, skipped: int) -> None:
    assert parse(value) == ([], [], skipped)


def test_polygon_beside_a_point_stays() -> None:
    features, told, skipped = parse(
        "GEOMETRYCOLLECTION (POINT (0 0), POLYGON ((0 0, 9 0, 9 9, 0 0)))"
    )
    assert rings(features) == [[[(0, 0), (9, 0), (9, 9)]]]
    assert (told, skipped) == ([], 1)


# What is wrong, and where

RING = "expected a ring: [[x, y], [x, y], [x, y], ...]"
BEYOND = "the coordinates {} are beyond any map"


def polygon(*rings: Any) -> dict[str, Any]:
    return {"type": "Polygon", "coordinates": list(rings)}


@pytest.mark.parametrize(
    ("value", "at", "message"),
    [
        (None, (), "expected polygons, not None"),
        (5, (), "expected polygons, not 5"),
        ([None], (0,), "expected a polygon, not None"),
        ([[]], (0,), "expected a ring [[x, y], [x, y], [x, y], ...] or a list of rings"),
        ([["1", "2"]], (), "a ring needs at least three distinct points, not 1"),
        ([SQUARE, [["1", "2"], ["3", "4"]]], (1,),
         "a ring needs at least three distinct points, not 2"),
        ([SQUARE, [["1", "2"], ["3", "4"], ["1", "2"]]], (1,),
         "a ring needs at least three distinct points, not 2"),
        ([[SQUARE, HOLE[:2]]], (0, 1), "a ring needs at least three distinct points, not 2"),
        ([[[SQUARE], [HOLE[:2]]]], (0, 1, 0),
         "a ring needs at least three distinct points, not 2"),
        ([[*SQUARE, ["1"]]], (0, 4), "expected a point [x, y], not [1]"),
        ([[*SQUARE, "12"]], (0, 4), "expected a point [x, y], not '12'"),
        ([[*SQUARE, ["a", "2"]]], (0, 4), "expected a point [x, y], not [a, 2]"),
        ([[*SQUARE, ["1", None]]], (0, 4), "expected a point [x, y], not [1, None]"),
        ([[*SQUARE, [["1"], "2"]]], (0, 4), "expected a point [x, y], not [['1'], 2]"),
        ([[*SQUARE, {"x": "1"}]], (0, 4), "expected a point [x, y], not {'x': '1'}"),
        ([[["1"], ["2"], ["3"]]], (0,), RING),
        ([[["nan", "0"], *SQUARE]], (0, 0), BEYOND.format("nan, 0")),
        ([[*SQUARE, ["0", "-inf"]]], (0, 4), BEYOND.format("0, -inf")),
        ([[*SQUARE, ["1e999", "0"]]], (0, 4), BEYOND.format("inf, 0")),
        ([[*SQUARE, ["0", "2e12"]]], (0, 4), BEYOND.format("0, 2e+12")),
        ("POLYGON ((0 0, 9 0, 0 0, 0 0))", (),
         "a ring needs at least three distinct points, not 2"),
        ([{"key": "a"}], (0,), 'a feature needs a "polygon"'),
        ([{"key": "a", "polygon": None}], (0, "polygon"), "expected a polygon, not None"),
        ([{"polygon": SQUARE, "nam": "a"}], (0, "nam"), 'unknown key "nam"'),
        ([{"polygon": SQUARE, "key": ["a"]}], (0, "key"), '"key": expected a text'),
        ([{"polygon": SQUARE, "name": "a\a"}], (0, "name"),
         '"name" holds a character that cannot be shown'),
        ({}, (), 'GeoJSON needs a "type"'),
        ({"type": None}, (), 'GeoJSON needs a "type"'),
        ({"type": "Poligon"}, ("type",), '"Poligon" is no type of GeoJSON'),
        ({"type": ["Polygon"]}, ("type",), '"[\'Polygon\']" is no type of GeoJSON'),
        ({"type": "FeatureCollection"}, (), 'a FeatureCollection needs a list "features"'),
        ({"type": "FeatureCollection", "features": [5]}, ("features", 0),
         'GeoJSON needs a "type"'),
        (feature([]), ("geometry",), 'GeoJSON needs a "type"'),
        ({**feature(polygon(SQUARE)), "properties": "a"}, ("properties",),
         "properties must be a mapping"),
        ({"type": "GeometryCollection"}, (), 'a GeometryCollection needs a list "geometries"'),
        ({"type": "Polygon"}, (), 'a Polygon needs a list "coordinates"'),
        ({"type": "MultiPolygon", "coordinates": [5]}, ("coordinates", 0),
         "expected a list of rings"),
        (polygon("abc"), ("coordinates", 0), RING),
        (polygon({"x": 1}), ("coordinates", 0), RING),
        (polygon([]), ("coordinates", 0), RING),
        (polygon(SQUARE, [[True, 0], [1, 0], [1, 1]]), ("coordinates", 1, 0),
         "expected a point [x, y], not [True, 0]"),
        (polygon([[10**400, 0], [1, 0], [1, 1]]), ("coordinates", 0, 0),
         f"expected a point [x, y], not [1{37 * '0'}…"),
    ],
)  # fmt: skip
def test_wrong_value_is_told_at_its_place(value: Any, at: Any, message: str) -> None:
    _, told, _ = parse(value)
    assert [(place, words) for place, words, _ in told] == [(at, message)]


@pytest.mark.parametrize(
    "text",
    [
        "POLYGON ((0 0, 9 0, 9 9",
        "POLYGON ((0 0, 9 0, 9 9))",
        "POLYGON (0 0, 9 0, 9 9, 0 0)",
        "CIRCLE (0 0)",
        "CURVEPOLYGON ((0 0, 9 0, 9 9, 0 0))",
        "lake.geojson",
        "",
    ],
)
def test_text_in_a_list_that_is_not_wkt(text: str) -> None:
    _, told, _ = parse([SQUARE, text])
    ((at, message, hint),) = told
    assert at == (1,)
    assert message.startswith("this is not WKT: ")
    assert hint == "for example POLYGON ((0 0, 9 0, 9 9, 0 0))"


def test_number_beyond_double_precision_in_wkt() -> None:
    _, told, _ = parse("POLYGON ((1e999 0, 9 0, 9 9, 1e999 0))")
    assert [message for _, message, _ in told] == [BEYOND.format("inf, 0")]


def test_all_wrong_rings_are_told_at_once() -> None:
    _, told, _ = parse([[SQUARE, HOLE[:2], HOLE[:1]], "CIRCLE", {"polygon": [["a", "b"]]}])
    assert [at for at, _, _ in told] == [(0, 1), (0, 2), (1,), (2, "polygon", 0)]


def test_misspelt_key_and_type_are_told_with_the_nearest_known_one() -> None:
    _, told, _ = parse([{"polygon": SQUARE, "clas": "a"}, {"type": "polygone"}])
    assert [hint for _, _, hint in told] == ['did you mean "class"?', 'did you mean "Polygon"?']


@given(
    st.recursive(
        st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
        lambda inner: (
            st.lists(inner, max_size=4)
            | st.dictionaries(
                st.sampled_from(["type", "key", "polygon", "coordinates", "geometry", "features"]),
                inner | st.sampled_from(["Feature", "Polygon", "MultiPolygon"]),
            )
        ),
    )
)
def test_fault_in_any_value_is_told_at_a_place_that_is_there(value: Any) -> None:
    _, told, _ = parse(value)
    for at, _, _ in told:
        found = value
        for step in at:
            found = found[step]


# Paths


@pytest.mark.parametrize(
    "text", ["POLYGON ((0 0", "polygon((0 0", "MULTIPOLYGON Z (", "POLYGONZ(", "POINT (0 0)",
             "POLYGON EMPTY", "SRID=4326;POLYGON", "GEOMETRYCOLLECTION (", "\n  POLYGON (("],
)  # fmt: skip
def test_text_that_is_wkt(text: str) -> None:
    assert is_wkt(text)


@pytest.mark.parametrize(
    "text", ["polygons.geojson", "Polygon.geojson", "points/2020.geojson", "multipolygon_1.json",
             "polygon-a.geojson", "lake.geojson", "", "linestrings"],
)  # fmt: skip
def test_text_that_is_a_path(text: str) -> None:
    assert not is_wkt(text)
