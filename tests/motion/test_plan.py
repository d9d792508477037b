"""The plan: which of the two motions is chosen, and the ways tried where one is not proved."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import affinity
from shapely.geometry import Polygon, box

import geotween
from geotween.data.polygons import Feature, PolygonSet, polygon_set
from geotween.motion.measure import measure
from geotween.motion.morph import Morph, plan
from geotween.motion.techniques import resolve
from tests.motion.front.tilings import KINDS
from tests.motion.front.tilings import keyed as tiling
from tests.motion.made import FAMILIES, KEYED, made
from tests.motion.shapes import star

PROVING = settings.get_current_profile_name() == "prove"
METHODS = ["auto", "morph"]

DISC = shapely.Point(0, 0).buffer(1)


def ways(m: Morph) -> dict[str, int]:
    return m.certificate.ways["regions"]


def keyed(**polygons: Polygon) -> PolygonSet:
    return polygon_set(Feature(p, key=k) for k, p in polygons.items())


# The choice.


@pytest.mark.parametrize("way", [0.05, 0.5, 1.0, 1.9])
def test_a_disc_that_moves_travels(way: float) -> None:
    assert ways(geotween.morph([DISC], [affinity.translate(DISC, way)])) == {"trajectory": 1}


def test_a_disc_that_grows_on_one_side_is_swept() -> None:
    grown = DISC.union(affinity.translate(DISC, 0.7))
    assert ways(geotween.morph([DISC], [grown])) == {"front": 1}
    assert ways(geotween.morph([grown], [DISC])) == {"front": 1}


def test_a_border_between_two_is_swept_for_both_of_them() -> None:
    before = {"a": box(0, 0, 4, 4), "b": box(4, 0, 9, 4)}
    after = {"a": box(0, 0, 6, 4), "b": box(6, 0, 9, 4)}
    m = geotween.morph(before, after)
    assert ways(m) == {"front": 2}
    areas = [sum(p.area for p in m.frame(t).polygons) for t in np.linspace(0, 1, 9)]
    assert areas == pytest.approx([36] * 9)


@pytest.mark.parametrize("kinds", [list(KINDS), ["swaps"]])
def test_a_tiling_does_not_travel_whatever_its_tiles_do(kinds: list[str]) -> None:
    for seed in range(3):
        m = plan(*tiling(seed, 14, kinds), resolve("auto"))
        assert set(ways(m)) == {"front"}


def test_a_storm_travels_over_a_country_that_grows() -> None:
    before = keyed(storm=affinity.translate(DISC, -9, 9), land=box(0, 0, 4, 4))
    after = keyed(storm=affinity.translate(DISC, -5, 9), land=box(0, 0, 6, 4))
    assert ways(plan(before, after, resolve("auto"))) == {"trajectory": 1, "front": 1}


@pytest.mark.parametrize("what", [("key", "land"), ("layer", "regions")])
def test_a_scene_may_choose_otherwise(what: tuple[str, str]) -> None:
    before, after = keyed(land=box(0, 0, 4, 4)), keyed(land=box(0, 0, 6, 4))
    assert ways(plan(before, after, resolve("auto"))) == {"front": 1}
    by_name = resolve("auto", exceptions={what: "morph"})
    assert ways(plan(before, after, by_name)) == {"trajectory": 1}


@pytest.mark.parametrize("scale", [1e9, 1e-9])
@pytest.mark.parametrize("family", ["stars", "archipelagos", "bordering"])
def test_the_choice_turns_and_scales_with_the_data(family: str, scale: float) -> None:
    origin, target = made(family, 1)

    def changed(end: PolygonSet) -> PolygonSet:
        turned = [affinity.rotate(p, 33, origin=(2, 1)) for p in end.polygons]
        scaled: Any = [affinity.scale(p, scale, scale, origin=(0, 0)) for p in turned]
        return PolygonSet(np.array(scaled, dtype=object), end.identities)

    plain = plan(origin, target, resolve("auto"))
    again = plan(changed(origin), changed(target), resolve("auto"))
    assert ways(plain) == ways(again)


# The ladder.


def test_boundary_in_common_is_pinned_where_rotation_would_move_it() -> None:
    land = Polygon([(0, 0), (4, 0), (4, 3), (0, 3)])
    bay = Polygon([(0, 0), (4, 0), (4, 3), (3, 3), (2, 1), (1, 3), (0, 3)])
    m = geotween.morph([land], [bay], "morph")
    assert m.certificate.valid
    assert m.certificate.measures["common boundary moved"] == 0


@pytest.mark.parametrize("seed", range(3))
def test_a_spiral_that_no_matching_proves_is_swept_while_it_travels(seed: int) -> None:
    origin, target = made("spirals", seed)
    away = PolygonSet(
        np.array([affinity.translate(p, 20, 5) for p in target.polygons], dtype=object),
        target.identities,
    )
    for way in ("rotation", "trajectory"):
        by = resolve("morph", "within", matching=way, radius=100)
        assert not plan(origin, away, by).certificate.valid
    m = plan(origin, away, resolve("morph", "within", radius=100))
    assert m.certificate.valid
    assert ways(m) == {"front": 1}
    found = measure(m.tracks, origin, away)
    assert found.invalid_time == 0
    assert found.inexact_ends < 1e-9


def test_only_the_group_that_crosses_takes_another_way() -> None:
    spiral, curled = (end.polygons[0] for end in made("spirals", 0))
    before = keyed(spiral=spiral, star=star(20, 1, x=30))
    after = keyed(spiral=curled, star=star(30, 2, x=32))
    m = plan(before, after, resolve("morph"))
    assert m.certificate.valid
    assert ways(m) == {"front": 1, "trajectory": 1}


# Everything together, on seeded transitions of all kinds.


def assert_valid_and_so_in_frames(family: str, seed: int, method: str, frames: int) -> None:
    origin, target = made(family, seed)
    m = plan(origin, target, resolve(method, "key" if family in KEYED else None))
    assert m.certificate.valid, m.certificate.problems
    found = measure(m.tracks, origin, target, frames)
    assert found.invalid_time == 0
    assert found.overlap < 1e-9
    assert found.inexact_ends < 1e-9
    assert found.boundary_moved < 1e-9
    if set(ways(m)) == {"front"}:
        assert found.lost < 1e-9
        assert found.area_largest < 0.01


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("family", FAMILIES)
def test_what_is_called_valid_is_so_in_frames_of_one_of_each_family(
    family: str, method: str
) -> None:
    assert_valid_and_so_in_frames(family, 4, method, 51)


@pytest.mark.skipif(not PROVING, reason="takes long; make prove has it")
@given(st.sampled_from(list(FAMILIES)), st.integers(0, 2**32), st.sampled_from(METHODS))
def test_what_is_called_valid_is_so_in_frames(family: str, seed: int, method: str) -> None:
    assert_valid_and_so_in_frames(family, seed, method, 201)
