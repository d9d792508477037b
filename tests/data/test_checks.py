"""What a scene says and its data do not bear out."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import geotween
from geotween.scene.errors import SceneError

Write = Callable[..., Path]
POND = "{key: a, class: pond, polygon: [[0, 0], [4, 0], [4, 4]]}"
BARE = "[[0, 0], [4, 0], [4, 4]]"


def told(write: Write, head: str, first: str = POND, second: str = POND) -> list[str]:
    text = f"title: t\n{head}\nsteps:\n  - {{polygons: [{first}]}}\n  - {{polygons: [{second}]}}\n"
    return [str(problem) for problem in geotween.load(write(text)).problems]


def test_a_style_for_a_class_that_is_there_is_no_doubt(write_scene: Write) -> None:
    assert told(write_scene, "style: {class: {pond: {fill: red}}, key: {a: {width: 2}}}") == []


@pytest.mark.parametrize("word", ["class", "key"])
def test_a_style_that_no_feature_answers_to(write_scene: Write, word: str) -> None:
    known = {"class": "pond", "key": "a"}[word]
    assert told(write_scene, f"style: {{{word}: {{lake: {{fill: red}}}}}}") == [
        f'warning: style for the {word} "lake", which no feature has; there are {known}'
    ]


def test_a_style_by_class_where_nothing_has_one(write_scene: Write) -> None:
    (only,) = told(write_scene, "style: {class: {lake: {fill: red}}}", BARE, BARE)
    assert only.endswith('"lake", which no feature has; no feature has a class')


def test_correspondence_by_key_without_keys(write_scene: Write) -> None:
    (only,) = told(write_scene, "motion: {correspondence: key}", BARE, BARE)
    assert only.startswith("warning: correspondence by key, but no feature has a key")
    assert told(write_scene, "motion: {correspondence: key}") == []


def test_time_that_runs_backwards(write_scene: Write) -> None:
    steps = "".join(f"  - {{time: {t}, polygons: [{BARE}]}}\n" for t in (1990, 1980, 1985))
    problems = geotween.load(write_scene(f"title: t\nsteps:\n{steps}")).problems
    assert [(p.kind, p.severity, p.steps) for p in problems] == [
        ("time order", "note", ("1990", "1980"))
    ]


def test_data_much_higher_than_wide_need_a_page_size(write_scene: Write) -> None:
    tall = "[[0, 0], [1, 0], [1, 1000]]"
    with pytest.raises(SceneError, match="more than 20 times as high as wide"):
        told(write_scene, "", tall, tall)
    assert told(write_scene, "map: {height: 900}", tall, tall) == []


@pytest.mark.parametrize("style", ["{fill: #c1440e}", "\n  fill: #c1440e\n  width: 2"])
def test_a_colour_without_quotes_is_told(write_scene: Write, style: str) -> None:
    with pytest.raises(SceneError) as caught:
        told(write_scene, f"style: {style}")
    (fault,) = caught.value.faults
    assert fault.hint == '# begins a comment: a colour needs quotes, "#c1440e"'


def test_a_comment_after_a_key_is_a_comment(write_scene: Write) -> None:
    assert told(write_scene, "subtitle: # to be written\nstyle: # add colours") == []
