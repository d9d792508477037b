"""Common boundary, and whether it rests."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from shapely.affinity import rotate, scale
from shapely.geometry import Polygon, box

import geotween
from geotween.motion.common import moved_shares

Change = Callable[[Polygon], Polygon]

CHANGES: dict[str, Change] = {
    "as it is": lambda p: p,
    "turned": lambda p: rotate(p, 33, origin=(3, 1)),
    "reflected": lambda p: scale(p, -1, 1, origin=(0, 0)),
    "subdivided": lambda p: p.segmentize(0.3),
}
LAND = Polygon([(0, 0), (4, 0), (4, 3), (0, 3)])
WITH_A_BAY = Polygon([(0, 0), (4, 0), (4, 3), (3, 3), (2, 1), (1, 3), (0, 3)])


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_three_sides_of_a_land_in_which_a_bay_opens_rest(change: Change) -> None:
    one, other = change(LAND), change(WITH_A_BAY)
    for here, there in ((one, other), (other, one)):
        m = geotween.morph([here], [there], "morph", matching="trajectory")
        assert moved_shares(m.tracks, 1e-9).sum() == 0


def test_a_side_that_swims_is_told() -> None:
    (track,) = geotween.morph([LAND], [LAND], "morph").tracks
    swims = replace(track, vertices=np.stack([track.vertices[0], np.roll(track.vertices[1], 1, 0)]))
    assert moved_shares([swims], 1e-9).sum() == 1


def test_a_vertex_that_slides_along_a_side_moves_nothing() -> None:
    (track,) = geotween.morph(
        [box(0, 0, 1, 1)], [box(0, 0, 3, 1)], "morph", matching="rotation"
    ).tracks
    assert moved_shares([track], 1e-9).sum() == 0


def test_a_vertex_that_slides_between_two_edges_of_one_side_moves_nothing() -> None:
    one = Polygon([(0, 0), (1, 0), (4, 0), (4, 4), (0, 4)])
    other = Polygon([(0, 0), (3, 0), (4, 0), (4, 4), (0, 4)])
    (track,) = geotween.morph([one], [one], "morph").tracks
    target = np.asarray(other.exterior.coords)[:-1]
    origin = np.asarray(one.exterior.coords)[:-1]
    slides = replace(track, vertices=np.stack([origin, target]))
    assert moved_shares([slides], 1e-9).sum() == 0


def test_where_nothing_is_common_nothing_moves() -> None:
    m = geotween.morph([box(0, 0, 1, 1)], [box(0.3, 0.3, 2, 2)], "morph")
    assert moved_shares(m.tracks, 1e-9).sum() == 0
    assert moved_shares([], 1e-9).sum() == 0
