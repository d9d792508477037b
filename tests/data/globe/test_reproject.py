from __future__ import annotations

import json

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from pyproj import Geod
from shapely.geometry import MultiPolygon, Polygon, box, shape

from geotween.data.globe.longitudes import TURN
from geotween.data.globe.projection import fitting, named, read_crs
from geotween.data.globe.reproject import project, reproject
from geotween.data.problems import Problem
from tests.real_data import files, needs_real_data

WGS84 = read_crs("EPSG:4326")
EUROPE = read_crs("EPSG:3035")
ARCTIC = read_crs("EPSG:3413")
GLOBE = Geod(ellps="WGS84")


def array(*geometries: Polygon | MultiPolygon):
    return np.array(geometries, dtype=object)


def onto(text: str, *geometries: Polygon | MultiPolygon, crs=WGS84):
    """Geometries on the map that ``text`` names, or that suits them (``auto``), and problems."""
    together = array(*geometries)
    chosen = fitting(together, crs) if text == "auto" else named(text, together, crs)
    return project(together, crs, chosen)


def drawn(text: str, geometry: Polygon | MultiPolygon, crs=WGS84):
    (found,), _ = onto(text, geometry, crs=crs)
    assert found.is_valid
    return found


def true_area(geometry: Polygon | MultiPolygon) -> float:
    """In m²; edges straight in longitude and latitude."""
    fine = shapely.segmentize(shapely.orient_polygons(geometry), 0.1)
    return sum(abs(GLOBE.geometry_area_perimeter(part)[0]) for part in shapely.get_parts(fine))


def longest_edge(geometry: Polygon | MultiPolygon) -> float:
    points, ring = shapely.get_coordinates(
        shapely.get_rings(shapely.get_parts(geometry)), return_index=True
    )
    lengths = np.hypot(*np.diff(points, axis=0).T)
    return lengths[np.diff(ring) == 0].max()


def turn(geometry, degrees: float):
    return shapely.transform(geometry, lambda xy: np.add(xy, (degrees, 0)))


def mirror(geometry):
    return shapely.transform(geometry, lambda xy: xy * (-1, 1))


WEST = [(28, 60), (30, 70), (60, 69), (100, 77), (140, 72), (180, 69)]
EAST = [(180, 65), (163, 60), (156, 51), (140, 54), (130, 43), (90, 50), (50, 45)]
CHUKOTKA = [(180, 69), (190.3, 66.1), (180, 65)]
RUSSIA = {
    "cut in two": MultiPolygon(
        [Polygon(WEST + EAST), Polygon([(x - TURN, y) for x, y in CHUKOTKA])]
    ),
    "with a jump": Polygon([*WEST[:-1], (180, 69), (-169.7, 66.1), *EAST]),
    "beyond 180": Polygon([*WEST, CHUKOTKA[1], *EAST]),
}


@pytest.mark.parametrize("text", ["auto", "EPSG:3576", "+proj=eqearth +lon_0=100"])
def test_russia_is_one_piece_however_it_is_written(text):
    found = [drawn(text, russia) for russia in RUSSIA.values()]
    for russia in found:
        assert isinstance(russia, Polygon)
        assert russia.area == pytest.approx(found[0].area, rel=1e-9)
        assert russia.symmetric_difference(found[0]).area < 1e-9 * found[0].area
    west, south, east, north = found[0].bounds
    assert 5e6 < max(east - west, north - south) < 12e6
    assert longest_edge(found[0]) < 4e6


def test_russia_is_cut_where_the_map_is():
    for russia in RUSSIA.values():
        found = drawn("+proj=eqearth", russia)
        assert len(found.geoms) == 2
        assert longest_edge(found) < 4e6


def test_fiji_on_its_own_map_is_a_few_hundred_kilometres_wide():
    fiji = MultiPolygon([box(177, -18.3, 178.7, -17.3), box(178.5, -17, 180, -16.1)])
    rest = box(-180, -17, -179.8, -16.1)
    found = drawn("auto", MultiPolygon([*fiji.geoms, rest]))
    assert len(found.geoms) == 2
    assert found.bounds[2] - found.bounds[0] == pytest.approx(340e3, rel=0.05)


def test_the_aleutians_lie_west_of_alaska():
    aleutians = MultiPolygon([box(172.5, 52, 180, 53), box(-180, 51, -165, 54)])
    conus = box(-125, 25, -67, 49)
    (islands, states), problems = onto("auto", aleutians, conus)
    assert problems == []
    assert isinstance(islands, Polygon)
    assert islands.bounds[2] < states.bounds[0] + 1e6
    assert shapely.total_bounds(array(islands, states))[2] < 6e6


CAP = Polygon([(x, 66.5) for x in range(-180, 180, 5)])


@pytest.mark.parametrize("cap", [CAP, CAP.reverse(), turn(CAP, 180)])
def test_the_arctic_is_a_disk_on_a_polar_map(cap):
    found = drawn("auto", cap)
    assert isinstance(found, Polygon)
    assert found.area == pytest.approx(true_area(box(-180, 66.5, 180, 90)), rel=2e-3)
    assert shapely.minimum_bounding_circle(found).area == pytest.approx(found.area, rel=1e-2)
    assert found.contains(shapely.Point(0, 0))


def test_the_arctic_is_a_strip_on_a_map_of_the_world():
    found = drawn("+proj=eqearth +lon_0=33", CAP)
    assert isinstance(found, Polygon)
    assert found.area == pytest.approx(drawn("auto", CAP).area, rel=1e-4)


COAST = [(x, -70 + 5 * np.sin(np.radians(2 * x))) for x in range(-180, 181, 5)]
ANTARCTICA = {
    "to the pole and back": Polygon([*COAST, (180, -90), (-180, -90)]),
    "missing 180 by rounding": Polygon(
        [(-179.99999999999994, COAST[0][1]), *COAST[1:], (180, -90), (-179.99999999999994, -90)]
    ),
    "to the pole in many steps": Polygon(
        [*COAST, (180, -80), (180, -90), (60, -90), (-70, -90), (-180, -90), (-180, -75.3)]
    ),
    "around the pole": Polygon(COAST[:-1]),
}


@pytest.mark.parametrize("name", ANTARCTICA)
@pytest.mark.parametrize("text", ["auto", "EPSG:3031", "+proj=laea +lat_0=-60 +lon_0=40"])
def test_antarctica_has_no_spike_on_a_map_around_the_pole(text, name):
    found = drawn(text, ANTARCTICA[name])
    usual = drawn(text, ANTARCTICA["around the pole"])
    assert isinstance(found, Polygon)
    assert len(found.interiors) == 0
    assert found.symmetric_difference(usual).area < 1e-6 * usual.area
    (pole,), _ = onto(text, Polygon([(x, -89.9) for x in range(0, 360, 5)]))
    assert found.contains(pole)
    assert found.exterior.distance(pole) > 1e6


@pytest.mark.parametrize("name", ANTARCTICA)
@pytest.mark.parametrize("lon_0", [0, 30, -101.5])
def test_antarctica_is_a_strip_on_a_map_of_the_world(lon_0, name):
    found = drawn(f"+proj=eqearth +lon_0={lon_0}", ANTARCTICA[name])
    assert isinstance(found, Polygon)
    area = drawn("auto", ANTARCTICA["around the pole"]).area
    assert found.area == pytest.approx(area, rel=1e-4)


AREAS = [
    box(-125, 24, -67, 49), box(-17, -35, 51, 37), box(-179, -60, -1, 75), box(95, -11, 141, 6),
    CAP, ANTARCTICA["around the pole"], RUSSIA["with a jump"], box(7.1, 46, 7.3, 46.1),
    box(-70, -55, -66, -20), Polygon([(0, 40), (20, 40), (10, 55)], [[(8, 45), (12, 45), (9, 48)]]),
]  # fmt: skip


@pytest.mark.parametrize("area", AREAS)
def test_chosen_projections_keep_areas(area):
    truth = true_area(box(-180, 66.5, 180, 90)) if area is CAP else true_area(area)
    if area is ANTARCTICA["around the pole"]:
        truth = true_area(ANTARCTICA["to the pole and back"])
    if area is RUSSIA["with a jump"]:
        truth = true_area(RUSSIA["beyond 180"])
    assert drawn("auto", area).area == pytest.approx(truth, rel=1e-3)


def test_the_border_along_a_parallel_bends_and_the_one_along_a_meridian_does_not():
    found = drawn("+proj=aea +lat_1=29.5 +lat_2=45.5 +lon_0=-96", box(-123, 30, -96, 49))
    points = shapely.get_coordinates(found)
    middle = points[np.isclose(points[:, 0], 0, atol=1)]
    assert len(np.unique(middle, axis=0)) == 2
    assert len(points) > 20
    chord = shapely.LineString([found.exterior.coords[0], found.exterior.coords[-2]])
    assert chord.hausdorff_distance(found.exterior) > 1e5


def test_mercator_ends_before_the_pole_and_says_so():
    found, problems = onto("EPSG:3857", box(-10, 60, 10, 90), box(0, 0, 10, 10))
    assert found[0].bounds[3] == pytest.approx(20_048_966, rel=1e-3)
    (problem,) = problems
    assert (problem.kind, problem.severity) == ("beyond projection", "warning")
    beyond = (1 - np.sin(np.radians(85.06))) * 20
    all_of_it = (1 - np.sin(np.radians(60))) * 20 + np.sin(np.radians(10)) * 10
    assert problem.measure == pytest.approx(beyond / all_of_it)
    assert "85.06°" in str(problem)


def test_what_lies_wholly_beyond_mercator_is_empty():
    found, problems = onto("EPSG:3857", box(0, 86, 10, 88), box(0, 0, 10, 10))
    assert found[0].is_empty
    assert not found[1].is_empty
    assert [p.kind for p in problems] == ["beyond projection"]


@pytest.mark.parametrize(
    ("text", "away"),
    [
        ("+proj=ortho +lat_0=40", box(170, -40, 175, -30)),
        ("EPSG:3413", ANTARCTICA["around the pole"]),
        ("EPSG:3413", ANTARCTICA["to the pole and back"]),
        ("EPSG:2154", ANTARCTICA["to the pole and back"]),
    ],
)
def test_what_a_projection_cannot_show_is_left_out_and_counted(text, away):
    near = box(0, 45, 10, 55)
    found, problems = onto(text, away, near, MultiPolygon([away, near]))
    assert found[0].is_empty
    assert found[1].equals(found[2])
    (problem,) = [p for p in problems if p.severity != "note"]
    assert (problem.kind, problem.severity, problem.measure) == ("beyond projection", "error", 2)


def test_jumps_are_noted():
    _, problems = onto("auto", RUSSIA["with a jump"], box(20, 50, 25, 55))
    assert [(p.kind, p.severity, p.measure) for p in problems] == [("antimeridian", "note", 1)]
    assert all(isinstance(p, Problem) for p in problems)


def states_like(rows: int, columns: int, seed: int, west: float = -120):
    """A tiling of the mid-latitudes by quadrilaterals that share their corners."""
    rng = np.random.default_rng(seed)
    x, y = np.meshgrid(west + 8.0 * np.arange(columns + 1), 25 + 7.0 * np.arange(rows + 1))
    x += rng.uniform(-2, 2, x.shape)
    y += rng.uniform(-2, 2, y.shape)
    corner = np.stack([x, y], axis=-1)
    around = [corner[:-1, :-1], corner[:-1, 1:], corner[1:, 1:], corner[1:, :-1]]
    return shapely.polygons(np.stack(around, axis=2).reshape(-1, 4, 2))


@pytest.mark.parametrize("text", ["auto", "EPSG:3857", "EPSG:5070", "+proj=laea +lat_0=90"])
@pytest.mark.parametrize("west", [-120, 150], ids=["inland", "across 180"])
@pytest.mark.parametrize("seed", range(3))
def test_a_tiling_stays_one(text, west, seed):
    tiles = states_like(4, 6, seed, west)
    short = shapely.transform(
        tiles, lambda xy: np.column_stack([(xy[:, 0] + 180) % 360 - 180, xy[:, 1]])
    )
    found, _ = onto(text, *short)
    assert shapely.coverage_is_valid(found)
    assert shapely.is_valid(found).all()
    whole = shapely.union_all(found)
    parts = 2 if west == 150 and text == "EPSG:3857" else 1
    assert shapely.get_num_geometries(whole) == parts
    assert all(len(part.interiors) == 0 for part in shapely.get_parts(whole))


@needs_real_data
@pytest.mark.parametrize("name", ["us_regions", "scale_us_counties"])
@pytest.mark.parametrize("text", ["auto", "EPSG:5070", "EPSG:3857", "+proj=eqearth +lon_0=100"])
def test_states_still_share_their_borders(name, text):
    features = json.loads(files(name)[-1].read_text(encoding="utf-8"))["features"]
    states = array(*(shape(feature["geometry"]) for feature in features))
    assert shapely.coverage_is_valid(states)
    found, problems = onto(text, *states)
    assert problems == []
    assert shapely.coverage_is_valid(found)
    assert shapely.is_valid(found).all()


def test_holes_are_kept():
    frame = box(-10, 40, 10, 60).difference(box(-5, 45, 5, 55))
    assert len(drawn("auto", frame).interiors) == 1


def test_polygons_in_another_order_give_the_same_in_that_order():
    tiles = states_like(3, 4, 1)
    order = np.random.default_rng(2).permutation(len(tiles))
    here, there = onto("auto", *tiles)[0], onto("auto", *tiles[order])[0]
    assert shapely.equals_exact(here[order], there).all()


@pytest.mark.parametrize("text", ["auto", "EPSG:3857", "+proj=eqearth"])
@pytest.mark.parametrize("name", ["tiles", *RUSSIA])
def test_a_mirrored_globe_gives_a_mirrored_map(text, name):
    given_shapes = states_like(3, 4, 1) if name == "tiles" else array(RUSSIA[name])
    here, there = onto(text, *given_shapes)[0], onto(text, *mirror(given_shapes))[0]
    apart = shapely.area(shapely.symmetric_difference(here, mirror(there)))
    assert (apart < 1e-9 * shapely.area(here)).all()


@given(st.integers(-360, 360), st.integers(0, 5))
@settings(max_examples=30, deadline=None)
def test_where_on_the_globe_data_lie_does_not_matter(degrees, seed):
    tiles = states_like(2, 3, seed)
    here, there = onto("auto", *tiles)[0], onto("auto", *turn(tiles, degrees))[0]
    first, second = shapely.get_coordinates(here), shapely.get_coordinates(there)
    assert first.shape == second.shape
    assert np.abs(first - second).max() < 1e-9 * np.abs(first).max()


def test_the_same_system_changes_nothing():
    plan = array(box(4e6, 3e6, 4.1e6, 3.1e6))
    found, problems = project(plan, EUROPE, named("EPSG:3035", plan, EUROPE))
    assert found is plan
    assert problems == []
    assert reproject(plan, EUROPE, EUROPE) is plan


def test_there_and_back_again_is_where_it_was():
    plan = box(4e6, 3e6, 4.4e6, 3.3e6)
    (globe,) = reproject(array(plan), EUROPE, WGS84)
    (back,) = reproject(array(globe), WGS84, EUROPE)
    assert back.symmetric_difference(plan).area < 1e-4 * plan.area
    assert globe.exterior.distance(shapely.Point(globe.exterior.coords[0])) < 1e-9
    assert 5 < shapely.get_num_coordinates(globe) < 200


def test_between_two_datums_a_whole_turn_stays_one():
    band = box(-180, -10, 180, 10)
    (found,) = reproject(array(band), WGS84, read_crs("+proj=longlat +ellps=bessel"))
    assert found.bounds[::2] == (-180, 180)


def test_sea_ice_around_the_pole_goes_from_its_plane_to_any_map():
    ice = shapely.Point(1e5, -2e5).buffer(2e6).difference(box(-3e5, -3e5, 3e5, 3e5))
    whole = drawn("EPSG:3575", ice, crs=ARCTIC)
    strip = drawn("+proj=eqearth +lon_0=100", ice, crs=ARCTIC)
    assert len(whole.interiors) == 1
    assert strip.area == pytest.approx(whole.area, rel=1e-3)
    assert not whole.contains(shapely.Point(0, 0))


def test_nothing_and_empty_geometries_pass():
    assert [len(x) for x in onto("auto")] == [0, 0]
    found, problems = onto("auto", Polygon(), box(0, 0, 1, 1), MultiPolygon())
    assert shapely.is_empty(found).tolist() == [True, False, True]
    assert problems == []


@pytest.mark.parametrize("crs", ["EPSG:4326", "EPSG:4267", "EPSG:3035"])
@pytest.mark.parametrize("text", ["auto", "EPSG:3857", "EPSG:3034"])
def test_what_is_on_no_globe_is_left_out_and_the_rest_is_there(text, crs):
    source = read_crs(crs)
    (near,) = reproject(array(box(5, 45, 10, 50)), WGS84, source)
    nowhere = box(1e9, 1e9, 2e9, 2e9) if source.is_projected else box(0, 91, 10, 95)
    (here, gone), problems = onto(text, near, nowhere, crs=source)
    assert here.is_valid
    assert here.area > 1e11
    assert gone.is_empty
    assert [p.kind for p in problems] == ["beyond projection"]
