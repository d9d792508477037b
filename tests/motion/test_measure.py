"""Measures of known motions; and frames as an independent check of the proof."""

from __future__ import annotations

import os
from dataclasses import astuple, replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import ArrayLike, NDArray
from shapely.geometry import Polygon

from geotween.data.polygons import Feature, Identity, PolygonSet, polygon_set
from geotween.motion.measure import OVERLAP, Measures, invalid_frames, measure
from geotween.motion.morph import plan
from geotween.motion.sweep import sweep
from geotween.motion.tracks import Track
from tests.motion.made import FAMILIES, made, techniques

Floats = NDArray[np.float64]

SQUARE = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
FRAMES = 201
TIMES = np.linspace(0, 1, FRAMES)
SLACK = 1e-6

# The small sample takes one transition of each family, the large one looks for more of them.
PROVING = os.environ.get("HYPOTHESIS_PROFILE") == "prove"
EXAMPLES = settings.default.max_examples if PROVING and settings.default else 22


def shifted(x: float, y: float) -> Floats:
    return SQUARE + np.array([x, y])


def regions(*rings: ArrayLike, layer: str = "regions") -> PolygonSet:
    return polygon_set(Feature(Polygon(np.asarray(ring)), layer=layer) for ring in rings)


def track(*keys: ArrayLike, number: int = 0, layer: str = "regions", keyed: bool = False) -> Track:
    vertices = np.array(keys, dtype=float)
    count = vertices.shape[1]
    who = Identity(number, layer=layer, keyed=keyed)
    return Track(
        who,
        (who, who),
        layer,
        np.linspace(0, 1, len(keys)),
        vertices,
        np.array([0, count]),
        np.zeros(count, dtype=np.uint8),
    )


def is_nothing(found: Measures) -> bool:
    return max(astuple(found)) < 1e-15


def about(value: float) -> float:
    return pytest.approx(value, abs=1e-12)


# Known motions.


def test_what_stays_measures_nothing() -> None:
    stays = regions(SQUARE)
    assert is_nothing(measure([track(SQUARE, SQUARE)], stays, stays))
    assert measure([], regions(), regions()) == Measures()


def test_one_frame_is_too_few() -> None:
    with pytest.raises(ValueError, match="two frames"):
        measure([], regions(), regions(), 1)


def test_squares_that_swap_places_overlap_from_a_quarter_to_three_quarters() -> None:
    left, right = SQUARE, shifted(2, 0)
    swap = [track(left, right), track(right, left, number=1)]
    found = measure(swap, regions(left, right), regions(right, left))
    assert found.overlap == about(0.5)
    assert found.invalid_time == about(99 / 201)
    assert found.lost == 1
    assert found.area_largest == about(0)
    assert invalid_frames(swap, np.array([0.2, 0.25, 0.3, 0.5, 0.75])).tolist() == [
        *[False] * 2,
        *[True] * 2,
        False,
    ]


def test_a_square_turned_half_round_shrinks_to_nothing_half_way() -> None:
    turned = np.roll(SQUARE, 2, axis=0)
    found = measure([track(SQUARE, turned)], regions(SQUARE), regions(turned))
    assert (found.lost, found.area_largest) == (about(1), about(1))
    assert found.area_mean == pytest.approx(2 / 3, abs=0.01)  # of 1 - (1 - 2t)²
    assert found.boundary_moved == about(0.99 * np.sqrt(0.5))  # to a hundredth of the square
    assert found.jump == about(np.sqrt(2) / 200)
    assert found.inexact_ends == found.overlap == found.stray == 0


def test_a_bow_tie_is_invalid_and_its_two_wings_do_not_overlap() -> None:
    tie = SQUARE[[0, 1, 3, 2]]
    found = measure([track(SQUARE, tie, SQUARE)], regions(SQUARE), regions(SQUARE))
    assert 0.4 < found.invalid_time < 0.6
    assert found.overlap == 0


def test_an_end_that_is_missed_by_a_tenth() -> None:
    found = measure([track(SQUARE, SQUARE * [0.9, 1])], regions(SQUARE), regions(SQUARE))
    assert found.inexact_ends == about(0.1)


def test_pieces_of_each_others_feature_are_inexact() -> None:
    left, right = SQUARE, shifted(1, 0)
    stays = polygon_set(Feature(Polygon(ring), key=key) for key, ring in enumerate((left, right)))
    tracks = [track(left, left, number=1, keyed=True), track(right, right, keyed=True)]
    assert measure(tracks, stays, stays).inexact_ends == 1


def test_pieces_of_each_others_feature_without_keys_look_the_same() -> None:
    left, right = SQUARE, shifted(1, 0)
    tracks = [track(left, left, number=1), track(right, right)]
    assert measure(tracks, regions(left, right), regions(left, right)).inexact_ends == 0


def test_a_layer_nobody_asked_for_is_inexact() -> None:
    stays = regions(SQUARE)
    tracks = [track(SQUARE, SQUARE), track(SQUARE, SQUARE, layer="other")]
    found = measure(tracks, stays, stays)
    assert (found.inexact_ends, found.overlap, found.stray) == (1, 0, 0)


def test_a_layer_over_another_one_does_not_overlap_it() -> None:
    both = [regions(SQUARE), regions(SQUARE, layer="above")]
    every = PolygonSet(
        np.concatenate([one.polygons for one in both]),
        tuple(identity for one in both for identity in one.identities),
    )
    tracks = [track(SQUARE, SQUARE), track(SQUARE, SQUARE, layer="above")]
    assert is_nothing(measure(tracks, every, every))


def test_a_birth_grows_with_the_square_of_time() -> None:
    found = measure([track(np.full((4, 2), 0.5), SQUARE)], regions(), regions(SQUARE))
    assert found.area_largest == about(0.5)  # t - t², of half the target
    assert (found.lost, found.boundary_moved, found.inexact_ends) == (0, 0, 0)


def test_a_detour_strays_from_the_hull_and_uncovers_what_is_common() -> None:
    detour = track(SQUARE, shifted(0, 3), SQUARE)
    found = measure([detour], regions(SQUARE), regions(SQUARE))
    assert found.stray == about(3)
    assert found.lost == 1
    assert found.boundary_moved == about(3)
    assert found.jump == about(0.03)


def test_a_border_subdivided_on_one_side_is_common_and_sliding_along_it_is_no_move() -> None:
    longer = np.array([[0, 0], [0.3, 0], [0.7, 0], [2, 0], [2, 1], [0, 1]])
    start = np.array([[0, 0], [0.6, 0], [0.9, 0], [1, 0], [1, 1], [0, 1]])
    found = measure([track(start, longer)], regions(SQUARE), regions(longer))
    assert found.boundary_moved == about(0)
    bent = np.stack([start, (start + longer) / 2, longer])
    bent[1, 1] += [0, 0.1]
    found = measure([track(*bent)], regions(SQUARE), regions(longer))
    assert 0.03 < found.boundary_moved < 0.05


def test_a_jump_counts_once_however_short_it_lasts() -> None:
    still = track(SQUARE, SQUARE, shifted(5, 0), shifted(5, 0))
    sudden = replace(still, times=np.array([0, 0.5, 0.5 + 1e-9, 1]))
    assert measure([sudden], regions(SQUARE), regions(shifted(5, 0))).jump == about(5 / 6)


# What must not matter.

families = st.sampled_from(sorted(set(FAMILIES) - {"fires"}))
seeds = st.integers(0, 10_000)


@settings(max_examples=EXAMPLES)
@given(families, seeds, st.sampled_from([1e-9, 1.0, 1e9]))
def test_rescaled_turned_or_played_backwards(family: str, seed: int, scale: float) -> None:
    ends = made(family, seed)
    tracks = plan(*ends, techniques(family, "rotation")).tracks
    turn = np.array([[0, 1], [-1, 0]]) * scale

    def changed(end: PolygonSet) -> PolygonSet:
        return replace(end, polygons=shapely.transform(end.polygons, lambda p: p @ turn))

    backwards = [
        replace(t, ends=t.ends[::-1], times=1 - t.times[::-1], vertices=t.vertices[::-1] @ turn)
        for t in reversed(tracks)
    ]
    found = measure(tracks, *ends, frames=11)
    same = measure(backwards, changed(ends[1]), changed(ends[0]), frames=11)
    assert astuple(same) == pytest.approx(astuple(found), rel=1e-6, abs=1e-9)


# Against the proof.


def assert_proof_holds_in_frames(family: str, seed: int, matching: str) -> None:
    """What the sweep calls clean is clean in every frame; what is invalid in one is in it."""
    origin, target = made(family, seed)
    tracks = plan(origin, target, techniques(family, matching)).tracks
    proof = sweep(tracks)
    assert not proof.undecided
    if not proof.violations:
        found = measure(tracks, origin, target, FRAMES)
        assert found.invalid_time == 0
        assert found.overlap < OVERLAP
        return
    spans = [(v.start - SLACK, v.end + SLACK) for v in proof.violations]
    invalid: Floats = TIMES[invalid_frames(tracks, TIMES)]
    assert all(any(start <= t <= end for start, end in spans) for t in invalid.tolist())


@pytest.mark.parametrize("matching", ["rotation", "trajectory"])
@pytest.mark.parametrize("family", FAMILIES)
def test_proof_holds_in_frames_of_one_of_each_family(family: str, matching: str) -> None:
    assert_proof_holds_in_frames(family, 0, matching)


@pytest.mark.skipif(not PROVING, reason="takes an hour; make prove has it")
@given(st.sampled_from(list(FAMILIES)), seeds, st.sampled_from(["rotation", "trajectory"]))
def test_proof_holds_in_frames(family: str, seed: int, matching: str) -> None:
    assert_proof_holds_in_frames(family, seed, matching)
