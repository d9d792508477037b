"""TopoJSON: arcs joined to rings, and what is told where a topology is broken."""

from __future__ import annotations

import copy
import json
from itertools import chain, pairwise
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely.geometry import Polygon, box, shape

from geotween.data.read.topojson import TopologyError, to_geojson
from tests.data.shapes import parsed

Arc = tuple[tuple[float, ...], ...]

# Two squares side by side. Arc 0 is their common side "ABC", upwards; the left square runs along
# it as written, the right one as "CBA".
SQUARES: dict[str, Any] = {
    "type": "Topology",
    "objects": {
        "squares": {
            "type": "GeometryCollection",
            "geometries": [
                {"type": "Polygon", "id": "left", "properties": {"n": 1}, "arcs": [[0, 1]]},
                {"type": "Polygon", "id": 2, "arcs": [[-1, 2]]},
            ],
        }
    },
    "arcs": [
        [[2, 0], [2.5, 1], [2, 2]],
        [[2, 2], [0, 2], [0, 0], [2, 0]],
        [[2, 0], [4, 0], [4, 2], [2, 2]],
    ],
}
LEFT = [[2, 0], [2.5, 1], [2, 2], [0, 2], [0, 0], [2, 0]]
RIGHT = [[2, 2], [2.5, 1], [2, 0], [4, 0], [4, 2], [2, 2]]


def with_object(value: Any, **topology: Any) -> dict[str, Any]:
    return {**SQUARES, "objects": {"it": value}, **topology}


def decoded(value: Any, **topology: Any) -> Any:
    """The geometry of a topology's only object."""
    (feature,) = to_geojson(with_object(value, **topology))["features"]
    return feature["geometry"]


def test_arc_shared_by_two_squares_runs_both_ways() -> None:
    assert to_geojson(SQUARES) == {
        "type": "FeatureCollection",
        "features": [
            {
                "type": "Feature",
                "id": "left",
                "properties": {"n": 1},
                "geometry": {"type": "Polygon", "coordinates": [LEFT]},
            },
            {
                "type": "Feature",
                "id": 2,
                "properties": None,
                "geometry": {"type": "Polygon", "coordinates": [RIGHT]},
            },
        ],
    }
    assert len(parsed(to_geojson(SQUARES))) == 2


def test_quantized_arcs_are_differences_on_a_grid() -> None:
    quantized = {
        **SQUARES,
        "transform": {"scale": [0.5, 2], "translate": [-1, 10]},
        "arcs": [
            [[4, 0], [1, 1], [-1, 1]],
            [[4, 2], [-4, 0], [0, -2], [4, 0]],
            [[4, 0], [4, 0], [0, 2], [-4, 0]],
        ],
    }
    left, right = (f["geometry"]["coordinates"] for f in to_geojson(quantized)["features"])
    assert left == [[[1, 10], [1.5, 12], [1, 14], [-1, 14], [-1, 10], [1, 10]]]
    assert right == [[[1, 14], [1.5, 12], [1, 10], [3, 10], [3, 14], [1, 14]]]


def test_input_is_not_changed() -> None:
    before = copy.deepcopy(SQUARES)
    to_geojson(SQUARES)["features"][0]["geometry"]["coordinates"][0][0][0] = 99
    assert before == SQUARES
    assert to_geojson(SQUARES)["features"][0]["geometry"]["coordinates"] == [LEFT]


def test_multipolygon_and_nested_collection() -> None:
    both = {"type": "MultiPolygon", "arcs": [[[0, 1]], [[~0, 2]]]}
    assert decoded(both) == {"type": "MultiPolygon", "coordinates": [[LEFT], [RIGHT]]}
    inner = {"type": "GeometryCollection", "geometries": [both, {"type": None}]}
    outer = {"type": "GeometryCollection", "geometries": [inner]}
    nested = {"type": "GeometryCollection", "geometries": [decoded(both)]}
    assert decoded(outer) == nested


@pytest.mark.parametrize("quantized", [False, True])
def test_points_and_lines_keep_their_type(quantized: bool) -> None:
    transform = {"scale": [2, 2], "translate": [0, 1]} if quantized else None
    arcs = [[[1, 1], [2, 2]], [[3, 3], [1, 0]]]
    kinds = {
        "Point": ("coordinates", [5, 6, 7]),
        "MultiPoint": ("coordinates", [[5, 6], [7, 8]]),
        "LineString": ("arcs", [0]),
        "MultiLineString": ("arcs", [[0], [~0]]),
    }
    found = [
        decoded({"type": k, m: v}, arcs=arcs, transform=transform) for k, (m, v) in kinds.items()
    ]
    assert [f["type"] for f in found] == list(kinds)
    flat = [shapely.get_coordinates(shape(f)).tolist() for f in found]
    if quantized:
        assert flat[:2] == [[[10, 13]], [[10, 13], [14, 17]]]
        assert flat[2:] == [[[2, 3], [6, 7]], [[2, 3], [6, 7], [6, 7], [2, 3]]]
    else:
        assert flat[:2] == [[[5, 6]], [[5, 6], [7, 8]]]
        assert flat[2:] == [[[1, 1], [2, 2]], [[1, 1], [2, 2], [2, 2], [1, 1]]]


def test_empty_geometries_stay_empty() -> None:
    assert decoded({"type": "MultiPoint", "coordinates": []})["coordinates"] == []
    assert decoded({"type": "LineString", "arcs": []})["coordinates"] == []
    assert decoded({"type": None}) is None


def test_ring_that_quantization_collapsed_is_left_out() -> None:
    arcs = [*SQUARES["arcs"], [[1, 1], [1, 1]], [[1, 1], [1.5, 1], [1, 1], [1, 1]]]
    holed = {"type": "Polygon", "arcs": [[0, 1], [3], [4]]}
    assert decoded(holed, arcs=arcs) == {"type": "Polygon", "coordinates": [LEFT]}
    islands = {"type": "MultiPolygon", "arcs": [[[3]], [[0, 1]]]}
    assert decoded(islands, arcs=arcs) == {"type": "MultiPolygon", "coordinates": [[LEFT]]}
    assert decoded({"type": "Polygon", "arcs": [[4], [0, 1]]}, arcs=arcs) is None


def test_object_is_chosen_by_name() -> None:
    two = {
        **SQUARES,
        "objects": {**SQUARES["objects"], "left": {"type": "Polygon", "arcs": [[0, 1]]}},
    }
    assert to_geojson(two, "squares") == to_geojson(SQUARES)
    (feature,) = to_geojson(two, "left")["features"]
    assert feature["geometry"]["coordinates"] == [LEFT]
    with pytest.raises(TopologyError, match="several layers: name one with layer:") as error:
        to_geojson(two)
    assert (error.value.location, error.value.hint) == (("objects",), "there are squares, left")
    with pytest.raises(TopologyError, match='no layer "square"') as error:
        to_geojson(two, "square")
    assert (error.value.location, error.value.hint) == (("objects",), 'did you mean "squares"?')
    with pytest.raises(TopologyError) as error:
        to_geojson(two, "moon")
    assert error.value.hint == "known here: left, squares"


def polygon(*rings: Any) -> dict[str, Any]:
    return {"objects": {"it": {"type": "Polygon", "arcs": list(rings)}}}


RING = ("objects", "it", "arcs", 0)


@pytest.mark.parametrize(
    ("broken", "location", "message"),
    [
        ({"type": "FeatureCollection"}, ("type",), "Topology"),
        ({"objects": {}}, ("objects",), "objects"),
        ({"objects": {"it": 3}}, ("objects", "it"), "geometry object"),
        ({"objects": {"it": {}}}, ("objects", "it"), "geometry object"),
        ({"objects": {"it": {"type": "Square"}}}, ("objects", "it", "type"), '"Square"'),
        ({"objects": {"it": {"type": "Polygon"}}}, ("objects", "it", "arcs"), "needs a list"),
        ({"objects": {"it": {"type": "Point"}}}, ("objects", "it", "coordinates"), "needs a list"),
        (
            {"objects": {"it": {"type": "MultiPoint", "coordinates": [[1, 2], "a"]}}},
            ("objects", "it", "coordinates", 1),
            "finite",
        ),
        (
            {"objects": {"it": {"type": "GeometryCollection"}}},
            ("objects", "it", "geometries"),
            "geometries",
        ),
        (
            {"objects": {"it": {"type": "GeometryCollection", "geometries": [{"type": 3}]}}},
            ("objects", "it", "geometries", 0, "type"),
            '"3"',
        ),
        (polygon([0, 1], [0, 3]), ("objects", "it", "arcs", 1, 1), "no arc 3"),
        (polygon([0, -4]), (*RING, 1), "no arc 3"),
        (polygon([0, "1"]), (*RING, 1), "'1'"),
        (polygon([0, True]), (*RING, 1), "True"),
        (polygon(0), RING, "expected a list"),
        (polygon([0, 2]), (*RING, 1), "begin where"),
        (polygon([0]), RING, "do not close"),
        ({"arcs": None}, ("arcs",), "arcs"),
        ({"arcs": [[[0, 0], [1, 1]], [[0, 0]]]}, ("arcs", 1), "two positions"),
        ({"arcs": [[[0, 0], [1]]]}, ("arcs", 0), "finite"),
        ({"arcs": [[[0, 0], ["1", "1"]]]}, ("arcs", 0), "finite"),
        ({"arcs": [[[0, 0], [1, float("nan")]]]}, ("arcs", 0), "finite"),
        ({"arcs": [7]}, ("arcs", 0), "finite"),
        ({"arcs": [{"a": 1}]}, ("arcs", 0), "finite"),
        ({"transform": {"scale": [1, 1]}}, ("transform", "translate"), "translate"),
        ({"transform": {"scale": [1], "translate": [0, 0]}}, ("transform", "scale"), "scale"),
        ({"transform": {"scale": ["a", 1]}}, ("transform", "scale"), "finite"),
        ({"transform": 3}, ("transform", "scale"), "scale"),
        ({"transform": {"scale": [1e308, 1], "translate": [0, 0]}}, ("arcs", 0), "finite"),
    ],
)
def test_fault_is_told_at_its_place(broken: Any, location: Any, message: str) -> None:
    with pytest.raises(TopologyError, match=message) as error:
        to_geojson({**SQUARES, **broken})
    assert error.value.location == location


@pytest.mark.parametrize("value", [None, [], "Topology"])
def test_what_is_no_object_is_no_topology(value: Any) -> None:
    with pytest.raises(TopologyError):
        to_geojson(value)


@st.composite
def mosaics(draw: st.DrawFn) -> list[Polygon]:
    """A tiling: random unions of a grid's cells, with a vertex at each of the grid's points."""
    size = draw(st.integers(1, 5))
    owners = np.array(draw(st.lists(st.integers(0, 3), min_size=size**2, max_size=size**2)))
    cells = np.array([box(x, y, x + 1, y + 1) for x in range(size) for y in range(size)])
    regions = [shapely.coverage_union_all(cells[owners == owner]) for owner in np.unique(owners)]
    return list(shapely.get_parts(regions))


def arcs_of(polygons: list[Polygon]) -> tuple[list[Arc], list[list[list[int]]]]:
    """The borders between nodes, each once, and every polygon's rings by their numbers."""
    rings = [[r.coords[:-1] for r in (p.exterior, *p.interiors)] for p in polygons]
    beside: dict[Any, set[Any]] = {}
    for ring in chain(*rings):
        for before, here, after in zip(
            ring[-1:] + ring[:-1], ring, ring[1:] + ring[:1], strict=True
        ):
            beside.setdefault(here, set()).update((before, after))
    numbers: dict[Arc, int] = {}

    def number(arc: Arc) -> int:
        if arc[::-1] in numbers:
            return ~numbers[arc[::-1]]
        return numbers.setdefault(arc, len(numbers))

    def cut(ring: list[Any]) -> list[int]:
        nodes = [i for i, point in enumerate(ring) if len(beside[point]) > 2]
        first = nodes[0] if nodes else ring.index(min(ring))  # a hole and the island in it agree
        closed = ring[first:] + ring[: first + 1]
        ends = [i for i, point in enumerate(closed) if len(beside[point]) > 2 or i == 0]
        ends = sorted({*ends, len(closed) - 1})
        return [number(tuple(closed[a : b + 1])) for a, b in pairwise(ends)]

    found = [[cut(ring) for ring in polygon] for polygon in rings]
    return list(numbers), found


@given(mosaics(), st.sampled_from([None, 1.0, 0.1, 1e-9, 1e9]))
def test_mosaic_comes_back_from_its_arcs(tiles: list[Polygon], grid: float | None) -> None:
    arcs, rings = arcs_of(tiles)
    topology: dict[str, Any] = {
        "type": "Topology",
        "arcs": arcs,
        "objects": {"tiles": {"type": "GeometryCollection", "geometries": [
            {"type": "Polygon", "arcs": numbers} for numbers in rings
        ]}},
    }  # fmt: skip
    expected = np.array(tiles)
    if grid is not None:
        topology["transform"] = {"scale": [grid, grid * 2], "translate": [-7, 3]}
        topology["arcs"] = [np.diff(arc, axis=0, prepend=[(0, 0)]).tolist() for arc in arcs]
        expected = shapely.transform(tiles, lambda xy: xy * [grid, grid * 2] + [-7, 3])
    features = to_geojson(json.loads(json.dumps(topology)))["features"]
    found = np.array([shape(feature["geometry"]) for feature in features])
    assert shapely.equals_exact(found, expected, 0, normalize=True).all()
