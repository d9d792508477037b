"""Overlaps: who keeps what is shared, what stays as it was, and how it is told."""

from __future__ import annotations

import json
from collections.abc import Sequence

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely.affinity import affine_transform, rotate, translate
from shapely.geometry import MultiPolygon, Polygon, box

from geotween.data.polygons import Feature
from geotween.data.problems import Problem
from geotween.data.read.parse import Parser
from geotween.data.tidy.overlaps import separate
from geotween.data.tidy.repair import repair
from tests.data.shapes import polygons
from tests.real_data import files, needs_real_data

Shape = Polygon | MultiPolygon

LARGE, SMALL = box(0, 0, 4, 4), box(3, 1, 6, 3)


VALID = polygons().filter(lambda polygon: polygon.is_valid)  # a hole may lie outside

FINE = 2.0**-40


def keyed(*shapes: Shape) -> list[Feature]:
    return [Feature(shape, f"k{index}") for index, shape in enumerate(shapes)]


def cut(*shapes: Shape) -> list[Shape]:
    """What remains of each shape, all with keys of their own; none may vanish."""
    kept, _ = separate(keyed(*shapes))
    assert [f.key for f in kept] == [f"k{i}" for i in range(len(shapes))]
    return [f.geometry for f in kept]


def told(problems: Sequence[Problem]) -> list[tuple[str, str, str]]:
    return [(p.kind, p.severity, p.piece) for p in problems]


def same(one: Shape, other: Shape) -> bool:
    """Whether two shapes are the same set of points with the same vertices."""
    return bool(shapely.equals_exact(one, other, 1e-12, normalize=True))


def is_disjoint(shapes: Sequence[Shape], noise: float) -> bool:
    one, other = np.triu_indices(len(shapes), 1)
    listed = np.array(shapes, dtype=object)
    return bool((shapely.area(shapely.intersection(listed[one], listed[other])) <= noise).all())


def test_smaller_of_two_that_cross_keeps_the_corner_and_gets_its_vertices() -> None:
    large, small = cut(LARGE, SMALL)
    assert same(large, Polygon([(0, 0), (4, 0), (4, 1), (3, 1), (3, 3), (4, 3), (4, 4), (0, 4)]))
    assert small.equals(SMALL)
    assert {(4, 1), (4, 3)} <= set(small.exterior.coords)
    assert shapely.coverage_is_valid([large, small])


def test_crossing_that_no_number_can_name_is_the_same_on_both_sides() -> None:
    shapes = [rotate(LARGE, 10), rotate(SMALL, 25), rotate(box(1, 3, 3, 6), 7)]
    assert shapely.coverage_is_valid(cut(*shapes))


def test_later_of_two_of_one_size_keeps_what_they_share() -> None:
    one, other = cut(box(0, 0, 4, 4), box(2, 0, 6, 4))
    assert same(one, box(0, 0, 2, 4))
    assert other.area == 16


@pytest.mark.parametrize("angle", range(0, 90, 11))
def test_sizes_that_differ_by_rounding_only_are_the_same_size(angle: float) -> None:
    one, other = cut(rotate(box(0, 0, 4, 4), angle, (0, 0)), rotate(box(2, 0, 6, 4), angle, (0, 0)))
    assert (one.area, other.area) == (pytest.approx(8), pytest.approx(16))


def test_lake_within_its_country_becomes_a_hole_of_it() -> None:
    lake = box(1, 1, 2, 2)
    large, small = cut(LARGE, lake)
    assert same(large, LARGE.difference(lake))
    assert small is lake


def test_winds_within_winds_become_rings() -> None:
    strongest, strong = box(3, 3, 4, 4), box(2, 2, 5, 5)
    outer, middle, inner = cut(box(0, 0, 9, 9), strong, strongest)
    assert same(outer, box(0, 0, 9, 9).difference(strong))
    assert same(middle, strong.difference(strongest))
    assert inner is strongest


def test_where_three_overlap_the_smallest_keeps_it() -> None:
    shapes = [box(0, 0, 5, 5), box(2, 2, 6, 6), box(3, 1, 6, 4)]
    large, middle, small = cut(*shapes)
    assert small.equals(shapes[2])
    assert middle.equals(shapes[1].difference(shapes[2]))
    assert large.equals(shapes[0].difference(shapes[1]).difference(shapes[2]))


def test_what_is_cut_in_two_is_a_multipolygon() -> None:
    large, _ = cut(box(0, 0, 9, 2), box(4, -1, 5, 3))
    assert same(large, MultiPolygon([box(0, 0, 4, 2), box(5, 0, 9, 2)]))


def test_far_part_of_a_multipolygon_stays() -> None:
    islands = MultiPolygon([LARGE, box(20, 20, 21, 21)])
    large, _ = cut(islands, SMALL)
    assert same(large, islands.difference(SMALL))


def test_neighbour_of_a_cut_gets_the_vertices_that_it_puts_on_their_border() -> None:
    shapes = [LARGE, box(4, 0, 8, 4), box(3, 1, 4, 3)]
    kept = cut(*shapes)
    assert shapely.coverage_is_valid(kept)
    assert kept[1].equals(shapes[1])
    assert {(4, 1), (4, 3)} <= set(kept[1].exterior.coords)


def test_twins_with_keys_leave_the_later_one() -> None:
    kept, problems = separate(keyed(LARGE, SMALL, LARGE), step="1990")
    assert [f.key for f in kept] == ["k1", "k2"]
    assert told(problems) == [("overlap", "warning", ""), ("overlap", "warning", "k0")]
    assert "cover all of it" in problems[1].message
    assert all(p.steps == ("1990",) for p in problems)


def test_large_feature_that_smaller_ones_cover_is_named_as_lost() -> None:
    tiles = [box(x, y, x + 2, y + 2) for x in (0, 2) for y in (0, 2)]
    kept, problems = separate([Feature(LARGE, 7, name="The nation"), *keyed(*tiles)])
    assert [f.geometry for f in kept] == tiles
    assert told(problems)[1:] == [("overlap", "warning", "The nation")]


def test_hair_that_two_halves_leave_of_what_they_cover_is_nothing() -> None:
    shapes = [LARGE, box(0, 0, 1, 4), box(1 + 1e-12, 0, 4, 4)]
    kept, _ = separate(keyed(*(rotate(shape, 10, (0, 0)) for shape in shapes)))
    assert [f.key for f in kept] == ["k1", "k2"]


def test_features_without_key_become_one_along_a_chain() -> None:
    chain = [
        Feature(box(3 * i, 0, 3 * i + 4, 1), None, "fire", f"n{i}", 10 + i) for i in (0, 3, 1, 2)
    ]
    apart = Feature(box(20, 0, 21, 1), None, "fire", position=14)
    kept, problems = separate([apart, *chain], step="1990")
    assert kept[0] is apart
    assert kept[1].geometry.equals(box(0, 0, 13, 1))
    assert [(f.name, f.position, f.class_) for f in kept[1:]] == [("n0", 10, "fire")]
    assert told(problems) == [("overlap", "warning", "")]
    assert problems[0].measure == 3
    assert problems[0].message.startswith("3 pairs of overlapping features without a key")


def test_two_that_a_third_joins_count_as_one_when_sizes_are_compared() -> None:
    halves = [Feature(box(0, 0, 3, 2)), Feature(box(2, 0, 5, 2))]
    kept, problems = separate([*halves, Feature(box(1, 1, 4, 3.5), "k")])
    assert kept[0].geometry.equals(box(0, 0, 5, 2).difference(box(1, 1, 4, 3.5)))
    assert kept[1].geometry.equals(box(1, 1, 4, 3.5))
    assert [p.measure for p in problems] == [2, 4]


@pytest.mark.parametrize(
    "other",
    [Feature(SMALL, "k"), Feature(SMALL, None, "b"), Feature(SMALL)],
    ids=["one has a key", "classes differ", "one has no class"],
)
def test_all_others_are_cut(other: Feature) -> None:
    kept, problems = separate([Feature(LARGE, None, "a"), other])
    assert [f.geometry.area for f in kept] == [14, 6]
    (problem,) = problems
    assert problem.message == (
        "1 pair of overlapping features were cut apart: "
        f"polygon 1 and {'k' if other.key else 'polygon 2'}"
    )
    assert (problem.measure, problem.unit) == (2, "square map units")
    assert "the smaller keeps" in problem.hint


@pytest.mark.parametrize(("pixel", "severity"), [(0.21, "note"), (0.19, "warning")])
def test_overlap_that_the_page_cannot_show_is_cut_and_noted(pixel: float, severity: str) -> None:
    kept, problems = separate(keyed(LARGE, box(3.9, 0, 5, 4)), pixel=pixel)
    assert kept[0].geometry.bounds[2] == 3.9
    assert told(problems) == [("overlap", severity, "")]
    assert problems[0].measure == pytest.approx(0.4)


def test_overlap_that_shows_at_one_place_only_is_a_warning() -> None:
    wedge = Polygon([(4, 0), (8, 0), (8, 4), (3, 4)])
    assert told(separate(keyed(LARGE, wedge), pixel=1)[1]) == [("overlap", "warning", "")]
    assert told(separate(keyed(LARGE, wedge), pixel=2)[1]) == [("overlap", "note", "")]


@pytest.mark.parametrize(("deep", "count"), [(0.03, 2), (0.05, 1)])
def test_features_without_key_become_one_where_it_is_more_than_a_border(
    deep: float, count: int
) -> None:
    shapes = [LARGE, box(4 - deep, 0, 8 - deep, 4)]
    kept, problems = separate([Feature(shape) for shape in shapes])
    assert len(kept) == count
    assert problems[0].message.startswith(
        "1 pair of overlapping features " + ("without a key" if count == 1 else "were cut")
    )
    assert sum(f.geometry.area for f in kept) == pytest.approx(32 - 4 * deep)


def levels(*shapes: Shape, key: bool = False, class_: str | None = None) -> str:
    features = [
        Feature(shape, f"k{n}" if key else None, class_, attributes={"kt": n, "storm": "Ida"})
        for n, shape in enumerate(shapes)
    ]
    return separate(features, columns=["kt", "storm"])[1][0].hint


def test_hint_names_the_column_that_tells_nested_levels_apart() -> None:
    nested, word = [LARGE, box(1, 1, 3, 3)], "stay whole where the column that tells them apart"
    assert levels(*nested).endswith(f"{word} is named: class: kt")
    assert levels(*nested, key=True).endswith(f"{word} is named: class: kt")
    assert word not in levels(*nested, class_="gale")
    assert word not in levels(LARGE, SMALL)  # a third of it lies in the large one


def test_overlap_thinner_than_numbers_can_tell_is_left_alone() -> None:
    features = keyed(LARGE, box(4 - 1e-9, 0, 5, 4), Polygon([(0, 4), (4, 4 - 1e-9), (2, 6)]))
    kept, problems = separate(features)
    assert all(a is b for a, b in zip(kept, features, strict=True))
    assert problems == []


def test_what_a_cut_leaves_thinner_than_numbers_can_tell_is_dropped() -> None:
    large, _ = cut(box(0, 0, 10, 4), box(5, -1, 10 - 1e-9, 5))
    assert same(large, box(0, 0, 5, 4))


def test_tiling_comes_back_as_it_was() -> None:
    tiles = keyed(*(box(x, y, x + 1, y + 1) for x in range(4) for y in range(4)))
    kept, problems = separate(tiles)
    assert all(a is b for a, b in zip(kept, tiles, strict=True))
    assert problems == []


def test_nothing_passes() -> None:
    assert separate([]) == ([], [])


def test_two_tilings_over_each_other_share_nothing_even_where_each_fits() -> None:
    # In the middle both fit their own neighbours edge by edge.
    fine = [box(x, y, x + 1, y + 1) for x in range(9) for y in range(9)]
    coarse = [translate(box(2 * x, 2 * y, 2 * x + 2, 2 * y + 2), 0.5, 0.5)
              for x in range(4) for y in range(4)]  # fmt: skip
    kept, _ = separate(keyed(*fine, *coarse))
    assert [f.key for f in kept] == [f"k{i}" for i in range(81)]


@st.composite
def stacks(draw: st.DrawFn) -> list[Polygon]:
    """Rectangles on a small grid, with a vertex at each of its points or not: many common edges."""
    sides = st.tuples(st.integers(0, 4), st.integers(0, 4)).filter(lambda ab: ab[0] < ab[1])
    drawn = draw(st.lists(st.tuples(sides, sides, st.booleans()), min_size=1, max_size=8))
    shapes = [(box(x[0], y[0], x[1], y[1]), dense) for x, y, dense in drawn]
    return [shapely.segmentize(shape, 1) if dense else shape for shape, dense in shapes]


def check_rule(shapes: list[Polygon]) -> None:
    """Every polygon keeps what no smaller one, or later one of its size, has too."""
    kept, problems = separate(keyed(*shapes))
    found = {f.key: f.geometry for f in kept}
    size = max(shape.area for shape in shapes)
    assert shapely.is_valid(list(found.values())).all()
    assert is_disjoint(list(found.values()), 1e-9 * size)
    order = sorted(range(len(shapes)), key=lambda i: (shapes[i].area, -i))
    covered: Shape = Polygon()
    for index in order:
        # On a grid: without one GEOS errs where two shapes differ by rounding only.
        rest = shapes[index].difference(covered, grid_size=FINE)
        kept_here = found.get(f"k{index}", Polygon())
        apart = shapely.symmetric_difference(kept_here, rest, grid_size=FINE).area
        assert apart <= 1e-9 * size
        covered = covered.union(shapes[index], grid_size=FINE)
    overlaps = covered.area < sum(shape.area for shape in shapes) - 1e-9 * size
    assert bool(problems) == overlaps


@given(stacks())
def test_stack_of_rectangles_falls_apart_by_the_rule(shapes: list[Polygon]) -> None:
    check_rule(shapes)


@given(st.lists(VALID, min_size=1, max_size=7))
def test_random_polygons_fall_apart_by_the_rule(shapes: list[Polygon]) -> None:
    check_rule(shapes)


@given(VALID, VALID)
def test_cut_has_the_same_vertices_on_both_sides(one: Polygon, other: Polygon) -> None:
    kept, problems = separate(keyed(one, other))
    assert not problems or shapely.coverage_is_valid([f.geometry for f in kept])


def test_twins_whose_overlay_without_a_grid_is_wrong_are_twins() -> None:
    one = [
        (33, 46),
        (3.4008528784648187, 5.637526652452025),
        (2.0418470418470416, 9.578643578643579),
    ]
    other = [one[0], (one[1][0], 5.637526652452026), (2.041847041847042, one[2][1])]
    kept, _ = separate(keyed(Polygon(one), Polygon(other)))
    assert [f.key for f in kept] == ["k1"]


@given(VALID, st.data())
def test_twins_that_differ_by_rounding_only_are_twins(shape: Polygon, data: st.DataObject) -> None:
    turned = rotate(shape, 10)
    points = shapely.get_coordinates(turned.exterior)[:-1]
    steps = st.lists(st.integers(-1, 1), min_size=points.size, max_size=points.size)
    nudged = points + np.spacing(points) * np.reshape(data.draw(steps), points.shape)
    kept, problems = separate(keyed(Polygon(points), Polygon(nudged)))
    assert [f.key for f in kept] == ["k1"]
    assert problems[0].measure == pytest.approx(Polygon(points).area, rel=1e-9)


@given(st.lists(VALID, min_size=1, max_size=7))
def test_random_polygons_without_key_become_their_union(shapes: list[Polygon]) -> None:
    kept, _ = separate([Feature(shape) for shape in shapes])
    geometries = [f.geometry for f in kept]
    assert is_disjoint(geometries, 1e-9)
    assert shapely.union_all(geometries).symmetric_difference(shapely.union_all(shapes)).area < 1e-6
    assert sum(isinstance(g, MultiPolygon) for g in geometries) == 0


@given(
    st.lists(VALID, min_size=2, max_size=6),
    st.sampled_from([(0, -1, 1, 0), (-1, 0, 0, 1), (1e9, 0, 0, 1e9), (1e-9, 0, 0, 1e-9)]),
)
def test_turned_mirrored_or_rescaled_map_is_cut_the_same_way(
    shapes: list[Polygon], way: tuple[float, float, float, float]
) -> None:
    unit = abs(way[0] + way[1]) ** 2
    before, problems = separate(keyed(*shapes))
    after, problems_after = separate(keyed(*(affine_transform(s, [*way, 0, 0]) for s in shapes)))
    assert told(problems) == told(problems_after)
    assert [f.key for f in before] == [f.key for f in after]
    areas = [f.geometry.area * unit for f in before]
    assert [f.geometry.area for f in after] == pytest.approx(areas, rel=1e-6)


@pytest.mark.parametrize("far", [1e3, 1e7, 1e9])
def test_far_from_the_origin_only_what_numbers_can_tell_counts(far: float) -> None:
    # The left one's side is straight; rounding bends the right one's at each vertex.
    right = shapely.segmentize(box(4, 0, 8, 4), 0.3)
    tiles = [rotate(tile, 10, (0, 0)) for tile in (LARGE, right)]
    features = keyed(*(translate(tile, far, far) for tile in tiles))
    kept, problems = separate(features)
    assert problems == []
    assert all(a is b for a, b in zip(kept, features, strict=True))
    large, small = cut(translate(LARGE, far, far), translate(SMALL, far, far))
    assert (large.area, small.area) == (pytest.approx(14), pytest.approx(6))


@given(st.lists(VALID, min_size=1, max_size=6))
def test_what_was_separated_once_stays(shapes: list[Polygon]) -> None:
    once, _ = separate(keyed(*shapes))
    twice, problems = separate(once)
    assert problems == []
    assert all(a is b for a, b in zip(once, twice, strict=True))


@needs_real_data
def test_counties_lose_nothing_but_slivers() -> None:
    text = files("scale_us_counties")[0].read_text(encoding="utf-8")
    counties, _ = repair(Parser(lambda *_: None).features(json.loads(text)))
    kept, problems = separate([Feature(f.geometry, i) for i, f in enumerate(counties)])
    assert len(kept) == len(counties) == 3230
    assert problems[0].message.startswith("10 pairs")
    changed = [i for i, f in enumerate(counties) if kept[i].geometry is not f.geometry]
    assert len(changed) == 9
    total = [shapely.area([f.geometry for f in fs]).sum() for fs in (counties, kept)]
    assert total[0] - total[1] == pytest.approx(problems[0].measure, rel=0.5)
