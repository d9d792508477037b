"""Borders: what two pieces share at both ends is the same for both of them at any time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from shapely.affinity import rotate, translate
from shapely.geometry import Point, Polygon, box

from geotween.data.polygons import Feature, PolygonSet, polygon_set
from geotween.motion.borders import TiedRings, tied_rings
from geotween.motion.correspond import correspond
from geotween.motion.divide import NOBODY, Division, divide
from geotween.motion.interpolate import interpolate
from geotween.motion.match import match, points_at
from geotween.motion.neighbours import NOTHING, outlines
from geotween.motion.rings import MatchedPiece, Rings, next_vertex, rings_of
from geotween.motion.sweep import sweep
from geotween.motion.tracks import Track
from tests.motion.made import Transition, made
from tests.motion.shapes import hulls, seeds, star, tiles

Moving = dict[str, Polygon]
FRAME = box(-3, -3, 3, 3)
DISC = Point(0, 0).buffer(2, quad_segs=8)


def outline(count: int, seed: int, radius: float, x: float = 0, y: float = 0) -> Polygon:
    """A somewhat rough outline."""
    rng = np.random.default_rng(seed)
    angle = np.sort(rng.uniform(0, 2 * np.pi, count))
    reach = radius * rng.uniform(0.85, 1.1, count)
    return Polygon(np.column_stack([x + reach * np.cos(angle), y + reach * np.sin(angle)]))


ISLAND = outline(60, 1, 5)


def regions(polygons: Mapping[str, Polygon]) -> PolygonSet:
    return polygon_set(Feature(polygon, key=key) for key, polygon in polygons.items())


def division(origin: PolygonSet, target: PolygonSet, correspondence: str = "key") -> Division:
    return divide(correspond(origin, target, correspondence))


def matched(origin: Moving, target: Moving) -> tuple[MatchedPiece, ...]:
    return match(division(regions(origin), regions(target)), "trajectory").pieces


def moved(origin: Moving, target: Moving) -> tuple[Track, ...]:
    planned = match(division(regions(origin), regions(target)), "trajectory")
    return interpolate(planned, "regions", 1e-9)[0]


def edges(piece: MatchedPiece) -> NDArray[np.float64]:
    """The moving edges of a piece: both ends of each, at both ends of the transition, (n, 8)."""
    points = np.concatenate(piece.vertices, axis=1)
    return np.hstack([points, points[next_vertex(piece.offsets)]])


def shared(one: MatchedPiece, other: MatchedPiece) -> NDArray[np.float64]:
    """The moving edges that two pieces have in common, to the bit, from the side of the first."""
    back = {tuple(np.roll(edge, 4)) for edge in edges(other)}
    return np.array([edge for edge in edges(one) if tuple(edge) in back]).reshape(-1, 8)


def length(moving: NDArray[np.float64], end: int) -> float:
    way = moving[:, 4:] - moving[:, :4]
    return float(np.hypot(*way[:, 2 * end : 2 * end + 2].T).sum())


def parted(x: float, seed: int) -> Moving:
    """An island in two parts, with a crooked border near x."""
    rng = np.random.default_rng(seed)
    y = np.linspace(-7, 7, 15)
    west = Polygon([(-9, -7), *np.column_stack([x + rng.uniform(-0.5, 0.5, 15), y]), (-9, 7)])
    return {"west": ISLAND & west, "east": ISLAND - west}


def test_a_border_that_moves_is_the_same_for_both_and_nothing_crosses() -> None:
    origin, target = parted(-1, 1), parted(1.5, 2)
    border = shared(*matched(origin, target))
    for end, parts in enumerate((origin, target)):
        common = shapely.length(parts["west"] & parts["east"])
        assert length(border, end) == pytest.approx(common)
    assert sweep(moved(origin, target)).clean


def test_a_coast_that_one_part_has_at_both_ends_stays() -> None:
    origin, target = parted(-1, 1), parted(1.5, 2)
    for key, piece in zip(origin, matched(origin, target), strict=True):
        coast = origin[key].exterior & target[key].exterior.buffer(1e-9)
        moving = edges(piece)
        way = moving[:, [0, 1, 4, 5]] - moving[:, [2, 3, 6, 7]]
        still = np.abs(way).max(axis=1) < 1e-12
        assert length(moving[still], 0) == pytest.approx(coast.length)


def test_what_travels_together_stays_together() -> None:
    origin = parted(-0.5, 3)
    target = {key: rotate(p, 25, origin=(0, 0)) for key, p in parted(0.8, 4).items()}
    target = {key: translate(p, 14, 6) for key, p in target.items()}
    assert sweep(moved(origin, target)).clean


def test_an_enclave_fills_its_hole_at_any_time() -> None:
    origin, target = (
        {"around": ISLAND - inner, "enclave": inner}
        for inner in (outline(20, 5, 1.2), outline(25, 6, 1.2, 0.6, 0.4))
    )
    around, enclave = matched(origin, target)
    assert len(shared(around, enclave)) == len(enclave.seams)
    assert sweep(moved(origin, target)).clean


@pytest.mark.parametrize("turn", [0, 30])
def test_four_that_meet_in_another_way_open_a_gap_and_do_not_overlap(turn: float) -> None:
    west, east = Polygon([(-3, -3), (-1, 0), (-3, 3)]), Polygon([(3, -3), (3, 3), (1, 0)])
    north = Polygon([(-3, 3), (-1, 0), (1, 0), (3, 3)])
    one = {"w": west, "e": east, "n": north, "s": FRAME - west - east - north}
    other = {
        key: rotate(one[change], 90, (0, 0)) for key, change in zip("wsen", "nwse", strict=True)
    }
    ends = [{key: rotate(p, turn, (0, 0)) for key, p in end.items()} for end in (one, other)]
    assert sweep(moved(*ends)).clean
    half = [Polygon(track.at(0.5)).area for track in moved(*ends)]
    assert 34 < sum(half) < 36


def test_a_vertex_of_one_side_on_an_edge_of_the_other_is_both_sides_vertex() -> None:
    origin = {
        "low": box(0, 0, 4, 2),
        "left": box(0, 2, 1, 4),
        "right": Polygon([(1, 2), (3, 2), (4, 2), (4, 4), (1, 4)]),
    }
    target = {
        key: shapely.transform(p, lambda c: c + 0.2 * c[:, ::-1]) for key, p in origin.items()
    }
    low, left, right = matched(origin, target)
    assert length(shared(low, left), 0) == 1
    assert length(shared(low, right), 0) == 3
    assert [1, 2] in low.vertices[0].tolist()


@pytest.mark.parametrize(("turn", "still"), [(20, False), (90, True)])
def test_a_neighbour_that_goes_far_round_does_not_turn_what_stays(turn: float, still: bool) -> None:
    bar = box(0, -1.2, 3.5, 1.2)
    here, there = bar, rotate(bar, turn, (0, 0))
    disc, around = matched({"d": DISC, "b": here - DISC}, {"d": DISC, "b": there - DISC})
    assert (len(shared(disc, around)) == 0) == still
    way = np.hypot(*(disc.vertices[1] - disc.vertices[0]).T)
    assert (way.max() < 1e-12) == still


def test_without_neighbours_every_ring_is_matched_by_itself() -> None:
    apart = [star(20, 1), star(30, 2, x=5), star(25, 3, x=10)]
    touching = [box(20, 0, 22, 2), box(22, 0, 24, 3)]
    later = [shapely.transform(p, lambda c: c * 1.1 + [0.1, 0.2]) for p in [*apart, *touching]]
    one = {str(k): p for k, p in enumerate([*apart, *touching])}
    other = {str(k): p for k, p in enumerate(later)}
    together = matched(one, other)
    for key, piece in zip("012", together, strict=False):
        (alone,) = matched({key: one[key]}, {key: other[key]})
        assert (alone.vertices == piece.vertices).all()


def test_neighbours_at_one_end_only_are_matched_by_themselves() -> None:
    one = {"a": box(0, 0, 2, 2), "b": box(2, 0, 4, 3)}
    other = {"a": box(0, 0, 2, 2), "b": box(3, 0, 5, 3)}
    together = matched(one, other)
    for key, piece in zip("ab", together, strict=True):
        (alone,) = matched({key: one[key]}, {key: other[key]})
        assert (alone.vertices == piece.vertices).all()


@pytest.mark.parametrize("seed", range(5))
def test_cells_whose_corners_move_do_not_part(seed: int) -> None:
    origin, target = made("bordering", seed)
    tracks, _ = interpolate(match(division(origin, target), "trajectory"), "regions", 1e-9)
    assert sweep(tracks).clean
    frames = [[Polygon(track.at(t)) for track in tracks] for t in (0.25, 0.5, 0.75)]
    for cells in frames:
        assert shapely.union_all(cells).area == pytest.approx(shapely.area(cells).sum())
        assert shapely.area(cells).sum() == pytest.approx(shapely.area(origin.polygons).sum())


# What holds for all.

plans = st.one_of(
    st.builds(lambda n, m, s: (tiles(n, s), tiles(m, s + 1)), *[st.integers(2, 8)] * 2, seeds),
    st.builds(lambda n, m, s: (hulls(n, s), hulls(m, s + 1)), *[st.integers(2, 6)] * 2, seeds),
    st.builds(lambda n, m, s: (hulls(n, s), tiles(m, s + 1)), *[st.integers(2, 6)] * 2, seeds),
)


def planned(plan: Transition) -> Division:
    origin, target = (
        polygon_set(Feature(p, position=k) for k, p in enumerate(end)) for end in plan
    )
    return division(origin, target, "auto")


def ends_of(divided: Division) -> tuple[Rings, Rings]:
    """The outer rings of the pieces that have a partner, at both ends."""
    paired = (divided.indices != NOBODY).all(axis=1)
    one, other = (
        rings_of(shapely.polygons(shapely.get_exterior_ring(side[paired])))
        for side in (divided.origin_pieces, divided.target_pieces)
    )
    return one, other


def tied(ends: tuple[Rings, Rings]) -> Mapping[int, TiedRings]:
    return tied_rings(*ends, [(k, k) for k in range(len(ends[0].polygon_of))])


@given(plans)
def test_every_vertex_is_kept_in_order_and_on_its_ring(plan: Transition) -> None:
    ends = ends_of(planned(plan))
    for k, rings in tied(ends).items():
        for end, places, points in zip(
            ends, (rings.here, rings.there), rings.vertices, strict=True
        ):
            assert set(places[places == np.floor(places)]) == set(range(len(end[k])))
            steps = np.diff(np.append(places, places[0])) % len(end[k])
            assert steps.sum() == pytest.approx(len(end[k]))
            assert np.allclose(points_at(end[k], places), points, atol=1e-8)


def assert_same(
    one: Mapping[int, TiedRings], other: Mapping[int, TiedRings], turn: NDArray[np.float64]
) -> None:
    """The same ways, but for where they start, when one of them is turned."""
    assert set(one) == set(other)
    for k, rings in one.items():
        here, there = (np.hstack([*found]) for found in (rings.vertices @ turn, other[k].vertices))
        apart = np.abs(here[:, None] - there).max(axis=-1)
        nearest = max(apart.min(axis=0).max(), apart.min(axis=1).max())
        assert nearest < 1e-6 * np.abs(there).max()


@pytest.mark.parametrize("factor", [1e-9, 1.0, 1e9])
@given(st.integers(2, 8), st.integers(2, 8), seeds)
def test_turned_or_rescaled_the_motion_is_the_same(factor: float, n: int, m: int, s: int) -> None:
    turn = np.array([[0.6, 0.8], [-0.8, 0.6]]) * factor
    one, other = ends_of(planned((tiles(n, s), tiles(m, s + 1))))
    ends = (
        replace(one, vertices=one.vertices @ turn),
        replace(other, vertices=other.vertices @ turn),
    )
    assert_same(tied((one, other)), tied(ends), turn)


@given(st.integers(2, 8), st.integers(2, 8), seeds, st.integers(1, 5))
def test_it_does_not_matter_where_rings_start(n: int, m: int, s: int, by: int) -> None:
    one, other = ends_of(planned((tiles(n, s), tiles(m, s + 1))))
    rolled = [np.roll(one[k], by, axis=0) for k in range(len(one.polygon_of))]
    started = replace(one, vertices=np.concatenate(rolled))
    assert_same(tied((one, other)), tied((started, other)), np.eye(2))


@given(plans)
def test_edges_that_are_neighbours_run_back_along_each_other(
    plan: Transition,
) -> None:
    lines = outlines(rings_of(np.array(plan[0])))
    after = lines.vertices[next_vertex(lines.offsets)]
    known = np.flatnonzero(lines.beyond != NOTHING)
    assert (lines.beyond[lines.beyond[known]] == known).all()
    assert (after[lines.beyond[known]] == lines.vertices[known]).all()
    assert (lines.vertices[lines.beyond[known]] == after[known]).all()
