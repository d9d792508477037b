"""Tidy sets: what is told, in which step, and how often."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from shapely.geometry import Polygon, box

from geotween.data.polygons import Feature
from geotween.data.problems import Problem
from geotween.data.tidy.tidy import tidy
from geotween.scene.model import Map

GALE, STORM, HURRICANE = box(0, 0, 9, 9), box(2, 2, 7, 7), box(3, 3, 5, 5)


def winds(*shapes: Polygon) -> list[Feature]:
    return [
        Feature(shape, name=f"{kt} kt", attributes={"kt": kt, "id": f"{shape.area}{kt}", "x": 1})
        for kt, shape in zip((34, 50, 64), shapes, strict=False)
    ]


def told(*steps: list[Feature], scale: float = 100, **words: object) -> list[Problem]:
    labels = [str(1990 + n) for n in range(len(steps))]
    return tidy(steps, [], labels, Map(**words), scale).problems  # type: ignore[arg-type]


def test_what_happens_in_many_steps_is_told_once_in_the_worst_with_the_sum() -> None:
    small = winds(GALE, HURRICANE)
    (problem,) = told(small, winds(GALE, STORM, HURRICANE), small, winds(GALE))
    assert problem.steps == ("1991",)
    assert problem.message == (
        "3 pairs of overlapping features without a key were joined: most of all 34 kt and 50 kt, "
        "and less in 2 other steps: 1990, 1992"
    )
    assert (problem.measure, problem.unit) == (4 + (25 + 4 + 4) + 4, "square map units in all")


def test_steps_are_listed_up_to_eight() -> None:
    (problem,) = told(*[winds(GALE, STORM)] * 11)
    assert problem.message.endswith("and less in 10 other steps: 1991, 1992, 1993, 1994, 1995, "
                                    "1996, 1997, 1998, …")  # fmt: skip


def test_column_of_levels_is_one_whose_values_recur() -> None:
    smaller = winds(box(0, 0, 8, 8), STORM)
    (problem,) = told(winds(GALE, STORM), smaller)
    assert problem.hint.endswith("is named: class: kt")


def test_overlap_too_thin_for_the_page_is_a_note() -> None:
    shapes = [box(0, 0, 4, 4), box(3.99, 0, 8, 4)]
    features = [Feature(shape, key) for key, shape in enumerate(shapes)]
    assert [p.severity for p in told(features, scale=40)] == ["note"]
    assert [p.severity for p in told(features, scale=100)] == ["warning"]


LENS = Polygon([(4, 0), (8, 0), (8, 4), (4, 4), (4, 3), (4.01, 2), (4, 1)])
LEFT = Polygon([(0, 0), (4, 0), (4, 1), (4, 3), (4, 4), (0, 4)])
RIGHT = Polygon([(4, 0), (8, 0), (8, 4), (4, 4), (4, 3), (4, 1)])


@pytest.mark.parametrize("clean", [False, True])
def test_gap_is_told_in_the_step_that_has_one(clean: bool) -> None:
    sound, torn = ([Feature(LEFT, 1), Feature(other, 2)] for other in (RIGHT, LENS))
    (problem,) = told(sound, torn, clean=clean)
    assert problem.steps == ("1991",)
    assert problem.severity == "note"
    assert problem.measure == pytest.approx(0.01)
    assert problem.message == (
        "1 polygon fitted to their neighbours" if clean else "a narrow gap between neighbours"
    )


def test_gap_wider_than_two_pixels_is_meant() -> None:
    torn = [Feature(LEFT, 1), Feature(LENS, 2)]
    assert told(torn, torn, scale=300) == []


def test_cleaning_closes_a_gap_that_is_open_at_the_coast() -> None:
    torn = [Feature(box(0, 0, 4, 4), 1), Feature(box(4.01, 0, 8, 4), 2)]
    found = tidy([torn], [], ["1990"], Map(clean=True, simplify=0), 100).steps[0]
    shapes = np.array([feature.geometry for feature in found])
    assert shapely.coverage_is_valid(shapes)
    assert shapely.union_all(shapes).area == pytest.approx(32, abs=1e-3)
