from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import MultiPolygon, Polygon, box

from geotween.data.globe.projection import Projection, fitting, named, read_crs

WGS84 = read_crs("EPSG:4326")


def auto(*geometries: Polygon | MultiPolygon, crs=WGS84) -> Projection:
    return fitting(np.array(geometries, dtype=object), crs)


def by_name(text: str, *geometries: Polygon | MultiPolygon) -> Projection:
    return named(text, np.array(geometries, dtype=object), WGS84)


@pytest.mark.parametrize(
    "text", ["EPSG:5070", "5070", " epsg:5070 ", "+proj=laea +lat_0=52 +lon_0=10", "OGC:CRS84"]
)
def test_the_ways_to_name_a_system(text):
    crs = read_crs(text)
    assert crs.is_projected or crs.is_geographic
    assert read_crs(crs.to_wkt()).equals(crs)


@pytest.mark.parametrize(
    "text", ["EPSG:999999", "nonsense", "", "+proj=nothing", "EPSG:5773", "EPSG:4978", "x" * 500]
)
def test_what_names_no_map_is_refused_in_a_few_words(text):
    with pytest.raises(ValueError, match=r"coordinate") as error:
        read_crs(text)
    assert len(str(error.value)) < 200


def test_heights_are_left_aside():
    assert read_crs("EPSG:7415").is_projected


EXTENTS = {
    "the contiguous United States": (box(-125, 24, -67, 49), "Albers", "37° N, 96° W", 84),
    "Russia": (MultiPolygon([box(27, 41, 180, 82), box(-180, 62, -169, 72)]), "Albers", "E", -71),
    "the world": (box(-180, -90, 180, 84), "Equal Earth", "0°", 180),
    "a world without the Atlantic": (
        MultiPolygon([box(20, -50, 179, 75), box(179, -30, 310, 75)]),
        "Equal Earth",
        "165° E",
        -15,
    ),
    "the tropics": (box(-180, -23, 180, 23), "cylindrical", "15° N and S", 180),
    "Indonesia": (box(95, -11, 141, 6), "cylindrical", "118° E", -62),
    "the Arctic": (box(-180, 66, 180, 90), "north pole", "0°", None),
    "the Southern Ocean": (box(-180, -90, 180, -60), "south pole", "0°", None),
    "Norway and Siberia": (box(5, 61, 100, 80), "north pole", "53° E", None),
    "Africa": (box(-17, -35, 51, 37), "Lambert azimuthal", "1° N, 17° E", None),
    "Chile": (box(-76, -56, -67, -17), "Lambert azimuthal", "36° S, 71° W", None),
    "Iceland": (box(-24.5, 63.3, -13.5, 66.6), "Lambert azimuthal", "65° N, 19° W", None),
    "Manhattan": (box(-74.02, 40.70, -73.90, 40.88), "Lambert", "40.79° N, 73.96° W", None),
}


@pytest.mark.parametrize("name", EXTENTS)
def test_the_projection_that_suits(name):
    area, kind, centre, cut = EXTENTS[name]
    found = auto(area)
    assert kind in found.words
    assert centre in found.words
    assert found.cut == (cut if cut is None else pytest.approx(cut, abs=1))


def test_the_cut_is_opposite_the_centre_in_the_gap():
    aleutians = MultiPolygon([box(172, 51, 180, 53), box(-180, 51, -160, 60)])
    found = auto(aleutians, box(-125, 24, -67, 49))
    assert "cut" not in found.words
    assert found.cut is None or 113 > found.cut > -67
    assert found.crs.coordinate_operation.method_name in ("Albers Equal Area",)


def test_the_datum_is_that_of_the_data():
    nad83 = read_crs("EPSG:4269")
    found = auto(box(-125, 24, -67, 49), crs=nad83)
    assert found.crs.geodetic_crs.equals(nad83)


def test_degrees_from_paris_in_grads_are_put_on_wgs84():
    found = auto(box(0, 50, 6, 53), crs=read_crs("EPSG:4807"))
    assert found.crs.geodetic_crs.equals(WGS84)
    assert "46.3° N, 5° E" in found.words


def test_data_in_a_plane_are_looked_at_on_the_globe():
    found = auto(box(500_000, 5_540_000, 510_000, 5_550_000), crs=read_crs("EPSG:32633"))
    assert "50.06° N, 15.07° E" in found.words


def test_no_data_is_a_map_of_the_world():
    assert "Equal Earth" in auto().words


@given(st.integers(-179, 180))
def test_turning_the_globe_turns_the_centre(turn):
    area = box(-20, 30, 41, 55)
    before, after = auto(area), auto(shapely.transform(area, lambda xy: np.add(xy, (turn, 0))))
    assert (after.cut - before.cut - turn) % 360 == pytest.approx(0, abs=1e-9)


@given(st.integers(-1000, 800), st.integers(1, 900), st.integers(1, 900))
@settings(max_examples=50)
def test_north_and_south_are_treated_alike(south, height, width):
    south, north = south / 10, min((south + height) / 10, 89)
    if south >= north or south < -89:
        return
    here = auto(box(0, south, width / 5, north))
    there = auto(box(0, -north, width / 5, -south))
    assert here.words.split(",")[0] == there.words.split(",")[0]
    assert here.cut == there.cut


@pytest.mark.parametrize(
    ("text", "cut"),
    [
        ("EPSG:5070", 84),
        ("EPSG:3857", 180),
        ("EPSG:32633", -165),
        ("+proj=eqearth +lon_0=150", -30),
        ("+proj=hammer +lon_0=11", -169),
        ("EPSG:27572", pytest.approx(-177.6628, abs=0.01)),
        ("EPSG:3035", None),
        ("EPSG:3413", None),
        ("+proj=ortho +lat_0=20", None),
        ("EPSG:4326", 180),
    ],
)
def test_a_named_map_is_cut_opposite_its_central_meridian(text, cut):
    assert by_name(text, box(0, 0, 10, 10)).cut == cut


def test_a_map_of_longitudes_is_cut_where_the_data_are_not():
    fiji = MultiPolygon([box(177, -19, 180, -16), box(-180, -19, -179, -16)])
    assert by_name("EPSG:4326", fiji).cut == pytest.approx(-1)


def test_a_named_map_is_called_by_its_name():
    assert by_name("5070").words == "NAD83 / Conus Albers (5070)"
    assert by_name("+proj=eqearth +lon_0=150").words == "+proj=eqearth +lon_0=150"


@pytest.mark.parametrize(("text", "reach"), [("EPSG:3857", 85.06), ("EPSG:3035", 90)])
def test_how_far_towards_the_poles_a_map_reaches(text, reach):
    assert by_name(text).reach == reach


def test_an_unknown_name_is_refused():
    with pytest.raises(ValueError, match="unknown coordinate reference system"):
        by_name("EPSG:1")
