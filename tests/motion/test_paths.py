"""Paths: what turns keeps its shape, and pieces that touch stay together."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from geotween.motion.looks import polygons_at
from geotween.motion.paths import (
    MOST_STEPS,
    TECHNIQUES,
    TOUCHING,
    touching,
    travel_all,
)
from geotween.motion.rigid import best_turn
from geotween.motion.rings import MatchedPiece
from geotween.motion.sweep import sweep
from tests.motion.shapes import seeds
from tests.motion.ways import (
    FINE,
    HOLE,
    SQUARE,
    TIMES,
    Floats,
    area,
    at,
    centre,
    comb,
    outline,
    piece,
    proof,
    shifted,
    track,
    turned,
    way,
)

# Shapes that turn.


def test_a_comb_that_turns_a_quarter_keeps_its_shape_on_a_rigid_path() -> None:
    matched = piece(comb(), turned(comb(), 90) + 3)
    assert area(at(way(matched, "straight"), np.array([0.5]))[0]) < 0.51 * area(comb())
    for technique in ("rigid", "intrinsic"):
        path = way(matched, technique)
        areas = [area(places) for places in path.places]
        assert np.allclose(areas, area(comb()), rtol=1e-6)
        assert len(areas) > 10
        assert sweep([track(path, matched)]).clean


def test_teeth_that_lengthen_on_a_turn_do_not_cross() -> None:
    longer = np.where(comb() > 0.9, comb() * [1, 1.5], comb())
    matched = piece(comb(), turned(longer, 175))
    for technique in ("rigid", "intrinsic"):
        assert proof(matched, technique).clean
        areas = [area(places) for places in way(matched, technique).places]
        assert (np.diff(areas) > 0).all()


@pytest.mark.parametrize("technique", ["rigid", "intrinsic"])
def test_a_storm_turns_on_its_way(technique: str) -> None:
    storm = outline(4, 40)
    matched = piece(storm, shifted(turned(storm, 70), 9, 2))
    path = way(matched, technique)
    for t, places in zip(path.times, path.places, strict=True):
        middle = turned(storm, 70 * t, centre(storm)) + t * (
            centre(matched.vertices[1]) - centre(storm)
        )
        assert np.allclose(places, middle, atol=1e-12)
    assert sweep([track(path, matched)]).clean


def test_a_turn_takes_the_shorter_way_round() -> None:
    for degrees, side in ((170, 1), (190, -1), (-170, -1)):
        path = way(piece(SQUARE, turned(SQUARE, degrees)), "rigid")
        corner = path.places[1, 2] - centre(path.places[1])
        assert np.sign(0.5 * corner[1] - 0.5 * corner[0]) == side


@pytest.mark.parametrize("technique", ["rigid", "intrinsic"])
@pytest.mark.parametrize("degrees", [180, -180, 180 + 1e-12, 180 - 1e-12])
def test_half_a_turn_goes_counter_clockwise(technique: str, degrees: float) -> None:
    path = way(piece(comb(), turned(comb(), degrees)), technique)
    quarter = at(path, np.array([0.5]))[0]
    expected = (
        turned(comb(), 90, centre(comb())) + (centre(turned(comb(), 180)) - centre(comb())) / 2
    )
    assert np.allclose(quarter, expected, atol=1e-3)


@pytest.mark.parametrize("technique", ["rigid", "intrinsic"])
def test_what_does_not_turn_goes_straight(technique: str) -> None:
    matched = piece(comb(), 3 * comb() + [5, 7])
    path = way(matched, technique)
    assert len(path.times) == 2
    assert (path.places == matched.vertices).all()


@pytest.mark.parametrize("technique", TECHNIQUES)
def test_a_birth_and_a_death_go_straight(technique: str) -> None:
    point = np.full_like(SQUARE, 0.3)
    for matched in (piece(point, SQUARE), piece(SQUARE, point)):
        path = way(matched, technique)
        assert (path.places == matched.vertices).all()
        assert not path.gave_way


@pytest.mark.parametrize("start", range(4))
@pytest.mark.parametrize("technique", ["rigid", "intrinsic"])
def test_a_hole_goes_with_its_piece(technique: str, start: int) -> None:
    both = np.vstack([comb(), np.roll(HOLE * [1, 0.1] + [0, 0.02], start, axis=0)])
    matched = piece(both, turned(both, 120) + 2, len(comb()))
    path = way(matched, technique)
    for places in path.places:
        distance = np.hypot(*(places[-1] - places[:-1]).T)
        assert np.allclose(distance, np.hypot(*(both[-1] - both[:-1]).T))
    assert sweep([track(path, matched)]).clean


@pytest.mark.parametrize("technique", ["rigid", "intrinsic"])
def test_a_hole_opens_in_the_turning_frame(technique: str) -> None:
    open_, closed = np.vstack([SQUARE, HOLE]), np.vstack([SQUARE, np.full((4, 2), 0.7)])
    matched = piece(closed, turned(open_, 90), 4)
    assert sweep([track(way(matched, technique), matched)]).clean
    turning = way(matched, technique)
    corner = np.hypot(*(turning.places[:, 5] - turning.places[:, 2]).T)
    start, end = (np.hypot(*(closed[5] - closed[2])), np.hypot(*(open_[5] - open_[2])))
    assert ((corner > min(start, end) - 1e-3) & (corner < max(start, end) + 1e-3)).all()


@pytest.mark.parametrize("technique", ["rigid", "intrinsic"])
def test_common_boundary_does_not_turn(technique: str) -> None:
    grown = SQUARE * [1, 3] + [[0, 0], [0, 0], [2, 0], [2, 0]]
    matched = piece(SQUARE, grown)
    assert way(matched, technique).places.shape == (2, 4, 2)


def test_boundary_counts_by_its_length_and_not_by_its_vertices() -> None:
    one, other = SQUARE, np.array([[0, 0], [1.5, 0.3], [1, 1], [-0.4, 0.8]])
    crowd = np.linspace(0, 1, 52)[1:-1, None]
    crowded = piece(*(np.insert(v, 1, v[0] + crowd * (v[1] - v[0]), axis=0) for v in (one, other)))
    evenly = [
        np.concatenate(
            [
                a + np.linspace(0, 1, 200)[:-1, None] * (b - a)
                for a, b in zip(v, np.roll(v, -1, axis=0), strict=True)
            ]
        )
        for v in (one, other)
    ]
    turns = [best_turn([(m.vertices, m.offsets)]) for m in (crowded, piece(*evenly))]
    angles = [np.degrees(turn.angle) for turn in turns if turn is not None]
    assert angles[0] == pytest.approx(angles[1], abs=1)


# Pieces that touch.


def halves(seed: int) -> tuple[MatchedPiece, MatchedPiece]:
    """A rough outline cut in two along a broken line; both sides turn and change."""
    random = np.random.default_rng(seed)
    left = np.array([[0, 0], [2, 0], [2.3, 1], [1.8, 2], [2, 3], [0, 3]], dtype=float)
    right = np.array([[2, 0], [4, 0], [4, 3], [2, 3], [1.8, 2], [2.3, 1]], dtype=float)
    moved = {tuple(p): turned(p, 100) + random.uniform(-0.2, 0.2, 2) for p in (*left, *right)}
    return tuple(  # type: ignore[return-value]
        piece(ring, [moved[tuple(p)] for p in ring]) for ring in (left, right)
    )


@pytest.mark.parametrize("technique", ["rigid", "intrinsic"])
def test_pieces_along_a_seam_turn_as_one(technique: str) -> None:
    both = halves(1)
    groups = touching(both, 1e-9)
    assert groups.tolist() == [0, 0]
    paths = travel_all(both, groups, technique, FINE)
    assert (paths[0].times == paths[1].times).all()
    for here, there in zip((1, 2, 3, 4), (0, 5, 4, 3), strict=True):
        assert (paths[0].places[:, here] == paths[1].places[:, there]).all()
    assert sweep([track(*pair) for pair in zip(paths, both, strict=True)]).clean
    assert [path.gave_way for path in paths] == [TOUCHING if technique == "intrinsic" else ""] * 2


def test_pieces_that_part_turn_as_one_and_others_for_themselves() -> None:
    parted = (
        piece(SQUARE, turned(SQUARE, 50)),
        piece(shifted(SQUARE, 1, 0), shifted(turned(SQUARE, 50), 7, 0)),
    )
    alone = piece(shifted(SQUARE, 0, 9), shifted(turned(SQUARE, -80), 0, 9))
    pieces = (parted[0], alone, parted[1])
    groups = touching(pieces, 1e-9)
    assert groups[0] == groups[2] != groups[1]
    paths = travel_all(pieces, groups, "rigid", FINE)
    own = way(alone, "rigid")
    assert (paths[1].places == own.places).all()
    assert sweep([track(*pair) for pair in zip(paths, pieces, strict=True)]).clean


@pytest.mark.parametrize("end", [0, 1])
@pytest.mark.parametrize(
    "other",
    [shifted(SQUARE, 1, 0), shifted(SQUARE, 1, 0.3), SQUARE + 1],
    ids=["along an edge", "along part of an edge", "at a corner"],
)
def test_what_touches_at_one_end_is_a_group(end: int, other: Floats) -> None:
    sides = [(SQUARE, SQUARE), (other, other + 5)]
    pieces = [piece(*(pair if end == 0 else pair[::-1])) for pair in sides]
    assert touching(pieces, 1e-9).tolist() == [0, 0]


def test_what_is_apart_or_a_point_is_no_group() -> None:
    born = piece(np.full((4, 2), 1.0), SQUARE + 5)
    pieces = [piece(SQUARE, SQUARE), piece(SQUARE + 2, SQUARE + 2), born]
    assert len(np.unique(touching(pieces, 1e-9))) == 3
    assert len(touching([], 1e-9)) == 0


def test_an_island_touches_the_lake_that_it_fills() -> None:
    lake = np.vstack([SQUARE, HOLE])
    pieces = [piece(lake, lake, 4), piece(HOLE[::-1], HOLE[::-1])]
    assert touching(pieces, 1e-9).tolist() == [0, 0]


def test_a_birth_at_the_border_turns_with_its_neighbour() -> None:
    beside, point = turned(shifted(SQUARE, 1, 0), 90), np.full((4, 2), 1.0)
    pieces = [piece(SQUARE, turned(SQUARE, 90)), piece(point, beside)]
    paths = travel_all(pieces, touching(pieces, 1e-9), "rigid", FINE)
    assert len(paths[0].times) == len(paths[1].times) > 2
    middle = [at(path, TIMES) for path in (paths[0], way(pieces[0], "rigid"))]
    assert np.allclose(*middle, atol=2 * FINE)
    late = polygons_at([track(*pair) for pair in zip(paths, pieces, strict=True)], 0.99)
    assert shapely.intersection(*late).area < 1e-3


# Whatever the outline.

turns = st.floats(-150, 150)
techniques = st.sampled_from(["rigid", "intrinsic"])


def stars(seed: int, degrees: float) -> MatchedPiece:
    return piece(outline(seed), shifted(turned(outline(seed + 1), degrees), 2, 1))


@given(seeds, turns, techniques)
def test_ends_are_exact(seed: int, degrees: float, technique: str) -> None:
    matched = stars(seed, degrees)
    path = way(matched, technique)
    assert (path.places[[0, -1]] == matched.vertices).all()
    assert (path.times[[0, -1]] == [0, 1]).all()
    assert (np.diff(path.times) > 0).all()


@given(seeds, turns, st.floats(1e-3, 0.3))
def test_straight_lines_stay_within_the_tolerance(
    seed: int, degrees: float, tolerance: float
) -> None:
    matched = stars(seed, degrees)
    turn = best_turn([(matched.vertices, matched.offsets)])
    assert turn is not None
    finest = way(matched, "intrinsic", 0.0)
    assert len(finest.times) == len(way(matched, "rigid", 0.0).times) == MOST_STEPS + 1
    for technique, exact in (
        ("rigid", turn.at(matched.vertices, TIMES)),
        ("intrinsic", at(finest, TIMES)),
    ):
        off = at(way(matched, technique, tolerance), TIMES) - exact
        assert np.hypot(off[..., 0], off[..., 1]).max() <= tolerance * (1 + 1e-9)


@given(seeds, turns, techniques)
def test_the_way_back_is_the_same(seed: int, degrees: float, technique: str) -> None:
    matched = stars(seed, degrees)
    path, back = way(matched, technique), way(piece(*matched.vertices[::-1]), technique)
    assert np.allclose(back.times, 1 - path.times[::-1])
    assert np.allclose(back.places, path.places[::-1], atol=1e-12)


@given(seeds, turns, techniques, st.floats(-180, 180))
def test_a_path_turns_with_its_map(
    seed: int, degrees: float, technique: str, map_turn: float
) -> None:
    matched = stars(seed, degrees)
    path = way(matched, technique)
    other = way(piece(*(turned(v, map_turn) for v in matched.vertices)), technique)
    assert np.allclose(other.places, turned(path.places, map_turn), atol=1e-12)


@given(seeds, turns, techniques)
def test_a_path_is_mirrored_with_its_map(seed: int, degrees: float, technique: str) -> None:
    matched = stars(seed, degrees)
    path = way(matched, technique)
    other = way(piece(*(v[::-1] * [-1, 1] for v in matched.vertices)), technique)
    assert np.allclose(other.places[:, ::-1], path.places * [-1, 1], atol=1e-12)


@pytest.mark.parametrize("factor", [1e-9, 1e9])
@pytest.mark.parametrize("technique", TECHNIQUES)
def test_a_path_grows_with_its_map(technique: str, factor: float) -> None:
    matched = stars(7, 140)
    path = way(matched, technique)
    other = way(piece(*(matched.vertices * factor)), technique, FINE * factor)
    assert np.allclose(other.places, path.places * factor, atol=1e-12 * factor)


@given(seeds, turns, techniques, st.integers(0, 19))
def test_a_path_is_the_same_from_any_start(
    seed: int, degrees: float, technique: str, start: int
) -> None:
    matched = stars(seed, degrees)
    path = way(matched, technique)
    other = way(piece(*np.roll(matched.vertices, start, axis=1)), technique)
    assert np.allclose(other.places, np.roll(path.places, start, axis=1), atol=1e-12)


def test_the_order_of_pieces_changes_nothing() -> None:
    both = (*halves(2), stars(3, 90))
    there = travel_all(both, touching(both, 1e-9), "rigid", FINE)
    back = travel_all(both[::-1], touching(both[::-1], 1e-9), "rigid", FINE)[::-1]
    for one, other in zip(there, back, strict=True):
        assert np.allclose(one.places, other.places, atol=1e-12)
