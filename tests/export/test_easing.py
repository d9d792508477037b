"""Easings: the curves of CSS, and their parts between key times."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from geotween.export.easing import EASINGS, ease, segments, share_at

NAMES = pytest.mark.parametrize("name", EASINGS)


@NAMES
def test_an_easing_runs_from_0_to_1(name: str) -> None:
    assert ease(EASINGS[name], 0) == 0
    assert ease(EASINGS[name], 1) == 1


@NAMES
@given(st.floats(0, 1), st.floats(0, 1))
def test_an_easing_never_goes_back(name: str, a: float, b: float) -> None:
    low, high = sorted((a, b))
    assert ease(EASINGS[name], low) <= ease(EASINGS[name], high) + 1e-12


def test_ease_in_out_is_half_way_at_half_time() -> None:
    assert ease(EASINGS["ease-in-out"], 0.5) == pytest.approx(0.5)
    assert ease(EASINGS["ease-in"], 0.5) < 0.5 < ease(EASINGS["ease-out"], 0.5)


@NAMES
@given(st.floats(0, 1))
def test_the_share_at_which_t_is_reached(name: str, t: float) -> None:
    assert ease(EASINGS[name], share_at(EASINGS[name], t)) == pytest.approx(t, abs=1e-12)


@NAMES
@given(st.floats(0.1, 0.9), st.floats(0, 1))
def test_the_parts_of_an_easing_make_up_the_whole(name: str, cut: float, share: float) -> None:
    spline = EASINGS[name]
    for (start, end, part), (low, high) in zip(
        segments(spline, [0, cut, 1]), [(0, cut), (cut, 1)], strict=True
    ):
        here = start + share * (end - start)
        assert low + (high - low) * ease(part, share) == pytest.approx(ease(spline, here), abs=1e-5)
