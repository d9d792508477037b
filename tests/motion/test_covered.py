"""Whether what lies in a feature at both ends is covered on the way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapely.geometry import Polygon, box

import geotween
from geotween.data.polygons import Feature, PolygonSet, polygon_set
from geotween.motion.covered import bared
from geotween.motion.measure import measure
from geotween.motion.morph import plan
from geotween.motion.techniques import resolve
from tests.motion.made import made
from tests.motion.shapes import travelled

SQUARE = box(0, 0, 4, 4)


def alone(*polygons: Polygon) -> PolygonSet:
    return polygon_set(Feature(polygon) for polygon in polygons)


def test_a_square_that_grows_lays_nothing_bare() -> None:
    m = travelled([SQUARE], [box(-1, -1, 6, 5)])
    assert bared(m.tracks, alone(SQUARE), alone(box(-1, -1, 6, 5)), 1e-9) == 0


def test_a_square_turned_by_its_vertices_lays_itself_bare_half_way() -> None:
    (track,) = travelled([SQUARE], [SQUARE]).tracks
    half_round = np.stack([track.vertices[0], np.roll(track.vertices[1], 2, axis=0)])
    turned = replace(track, vertices=half_round)
    assert bared([turned], alone(SQUARE), alone(SQUARE), 1e-9) == 1
    quarter = np.stack([track.vertices[0], np.roll(track.vertices[1], 1, axis=0)])
    spun = replace(track, vertices=quarter)
    assert bared([spun], alone(SQUARE), alone(SQUARE), 1e-9) == pytest.approx(0.5)


def test_what_is_not_common_does_not_count() -> None:
    m = travelled([SQUARE], [box(9, 0, 13, 4)], correspondence="within", radius=20)
    assert bared(m.tracks, alone(SQUARE), alone(box(9, 0, 13, 4)), 1e-9) == 0


@pytest.mark.parametrize("family", ["stars", "combs", "crescents", "coasts"])
def test_it_is_what_frames_show(family: str) -> None:
    origin, target = made(family, 1)
    m = plan(origin, target, resolve("morph", matching="trajectory"))
    found = m.certificate.measures["bared"]
    lost = measure(m.tracks, origin, target, 41).lost
    assert found <= lost + 1e-9
    assert (found == 0) == (lost < 1e-12)


def test_a_front_lays_nothing_bare() -> None:
    grown = SQUARE.union(box(3, 1, 7, 3))
    assert geotween.morph([SQUARE], [grown], "front").certificate.measures["bared"] == 0
