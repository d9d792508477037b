from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely.geometry import MultiPolygon, Polygon, box

from geotween.data.globe.longitudes import (
    Parts,
    cut_at,
    joined,
    on_grid,
    parts_of,
    turned,
    unwrapped,
    widest_gap,
    with_equal_sides,
)


def parts(*geometries: Polygon | MultiPolygon) -> Parts:
    return parts_of(np.array(geometries, dtype=object))


def only(found: Parts) -> Polygon:
    (polygon,) = found.polygons
    return polygon


ACROSS = Polygon([(170.1, 60.3), (-170.1, 60.3), (-170.1, 70.7), (170.1, 70.7)])


def test_what_does_not_jump_stays_as_it_is():
    square = box(-10, 0, 10.1, 20)
    found, count = unwrapped(parts(square))
    assert only(found).equals_exact(square)
    assert count == 0


@pytest.mark.parametrize("turn", [-360, 0, 360])
def test_a_box_across_the_antimeridian_is_as_wide_as_it_was_drawn(turn):
    found, count = unwrapped(parts(shapely.transform(ACROSS, lambda xy: np.add(xy, (turn, 0)))))
    west, _, east, _ = only(found).bounds
    assert count == 1
    assert east - west == pytest.approx(19.8)
    assert only(found).is_valid


def test_a_crossing_at_doubled_points_is_no_band_around_the_globe():
    ring = [(175, 0), (180, 1), (-180, 1), (-175, 0), (-175, 9), (-180, 8), (180, 8), (175, 9)]
    found, _ = unwrapped(parts(Polygon(ring)))
    assert (
        only(found)
        .normalize()
        .equals(Polygon([(175, 0), (180, 1), (185, 0), (185, 9), (180, 8), (175, 9)]))
    )


def test_a_band_around_the_globe_stays_one():
    band = box(-180, -10, 180, 10)
    assert only(unwrapped(parts(band))[0]).equals_exact(band)


def test_a_hole_in_another_turn_is_a_hole_of_its_shell():
    hole = [(-176, 63), (-172, 63), (-172, 66), (-176, 66)]
    polygon = Polygon(ACROSS.exterior, [hole])
    found, _ = unwrapped(parts(polygon))
    assert only(found).area == pytest.approx(19.8 * 10.4 - 12)
    assert len(only(found).interiors) == 1


CAP = [(x, 70 + 5 * np.cos(np.radians(3 * x))) for x in range(-175, 180, 10)]


@pytest.mark.parametrize("north", [1, -1])
@pytest.mark.parametrize("turn", [slice(None), slice(None, None, -1)])
def test_a_ring_around_a_pole_encloses_that_pole_whichever_way_it_runs(north, turn):
    found, _ = unwrapped(parts(Polygon([(x, north * y) for x, y in CAP][turn])))
    cap = only(found)
    assert cap.is_valid
    assert cap.bounds[2] - cap.bounds[0] == 360
    assert cap.area == pytest.approx(360 * 20, rel=1e-3)
    assert (90 * north) in cap.bounds


def test_a_ring_of_land_around_a_pole_has_the_sea_as_its_hole():
    land = Polygon([(x, 60) for x in range(-180, 180, 10)], [[(x, 80) for x in range(5, 365, 10)]])
    found, _ = unwrapped(parts(land))
    assert shapely.area(found.polygons).sum() == pytest.approx(360 * 20)


@pytest.mark.parametrize("east", [180, 360])
def test_two_halves_that_data_cut_become_one(east):
    halves = MultiPolygon([box(east - 20, 50, east, 60), box(east - 360, 52, east - 350, 58)])
    whole = only(joined(parts(halves), cut=0.0 if east == 180 else 180.0))
    assert whole.equals(box(east - 20, 50, east, 60).union(box(east, 52, east + 10, 58)))


def test_halves_of_two_features_stay_two():
    found = joined(parts(box(160, 50, 180, 60), box(-180, 50, -170, 60)), cut=0.0)
    assert found.owners.tolist() == [0, 1]


def test_halves_that_lie_where_the_map_is_cut_stay_two():
    halves = MultiPolygon([box(160, 50, 180, 60), box(-180, 52, -170, 58)])
    assert len(joined(parts(halves), cut=180.0).polygons) == 2


def test_a_cut_divides_what_lies_across_it_and_keeps_the_rest_as_it_is():
    across, apart = box(20, 0, 40, 10), box(-50.1, 0, -40.1, 10)
    found = cut_at(parts(across, apart), 30.0)
    assert found.owners.tolist() == [0, 0, 1]
    assert found.polygons[2].equals_exact(apart)
    assert shapely.total_bounds(found.polygons)[::2].tolist() == [-330, 30]
    assert shapely.area(found.polygons).tolist() == pytest.approx([100, 100, 100])


def test_a_polar_cap_is_one_piece_wherever_it_is_cut():
    cap, _ = unwrapped(parts(Polygon(CAP)))
    for cut in (-180.0, -3.0, 0.0, 77.7, 180.0):
        piece = only(cut_at(cap, cut))
        assert piece.area == pytest.approx(only(cap).area)
        assert piece.bounds[2] - piece.bounds[0] == 360


def test_points_on_one_side_only_of_a_polar_seam_are_gone():
    ring = [(-180, -70), (0, -60), (180, -70), (180, -80), (180, -90), (-180, -90)]
    found = only(with_equal_sides(parts(Polygon(ring))))
    points = shapely.get_coordinates(found)
    west, _, east, _ = found.bounds
    assert east - west == 360
    assert found.area == pytest.approx(Polygon(ring).area)
    assert set(points[points[:, 0] == west, 1]) == set(points[points[:, 0] == east, 1])


@pytest.mark.parametrize(
    ("boxes", "middle", "width"),
    [
        ([box(-10, 0, 30, 1)], -170, 320),
        ([box(-120, 0, -60, 1), box(170, 0, 180, 1)], 55, 230),
        ([box(170, 0, 190, 1)], 0, 340),
        ([box(-180, 0, 180, 1)], None, 0),
        ([box(0, 0, 200, 1), box(-180, 0, -10, 1)], -5, 10),
        ([box(-100, 0, -80, 1), box(80, 0, 100, 1)], -180, 160),
        ([], -180, 360),
    ],
)
def test_the_widest_gap_of_longitudes(boxes, middle, width):
    found = widest_gap(parts(*boxes))
    assert found[1] == width
    if middle is not None:
        assert found[0] == middle


@given(st.lists(st.tuples(st.integers(-180, 179), st.integers(1, 90)), min_size=1, max_size=6))
def test_nothing_lies_in_the_widest_gap_and_no_longer_one_is_free(spans):
    covered = np.zeros(720, dtype=bool)  # half degrees
    for west, width in spans:
        covered[np.arange(2 * west, 2 * (west + width)) % 720] = True
    middle, room = widest_gap(parts(*(box(w, 0, w + d, 1) for w, d in spans)))
    free = np.arange(round(2 * (middle - room / 2)), round(2 * (middle + room / 2))) % 720
    assert not covered[free].any()
    runs = "".join("x" if c else " " for c in np.tile(covered, 2)).split("x")
    longest = max(map(len, runs)) if covered.any() else 720
    assert len(free) == longest


@given(st.floats(-180, 180), st.sampled_from([-720, -360, 360, 720]))
def test_whole_turns_on_the_grid_are_exact(longitude, turns):
    here = on_grid(np.array([longitude]))
    assert (on_grid(here + turns) - turns == here).all()
    assert abs(here[0] - longitude) <= 1e-9


def test_polygons_turned_there_and_back_are_the_same():
    there = turned(np.array([ACROSS]), np.array([1.0]))
    back = turned(there, np.array([-1.0]))
    assert np.abs(shapely.get_coordinates(back) - shapely.get_coordinates(ACROSS)).max() < 1e-12


@pytest.mark.parametrize("ring", [ACROSS, Polygon(CAP)], ids=["across", "around the pole"])
def test_the_same_as_the_library_antimeridian_finds(ring):
    library = pytest.importorskip("antimeridian")
    theirs = library.fix_polygon(ring, great_circle=False, fix_winding=ring is ACROSS)
    ours = shapely.union_all(cut_at(unwrapped(parts(ring))[0], 180.0).polygons)
    assert ours.symmetric_difference(theirs).area < 1e-5 * ours.area
