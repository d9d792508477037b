"""Coverages: when polygons are one, what is wrong along their borders, and how it is mended."""

from __future__ import annotations

import json
from collections.abc import Sequence

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from shapely.affinity import affine_transform, rotate, translate
from shapely.geometry import MultiPolygon, Polygon, box

from geotween.data.polygons import Feature
from geotween.data.read.parse import Parser
from geotween.data.tidy.coverage import clean_coverage, coverage_faults, looks_like_coverage
from geotween.data.tidy.repair import repair
from tests.real_data import files, needs_real_data

Shape = Polygon | MultiPolygon

WAYS = [(0, -1, 1, 0), (-1, 0, 0, 1), (1e9, 0, 0, 1e9), (1e-9, 0, 0, 1e-9)]
LEFT, RIGHT = box(0, 0, 4, 4), box(4, 0, 8, 4)
LACKING = Polygon([(4, 0), (8, 0), (8, 4), (4, 4), (4, 1)])  # a vertex that LEFT has not


def listed(*shapes: Shape) -> NDArray[np.object_]:
    return np.array(shapes, dtype=object)


def faults(*shapes: Shape) -> list[tuple[str, str, float]]:
    problems = coverage_faults(listed(*shapes))
    assert all(p.kind == "coverage" for p in problems)
    return [(p.severity, p.message.rpartition(", at ")[2], round(p.measure, 4)) for p in problems]


def cleaned(*shapes: Shape, gap_width: float = 0.1, snapping: float = 1e-6) -> list[Shape]:
    features = [Feature(shape, index) for index, shape in enumerate(shapes)]
    kept, _ = clean_coverage(features, gap_width=gap_width, snapping=snapping)
    return [feature.geometry for feature in kept]


@pytest.mark.parametrize(
    ("shapes", "expected"),
    [
        ([LEFT, RIGHT], True),
        ([LEFT, RIGHT, box(20, 20, 21, 21)], True),
        ([LEFT, LACKING], True),
        ([LEFT, box(4, 1, 8, 3)], True),
        ([LEFT, translate(RIGHT, 1e-6)], True),
        ([LEFT, translate(RIGHT, -1e-6)], True),
        ([box(0, 0, 9, 9) - box(2, 2, 4, 4), box(2, 2, 4, 4)], True),
        ([MultiPolygon([LEFT, box(20, 0, 21, 1)]), MultiPolygon([RIGHT, box(30, 0, 31, 1)])], True),
        ([], False),
        ([LEFT], False),
        ([LEFT, translate(RIGHT, 1)], False),
        ([LEFT, box(4, 4, 8, 8)], False),
        ([LEFT, Polygon([(4, 2), (8, 0), (8, 4)])], False),
        ([LEFT, translate(LEFT, 2, 2)], False),
        ([LEFT, LEFT], False),
        ([LEFT, box(0, 0, 2, 2)], False),
        ([MultiPolygon([LEFT, box(4, 4, 5, 5)])], False),
    ],
    ids=[
        "side by side", "and one apart", "vertex on one side only", "half a side",
        "narrow gap", "narrow overlap", "island in a lake", "in parts",
        "nothing", "one", "apart", "corner to corner", "corner to side",
        "over each other", "twins", "within along two sides", "parts of one",
    ],
)  # fmt: skip
def test_polygons_that_share_a_border_look_like_a_coverage(
    shapes: list[Shape], expected: bool
) -> None:
    for turn in (0, 90):
        assert looks_like_coverage(listed(*(rotate(s, turn, (0, 0)) for s in shapes))) is expected


def test_tiling_has_no_faults() -> None:
    assert faults(*(box(x, y, x + 1, y + 1) for x in range(3) for y in range(3))) == []


def test_polygons_over_each_other_are_no_coverage_and_have_no_faults() -> None:
    assert faults(LEFT, translate(LEFT, 2, 2)) == []


def test_vertex_that_one_side_lacks_is_noted() -> None:
    assert faults(LEFT, LACKING) == [("note", "2 polygons", 8)]


def test_narrow_gap_is_noted() -> None:
    assert faults(LEFT, RIGHT, translate(RIGHT, 4 + 1e-5)) == [("note", "2 polygons", 8)]


def test_strait_as_wide_as_maps_show_is_no_fault() -> None:
    assert faults(LEFT, RIGHT, translate(RIGHT, 4.01)) == []


def test_narrow_overlap_is_noted_and_a_deep_one_is_a_warning() -> None:
    narrow, deep = box(8 - 1e-6, 0, 12, 4), box(0, 4 - 0.5, 4, 8)
    assert [f[:2] for f in faults(LEFT, RIGHT, narrow)] == [("note", "2 polygons")]
    # The middle one is at fault on both sides.
    found = faults(LEFT, RIGHT, narrow, deep)
    assert [f[0] for f in found] == ["warning", "note"]


def test_bars_that_cross_overlap_though_no_vertex_of_one_lies_in_the_other() -> None:
    bars = [box(0, 11, 40, 12), box(7, 0, 8, 40)]
    found = faults(*bars, box(0, 40, 7, 44), box(7, 40, 8, 44))
    assert [f[:2] for f in found] == [("warning", "2 polygons")]


def test_faults_name_their_step_and_the_remedy() -> None:
    (problem,) = coverage_faults(listed(LEFT, LACKING), step="1990")
    assert str(problem) == (
        "note: 1990: common borders are not the same on both sides, at 2 polygons "
        "(8 map units of border); map: {clean: true} mends it"
    )


@pytest.mark.parametrize("way", WAYS)
def test_turned_mirrored_or_rescaled_map_has_the_same_faults(way: Sequence[float]) -> None:
    shapes = [LEFT, LACKING, box(0, 4 - 0.5, 4, 8), translate(RIGHT, 4 + 1e-5)]
    moved = [affine_transform(shape, [*way, 0, 0]) for shape in shapes]
    unit = abs(way[0] + way[1])
    expected = [(p.severity, p.message, pytest.approx(p.measure * unit))
                for p in coverage_faults(listed(*shapes))]  # fmt: skip
    found = coverage_faults(listed(*moved))
    assert [(p.severity, p.message, p.measure) for p in found] == expected
    assert len(found) == 2


def test_gap_that_a_page_shows_is_noted_with_its_area_and_its_step() -> None:
    lens = Polygon([(4, 0), (8, 0), (8, 4), (4, 4), (4, 3), (4.1, 2), (4, 1)])
    left = Polygon([(0, 0), (4, 0), (4, 1), (4, 3), (4, 4), (0, 4)])
    (problem,) = coverage_faults(listed(left, lens), gap_width=0.2, step="1990")
    assert str(problem) == (
        "note: 1990: a narrow gap between neighbours (0.1 square map units); "
        "map: {clean: true} closes what it can"
    )
    assert coverage_faults(listed(left, lens), gap_width=0.05, step="1990") == []


def test_open_gap_between_neighbours_is_closed_with_the_same_vertices_on_both_sides() -> None:
    shapes = [box(0, 0, 9, 4), box(0, 4.02, 3, 8), box(3, 4.02, 9, 8), box(20, 0, 21, 1)]
    filled = cleaned(*shapes, gap_width=0.1)
    assert shapely.coverage_is_valid(filled)
    assert sum(s.area for s in filled) == pytest.approx(9 * 8 + 1, abs=1e-3)
    assert shapely.union_all(filled[:3]).geom_type == "Polygon"
    assert filled[3] is shapes[3]


def test_gap_is_closed() -> None:
    ring = [box(0, 0, 9, 1), box(0, 1, 4, 3), box(4.05, 1, 9, 3), box(0, 3, 9, 4)]
    filled = cleaned(*ring)
    assert shapely.coverage_is_valid(filled)
    assert shapely.union_all(filled).equals(box(0, 0, 9, 4))


def test_gap_wider_than_asked_for_stays() -> None:
    ring = [box(0, 0, 9, 1), box(0, 1, 4, 3), box(5, 1, 9, 3), box(0, 3, 9, 4)]
    assert shapely.union_all(cleaned(*ring)).area == 34


def test_overlap_goes_to_one_of_the_two() -> None:
    shapes = cleaned(LEFT, box(3.9, 0, 8, 4))
    assert shapely.coverage_is_valid(shapes)
    assert sum(shape.area for shape in shapes) == pytest.approx(32)


def test_vertex_is_given_to_the_side_that_lacks_it() -> None:
    features = [Feature(LEFT, 1), Feature(LACKING, 2), Feature(box(20, 0, 21, 1), 3)]
    kept, problems = clean_coverage(features, gap_width=0, snapping=0, step="1990")
    assert (4, 1) in kept[0].geometry.exterior.coords
    assert kept[1] is features[1]
    assert kept[2] is features[2]
    assert problems == []  # no area changed hands


def test_coverage_that_fits_comes_back_as_it_was() -> None:
    tiles = [Feature(box(x, y, x + 1, y + 1), f"{x}{y}") for x in range(3) for y in range(3)]
    kept, problems = clean_coverage(tiles, gap_width=0.01, snapping=1e-6)
    assert all(a is b for a, b in zip(kept, tiles, strict=True))
    assert problems == []


def test_area_that_changed_hands_is_told() -> None:
    features = [Feature(LEFT, 1), Feature(box(3.9, 0, 8, 4), 2)]
    _, problems = clean_coverage(features, gap_width=0, snapping=0, step="1990")
    assert [(p.kind, p.severity, p.steps) for p in problems] == [("cleaned", "note", ("1990",))]
    assert problems[0].message == "1 polygon fitted to their neighbours"
    assert (problems[0].measure, problems[0].unit) == (
        pytest.approx(0.4),
        "square map units changed",
    )


def test_feature_that_its_neighbours_cover_is_left_out_and_named() -> None:
    features = [Feature(LEFT, 1), Feature(RIGHT, 2), Feature(LEFT, 3, name="Twin")]
    kept, problems = clean_coverage(features, gap_width=0, snapping=0)
    assert [f.key for f in kept] == [1, 2]
    assert [(p.severity, p.piece) for p in problems] == [("note", ""), ("warning", "Twin")]


def test_nothing_is_clean() -> None:
    assert clean_coverage([], gap_width=1, snapping=0) == ([], [])


def test_older_shapely_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(shapely, "coverage_clean")
    with pytest.raises(RuntimeError, match=r"needs shapely 2\.2"):
        clean_coverage([Feature(LEFT)], gap_width=0, snapping=0)


@given(st.data(), st.integers(2, 4), st.sampled_from([1e-9, 1e-5, 1e-3]))
def test_tiles_moved_a_little_fit_again(data: st.DataObject, size: int, shift: float) -> None:
    moves = st.lists(st.integers(-9, 9), min_size=2 * size**2, max_size=2 * size**2)
    way = np.reshape(data.draw(moves), (-1, 2)) / 9 * shift
    tiles = [box(x, y, x + 1, y + 1) for x in range(size) for y in range(size)]
    moved = [translate(tile, *by) for tile, by in zip(tiles, way, strict=True)]
    fitted = cleaned(*moved, gap_width=4 * shift, snapping=4 * shift)
    assert len(fitted) == len(tiles)
    assert shapely.coverage_is_valid(fitted, gap_width=4 * shift)
    assert (shapely.hausdorff_distance(fitted, tiles) < 8 * shift).all()


@needs_real_data
def test_counties_fit_after_cleaning() -> None:
    text = files("scale_us_counties")[0].read_text(encoding="utf-8")
    counties, _ = repair(Parser(lambda *_: None).features(json.loads(text)))
    before = listed(*(f.geometry for f in counties))
    assert [(p.severity, p.message[-11:]) for p in coverage_faults(before)] == [
        ("warning", " 2 polygons"), ("note", "12 polygons"),
    ]  # fmt: skip
    kept, problems = clean_coverage(counties, gap_width=0.004, snapping=1e-6)
    after = listed(*(f.geometry for f in kept))
    assert len(after) == 3230
    assert shapely.coverage_is_valid(after)
    assert shapely.is_valid(after).all()
    assert coverage_faults(after) == []
    assert [p.severity for p in problems] == ["note"]
    assert shapely.area(after).sum() == pytest.approx(shapely.area(before).sum(), rel=1e-7)
    assert sum(a is b for a, b in zip(before, after, strict=True)) > 3200
