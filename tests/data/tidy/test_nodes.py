"""Nodes: corners that lie on a neighbour's edge, and what must stay as it was."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely.affinity import affine_transform, rotate
from shapely.geometry import MultiPolygon, Polygon, box

from geotween.data.load import load
from geotween.data.tidy.linework import Shapes
from geotween.data.tidy.nodes import noded, tolerance
from tests.conftest import WriteScene
from tests.data.tidy.test_linework import a_set

LONG = box(0, 0, 9, 4)
ABOVE = [box(0, 4, 3, 8), box(3, 4, 5, 8), box(5, 4, 9, 8)]


def corners(shape: object) -> set[tuple[float, float]]:
    return {(x, y) for x, y in shapely.get_coordinates(shape).tolist()}


def turned(shapes: Shapes, angle: float) -> Shapes:
    return a_set(*(rotate(shape, angle, (0, 0)) for shape in shapes))


def test_long_edge_gets_the_corners_of_those_beside_it() -> None:
    long, *above = noded(a_set(LONG, *ABOVE))
    assert long.equals(LONG)
    assert corners(long) - corners(LONG) == {(3, 4), (5, 4)}
    assert all(new is old for new, old in zip(above, ABOVE, strict=True))


@pytest.mark.parametrize("angle", range(0, 360, 23))
def test_corners_that_are_off_by_rounding_are_the_same_bits_on_both_sides(angle: float) -> None:
    shapes = noded(turned(a_set(LONG, *ABOVE), angle))
    assert shapely.coverage_is_valid(shapes)
    assert len(corners(shapes[0]) & corners(shapes[2])) == 2


def test_two_long_edges_that_overlap_get_each_others_ends() -> None:
    one, other = noded(a_set(LONG, box(4, 4, 14, 8)))
    assert (4, 4) in corners(one)
    assert (9, 4) in corners(other)


def test_hole_gets_the_corners_of_what_lies_in_it() -> None:
    lake = box(0, 0, 9, 9) - box(2, 2, 6, 6)
    shapes = noded(a_set(lake, box(2, 2, 4, 6), box(4, 2, 6, 6)))
    assert shapely.coverage_is_valid(shapes)


def test_parts_stay_parts() -> None:
    far = MultiPolygon([LONG, box(20, 0, 21, 1)])
    found = noded(a_set(far, *ABOVE))[0]
    assert found.geom_type == "MultiPolygon"
    assert corners(found) - corners(far) == {(3, 4), (5, 4)}


def test_a_corner_that_is_off_by_more_than_rounding_stays_off() -> None:
    shapes = a_set(LONG, box(3, 4 + 1e-7 / 3, 5, 8))
    assert all(new is old for new, old in zip(noded(shapes), shapes, strict=True))


def test_a_corner_that_was_rounded_to_decimals_lies_on_the_edge() -> None:
    slope = Polygon([(0, 0), (9, 0), (9, 7.31264)])
    corner = (3.33333, 2.70838)  # on the slope it would be 2.708382…
    above = Polygon([(0, 0), corner, (0, 8)])
    shapes = a_set(slope, above, Polygon([corner, (9, 7.31264), (0, 8)]))
    assert corner in corners(noded(shapes)[0])
    assert shapely.coverage_is_valid(noded(shapes))


@pytest.mark.parametrize(
    ("points", "expected"),
    [
        ([[0, 0], [40, 40]], 40e-5),
        ([[0.25, 0], [40, 40]], 40e-5),
        ([[0.12345, 0], [40, 40]], 2**0.5 * 1e-5),
        ([[0.1234567, 0], [40, 40]], 2**0.5 * 1e-7),
        ([[1 / 3, 0], [40, 40]], (40 - 1e-9) * 1e-9),
    ],
    ids=["whole", "hundredths of much", "5 decimals", "7 decimals", "as computed"],
)
def test_tolerance_is_what_rounding_left(points: list[list[float]], expected: float) -> None:
    assert tolerance(np.array(points)) == pytest.approx(expected, rel=0.01)


def test_an_edge_around_the_globe_gets_nothing() -> None:
    fiji = Polygon([(179, 0), (-179, 0), (-179, 1), (179, 1)])
    shapes = a_set(fiji, box(0, 0, 9, 9))
    assert noded(shapes, longest=180)[0] is fiji


def test_a_spike_with_a_corner_on_it_goes() -> None:
    foot = (19.182690148251982, 47.84967883934739)
    on = (19.153711046896284, 48.011394045833434)
    tip = (19.112923489815937, 48.239005252072985)
    spiked, beside = Polygon([foot, tip, on, (25, 47)]), Polygon([foot, on, tip, (15, 48)])
    assert spiked.is_valid
    found = noded(a_set(MultiPolygon([spiked]), beside))
    assert corners(found[0]) == {foot, on, (25, 47)}
    assert found[0].geom_type == "MultiPolygon"
    assert shapely.is_valid(found).all()
    assert shapely.coverage_is_valid(found)


@pytest.mark.parametrize("shapes", [[], [LONG], [Polygon(), Polygon()], [LONG, Polygon()]])
def test_nothing_to_node(shapes: list[Polygon]) -> None:
    found = noded(a_set(*shapes))
    assert all(new is old for new, old in zip(found, shapes, strict=True))


@st.composite
def tilings(draw: st.DrawFn) -> Shapes:
    """A box cut again and again in two, each cut ending on edges of others, then turned."""
    tiles = [(0.0, 0.0, 1.0, 1.0)]
    for share, upright in draw(st.lists(st.tuples(st.floats(0.2, 0.8), st.booleans()), max_size=9)):
        west, south, east, north = tiles.pop(0)
        x, y = west + share * (east - west), south + share * (north - south)
        if upright:
            tiles += [(west, south, x, north), (x, south, east, north)]
        else:
            tiles += [(west, south, east, y), (west, y, east, north)]
    return turned(a_set(*(box(*tile) for tile in tiles)), draw(st.floats(0, 90)))


@given(tilings())
def test_any_tiling_fits_edge_by_edge(tiles: Shapes) -> None:
    found = noded(tiles)
    assert shapely.is_valid(found).all()
    assert shapely.coverage_is_valid(found)
    assert shapely.area(found) == pytest.approx(shapely.area(tiles), rel=1e-6)
    for new, old in zip(found, tiles, strict=True):
        assert corners(old) <= corners(new)
        assert (new is old) == (corners(old) == corners(new))


@given(tilings())
def test_what_is_noded_stays(tiles: Shapes) -> None:
    once = noded(tiles)
    assert all(new is old for new, old in zip(noded(once), once, strict=True))


@given(
    tilings(),
    st.sampled_from([(0, -1, 1, 0), (-1, 0, 0, 1), (2.0**30, 0, 0, 2.0**30)]),
    st.randoms(use_true_random=False),
)
def test_order_direction_and_size_do_not_matter(
    tiles: Shapes, way: tuple[float, ...], random: st.randoms
) -> None:
    order = list(range(len(tiles)))
    random.shuffle(order)
    moved = a_set(*(shapely.reverse(affine_transform(tiles[i], [*way, 0, 0])) for i in order))
    there = [affine_transform(shape, [*way, 0, 0]) for shape in noded(tiles)]
    for found, i in zip(noded(moved), order, strict=True):
        assert corners(found) == corners(there[i])


def test_a_tiling_on_the_globe_stays_one_on_the_map(write_scene: WriteScene) -> None:
    # The corner at 1/3 of the slope is on it but for rounding; projected, the slope bends.
    x, y = 10 + 20 / 3, 40 + 7 / 3
    south = "[[10, 40], [30, 47], [30, 35]]"
    west, east = f"[[10, 40], [{x}, {y}], [12, 55]]", f"[[{x}, {y}], [30, 47], [12, 55]]"
    step = "polygons: [" + ", ".join(f"{{polygon: {ring}}}" for ring in (south, west, east)) + "]"
    path = write_scene(f"title: t\nmap: {{crs: EPSG:4326}}\nsteps: [{step}, {step}]\n")
    scene = load(path)
    assert scene.problems == ()
    assert [len(found.regions) for found in scene] == [3, 3]
    assert all(shapely.coverage_is_valid(found.regions.polygons) for found in scene)
