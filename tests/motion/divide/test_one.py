"""The public division: all techniques keep its promises, and it refuses what it cannot divide."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import affinity
from shapely.geometry import MultiPolygon, Polygon, box

import geotween
from tests.motion.divide.partitions import (
    COMB,
    HARD,
    SQUARE,
    TECHNIQUES,
    areas,
    assert_partition,
)
from tests.motion.shapes import blobs, star, tiles

TWO = [box(0, 0, 3, 8), box(5, 0, 8, 8)]


@pytest.mark.parametrize("technique", TECHNIQUES)
@pytest.mark.parametrize("case", HARD)
def test_hard_ones_are_partitions_into_connected_pieces(case: str, technique: str) -> None:
    polygon, others = HARD[case]()
    pieces = geotween.divide(polygon, others, technique)
    assert len(pieces) == len(others)
    assert_partition(polygon, pieces)


@pytest.mark.parametrize("technique", TECHNIQUES)
@pytest.mark.parametrize("case", ["a comb", "a ring", "overlapping", "200 of them"])
def test_hard_ones_are_partitions_into_parts_where_asked(case: str, technique: str) -> None:
    polygon, others = HARD[case]()
    assert_partition(polygon, geotween.divide(polygon, others, technique, connected=False), False)


@pytest.mark.parametrize("technique", TECHNIQUES)
def test_what_reaches_round_another_is_in_parts_or_connected(technique: str) -> None:
    # Both teeth's tips are nearest to the bar above: two parts, of which the right one is larger.
    bar, base = box(-1, 4, 9, 7), box(0, -1, 9, 1)
    teeth = Polygon([*COMB.exterior.coords[:6], (5, 5.9), (4.1, 5.9), *COMB.exterior.coords[8:]])
    apart, _ = geotween.divide(teeth, [bar, base], technique, connected=False)
    one, _ = geotween.divide(teeth, [bar, base], technique)
    assert isinstance(apart, MultiPolygon)
    assert isinstance(one, Polygon)
    assert one.area < apart.area


def test_one_correspondent_gets_everything() -> None:
    assert geotween.divide(COMB, [box(0, 0, 1, 1)]) == [COMB]


@pytest.mark.parametrize("technique", TECHNIQUES)
def test_the_same_pieces_whatever_the_order(technique: str) -> None:
    others = [star(7, i, 2, *place) for i, place in enumerate([(2, 2), (6, 2), (4, 6), (7, 7)])]
    order = [2, 0, 3, 1]
    pieces = geotween.divide(SQUARE, others, technique)
    again = geotween.divide(SQUARE, [others[k] for k in order], technique)
    for k, piece in zip(order, again, strict=True):
        assert piece.normalize().equals(pieces[k].normalize())


@pytest.mark.parametrize("technique", ["territory", "voronoi"])
@pytest.mark.parametrize(
    "change",
    [
        lambda p: affinity.rotate(p, 33, origin=(3, 1)),
        lambda p: affinity.scale(p, -1, 1, origin=(0, 0)),
        lambda p: affinity.scale(p, 1e9, 1e9, origin=(0, 0)),
        lambda p: affinity.scale(p, 1e-9, 1e-9, origin=(0, 0)),
        lambda p: affinity.translate(p, 1000, -500),
    ],
    ids=["turned", "reflected", "a billion times", "a billionth", "moved"],
)
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_what_is_done_to_all_is_done_to_the_pieces(change: Any, technique: str, seed: int) -> None:
    polygon, others = star(30, seed, 5, 5, 5), tiles(6, seed)
    pieces = [change(p) for p in geotween.divide(polygon, others, technique)]
    again = geotween.divide(change(polygon), [change(p) for p in others], technique)
    assert areas(again) == pytest.approx(areas(pieces), rel=1e-3)
    assert sum(areas(again)) == pytest.approx(change(polygon).area, rel=1e-9)


outlines = st.builds(star, st.integers(3, 60), st.integers(0, 999), st.just(5.0), st.just(5.0))
others = st.one_of(
    st.builds(tiles, st.integers(2, 9), st.integers(0, 999)),
    st.builds(blobs, st.integers(2, 7), st.integers(0, 999)),
)


@settings(max_examples=40)
@given(outlines, others, st.sampled_from(TECHNIQUES), st.booleans())
def test_divisions_are_partitions(
    polygon: Polygon, correspondents: list[Polygon], technique: str, connected: bool
) -> None:
    if correspondents:
        pieces = geotween.divide(polygon, correspondents, technique, connected)
        assert_partition(polygon, pieces, connected)


def test_the_same_input_gives_the_same_bytes() -> None:
    first, again = (geotween.divide(star(50, 1, 5), tiles(5, 2)) for _ in range(2))
    assert shapely.to_wkb(first).tolist() == shapely.to_wkb(again).tolist()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"technique": "scissors"}, "unknown technique 'scissors'; expected one of territory"),
        ({"technique": "voronoi", "weights": [1, 2]}, "voronoi takes no weights"),
        ({"smooth": True}, "territory has no smooth"),
        ({"weights": [1]}, "1 weights for 2 correspondents"),
        ({"weights": [1, 0]}, "above 0"),
        ({"weights": [1, np.nan]}, "above 0"),
        ({"weights": "length"}, 'numbers or "area"'),
    ],
)
def test_options_it_does_not_have(options: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        geotween.divide(SQUARE, TWO, **options)


@pytest.mark.parametrize(
    ("polygon", "correspondents", "message"),
    [
        (Polygon(), TWO, "the polygon is empty"),
        (SQUARE, [], "one correspondent at least"),
        (SQUARE, [Polygon(), SQUARE], "a correspondent is empty"),
        (Polygon([(0, 0), (1, 1), (1, 0), (0, 1)]), TWO, "the polygon is not valid"),
    ],
)
def test_geometries_it_refuses(polygon: Any, correspondents: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        geotween.divide(polygon, correspondents)


def test_other_things_than_polygons() -> None:
    with pytest.raises(TypeError, match="a correspondent is a Point"):
        geotween.divide(SQUARE, [SQUARE.centroid, SQUARE])  # type: ignore[list-item]
    with pytest.raises(TypeError, match="the polygon is a MultiPolygon"):
        geotween.divide(MultiPolygon([SQUARE]), TWO)  # type: ignore[arg-type]
