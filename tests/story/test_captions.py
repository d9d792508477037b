"""Captions of small pictures: what is told first, and what is counted."""

from __future__ import annotations

from collections.abc import Mapping

import pytest

from geotween.data.load import load
from geotween.story.captions import LEADS, MANY, told
from tests.conftest import WriteScene

Things = Mapping[str, tuple[float, float, float, float]]


def feature(name: str, box: tuple[float, float, float, float], key: bool) -> str:
    x0, y0, x1, y1 = box
    ring = f"[[{x0}, {y0}], [{x1}, {y0}], [{x1}, {y1}], [{x0}, {y1}]]"
    return f"{{{f'key: {name}, ' if key else ''}polygon: {ring}}}"


def caption(write_scene: WriteScene, here: Things, there: Things, *, keys: bool = True) -> str:
    """What is told of two steps, after the words about when it was."""
    steps = "".join(
        f"  - {{polygons: [{', '.join(feature(k, box, keys) for k, box in end.items())}]}}\n"
        for end in (here, there)
    )
    text = told(load(write_scene(f"title: t\nsteps:\n{steps}")))[1]
    assert text.startswith("From 1 to 2, ")
    return text.removeprefix("From 1 to 2, ")


def row(count: int, width: float = 4) -> Things:
    """Squares beside each other, called a, b, c and so on."""
    return {chr(97 + k): (10 * k, 0, 10 * k + width, width) for k in range(count)}


def test_nothing_changed(write_scene: WriteScene) -> None:
    assert caption(write_scene, row(2), row(2)) == "nothing changed."


def test_the_largest_is_told_first_then_what_came_and_went(write_scene: WriteScene) -> None:
    here = {"a": (0, 0, 9, 9), "b": (10, 0, 18, 8), "c": (20, 0, 21, 1)}
    there = {"a": (0, 0, 9, 8), "b": (10, 0, 18, 6), "d": (30, 0, 31, 1)}
    assert caption(write_scene, here, there) == (
        "a shrank by 11%; d appeared; c vanished. One other area shrank."
    )
    assert LEADS == 3


def test_a_split_names_its_parts_and_a_merger_its_sources(write_scene: WriteScene) -> None:
    whole: Things = {"a": (0, 0, 9, 9)}
    halves: Things = {"b": (0, 0, 4, 9), "c": (5, 0, 9, 9)}
    assert caption(write_scene, whole, halves) == "a split into b and c."
    assert caption(write_scene, halves, whole) == "a merged from b and c."


def test_many_parts_are_counted(write_scene: WriteScene) -> None:
    parts: Things = {f"p{k}": (k, 0, k + 1, 1) for k in range(6)}
    assert caption(write_scene, {"a": (0, 0, 6, 1)}, parts) == "a split into six parts."


def test_what_lives_on_splits_off_and_merges_with_others(write_scene: WriteScene) -> None:
    whole: Things = {"a": (0, 0, 10, 1)}
    parted: Things = {"a": (0, 0, 8, 1), "b": (8.5, 0, 10, 1)}
    assert caption(write_scene, whole, parted) == "a shrank by 20% and split off b."
    assert caption(write_scene, parted, whole) == "a grew by 25% and merged with b."


def test_a_new_name_is_told(write_scene: WriteScene) -> None:
    here, there = {"a": (0.0, 0.0, 4.0, 4.0)}, {"b": (0.0, 0.0, 4.0, 6.0)}
    assert caption(write_scene, here, there) == "a became b and grew by 50%."


def test_growth_beyond_three_times_is_told_as_a_multiple(write_scene: WriteScene) -> None:
    here, there = {"a": (0.0, 0.0, 4.0, 1.0)}, {"a": (0.0, 0.0, 4.0, 3.4)}
    assert caption(write_scene, here, there) == "a grew to 3.4 times its area."
    assert caption(write_scene, there, here) == "a shrank by 71%."


def test_a_move_is_told_with_its_direction(write_scene: WriteScene) -> None:
    here, there = {"a": (0.0, 0.0, 4.0, 4.0)}, {"a": (9.0, 0.0, 13.0, 4.0)}
    assert caption(write_scene, here, there) == "a moved to the right."


def test_things_without_names_are_the_largest_and_others(write_scene: WriteScene) -> None:
    here, there = row(3), {**row(3, 5), "z": (90.0, 0.0, 91.0, 1.0)}
    there["a"] = (0.0, 0.0, 6.0, 6.0)
    assert caption(write_scene, here, there, keys=False) == (
        "the largest area grew by 125%. One other area appeared and two other areas grew."
    )


def test_equals_without_names_are_counted(write_scene: WriteScene) -> None:
    assert caption(write_scene, {}, row(3), keys=False) == "three areas appeared."


@pytest.mark.parametrize("changed", [MANY, MANY + 1])
def test_many_changes_are_summed_up(write_scene: WriteScene, changed: int) -> None:
    count = MANY + 4
    there = {**row(count), **{k: v for k, v in row(count, 5).items() if ord(k) < 97 + changed}}
    text = caption(write_scene, row(count), there)
    assert text == (
        "nine of twelve areas changed: nine areas grew."
        if changed > MANY
        else "a grew by 56%; b grew by 56%; c grew by 56%. Five other areas grew."
    )


def test_one_that_outweighs_many_is_told_with_them(write_scene: WriteScene) -> None:
    here = {**row(MANY + 1), "z": (0.0, 20.0, 100.0, 80.0)}
    there = {**row(MANY + 1, 5), "z": (0.0, 20.0, 100.0, 90.0)}
    assert caption(write_scene, here, there) == (
        "all ten areas changed: z grew by 17%; nine other areas grew."
    )
