"""Keyframes: paths by key and paint, seams, backings, ghosts, and what the page is told of them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import geotween
from geotween.export.build import plan_scene
from geotween.export.decoded import tracks_told
from geotween.export.keyframes import Keyframes, keyframes
from geotween.export.page import keyframes_json
from geotween.export.paint import PALETTE, RAMP
from geotween.export.svg import animated_svg
from geotween.export.words import words

Write = Callable[..., Path]
WHOLE = "{class: whole, polygon: [[0, 0], [8, 0], [8, 8], [0, 8]]}"
LEFT = "{class: left, polygon: [[0, 3], [1, 3], [1, 5], [0, 5]]}"
RIGHT = "{class: right, polygon: [[7, 3], [8, 3], [8, 5], [7, 5]]}"
SPLIT = (
    f"motion: {{method: morph}}\nsteps: [{{polygons: [{WHOLE}]}}, {{polygons: [{LEFT}, {RIGHT}]}}]"
)


def frames(write: Write, text: str) -> Keyframes:
    scene = geotween.load(write(f"title: t\n{text}\n"))
    return keyframes(scene, plan_scene(scene)[0])


def kinds(of: Keyframes, span: int) -> list[tuple[str, str]]:
    return [(s.slot.kind, s.paints[0].fill) for s in of.spans[span][1]]


def test_classes_take_the_palette_in_order_of_appearance(write_scene: Write) -> None:
    found = frames(write_scene, SPLIT)
    assert kinds(found, 0) == [("region", PALETTE[0])]
    assert kinds(found, 2) == [("region", PALETTE[1]), ("region", PALETTE[2])]


def test_key_before_class_before_all(write_scene: Write) -> None:
    style = 'style: {fill: "#111111", class: {b: {fill: "#222222"}}, key: {z: {fill: "#333333"}}}'
    a, b, c = (f"polygon: [[{x}, 0], [{x + 1}, 0], [{x + 1}, 1]]" for x in (0, 2, 4))
    listed = f"[{{key: x, {a}}}, {{key: y, class: b, {b}}}, {{key: z, class: b, {c}}}]"
    found = frames(write_scene, f"{style}\nsteps: [{{polygons: {listed}}}, {{polygons: []}}]")
    assert [fill for _, fill in kinds(found, 0)] == ["#111111", "#222222", "#333333"]


def test_a_split_into_two_colours_has_two_paths_that_turn(write_scene: Write) -> None:
    shapes = frames(write_scene, SPLIT).spans[1][1]
    turning = [tuple(p.fill for p in s.paints) for s in shapes if s.slot.kind == "region"]
    assert turning == [(PALETTE[0], PALETTE[1]), (PALETTE[0], PALETTE[2])]


def test_a_split_of_one_colour_is_one_path(write_scene: Write) -> None:
    text = 'style: {fill: "#123456", stroke: none}\n' + SPLIT
    shapes = frames(write_scene, text).spans[1][1]
    assert [(s.slot.kind, len(s.tracks)) for s in shapes] == [("region", 2)]


def test_a_stroked_split_strokes_border_and_seam_apart(write_scene: Write) -> None:
    text = 'style: {fill: "#123456", stroke: black}\n' + SPLIT
    shapes = frames(write_scene, text).spans[1][1]
    assert [(s.slot.kind, s.slot.code) for s in shapes] == [
        ("region", 0), ("border", 0), ("seam", 1),
    ]  # fmt: skip
    assert not shapes[0].paints[0].stroked


def test_while_still_of_one_colour_the_parts_have_a_backing(write_scene: Write) -> None:
    (backing,) = (s for s in frames(write_scene, SPLIT).spans[1][1] if s.slot.kind == "backing")
    assert backing.show == (0.0, 0.05)
    assert backing.paints[0].fill == backing.paints[1].fill == PALETTE[0]


def test_a_ghost_keeps_the_origins_outline_during_the_transition(write_scene: Write) -> None:
    found = frames(write_scene, SPLIT.replace("{method", "{ghost: origin, method"))
    assert [k for k, _ in kinds(found, 0)] == ["region"]
    ghost = found.spans[1][1][-1]
    assert ghost.slot.kind == "ghost"
    assert np.array_equal(ghost.tracks[0].vertices, found.spans[0][1][0].tracks[0].vertices)
    assert found.slots()[-1].kind == "ghost"


def test_an_empty_step_shows_nothing(write_scene: Write) -> None:
    found = frames(write_scene, f"steps: [{{polygons: [{WHOLE}]}}, {{polygons: []}}]")
    assert [len(shapes) for _, shapes in found.spans] == [1, 1, 0]


def test_opacity_sits_on_the_group(write_scene: Write) -> None:
    style = "style: {opacity: 0.5, class: {right: {opacity: 0.2}}}\n"
    groups = [g["opacity"] for g in keyframes_json(frames(write_scene, style + SPLIT))["groups"]]
    assert [tuple(g) for g in groups] == [(0.5, 0.5), (0.5, 0.2), (0.2, 0.2)]


@pytest.mark.parametrize("span", [0, 1, 2])
def test_the_page_is_told_the_same_vertices(write_scene: Write, span: int) -> None:
    found = frames(write_scene, SPLIT)
    data = keyframes_json(found)
    told = tracks_told(data)
    for shape, written in zip(found.spans[span][1], data["spans"][span]["shapes"], strict=True):
        for track, number in zip(shape.tracks, np.cumsum(written["tracks"]), strict=True):
            for t in track.times:
                assert np.array_equal(told[number].at(t), track.at(t))
            assert told[number].rings == np.diff(track.offsets).tolist()


def test_what_does_not_change_is_one_path_of_the_svg_for_all_time(write_scene: Write) -> None:
    still = "[{key: a, polygon: [[0, 0], [8, 0], [8, 8]]}]"
    found = frames(write_scene, f"steps: [{{polygons: {still}}}, {{polygons: {still}}}]")
    svg = animated_svg(found, "t", "", words(found, "t", ""))
    assert svg.count('class="region"') == 1
    assert "animate" not in svg.split('class="words"')[0]


NESTED = (
    "steps: [{polygons: [{class: much, polygon: [[4, 4], [5, 4], [5, 5]]}, "
    "{class: little, polygon: [[0, 0], [9, 0], [9, 9], [0, 9]]}]}, {polygons: []}]"
)


def test_nested_classes_are_layers_from_light_to_dark(write_scene: Write) -> None:
    found = frames(write_scene, NESTED)
    slots = [slot for slot in found.slots() if slot.kind == "region"]
    assert [slot.group.layer for slot in slots] == ["little", "much"]
    fills = {shape.slot: shape.paints[0].fill for shape in found.spans[0][1]}
    assert [fills[slot] for slot in slots] == [RAMP[0], RAMP[-1]]


def test_a_ghost_lies_above_all_layers(write_scene: Write) -> None:
    found = frames(write_scene, f"motion: {{ghost: origin}}\n{NESTED}")
    assert [slot.group.layer for slot in found.slots()] == ["little", "much", "ghost"]
