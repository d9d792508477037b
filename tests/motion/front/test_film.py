"""From arrivals to tracks: exact at every moment, and no more vertices than there are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from geotween.motion.front.film import tracks_of
from geotween.motion.front.levels import Arrivals
from geotween.motion.front.plane import NOTHING, Thing
from geotween.motion.sweep import sweep
from geotween.motion.tracks import SEAM_AT_ORIGIN, SEAM_AT_TARGET, Track, frame
from tests.motion.front.filmed import Mesh, by_chance, named, things

MOMENTS = (0.0, 0.1, 1 / 3, 0.47, 0.5, 0.77, 0.9, 1.0)


def film(mesh: Mesh) -> tuple[Track, ...]:
    return tracks_of(mesh.arrivals(), things(mesh.count), "regions")


def lives(tracks: Sequence[Track]) -> list[tuple[float, float]]:
    return [track.life for track in tracks]


def area(tracks: Sequence[Track], t: float, key: str = "0") -> float:
    drawn = frame(tracks, t)
    return sum(p.area for p, k in zip(drawn.polygons, drawn.keys, strict=True) if k == key)


def assert_exact(mesh: Mesh, tracks: Sequence[Track], t: float) -> None:
    """Each thing is drawn where it is, in valid polygons: of the right area, and nowhere else."""
    drawn = frame(tracks, t)
    polygons = np.array(drawn.polygons, dtype=object)
    assert shapely.is_valid(polygons).all()
    rng = np.random.default_rng(0)
    places, who = mesh.thing_at(rng.dirichlet([1, 1, 1], len(mesh.triangles)), t)
    for number, wanted in enumerate(mesh.areas(t)):
        mine = polygons[[key == str(number) for key in drawn.keys]]
        assert shapely.area(mine).sum() == pytest.approx(wanted, abs=1e-13)
        inside = shapely.contains_xy(mine[:, None], *places.T).sum(axis=0)
        assert np.array_equal(inside, who == number)


# Pictures: a dot is nothing, a front moves from the number 0 on.

SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
#    3---2---5
#    | 0 | . |    the right-hand square is taken from the left
#    0---1---4
GROWS = Mesh.of(
    [*SQUARE, (2, 0), (2, 1)],
    [(0, 1, 2), (0, 2, 3), (1, 4, 5), (1, 5, 2)],
    [[0, 0, 0], [0, 0, 0], [0, 1, 1], [0, 1, 0]],
    [0, 0, NOTHING, NOTHING],
    [0, 0, 0, 0],
)


def test_a_square_that_grows_is_one_track() -> None:
    tracks = film(GROWS)
    assert lives(tracks) == [(0, 1)]
    assert len(tracks[0].nodes) == 7  # the square, and where the front crosses three edges
    for t in MOMENTS:
        assert area(tracks, t) == pytest.approx(1 + t)
        assert_exact(GROWS, tracks, t)


def test_nothing_comes_of_nothing() -> None:
    none = np.empty((0, 2), dtype=np.intp)
    corners = np.empty((0, 3), dtype=np.intp)
    flat = np.empty(0, dtype=np.intp)
    empty = Arrivals(np.empty((0, 2)), corners, np.empty((0, 3)), flat, flat, none, none, none)
    assert tracks_of(empty, (), "regions") == ()


def test_what_does_not_change_keeps_its_vertices_beside_a_front() -> None:
    """A front between 0 and 1 runs along the whole of 2, which has no vertex there but its own."""
    points = [(0, 0), (4, 0), (4, 1), (0, 1), (4, 2), (0, 2)]
    mesh = Mesh.of(
        points,
        [(0, 1, 2), (0, 2, 3), (3, 2, 4), (3, 4, 5)],
        [[0, 0, 0], [0, 0, 0], [0, 1, 1], [0, 1, 0]],
        [2, 2, 1, 1],
        [2, 2, 0, 0],
    )
    tracks = film(mesh)
    (still,) = (track for track in tracks if track.key == "2")
    assert still.life == (0, 1)
    assert sorted(map(tuple, still.vertices[0].tolist())) == sorted(map(tuple, points[:4]))
    assert np.array_equal(still.vertices[0], still.vertices[1])
    assert_exact(mesh, tracks, 0.3)


def test_both_sides_of_a_border_that_moves_share_its_vertices() -> None:
    mesh = replace(GROWS, before=np.array([0, 0, 1, 1]))
    one, other = film(mesh)
    assert one.film is other.film
    assert one.nodes is not None
    assert other.nodes is not None
    assert len(np.intersect1d(one.nodes, other.nodes)) == 3
    assert_exact(mesh, [one, other], 0.6)


def test_all_levels_run_through_a_pivot() -> None:
    """A front that turns around a corner at which all levels meet."""
    points = [(0, 0), (2, 0), (2, 2), (0, 2)]
    times = [[0.25, 0, 0.5], [0.75, 0.5, 1]]
    mesh = Mesh.of(points, [(0, 1, 2), (0, 2, 3)], times, [NOTHING, NOTHING], [0, 0])
    tracks = film(mesh)
    for t in MOMENTS[1:-1]:
        assert_exact(mesh, tracks, t)
    assert sweep(tracks).clean


def annulus(around: int, within: int) -> Mesh:
    """A ring of eight triangles around a square of two; the front comes from without."""
    inner, outer = [(x, y) for x, y in SQUARE], [(-1, -1), (2, -1), (2, 2), (-1, 2)]
    ring = [(4 + k, 4 + (k + 1) % 4, k) for k in range(4)]
    ring += [(4 + (k + 1) % 4, (k + 1) % 4, k) for k in range(4)]
    times = [[0, 0, 1]] * 4 + [[0, 1, 1]] * 4
    return Mesh.of(
        [*inner, *outer],
        [*ring, (0, 1, 2), (0, 2, 3)],
        [*times, [0, 0, 0], [0, 0, 0]],
        [around] * 8 + [within] * 2,
        [0] * 8 + [within] * 2,
    )


def test_an_outline_with_a_hole_that_closes_in_on_an_island() -> None:
    mesh = annulus(NOTHING, 1)
    tracks = film(mesh)
    assert [(track.key, len(track.offsets) - 1) for track in tracks] == [("0", 2), ("1", 1)]
    for t in MOMENTS[1:-1]:
        assert_exact(mesh, tracks, t)
    assert sweep(tracks).clean


def test_a_hole_that_comes_to_be_around_an_island_of_the_same_thing() -> None:
    """The outer ring holds the hole, not the island in it."""
    mesh = annulus(NOTHING, 0)
    tracks = film(mesh)
    assert sorted(len(track.offsets) - 1 for track in tracks) == [1, 2]
    for t in MOMENTS[1:-1]:
        assert_exact(mesh, tracks, t)


def test_crossings_on_both_sides_of_an_edge_pass_each_other() -> None:
    """The left side of the edge in the middle is faster at first; at a third they change places."""
    points = [(0, 0), (2, 1), (0, 2), (-2, 1)]
    times = [[0, 0, 1], [0.5, 0.5, 0.25]]
    mesh = Mesh.of(points, [(0, 1, 2), (2, 3, 0)], times, [1, 1], [0, 0])
    tracks = film(mesh)
    for t in MOMENTS[1:-1]:
        assert_exact(mesh, tracks, t)
    assert sweep(tracks).clean


def test_two_that_meet_at_a_point_and_join_are_rings_without_a_point_twice() -> None:
    #  3---2---5
    #  | 0 |\ .|
    #  0---1---4    the square on the left, and the triangle 5; they meet in 2
    #       \ 0|
    #        ---6
    points = [*SQUARE, (2, 0), (2, 1), (3, 2)]
    triangles = [(0, 1, 2), (0, 2, 3), (1, 4, 2), (2, 4, 5), (2, 5, 6)]
    times = [[0, 0, 0], [0, 0, 0], [0, 1, 0], [1, 1, 1], [0, 0, 0]]
    mesh = Mesh.of(points, triangles, times, [0, 0, NOTHING, NOTHING, 0], [0, 0, 0, NOTHING, 0])
    tracks = film(mesh)
    assert len(tracks) == 2
    for track in tracks:
        assert len(np.unique(track.nodes)) == len(track.nodes)
    for t in MOMENTS:
        assert_exact(mesh, tracks, t)


def test_a_track_for_each_part_of_the_time() -> None:
    """The front stops at two corners on its way."""
    points = [(0, 0), (3, 0), (3, 1), (2, 1), (1, 1), (0, 1)]
    triangles = [(0, 4, 5), (0, 3, 4), (0, 1, 3), (1, 2, 3)]
    times = [[0, 0.25, 0], [0, 0.5, 0.25], [0, 1, 0.5], [1, 1, 0.5]]
    mesh = Mesh.of(points, triangles, times, [NOTHING] * 4, [0] * 4)
    tracks = film(mesh)
    assert lives(tracks) == [(0, 0.25), (0.25, 0.5), (0.5, 1)]
    for t in MOMENTS[1:]:
        assert_exact(mesh, tracks, t)


def test_what_parts_in_place_has_a_seam_at_the_origin() -> None:
    mesh = replace(GROWS, before=np.array([0, 0, 1, 1]), after=np.array([0, 0, 1, 1]))
    whole, left, right = (named(key) for key in "wlr")
    parting = (Thing(whole, left), Thing(whole, right))
    joining = (Thing(left, whole), Thing(right, whole))
    for two, code in ((parting, SEAM_AT_ORIGIN), (joining, SEAM_AT_TARGET)):
        tracks = tracks_of(mesh.arrivals(), two, "regions")
        assert [sorted(track.seams.tolist()) for track in tracks] == [[0, 0, 0, code]] * 2
        assert [track.identity for track in tracks] == [thing.origin for thing in two]
        assert [track.ends for track in tracks] == [(thing.origin, thing.target) for thing in two]


def test_what_begins_or_ends_is_itself_at_both_ends() -> None:
    mesh = replace(GROWS, before=np.array([1, 1, 0, 0]), after=np.array([0, 0, 0, 0]))
    mesh = replace(mesh, times=np.array([[0, 0, 1], [0, 1, 0], [0, 0, 0], [0, 0, 0.0]]))
    gone, new = named("gone"), named("new")
    tracks = tracks_of(mesh.arrivals(), (Thing(None, new), Thing(gone, None)), "regions")
    assert {(track.key, track.ends) for track in tracks} == {
        ("new", (new, new)),
        ("gone", (gone, gone)),
    }


def test_arrivals_that_do_not_fit_together() -> None:
    arrivals = GROWS.arrivals()
    still = np.where(arrivals.sides == NOTHING, 0, NOTHING)
    with pytest.raises(ArithmeticError, match="in nothing"):
        tracks_of(replace(arrivals, still=still), things(1), "regions")
    still = arrivals.still.copy()
    still[0, 1] = 1
    with pytest.raises(ArithmeticError, match="do not close"):
        tracks_of(replace(arrivals, still=still), things(2), "regions")
    with pytest.raises(ArithmeticError, match="not its triangles'"):
        tracks_of(replace(arrivals, edges=arrivals.edges[:, ::-1]), things(1), "regions")


meshes = st.builds(
    by_chance,
    st.integers(0, 10_000),
    st.integers(4, 16),
    st.integers(1, 3),
    st.sampled_from([1, 2, 4, 8]),
    st.booleans(),
)
open_times = st.floats(0.001, 0.999).filter(lambda t: abs(8 * t - round(8 * t)) > 1e-6)


@given(meshes, open_times)
def test_no_gap_and_no_overlap(mesh: Mesh, t: float) -> None:
    assert_exact(mesh, film(mesh), t)


@given(meshes, st.integers(0, 8))
def test_frames_are_exact_where_tracks_give_way(mesh: Mesh, eighth: int) -> None:
    drawn = frame(film(mesh), eighth / 8)
    polygons = np.array(drawn.polygons, dtype=object)
    assert shapely.is_valid(polygons).all()
    for number, wanted in enumerate(mesh.areas(eighth / 8)):
        mine = polygons[[key == str(number) for key in drawn.keys]]
        assert shapely.area(mine).sum() == pytest.approx(wanted, abs=1e-13)


@given(meshes)
def test_the_proof_finds_nothing_wrong(mesh: Mesh) -> None:
    assert sweep(film(mesh)).clean


@given(meshes)
def test_a_vertex_is_where_its_straight_way_leads_in_every_track(mesh: Mesh) -> None:
    known: dict[tuple[int, float], list[float]] = {}
    for track in film(mesh):
        assert track.film is not None
        assert track.nodes is not None
        since, until = track.film.lives[:, track.nodes]
        assert ((since <= track.life[0]) & (until >= track.life[1])).all()
        for end, t in enumerate(track.life):
            for node, place in zip(track.nodes.tolist(), track.vertices[end].tolist(), strict=True):
                assert known.setdefault((node, t), place) == place


@given(meshes, st.sampled_from([1e-9, 1.0, 1e9]), st.sampled_from([0, 1, 2, 3]))
def test_turned_and_rescaled_it_is_the_same(mesh: Mesh, scale: float, turns: int) -> None:
    turn = np.linalg.matrix_power(np.array([[0, 1], [-1, 0]]), turns) * scale
    other = replace(mesh, points=mesh.points @ turn)
    for one, two in zip(film(mesh), film(other), strict=True):
        assert one.life == two.life
        assert one.key == two.key
        assert two.vertices == pytest.approx(one.vertices @ turn, rel=1e-12, abs=1e-12 * scale)
