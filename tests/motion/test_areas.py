"""Area over time, computed from the motion."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from shapely.affinity import rotate
from shapely.geometry import Polygon, box

import geotween
from geotween.motion.areas import area_over_time
from geotween.motion.morph import plan
from geotween.motion.rings import Offsets, Vertices
from tests.motion.made import FAMILIES, made, techniques
from tests.motion.shapes import star, travelled


def test_a_square_that_grows_to_three_times_its_side_sags_below_the_straight_way() -> None:
    grown = area_over_time(travelled([box(0, 0, 1, 1)], [box(0, 0, 3, 3)]).tracks)
    assert grown.ends == pytest.approx((1, 9))
    assert grown.extremes() == pytest.approx((1, 9))
    assert grown.extremes(linear=True) == pytest.approx((-1, 0))  # (1 + 2t)² - (1 + 8t) at 1/2


def test_a_square_turned_by_its_vertices_half_round_shrinks_to_nothing_in_between() -> None:
    square = Polygon([(0, 0), (1, 0), (1, 1), (0, 1)])
    (track,) = geotween.morph([square], [square], "morph").tracks
    turned = np.stack([track.vertices[0], np.roll(track.vertices[1], 2, axis=0)])
    area = area_over_time([replace(track, vertices=turned)])
    assert area.extremes() == pytest.approx((0, 1))


def test_nothing_has_no_area() -> None:
    assert area_over_time([]).extremes() == (0, 0)


@pytest.mark.parametrize("family", FAMILIES)
def test_areas_are_those_of_frames(family: str) -> None:
    origin, target = made(family, 3)
    m = plan(origin, target, techniques(family, "rotation"))
    area = area_over_time(m.tracks)
    low, high = area.extremes()
    for t in np.linspace(0, 1, 9):
        k = max(int(np.searchsorted(area.times, t, side="right")) - 1, 0)
        row = area.coefficients[min(k, len(area.coefficients) - 1)]
        signed = sum(_signed(track.at(t), track.offsets) for track in m.tracks)
        assert row @ [1, t, t * t] == pytest.approx(signed, rel=1e-9, abs=1e-9)
        assert low - 1e-9 <= signed <= high + 1e-9


@pytest.mark.parametrize("scale", [1e9, 1e-9])
def test_rescaled_and_turned(scale: float) -> None:
    one, other = star(20, 1), star(30, 2)
    plain = area_over_time(geotween.morph([one], [other], "morph").tracks)
    changed = [
        Polygon(np.asarray(rotate(p, 33, origin=(0, 0)).exterior.coords) * scale)
        for p in (one, other)
    ]
    again = area_over_time(geotween.morph(changed[:1], changed[1:], "morph").tracks)
    scaled = np.array(plain.extremes(linear=True)) * scale**2
    assert again.extremes(linear=True) == pytest.approx(scaled, rel=1e-6)


def _signed(points: Vertices, offsets: Offsets) -> float:
    total = 0.0
    for first, last in pairwise(offsets):
        x, y = points[first:last].T
        total += float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2
    return total
