"""Map furniture: labels inside their regions, a true scale bar and graticule, legend, callouts."""

from __future__ import annotations

import re
from collections.abc import Callable
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
import shapely

import geotween
from geotween.export.build import plan_scene
from geotween.export.furniture.labels import SIZE
from geotween.export.furniture.multiples import multiples
from geotween.export.furniture.room import polygons_at
from geotween.export.furniture.text import text_width
from geotween.export.keyframes import Keyframes, keyframes
from geotween.export.page import keyframes_json
from geotween.export.resources import resource
from geotween.export.svg import animated_svg, still_svg
from geotween.export.words import words
from geotween.scene.errors import SceneError

Write = Callable[..., Path]
# A crescent that turns round: what is innermost in it goes from one side to the other.
CRESCENT = "[[0, 0], [60, 0], [60, 10], [20, 10], [20, 50], [60, 50], [60, 60], [0, 60]]"
TURNED = "[[60, 0], [60, 60], [0, 60], [0, 50], [40, 50], [40, 10], [0, 10], [0, 0]]"
# A hook that grows a bar on the other side of a bay: the straight way leads over the bay.
HOOK = "[[0, 0], [60, 0], [60, 20], [30, 20], [30, 60], [0, 60]]"
LONGER = "[[0, 0], [60, 0], [60, 60], [40, 60], [40, 20], [10, 20], [10, 60], [0, 60]]"
ATLANTIC = "[[-30, 30], [10, 30], [10, 60], [-30, 60]]"


def load(write: Write, steps: str, frame: str = "", top: str = "") -> Keyframes:
    scene = geotween.load(write(f"title: t\n{top}\nmap: {{{frame}}}\nsteps: [{steps}]\n"))
    return keyframes(scene, plan_scene(scene)[0])


def step(*features: str, label: str = "") -> str:
    said = f"label: {label}, " if label else ""
    return f"{{{said}polygons: [{', '.join(features)}]}}"


def feature(polygon: str, **words: str) -> str:
    said = "".join(f"{name}: {value}, " for name, value in words.items())
    return f"{{{said}polygon: {polygon}}}"


def box(x: float, y: float, width: float, height: float) -> str:
    return f"[[{x}, {y}], [{x + width}, {y}], [{x + width}, {y + height}], [{x}, {y + height}]]"


def covered(frames: Keyframes, span: int, key: str, t: float) -> shapely.Geometry:
    """What the regions of a key cover, in px."""
    tracks = [
        track
        for shape in frames.spans[span][1]
        if shape.slot.kind == "region" and shape.slot.key == key
        for track in shape.tracks
        if track.life[0] <= t <= track.life[1]
    ]
    return shapely.union_all(shapely.make_valid([p for k in tracks for p in polygons_at(k, t)]))


def places(way: tuple[tuple[float, float, float], ...], moments: np.ndarray) -> np.ndarray:
    times, x, y = np.transpose(way)
    return np.column_stack([np.interp(moments, times, axis) for axis in (x, y)])


# ---- labels ----


@pytest.mark.parametrize("method", ["morph", "front"])
def test_a_label_lies_inside_its_region_at_every_moment(write_scene: Write, method: str) -> None:
    one = [feature(HOOK, key="c", name="C"), feature(box(90, 0, 30, 60), key="d", name="Dee")]
    other = [feature(LONGER, key="c", name="C"), feature(box(100, 20, 30, 70), key="d", name="Dee")]
    found = load(write_scene, f"{step(*one)}, {step(*other)}", top=f"motion: {{method: {method}}}")
    assert {label.text for label in found.furniture.labels} == {"C", "Dee"}
    moments = np.linspace(0, 1, 101)
    for label in found.furniture.labels:
        for span, way in label.spans.items():
            for t, place in zip(moments, places(way, moments), strict=True):
                assert covered(found, span, label.key, float(t)).contains(shapely.Point(place))


def test_labels_of_the_territory_lie_inside_and_apart() -> None:
    scene = geotween.load(resource("scenes") / "territory.yaml")
    found = keyframes(scene, plan_scene(scene)[0])
    moments = np.linspace(0, 1, 21)
    assert len(found.furniture.labels) >= 3
    for span in range(len(found.spans)):
        shown = [label for label in found.furniture.labels if span in label.spans]
        ways = {label.text: places(label.spans[span], moments) for label in shown}
        for label in shown:
            for t, place in zip(moments, ways[label.text], strict=True):
                region = covered(found, span, label.key, float(t))
                assert region.contains(shapely.Point(place)), (label.text, span, t)
        for a, b in combinations(ways, 2):
            width = (text_width(a, SIZE) + text_width(b, SIZE)) / 2
            apart = np.abs(ways[a] - ways[b]) >= [width, SIZE]
            assert apart.any(axis=1).all(), (a, b, span)


def test_a_label_stays_where_nothing_moves(write_scene: Write) -> None:
    still = step(feature(box(0, 0, 90, 60), key="a", name="Alpha"))
    (label,) = load(write_scene, f"{still}, {still}").furniture.labels
    assert label.spans[0] == label.spans[1] == label.spans[2]
    assert len(label.spans[1]) == 1


def test_a_region_too_small_for_its_text_has_no_label(write_scene: Write) -> None:
    large, small = feature(box(0, 0, 99, 99), name="Large"), feature(box(120, 0, 1, 1), name="S")
    found = load(write_scene, f"{step(large, small)}, {step(large, small)}")
    assert [label.text for label in found.furniture.labels] == ["Large"]


def test_of_two_labels_that_would_collide_the_larger_regions_stays(write_scene: Write) -> None:
    rows = feature(box(5, 0, 90, 1.7), name="Short"), feature(box(0, 1.7, 100, 1.7), name="Long")
    found = load(write_scene, f"{step(*rows)}, {step(*rows)}")
    assert [label.text for label in found.furniture.labels] == ["Long"]


def test_a_label_that_would_have_to_leap_is_hidden_on_the_way(write_scene: Write) -> None:
    steps = (step(feature(shape, key="c", name="C")) for shape in (CRESCENT, TURNED))
    (label,) = load(write_scene, ", ".join(steps)).furniture.labels
    assert list(label.spans) == [0, 2]


def test_a_label_is_hidden_while_its_region_takes_another_name(write_scene: Write) -> None:
    before, after = (step(feature(box(0, 0, 9, 9), key="a", name=n)) for n in ("Old", "New"))
    found = load(write_scene, f"{before}, {after}").furniture.labels
    assert {label.text: list(label.spans) for label in found} == {"Old": [0], "New": [2]}


@pytest.mark.parametrize(("named", "expected"), [("none", []), ("keys", ["k1"]), ("names", ["N"])])
def test_labels_as_the_scene_says(write_scene: Write, named: str, expected: list[str]) -> None:
    still = step(feature(box(0, 0, 9, 9), key="k1", name="N"))
    found = load(write_scene, f"{still}, {still}", f"labels: {named}").furniture.labels
    assert [label.text for label in found] == expected


def test_more_names_than_an_atlas_has_room_for_are_not_labelled_unasked(write_scene: Write) -> None:
    many = step(*(feature(box(20 * i, 0, 19, 19), name=f"n{i}") for i in range(13)))
    assert not load(write_scene, f"{many}, {many}").furniture.labels
    assert len(load(write_scene, f"{many}, {many}", "labels: names").furniture.labels) == 13


# ---- scale bar and graticule ----


@pytest.mark.parametrize("projection", ["auto", "EPSG:3857", "EPSG:3035"])
def test_the_scale_bar_is_true_at_the_centre(write_scene: Write, projection: str) -> None:
    pyproj = pytest.importorskip("pyproj")
    one = step(feature(ATLANTIC))
    frame = f'crs: "EPSG:4326", projection: "{projection}", scale_bar: true'
    scene = geotween.load(write_scene(f"title: t\nmap: {{{frame}}}\nsteps: [{one}, {one}]\n"))
    found = keyframes(scene, plan_scene(scene)[0])
    bar, page = found.furniture.scale_bar, found.page
    assert bar is not None
    half = np.array([bar.width / 2, 0])
    centre = np.array([page.width, page.height]) / 2
    ends = (np.array([centre - half, centre + half]) - page.shift) / page.scale
    back = pyproj.Transformer.from_crs(scene.crs, "EPSG:4326", always_xy=True)
    (west, east), (south, north) = back.transform(*ends.T)
    metres = pyproj.Geod(ellps="WGS84").inv(west, south, east, north)[2]
    said = float(bar.words.split("\xa0")[0]) * 1000
    assert metres == pytest.approx(said, rel=1e-4)


def test_a_scale_bar_says_where_it_holds_or_is_left_out(write_scene: Write) -> None:
    pytest.importorskip("pyproj")
    one = step(feature(ATLANTIC))
    frame = 'crs: "EPSG:4326", projection: "EPSG:3857"'
    assert load(write_scene, f"{one}, {one}", frame).furniture.scale_bar is None
    small = step(feature("[[8, 44], [9, 44], [9, 45], [8, 45]]"))
    bar = load(write_scene, f"{small}, {small}", frame).furniture.scale_bar
    assert bar is not None
    assert "centre" not in bar.words
    wide = load(write_scene, f"{one}, {one}", frame + ", scale_bar: true").furniture.scale_bar
    assert wide is not None
    assert "at the centre" in wide.words


def test_a_unit_gives_planar_coordinates_a_scale_bar(write_scene: Write) -> None:
    one = step(feature(box(0, 0, 928, 500)))
    assert load(write_scene, f"{one}, {one}").furniture.scale_bar is None
    bar = load(write_scene, f"{one}, {one}", "unit: km").furniture.scale_bar
    assert bar is not None
    assert (bar.words, bar.width) == ("100\xa0km", pytest.approx(100))


def test_the_graticule_is_true_to_the_projection(write_scene: Write) -> None:
    pyproj = pytest.importorskip("pyproj")
    one = step(feature(ATLANTIC))
    frame = 'crs: "EPSG:4326", graticule: 10'
    scene = geotween.load(write_scene(f"title: t\nmap: {{{frame}}}\nsteps: [{one}, {one}]\n"))
    found = keyframes(scene, plan_scene(scene)[0])
    page = found.page
    back = pyproj.Transformer.from_crs(scene.crs, "EPSG:4326", always_xy=True)
    assert len(found.furniture.graticule) >= 6
    for line in found.furniture.graticule:
        points = line * 0.1
        assert (points >= -0.1).all()
        assert (points <= [page.width + 0.1, page.height + 0.1]).all()
        lon, lat = back.transform(*((points - page.shift) / page.scale).T)
        off = min(np.abs(v - 10 * np.rint(v / 10)).max() for v in (lon, lat))
        assert off < 0.02  # degrees: less than a third of a pixel


# ---- legend, tips, annotations ----


def test_a_legend_lists_classes_that_differ_in_colour(write_scene: Write) -> None:
    both = step(
        feature(box(0, 0, 9, 9), **{"class": "a"}), feature(box(20, 0, 9, 9), **{"class": "b"})
    )
    found = load(write_scene, f"{both}, {both}").furniture.legend
    assert [entry.label for entry in found] == ["a", "b"]
    assert len({entry.fill for entry in found}) == 2
    same = load(write_scene, f"{both}, {both}", top='style: {fill: "#111111"}')
    assert same.furniture.legend == ()
    named = load(write_scene, f"{both}, {both}", "legend: {b: Bees}").furniture.legend
    assert [entry.label for entry in named] == ["Bees"]


def test_a_tip_that_never_changes_is_told_once(write_scene: Write) -> None:
    names = ("One", "One", "Two")
    steps = ", ".join(
        step(
            feature(box(0, 0, 9, 9), key="a", name="A"), feature(box(20, 0, 9, 9), key="b", name=n)
        )
        for n in names
    )
    tips = keyframes_json(load(write_scene, steps))["tips"]
    assert [list(of_step) for of_step in tips] == [["a", "b"], ["b"], ["b"]]
    assert [of_step["b"]["name"] for of_step in tips] == list(names)


def test_an_annotation_is_shown_in_its_steps_only(write_scene: Write) -> None:
    one, two = (step(feature(box(0, 0, 100, 60)), label=n) for n in ("One", "Two"))
    notes = 'annotations: [{text: "<b>", at: [50, 30], steps: [Two]}]'
    found = load(write_scene, f"{one}, {two}", notes)
    first, second = (still_svg(found, "t", number) for number in (0, 1))
    assert 'data-steps="1"' in first
    assert 'visibility="hidden"' in first.split('class="annotation"')[1]
    assert "visibility" not in second
    assert "&lt;b&gt;" in second
    (callout,) = found.furniture.callouts
    assert callout.dot == tuple(found.page.pixels(np.array([[50.0, 30.0]]))[0])


def test_an_annotation_at_a_corner_keeps_its_words_on_the_page(write_scene: Write) -> None:
    one = step(feature(box(0, 0, 100, 60)))
    corners = ", ".join(f"{{text: some words, at: [{x}, {y}]}}" for x in (0, 100) for y in (0, 60))
    found = load(write_scene, f"{one}, {one}", f"annotations: [{corners}]")
    for callout in found.furniture.callouts:
        left, top, right, bottom = callout.box
        assert left >= 0
        assert top >= 0
        assert right <= found.page.width
        assert bottom <= found.page.height


def test_longitude_and_latitude_of_an_annotation_are_projected(write_scene: Write) -> None:
    pytest.importorskip("pyproj")
    one = step(feature(ATLANTIC))
    notes = 'crs: "EPSG:4326", annotations: [{text: x, at: [-10, 45]}]'
    (callout,) = load(write_scene, f"{one}, {one}", notes).furniture.callouts
    assert callout.dot[0] == pytest.approx(480, abs=1)  # the map's middle meridian


@pytest.mark.parametrize(
    ("frame", "message"),
    [
        ("labels: nmaes", '2:15: no feature has a column "nmaes"'),
        ("legend: {water: W}", '"water" is no class, key or layer'),
        ("graticule: auto", "a graticule needs"),
        ("scale_bar: true", "a scale bar needs"),
        ("tooltip: [owner]", 'no feature has a column "owner"'),
        ("annotations: [{text: x, at: [0, 0], steps: [Noon]}]", 'no step is called "Noon"'),
        ("annotations: [{text: x, at: [0]}]", "expected a place"),
        ("annotations: [{text: x, at: [0, 0], offset: 3}]", "expected px"),
        ("graticule: 0", "expected auto, none, or degrees"),
    ],
)
def test_furniture_that_cannot_be_is_a_fault_at_its_place(
    write_scene: Write, frame: str, message: str
) -> None:
    one = step(feature(box(0, 0, 9, 9)))
    with pytest.raises(SceneError) as caught:
        geotween.load(write_scene(f"title: t\nmap: {{{frame}}}\nsteps: [{one}, {one}]\n"))
    assert message in str(caught.value)


# ---- drawn ----


def test_layers_above_are_drawn_over_the_regions(write_scene: Write) -> None:
    one = step(feature(box(0, 0, 9, 9)))
    layers = f"layers: [{{name: under, polygons: [{box(0, 0, 5, 5)}]}}, "
    layers += f"{{name: over, above: true, polygons: [{box(0, 0, 5, 5)}]}}]"
    found = load(write_scene, f"{one}, {one}", layers)
    for svg in (still_svg(found, "t"), animated_svg(found, "t", "", words(found, "t", ""))):
        order = [svg.index(mark) for mark in ('"under"', 'class="stage"', '"over"')]
        assert order == sorted(order)


def test_a_page_in_arabic_runs_from_right_to_left(write_scene: Write) -> None:
    one = step(feature(box(0, 0, 100, 60)))
    notes = "annotations: [{text: x, at: [10, 30]}]"
    found = load(write_scene, f"{one}, {one}", notes, top="lang: ar")
    svg = animated_svg(found, "t", "", words(found, "t", ""))
    assert 'direction="rtl"' in svg.split('class="words"')[1]
    assert 'text-anchor="end"' in svg.split('class="annotation"')[1]  # begins at the line, in rtl


def test_small_multiples_are_coarse_and_what_touches_goes_on_touching(write_scene: Write) -> None:
    wave = [[x, 30 + (5 if x == 50 else 0.05 * (-1) ** x)] for x in range(101)]
    below, above = ([*wave, [100, end], [0, end]] for end in (0, 60))
    both = step(*(feature(str(p), key=k) for k, p in (("a", below), ("b", above))))
    svg = multiples(load(write_scene, f"{both}, {both}", "simplify: off"), "t")[0]
    rings = [np.array(re.findall(r"-?\d+", r), int) for r in re.findall(r"M([^z]*)z", svg)]
    one, other = (
        {(x, y) for x, y in np.cumsum(ring.reshape(-1, 2), axis=0).tolist() if 60 < y < 120}
        for ring in rings
    )
    assert one == other
    assert 3 < len(one) < 30
