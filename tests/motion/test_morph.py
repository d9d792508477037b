"""The whole way from two sets to frames: exact ends, keys, properties, metamorphic relations."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely import affinity
from shapely.geometry import MultiPolygon, Polygon, box

import geotween
from geotween.motion.morph import plan
from geotween.motion.techniques import METHODS, Techniques, resolve
from tests.motion.made import made
from tests.motion.shapes import blobs, polygon_sets, star, tiles, travelled


def area(polygons: list[Polygon]) -> MultiPolygon:
    # On a fine grid: without one, union can lose a polygon whose edge all but meets another's.
    return shapely.union_all(polygons, grid_size=1e-12) if polygons else MultiPolygon()


def assert_same_area(one: list[Polygon], other: list[Polygon], tolerance: float = 1e-9) -> None:
    a, b = area(one), area(other)
    assert a.symmetric_difference(b).area <= tolerance * max(a.area, b.area)


@given(polygon_sets, polygon_sets)
def test_the_ends_are_exact(origin: list[Polygon], target: list[Polygon]) -> None:
    m = travelled(origin, target)
    assert_same_area(m.frame(0).polygons, origin)
    assert_same_area(m.frame(1).polygons, target)
    assert m.certificate.measures["partition error"] <= 1e-9


@given(polygon_sets, polygon_sets)
def test_rings_have_equal_counts_at_both_ends(origin: list[Polygon], target: list[Polygon]) -> None:
    for track in travelled(origin, target).tracks:
        assert track.vertices.shape == (2, track.offsets[-1], 2)
        assert len(track.seams) == track.offsets[-1]
        assert np.isfinite(track.vertices).all()


@given(polygon_sets)
def test_a_set_that_does_not_change_does_not_move(polygons: list[Polygon]) -> None:
    named = {str(i): p for i, p in enumerate(polygons)}
    m = travelled(named, named, correspondence="key")
    assert all((t.vertices[0] == t.vertices[1]).all() for t in m.tracks)


def test_half_way_a_square_that_moves_is_half_way() -> None:
    m = travelled([box(0, 0, 2, 2)], [box(1, 0, 3, 2)])
    (middle,) = m.frame(0.5).polygons
    assert middle.equals(box(0.5, 0, 2.5, 2))


def test_birth_and_death_scale_about_the_centroid() -> None:
    m = travelled([box(0, 0, 2, 2)], [box(10, 0, 14, 4)])
    assert [p.bounds for p in m.frame(0.5).polygons] == [(11, 1, 13, 3), (0.5, 0.5, 1.5, 1.5)]
    assert [p.bounds for p in m.frame(0).polygons] == [(0, 0, 2, 2)]
    assert [p.bounds for p in m.frame(1).polygons] == [(10, 0, 14, 4)]


def test_a_ring_that_dies_keeps_its_hole_inside() -> None:
    ring = Polygon(box(0, 0, 8, 8).exterior, [box(1, 1, 3, 3).exterior])
    m = travelled([ring], [])
    for t in (0, 0.3, 0.9):
        (shrunk,) = m.frame(t).polygons
        assert shrunk.is_valid
        assert shrunk.area == pytest.approx(ring.area * (1 - t) ** 2)


def test_from_nothing_to_nothing() -> None:
    m = travelled([], [])
    assert m.tracks == m.pairs == ()
    assert m.frame(0.5).polygons == []


class TestKeys:
    """A piece bears the target's key where only the target's lives on, else the origin's."""

    def test_an_annexed_piece_bears_the_key_that_lives_on(self) -> None:
        origin = {"a": box(0, 0, 4, 4), "b": box(4, 0, 8, 4)}
        m = travelled(origin, {"b": box(0, 0, 8, 4)})
        assert sorted(m.frame(0.5).keys) == ["b", "b"]

    def test_a_piece_of_a_union_that_breaks_up_bears_the_origins(self) -> None:
        m = travelled({"u": box(0, 0, 8, 4)}, {"a": box(0, 0, 3, 4), "b": box(5, 0, 8, 4)})
        assert m.frame(0.5).keys == ["u", "u"]

    def test_where_both_live_on_it_bears_the_origins(self) -> None:
        both = {"a": box(0, 0, 4, 4), "b": box(4, 0, 8, 4)}
        m = geotween.morph(both, both, "paper")
        assert [(p.origin_key, p.target_key) for p in m.pairs] == [
            ("a", "a"), ("a", "b"), ("b", "a"), ("b", "b"),
        ]  # fmt: skip
        assert m.frame(0.5).keys == ["a", "a", "b", "b"]

    def test_births_and_deaths_bear_their_own(self) -> None:
        m = travelled({"old": box(0, 0, 1, 1)}, {"new": box(5, 5, 6, 6)})
        assert m.frame(0.5).keys == ["old", "new"]
        assert [(p.origin_key, p.target_key) for p in m.pairs] == [(None, "new"), ("old", None)]

    def test_a_sequence_has_positions_for_keys_empties_counted(self) -> None:
        m = travelled([Polygon(), box(0, 0, 1, 1)], [box(0, 0, 1, 2)])
        assert [(p.origin_key, p.target_key) for p in m.pairs] == [(1, 0)]

    def test_parts_of_a_multipolygon_carry_its_key(self) -> None:
        parts = MultiPolygon([box(0, 0, 1, 1), box(3, 0, 4, 1)])
        m = travelled({"islands": parts}, {"islands": parts}, correspondence="key")
        assert [p.origin_key for p in m.pairs] == ["islands", "islands"]


def test_fit_each_brings_the_target_into_the_origins_box() -> None:
    m = travelled([box(0, 0, 10, 4)], [box(100, 100, 101, 102)], fit="each")
    (fitted,) = m.frame(1).polygons
    assert fitted.bounds == pytest.approx((4, 0, 6, 4))


def test_a_bow_tie_is_repaired_and_reported() -> None:
    bow_tie = Polygon([(0, 0), (4, 4), (4, 0), (0, 4)])
    m = geotween.morph([bow_tie], [box(0, 0, 4, 4)])
    assert [p.kind for p in m.certificate.problems if p.severity == "warning"] == ["repaired"]
    assert area(m.frame(0).polygons).area == pytest.approx(8)


@pytest.mark.parametrize("away", [1e5, 1e8])
def test_far_from_the_origin_is_like_near_it(away: float) -> None:
    origin, target = SETS["blobs"]
    near = travelled(origin, target)
    far = travelled(*([affinity.translate(p, away, -away) for p in s] for s in (origin, target)))
    assert not [p for p in far.certificate.problems if p.severity != "note"]
    for t in (0, 0.5, 1):
        assert areas_of_pieces(far.frame(t).polygons) == pytest.approx(
            areas_of_pieces(near.frame(t).polygons), rel=1e-12 * away
        )


def test_too_far_for_its_size_is_refused() -> None:
    with pytest.raises(ValueError, match="too far from the origin"):
        travelled([box(1e12, 0, 1e12 + 1, 1)], [])
    with pytest.raises(ValueError, match="not finite, or beyond"):
        travelled([box(0, 0, 1e160, 1e160)], [])


def test_a_polygon_alone_is_no_set() -> None:
    with pytest.raises(TypeError, match="origin is a Polygon; expected a sequence"):
        travelled(box(0, 0, 1, 1), [])  # type: ignore[arg-type]


@pytest.mark.parametrize("method", METHODS)
def test_what_rests_is_proved(method: str) -> None:
    m = geotween.morph([box(0, 0, 1, 1)], [box(0, 0, 1, 1)], method)
    assert m.certificate.valid is True
    assert m.certificate.problems == ()


def test_two_that_swap_places_overlap_on_the_way_and_are_named() -> None:
    left, right = box(0, 0, 2, 2), box(6, 0, 8, 2)
    m = travelled({"a": left, "b": right}, {"a": right, "b": left}, correspondence="key")
    assert not m.certificate.valid
    (problem,) = m.certificate.problems
    assert str(problem).startswith("warning: a and b overlap from 33% to 67% of the way (")
    assert m.certificate.measures["crossing"] == pytest.approx(1 / 3)


@pytest.mark.parametrize("family", ["combs", "fires"])
def test_what_would_cross_itself_by_rotation_does_not_by_trajectory(family: str) -> None:
    sets = made(family, 0)
    by = {name: plan(*sets, resolve("morph", matching=name)) for name in ("rotation", "trajectory")}
    assert [morph.certificate.valid for morph in by.values()] == [False, True]
    assert plan(*sets, resolve("morph")).certificate.ways == {"regions": {"trajectory": 1}}


def test_what_no_matching_proves_stays_by_rotation_and_is_told() -> None:
    left, right = box(0, 0, 2, 2), box(6, 0, 8, 2)
    swap = travelled({"a": left, "b": right}, {"a": right, "b": left}).certificate
    assert swap.ways == {"regions": {"rotation": 2}}
    assert [problem.severity for problem in swap.problems] == ["warning"]


def test_each_stage_can_be_named_on_its_own() -> None:
    paper = Techniques("paper", "intersects", "voronoi", "rotation", births="centroid")
    assert resolve("paper") == paper
    assert resolve("auto").retries
    assert resolve("auto", matching="rotation").retries == ()
    assert resolve("auto", matching="trajectory").matching == "trajectory"
    assert resolve("paper", correspondence="key").correspondence == "key"
    with pytest.raises(ValueError, match="unknown division 'scissors'; expected one of advancing"):
        resolve("paper", division="scissors")


# Metamorphic relations: what is done to both sets is done to every frame. The sets have no empty
# Voronoi cell: where those are cut depends on a search along the axes.
SETS = {
    "blobs": (blobs(3, 11), blobs(4, 12)),
    "star-blobs": ([star(40, 17, 4, 5, 5)], blobs(5, 18)),
    "tiles-blobs": (tiles(4, 6), blobs(3, 7)),
    "tiles": (tiles(4, 2), tiles(3, 3)),
}
# Here no two seeds coincide, which is settled by the order of the polygons.
FREE_OF_ORDER = {name: SETS[name] for name in ("blobs", "star-blobs")}
Sets = tuple[list[Polygon], list[Polygon]]
Change = Callable[[Polygon], Polygon]

CHANGES: dict[str, Change] = {
    "turned by a quarter": lambda p: affinity.rotate(p, 90, origin=(0, 0)),
    "turned by 33 degrees": lambda p: affinity.rotate(p, 33, origin=(3, 1)),
    "reflected": lambda p: affinity.scale(p, -1, 1, origin=(0, 0)),
    "a billion times as large": lambda p: affinity.scale(p, 1e9, 1e9, origin=(0, 0)),
    "a billionth as large": lambda p: affinity.scale(p, 1e-9, 1e-9, origin=(0, 0)),
    "moved": lambda p: affinity.translate(p, 1000, -500),
}


def areas_of_pieces(polygons: list[Polygon]) -> list[float]:
    return sorted(abs(p.area) for p in polygons)


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
@pytest.mark.parametrize("sets", SETS.values(), ids=SETS)
def test_what_is_done_to_the_sets_is_done_to_the_frames(sets: Sets, change: Change) -> None:
    assert_changes_alike(sets, change, "rotation")


# A reflection turns the direction of rings round, and trajectories depend on it a little.
@pytest.mark.parametrize("name", [name for name in CHANGES if name != "reflected"])
@pytest.mark.parametrize("sets", SETS.values(), ids=SETS)
def test_what_is_done_to_the_sets_is_done_to_the_trajectories(sets: Sets, name: str) -> None:
    assert_changes_alike(sets, CHANGES[name], "trajectory")


def assert_changes_alike(sets: Sets, change: Change, matching: str) -> None:
    before = travelled(*sets, matching=matching)
    changed_sets = ([change(p) for p in polygons] for polygons in sets)
    after = travelled(*changed_sets, matching=matching)
    for t in (0.0, 0.25, 0.5, 1.0):
        changed = [change(p) for p in before.frame(t).polygons]
        drawn = after.frame(t).polygons
        assert len(changed) == len(drawn)
        assert areas_of_pieces(changed) == pytest.approx(areas_of_pieces(drawn), rel=1e-6)
        centres = [np.array([p.centroid.coords[0] for p in f]) for f in (changed, drawn)]
        extent = np.ptp(centres[0], axis=0).max() + np.sqrt(changed[0].area)
        assert np.allclose(*centres, atol=1e-6 * extent)


@pytest.mark.parametrize("sets", FREE_OF_ORDER.values(), ids=FREE_OF_ORDER)
def test_the_order_of_polygons_does_not_matter(sets: Sets) -> None:
    origin, target = sets
    m = travelled(origin, target)
    assert not m.problems
    other = travelled(origin[::-1], target[::-1])
    for t in (0.0, 0.4, 1.0):
        assert areas_of_pieces(m.frame(t).polygons) == pytest.approx(
            areas_of_pieces(other.frame(t).polygons)
        )


@pytest.mark.parametrize("sets", SETS.values(), ids=SETS)
def test_backwards_is_the_same_in_reverse(sets: Sets) -> None:
    forth, back = travelled(*sets), travelled(*sets[::-1])
    for t in (0.0, 0.3, 0.5, 1.0):
        assert areas_of_pieces(forth.frame(t).polygons) == pytest.approx(
            areas_of_pieces(back.frame(1 - t).polygons), rel=1e-6
        )


@given(st.floats(0, 1))
def test_vertices_travel_on_straight_lines(t: float) -> None:
    m = travelled([star(9, 1)], [star(12, 2)])
    (track,) = m.tracks
    assert track.at(t) == pytest.approx(track.vertices[0] * (1 - t) + track.vertices[1] * t)


@pytest.mark.parametrize("t", [-0.1, 1.1, float("nan")])
def test_t_outside_the_transition_is_refused(t: float) -> None:
    with pytest.raises(ValueError, match="from 0 to 1"):
        travelled([box(0, 0, 1, 1)], []).frame(t)
