"""Formats: what is written into a file comes out of it, whichever format it has."""

from __future__ import annotations

import datetime
import json
import sys
import tempfile
import zipfile
from pathlib import Path
from typing import Any

import pyogrio
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import GeometryCollection, LineString, MultiPolygon, Point, Polygon, box

from geotween.data.polygons import Feature
from tests.data.written import (
    FORMATS,
    TABLES,
    TEXTS,
    as_collection,
    as_topology,
    attempt,
    read,
    shapes,
    write,
)

SQUARE, OTHER = box(0, 0, 4, 4), box(6, 0, 9, 4)
FRAME = Polygon(box(0, 0, 9, 9).exterior, [box(3, 3, 6, 6).exterior])
UNREADABLE = "is the file complete, and of the kind that its name says?"

# What every format that has columns can hold; a DBF drops spaces at the end, and an empty text.
LETTERS = st.characters(codec="utf-8", categories=("L", "N"))
COLUMNS: dict[str, st.SearchStrategy[Any]] = {
    "text": st.text(LETTERS, min_size=1, max_size=20),
    "whole": st.integers(-(2**31), 2**31 - 1),
    "number": st.integers(-(10**6), 10**6).map(lambda n: n / 8),
    "yes": st.booleans(),
    "day": st.dates(datetime.date(1800, 1, 1), datetime.date(2200, 1, 1)),
}


@st.composite
def tables(draw: st.DrawFn) -> tuple[list[Any], dict[str, list[Any]]]:
    """Some shapes, and columns for them: their number, and one of each kind, with gaps."""
    held = draw(st.lists(shapes(), min_size=1, max_size=4))
    size = {"min_size": len(held), "max_size": len(held)}
    columns = {n: draw(st.lists(st.none() | values, **size)) for n, values in COLUMNS.items()}
    return held, {"number_": list(range(len(held))), **columns}


def written_as(kind: str, values: list[Any]) -> list[Any]:
    """A column as a file of this kind can hold it: JSON writes dates as texts."""
    dates = any(isinstance(value, datetime.date) for value in values)
    return [v and v.isoformat() for v in values] if dates and kind in TEXTS else values


def plain(value: Any) -> Any:
    """A value without what formats make of dates: 2020/01/05, 2020-01-05T00:00:00."""
    if isinstance(value, datetime.date):
        return value.isoformat()
    return value.replace("/", "-").removesuffix("T00:00:00") if isinstance(value, str) else value


def same(features: list[Feature], shapes: list[Any]) -> bool:
    found = shapely.normalize(
        [f.geometry if isinstance(f.geometry, MultiPolygon) else MultiPolygon([f.geometry])
         for f in features]
    )  # fmt: skip
    wanted = [s if isinstance(s, MultiPolygon) else MultiPolygon([s]) for s in shapes]
    exact = map(shapely.equals_exact, found, shapely.normalize(wanted))  # nor need they be valid
    return len(found) == len(wanted) and all(exact)


@pytest.mark.parametrize("kind", FORMATS)
@given(tables())
@settings(max_examples=12)
def test_what_goes_into_a_file_comes_out_of_it(
    kind: str, table: tuple[list[Any], dict[str, list[Any]]]
) -> None:
    held, columns = table
    if kind in ("shp", "zip"):
        del columns["yes"]  # a DBF has no truth values here
    elif kind in ("gpkg", "fgb", "kml"):
        columns["yes"] = [value or False for value in columns["yes"]]
    columns = {} if kind == "wkt" else {n: written_as(kind, v) for n, v in columns.items()}
    with tempfile.TemporaryDirectory() as folder:
        found = read(write(Path(folder) / f"held.{kind}", held, columns))
    if columns:  # FlatGeobuf sorts its features by place
        found.features.sort(key=lambda feature: int(feature.attributes["number_"]))
    assert same(found.features, held)
    assert found.skipped == 0
    for name, values in columns.items():
        read_back = [plain(feature.attributes[name]) for feature in found.features]
        assert read_back == [plain(value) for value in values]


@pytest.mark.parametrize("kind", ["gpkg", "fgb", "kml", "parquet"])
def test_truth_value_that_is_not_there_is_neither_true_nor_false(kind: str, tmp_path: Path) -> None:
    path = write(tmp_path / f"a.{kind}", [SQUARE] * 3, {"yes": [True, None, False]})
    found = sorted((f.attributes["yes"] for f in read(path).features), key=str)
    assert found == [False, None, True]


@pytest.mark.parametrize("kind", [kind for kind in FORMATS if kind != "wkt"])
def test_key_is_the_same_text_whichever_the_format_and_the_type(kind: str, tmp_path: Path) -> None:
    columns = {"code": [7, None], "level": [2.0, 2.5], "Ort": ["Größe", "日本"]}
    path = write(tmp_path / f"a.{kind}", [SQUARE, OTHER], columns)
    found = read(path, key="code", **{"class": "level"}, name="Ort").features
    assert {(f.key, f.class_, f.name) for f in found} == {
        ("7", "2", "Größe"),
        (None, "2.5", "日本"),
    }


@pytest.mark.parametrize("kind", FORMATS)
def test_crs_is_that_of_the_file_else_that_of_the_source(kind: str, tmp_path: Path) -> None:
    path = write(tmp_path / f"a.{kind}", [SQUARE])
    known = {"wkt": None, "geojson": None, "topojson": None, "parquet": "OGC:CRS84"}
    of_file = known.get(kind, "EPSG:4326")
    assert read(path).crs == of_file
    assert read(path, crs="EPSG:3857").crs == (of_file or "EPSG:3857")


def test_crs_in_a_geojson_and_in_ewkt(tmp_path: Path) -> None:
    member = {"crs": {"type": "name", "properties": {"name": "EPSG:5070"}}}
    (tmp_path / "a.geojson").write_text(json.dumps({**as_collection([SQUARE]), **member}))
    (tmp_path / "a.wkt").write_text(f"SRID=5070;{SQUARE.wkt}\n")
    assert read(tmp_path / "a.geojson").crs == read(tmp_path / "a.wkt").crs == "EPSG:5070"


@pytest.mark.parametrize("crs", [None, {"type": "GeographicCRS", "name": "x"}])
def test_crs_of_a_geoparquet_may_be_none_or_projjson(crs: Any, tmp_path: Path) -> None:
    found = read(write(tmp_path / "a.parquet", [SQUARE], crs=crs)).crs
    assert (found and json.loads(found)) == crs


# What has no area


@pytest.mark.parametrize("kind", [k for k in FORMATS if k not in ("shp", "zip", "fgb")])
def test_polygons_of_a_collection_are_one_feature_and_the_rest_is_counted(
    kind: str, tmp_path: Path
) -> None:
    mixed = GeometryCollection([SQUARE, Point(1, 1), MultiPolygon([OTHER, FRAME])])
    lines = LineString([(0, 0), (1, 1)])
    found = read(_written(tmp_path / f"a.{kind}", [mixed, lines]))
    assert same(found.features, [MultiPolygon([SQUARE, OTHER, FRAME])])
    assert found.skipped == 2


@pytest.mark.parametrize("kind", ["geojson", "wkt", "gpkg"])
def test_collection_in_a_collection(kind: str, tmp_path: Path) -> None:
    inner = GeometryCollection([MultiPolygon([SQUARE, OTHER]), Point(1, 1)])
    nested = GeometryCollection([GeometryCollection([inner])])
    found = read(_written(tmp_path / f"a.{kind}", [nested]))
    assert same(found.features, [MultiPolygon([SQUARE, OTHER])])
    assert found.skipped == 1


@pytest.mark.parametrize("kind", [kind for kind in FORMATS if kind not in ("wkt", "fgb")])
def test_row_without_geometry_is_counted(kind: str, tmp_path: Path) -> None:
    found = read(write(tmp_path / f"a.{kind}", [SQUARE, None], {"key": ["a", "b"]}))
    assert [f.key for f in found.features] == ["a"]
    assert found.skipped == 1


def test_heights_are_dropped(tmp_path: Path) -> None:
    path = write(tmp_path / "a.gpkg", [shapely.force_3d(SQUARE, 5)])
    assert not read(path).features[0].geometry.has_z


@pytest.mark.parametrize("value", ["Feature", "geometry", "collection"])
def test_geojson_may_be_a_feature_or_a_bare_geometry(value: str, tmp_path: Path) -> None:
    geometry = json.loads(shapely.to_geojson(SQUARE))
    feature = {"type": "Feature", "properties": None, "geometry": geometry}
    several = {"type": "GeometryCollection", "geometries": [geometry]}
    wanted = {"Feature": feature, "geometry": geometry, "collection": several}[value]
    (tmp_path / "a.json").write_text(json.dumps(wanted))
    assert same(read(tmp_path / "a.json").features, [SQUARE])


# Layers, archives, encodings


def test_layer_of_a_geopackage(tmp_path: Path) -> None:
    path = write(tmp_path / "a.gpkg", [SQUARE], layer="spring")
    write(path, [OTHER], layer="autumn", append=True)
    assert same(read(path, layer="autumn").features, [OTHER])
    several = ("a.gpkg: the file has several layers: name one with layer:",
               "there are spring, autumn")  # fmt: skip
    assert attempt(path)[1] == [several]
    unknown = ('a.gpkg: there is no layer "winter"', "there are spring, autumn")
    assert attempt(path, layer="winter")[1] == [unknown]


def test_object_of_a_topology(tmp_path: Path) -> None:
    one = as_topology([SQUARE])
    one["objects"]["empty"] = {"type": "GeometryCollection", "geometries": []}
    (tmp_path / "a.json").write_text(json.dumps(one))
    assert same(read(tmp_path / "a.json", layer="held").features, [SQUARE])
    assert attempt(tmp_path / "a.json", layer="hled")[1] == [
        ('a.json: there is no layer "hled"', 'did you mean "held"?')
    ]
    several = "a.json: the file has several layers: name one with layer:"
    assert attempt(tmp_path / "a.json")[1] == [(several, "there are held, empty")]


@pytest.mark.parametrize("kind", ["geojson", "wkt", "parquet"])
def test_layer_of_a_format_without_layers(kind: str, tmp_path: Path) -> None:
    path = write(tmp_path / f"a.{kind}", [SQUARE])
    message = f'"layer": a.{kind} is of a format without layers'
    assert attempt(path, layer="held")[1] == [(message, "leave it out")]


def test_name_of_a_placemark_is_the_name(tmp_path: Path) -> None:
    path = write(tmp_path / "a.kml", [SQUARE])
    named = path.read_text().replace("<Placemark>", "<Placemark><name>Pond</name>")
    path.write_text(named)
    assert read(path).features[0].name == "Pond"
    assert read(path, name="description").features[0].name == ""


def test_number_that_is_none_is_no_key(tmp_path: Path) -> None:
    path = write(tmp_path / "a.parquet", [SQUARE, OTHER], {"key": [float("nan"), 2.0]})
    assert [f.key for f in read(path).features] == [None, "2"]


def test_zip_may_hold_its_shapefile_in_a_folder(tmp_path: Path) -> None:
    flat = write(tmp_path / "a.zip", [SQUARE], {"key": ["é"]})
    with zipfile.ZipFile(flat) as source, zipfile.ZipFile(tmp_path / "b.zip", "w") as target:
        for name in source.namelist():
            target.writestr(f"export/2020/{name}", source.read(name))
    assert [f.key for f in read(tmp_path / "b.zip").features] == ["é"]


def packed(path: Path, *files: Path, folder: str = "") -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in files:
            archive.write(file, folder + file.name)
    return path


def test_zip_of_several_files(tmp_path: Path) -> None:
    first = write(tmp_path / "a.kml", [SQUARE])
    second = write(tmp_path / "b.gpkg", [OTHER])
    hidden = write(tmp_path / "c.fgb", [OTHER])
    path = packed(tmp_path / "d.zip", first, second)
    with zipfile.ZipFile(path, "a") as archive:
        archive.write(hidden, "__MACOSX/c.fgb")
    several = "d.zip: the archive has several files: name one with layer:"
    assert attempt(path)[1] == [(several, "there are a, b")]
    assert same(read(path, layer="a").features, [SQUARE])
    assert same(read(path, layer="b").features, [OTHER])
    assert attempt(path, layer="c")[1] == [
        ('d.zip: there is no one file "c" in the archive', "there are a, b")
    ]


@pytest.mark.parametrize("kind", ["gpkg", "fgb", "kml", "parquet"])
def test_zip_may_hold_other_tables(kind: str, tmp_path: Path) -> None:
    inner = write(tmp_path / f"a.{kind}", [SQUARE])
    assert same(read(packed(tmp_path / "a.zip", inner, folder="x/")).features, [SQUARE])


def test_kmz(tmp_path: Path) -> None:
    inner = write(tmp_path / "doc.kml", [SQUARE])
    assert same(read(packed(tmp_path / "a.kmz", inner)).features, [SQUARE])


def test_gml(tmp_path: Path) -> None:
    options = {"geometry_type": "Polygon", "crs": "EPSG:3857"}
    path = tmp_path / "a.gml"
    binary = shapely.to_wkb([SQUARE, OTHER])
    pyogrio.raw.write(str(path), binary, [], [], **options)
    assert same(read(path).features, [SQUARE, OTHER])


def test_zip_without_polygons_says_so(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        archive.writestr("readme.txt", "nothing here")
    ((message, _),) = attempt(tmp_path / "a.zip")[1]
    assert message.startswith("a.zip: cannot be read: ")
    assert "several layers" not in message


@pytest.mark.parametrize(("encoding", "text"), [("latin-1", "Größe"), ("cp1252", "5 € – Œuvre")])
def test_shapefile_in_another_encoding(encoding: str, text: str, tmp_path: Path) -> None:
    name = {"latin-1": "ISO-8859-1", "cp1252": "CP1252"}[encoding]  # as GDAL calls it
    path = write(tmp_path / "a.shp", [SQUARE], {"key": [text]}, encoding=name)
    assert read(path).features[0].key == text  # its .cpg says which
    path.with_suffix(".cpg").unlink()
    assert read(path, encoding=encoding).features[0].key == text
    path.with_suffix(".cpg").write_text("UTF-8")
    assert attempt(path)[1] != []
    assert read(path, encoding=encoding).features[0].key == text


def test_geojson_in_another_encoding(tmp_path: Path) -> None:
    text = json.dumps(as_collection([SQUARE], {"key": ["Größe"]}), ensure_ascii=False)
    (tmp_path / "a.geojson").write_bytes(text.encode("latin-1"))
    ((message, hint),) = attempt(tmp_path / "a.geojson")[1]
    assert message == "the byte 0xF6 is not UTF-8"
    assert hint.endswith("or name its encoding: {file: …, encoding: latin-1}")
    assert read(tmp_path / "a.geojson", encoding="latin-1").features[0].key == "Größe"


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "UTF8"])
def test_byte_order_mark_is_no_fault_where_utf8_is_named(encoding: str, tmp_path: Path) -> None:
    text = json.dumps(as_collection([SQUARE]))
    (tmp_path / "a.geojson").write_bytes(b"\xef\xbb\xbf" + text.encode())
    assert same(read(tmp_path / "a.geojson", encoding=encoding).features, [SQUARE])


@pytest.mark.parametrize("kind", ["geojson", "wkt"])
@pytest.mark.parametrize("encoding", ["latin-0", "hex", "undefined"])
def test_encoding_that_does_not_exist(kind: str, encoding: str, tmp_path: Path) -> None:
    path = write(tmp_path / f"a.{kind}", [SQUARE])
    assert attempt(path, encoding=encoding)[1] == [
        (f"no encoding {encoding}", "such as utf-8, latin-1, cp1252 or utf-16")
    ]


def test_encoding_of_a_shapefile_that_does_not_exist(tmp_path: Path) -> None:
    path = write(tmp_path / "a.shp", [SQUARE], {"key": ["a"]})
    assert attempt(path, encoding="latin-0")[1] == [
        ("a.shp: no encoding latin-0", "such as utf-8, latin-1, cp1252 or utf-16")
    ]


# Libraries that are missing


@pytest.mark.parametrize("kind", TABLES)
def test_missing_library_is_told_with_how_to_install_it(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write(tmp_path / f"a.{kind}", [SQUARE])
    package, extra = ("pyarrow", "parquet") if kind == "parquet" else ("pyogrio", "geo")
    monkeypatch.setitem(sys.modules, package, None)
    what = "GeoParquet" if kind == "parquet" else f".{kind}"
    assert attempt(path)[1] == [
        (f"a.{kind}: {what} files need the package {package}", f"pip install 'geotween[{extra}]'")
    ]


@pytest.mark.parametrize("kind", TEXTS)
def test_texts_need_no_library(kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for package in ("pyogrio", "pyarrow", "pyproj"):
        monkeypatch.setitem(sys.modules, package, None)
    assert same(read(write(tmp_path / f"a.{kind}", [SQUARE])).features, [SQUARE])


def test_file_whose_content_is_of_another_kind_than_its_name(tmp_path: Path) -> None:
    (tmp_path / "a.gpkg").write_text("<!DOCTYPE html>\n<html></html>\n")
    ((message, hint),) = attempt(tmp_path / "a.gpkg")[1]
    assert message == "a.gpkg: cannot be read: it is no .gpkg file"
    assert hint == UNREADABLE


def test_table_without_geometry(tmp_path: Path) -> None:
    path = tmp_path / "a.gpkg"
    pyogrio.raw.write(
        str(path), None, [shapely.area([SQUARE])], ["area"], geometry_type=None, crs=None
    )
    assert attempt(path)[1] == [("a.gpkg: the file has no geometry", "")]


def _written(path: Path, shapes: list[Any]) -> Path:
    """A file of shapes of any type."""
    if path.suffix == ".geojson":
        members = [json.loads(shapely.to_geojson(shape)) for shape in shapes]
        path.write_text(json.dumps({"type": "FeatureCollection", "features": [
            {"type": "Feature", "properties": {}, "geometry": member} for member in members
        ]}))  # fmt: skip
        return path
    if path.suffix == ".topojson":
        mixed = as_topology([SQUARE, OTHER, FRAME])
        polygons = mixed["objects"]["held"]["geometries"]
        line = {"type": "LineString", "arcs": [0]}
        point = {"type": "Point", "coordinates": [1, 1]}
        collection = {"type": "GeometryCollection", "geometries": [*polygons, point]}
        mixed["objects"]["held"]["geometries"] = [collection, line]
        path.write_text(json.dumps(mixed))
        return path
    return write(path, shapes)
