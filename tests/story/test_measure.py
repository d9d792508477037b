"""Areas, ways and bearings against geodesics."""

from __future__ import annotations

import json

import numpy as np
import pytest
import shapely
from pyproj import CRS, Geod, Transformer

from geotween.data.load import load
from geotween.story.events import scene_events
from geotween.story.measure import Globe, Plane, measure_of
from tests.conftest import WriteScene

GEOD = Geod(ellps="WGS84")
WGS84 = CRS.from_epsg(4326)
ACCURACY = 1e-3
PLACES = [(0, 0), (-119, 37), (12, -55), (179.5, 10), (-75, 80)]


def disc(lon: float, lat: float, radius: float, count: int = 720) -> shapely.Polygon:
    """A geodesic disc (m)."""
    bearings = np.linspace(360, 0, count, endpoint=False)
    east, north, _ = GEOD.fwd([lon] * count, [lat] * count, bearings, [radius] * count)
    turns = np.rint((np.asarray(east) - lon) / 360)
    return shapely.Polygon(np.column_stack([np.asarray(east) - 360 * turns, north]))


def globe_of(shapes: list[shapely.Polygon]) -> tuple[Globe, np.ndarray]:
    polygons = np.array(shapes, dtype=object)
    return Globe.of(WGS84, polygons), polygons


@pytest.mark.parametrize(("lon", "lat"), PLACES)
@pytest.mark.parametrize("radius", [1e2, 1e4, 5e5])
def test_area_of_a_disc_is_its_geodesic_one(lon: float, lat: float, radius: float) -> None:
    measure, polygons = globe_of([disc(lon, lat, radius)])
    known = abs(GEOD.geometry_area_perimeter(polygons[0])[0])
    assert measure.areas(polygons)[0] == pytest.approx(known, rel=ACCURACY)


@pytest.mark.parametrize("name", ["EPSG:3857", "EPSG:32611", "EPSG:3395", "EPSG:2226"])
def test_areas_do_not_depend_on_the_map(name: str) -> None:
    """Mercator doubles areas here; the last one is in feet."""
    round_one = disc(-119, 37, 2e4)
    crs = CRS.from_user_input(name)
    place = Transformer.from_crs(WGS84, crs, always_xy=True)
    drawn = shapely.transform(round_one, lambda p: np.column_stack(place.transform(*p.T)))
    polygons = np.array([drawn], dtype=object)
    known = abs(GEOD.geometry_area_perimeter(round_one)[0])
    assert Globe.of(crs, polygons).areas(polygons)[0] == pytest.approx(known, rel=ACCURACY)


@pytest.mark.parametrize(("lon", "lat"), PLACES)
@pytest.mark.parametrize("bearing", [0, 45, 90, 200, 315])
def test_ways_are_geodesics(lon: float, lat: float, bearing: float) -> None:
    far = 3e5
    east, north, _ = GEOD.fwd(lon, lat, bearing, far)
    east -= 360 * np.rint((east - lon) / 360)
    measure, polygons = globe_of([disc(lon, lat, 5e4), disc(east, north, 5e4)])
    centres = measure.centres(polygons)
    ways, bearings = measure.ways(centres[:1], centres[1:])
    assert ways[0] == pytest.approx(far, rel=ACCURACY)
    assert (bearings[0] - bearing + 180) % 360 - 180 == pytest.approx(0, abs=0.5)


def test_centre_of_parts_on_both_sides_of_the_antimeridian_is_between_them() -> None:
    measure, polygons = globe_of([disc(179, 0, 5e4), disc(-179, 0, 5e4), disc(180, 0, 5e4)])
    centres = measure.centres(polygons)
    ways, _ = measure.ways(centres[:2].mean(axis=0)[None], centres[2:])
    assert ways[0] < 10


def test_a_plane_has_its_own_units_or_metres() -> None:
    polygons = np.array([shapely.box(0, 0, 2, 3)], dtype=object)
    assert (Plane().areas(polygons)[0], Plane().real) == (6, False)
    assert (Plane(1000.0).areas(polygons)[0], Plane(1000.0).real) == (6e6, True)


def feature_collection(*shapes: shapely.Polygon) -> str:
    features = [
        {"type": "Feature", "properties": {"key": str(k)}, "geometry": shapely.geometry.mapping(s)}
        for k, s in enumerate(shapes)
    ]
    return json.dumps({"type": "FeatureCollection", "features": features})


@pytest.mark.parametrize("head", ["{}", "{projection: EPSG:3857}", "{projection: EPSG:4326}"])
def test_events_of_a_scene_are_measured_before_it_is_simplified(
    write_scene: WriteScene, head: str
) -> None:
    small, large = disc(10, 50, 1e3), disc(10.5, 50, 3e3)
    text = f"title: t\nmap: {head}\nsteps: [{{polygons: a.geojson}}, {{polygons: b.geojson}}]\n"
    far = disc(13, 50, 5e4)
    path = write_scene(text, a=feature_collection(small, far), b=feature_collection(large, far))
    scene = load(path)
    assert len(shapely.get_coordinates(scene.steps[0].regions.polygons)) < 721 * 2
    moved, grew, stable = scene_events(scene)[0].events
    assert (moved.kind, grew.kind, stable.kind) == ("moved", "grew", "stable")
    assert moved.distance == pytest.approx(GEOD.inv(10, 50, 10.5, 50)[2], rel=ACCURACY)
    assert grew.area_before == pytest.approx(np.pi * 1e3**2, rel=ACCURACY)
    assert grew.area_after == pytest.approx(np.pi * 3e3**2, rel=ACCURACY)


def test_steps_at_scales_of_their_own_are_not_measured(write_scene: WriteScene) -> None:
    text = """
title: t
map: {fit: each}
steps:
  - {polygons: [[[0, 0], [4, 0], [4, 4], [0, 4]]]}
  - {polygons: [[[0, 0], [8, 0], [8, 8], [0, 8]]]}
"""
    scene = load(write_scene(text))
    assert measure_of(scene) is None
    assert scene_events(scene)[0].events == ()
