"""What changes in place and what is swept, from where: small pictures, then any tiling."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely.geometry import Polygon, box

import geotween
from geotween.data.polygons import Feature, Identity, PolygonSet, polygon_set
from geotween.motion.front.changes import changes
from geotween.motion.front.plane import INNER, NEUTRAL, NONE, NOTHING, SINK, SOURCE, Change
from tests.motion.front.test_plane import transformed
from tests.motion.shapes import tiles
from tests.real_data import needs_real_data, write_scene

Step = Sequence[tuple[str, Polygon]]
Named = tuple[object, object]  # the keys of a thing at both ends


def keyed(step: Step) -> PolygonSet:
    return polygon_set(Feature(polygon, key=key) for key, polygon in step)


def unkeyed(*polygons: Polygon) -> PolygonSet:
    return polygon_set(Feature(polygon) for polygon in polygons)


def strip(keys: str, rows: str = "") -> Step:
    """A row of unit squares, one for each letter; squares of one letter are one polygon or more."""
    found = []
    for key in dict.fromkeys(keys.replace(".", "") + rows.replace(".", "")):
        cells = [box(x, 0, x + 1, 1) for x, letter in enumerate(keys) if letter == key]
        cells += [box(x, 1, x + 1, 2) for x, letter in enumerate(rows) if letter == key]
        found += [(key, part) for part in shapely.get_parts(shapely.union_all(cells))]
    return found


def key_of(identity: Identity | None) -> object:
    return None if identity is None else identity.key


def names(change: Change) -> list[Named]:
    return [(key_of(thing.origin), key_of(thing.target)) for thing in change.things]


def story(change: Change) -> dict[tuple[Named | None, Named | None], float]:
    """The area of what each thing keeps, (a, a), and of what it gives to another, (a, b)."""
    named: list[Named | None] = [*names(change), None]
    found: Counter[tuple[Named | None, Named | None]] = Counter()
    for before, after, face in zip(change.before, change.after, change.plane.faces, strict=True):
        found[named[before], named[after]] += face.area
    return dict(found)


def sides(change: Change, role: int) -> list[tuple[float, ...]]:
    """The middles of the edges that have a role for one of their sides."""
    chosen = (change.roles == role).any(axis=1)
    middles = change.plane.points[change.plane.edges[chosen]].mean(axis=1)
    return sorted(map(tuple, middles.tolist()))


def told(origin: str, target: str, annexation: str = "sweep") -> dict[str, float]:
    """The story of two strips in short: ``ab`` for a thing, ``ab>cd`` for what it gives."""
    change = changes(keyed(strip(origin)), keyed(strip(target)), annexation)
    found = {}
    for pair, area in story(change).items():
        words = ["" if n is None else f"{n[0] or '-'}{n[1] or '-'}" for n in pair]
        found[words[0] if pair[0] == pair[1] else ">".join(words)] = area
    return found


@pytest.mark.parametrize(
    ("origin", "target", "wanted"),
    [
        pytest.param("aa", "bb", {"ab": 2}, id="one to one: a new name"),
        pytest.param("aaa", "bcc", {"ab": 1, "ac": 2}, id="one to many: a splits into b and c"),
        pytest.param("abb", "ccc", {"ac": 1, "bc": 2}, id="many to one: a and b become c"),
        pytest.param("a.", "ab", {"aa": 1, ">-b": 1}, id="none to one: b is born beside a"),
        pytest.param("ab", "a.", {"aa": 1, "b->": 1}, id="one to none: b is gone beside a"),
        pytest.param("aabb", "abbb", {"aa": 1, "bb": 2, "aa>bb": 1}, id="b takes half of a"),
        pytest.param("abb", "aaa", {"aa": 1, "b->aa": 2}, id="a takes all of b: swept from a"),
        pytest.param("a.bb", "a.aa", {"aa": 1, "ba": 2}, id="a takes all of b, from no side"),
        pytest.param("aaa", "aba", {"aa": 2, "ab": 1}, id="b begins within a, in place"),
        pytest.param("aab.", "acb.", {"aa": 1, "ac": 1, "bb": 1}, id="c begins between a and b"),
        pytest.param("ab", "ba", {"ab": 1, "ba": 1}, id="a and b change places, in place"),
        pytest.param(
            "aabbc", "aabcc", {"aa": 2, "bb": 1, "cc": 1, "bb>cc": 1}, id="what is common rests"
        ),
        pytest.param(
            "aaabb", "ccbb.", {"ac": 2, "ac>bb": 1, "bb": 1, "bb>": 1},
            id="a is renamed c, and b moves on",
        ),
        pytest.param(
            "a.bbc", "aaaac", {"aa": 1, ">aa": 1, "b->aa": 2, "cc": 1},
            id="a takes b, running on through what was nothing",
        ),
    ],
)  # fmt: skip
def test_strips(origin: str, target: str, wanted: dict[str, float]) -> None:
    assert told(origin, target) == wanted


@pytest.mark.parametrize(
    ("origin", "target", "wanted"),
    [
        pytest.param("abb", "aaa", {"aa": 1, "ba": 2}, id="a takes all of b"),
        pytest.param("abbc", "aacc", {"aa": 1, "ba": 1, "bc": 1, "cc": 1}, id="a and c share b"),
        pytest.param("aabb", "abbb", {"aa": 1, "bb": 2, "aa>bb": 1}, id="b takes a part: swept"),
    ],
)
def test_annexation_in_place(origin: str, target: str, wanted: dict[str, float]) -> None:
    assert told(origin, target, "in-place") == wanted


def test_another_annexation_is_refused() -> None:
    with pytest.raises(ValueError, match="one of sweep, in-place"):
        changes(keyed([]), keyed([]), "by force")


def test_nothing_to_nothing() -> None:
    change = changes(keyed([]), keyed([]))
    assert (change.things, len(change.region), change.roles.shape) == ((), 0, (0, 2))


def test_a_border_that_moves_is_source_on_one_side_and_sink_on_the_other() -> None:
    change = changes(keyed(strip("aabb")), keyed(strip("abbb")))
    assert sides(change, SOURCE) == [(2, 0.5)]
    assert sides(change, SINK) == [(1, 0.5)]
    assert sides(change, NEUTRAL) == [(1.5, 0), (1.5, 1)]


def test_what_grows_has_itself_as_source_and_its_new_outline_as_sink() -> None:
    change = changes(keyed([("a", box(0, 0, 1, 1))]), keyed([("a", box(0, 0, 2, 1))]))
    assert sides(change, SOURCE) == [(1, 0.5)]
    assert sides(change, SINK) == [(1.5, 0), (1.5, 1), (2, 0.5)]


def test_what_shrinks_has_its_old_outline_as_source_and_what_stays_as_sink() -> None:
    change = changes(keyed([("a", box(0, 0, 2, 1))]), keyed([("a", box(0, 0, 1, 1))]))
    assert sides(change, SINK) == [(1, 0.5)]
    assert sides(change, SOURCE) == [(1.5, 0), (1.5, 1), (2, 0.5)]


def test_what_is_born_on_an_empty_plain_has_no_source() -> None:
    change = changes(keyed([]), keyed([("a", box(0, 0, 1, 1))]))
    assert change.region.tolist() == [0]
    assert sides(change, SOURCE) == []
    assert len(sides(change, SINK)) == 4


def test_a_hole_that_closes_is_swept_from_its_rim() -> None:
    ring = box(0, 0, 9, 9).difference(box(3, 3, 6, 6))
    change = changes(keyed([("a", ring)]), keyed([("a", box(0, 0, 9, 9))]))
    assert len(sides(change, SOURCE)) == 4
    assert sides(change, SINK) == []


def test_one_front_runs_on_from_region_to_region() -> None:
    #  a a c  ->  a c c    c takes what was a's beside it, and through that what was b's
    #  b b b      b c b
    change = changes(keyed(strip("bbb", "aac")), keyed(strip("bcb", "acc")))
    assert names(change) == [("b", "b"), ("a", "a"), ("c", "c")]
    assert change.region.max() == 1
    assert sides(change, SOURCE) == [(2, 1.5)]
    assert sides(change, SINK) == [(1, 0.5), (1, 1.5), (2, 0.5)]


def test_a_coast_that_recedes_while_its_country_splits_falls_to_both() -> None:
    #  a a  ->  b c    a strip of a, at the bottom, is lost
    #  a a      . .
    change = changes(keyed(strip("aa", "aa")), keyed(strip("..", "bc")))
    assert story(change)[("a", "b"), ("a", "b")] == 1
    assert story(change)[("a", "c"), ("a", "c")] == 1
    assert sides(change, SINK) == [(0.5, 1), (1.5, 1)]


def test_what_merges_takes_more_from_all_that_it_is_made_of() -> None:
    #  k k k  ->  s s k    a and b become s, and s takes what was k's above both
    #  a b k      s s k
    change = changes(keyed(strip("abk", "kkk")), keyed(strip("ssk", "ssk")))
    assert sides(change, SOURCE) == [(0.5, 1), (1.5, 1)]
    assert sides(change, SINK) == [(2, 1.5)]


@pytest.mark.parametrize(("target", "longest"), [("bbc", "b"), ("bcc", "c")])
def test_what_is_lost_belonged_to_what_it_borders_on_longest(target: str, longest: str) -> None:
    change = changes(keyed(strip("aaa", "aaa")), keyed(strip("...", target)))
    assert story(change)[("a", longest), None] == 3


@pytest.mark.parametrize(("target", "largest"), [("bbc", "b"), ("bcc", "c")])
def test_an_island_that_is_lost_belonged_to_the_largest_part(target: str, largest: str) -> None:
    change = changes(keyed(strip("aaa.a")), keyed(strip(target)))
    assert story(change)[("a", largest), None] == 1


def assert_consistent(change: Change, origin: PolygonSet, target: PolygonSet) -> None:
    """Faces have the keys of what covers them; regions and roles are what they are said to be."""
    inner = shapely.point_on_surface(change.plane.faces)
    for end, (polygons, cover) in enumerate([(origin, change.before), (target, change.after)]):
        holder, face = shapely.STRtree(inner).query(polygons.polygons, predicate="contains")
        assert sorted(face) == np.flatnonzero(cover != NOTHING).tolist()
        for number, place in zip(holder.tolist(), face.tolist(), strict=True):
            assert names(change)[cover[place]][end] == polygons.identities[number].key
    assert ((change.region == NOTHING) == (change.before == change.after)).all()
    for region in range(change.region.max(initial=NOTHING) + 1):
        faces = np.flatnonzero(change.region == region)
        assert len({(change.before[f], change.after[f]) for f in faces}) == 1
        parts = shapely.get_parts(shapely.coverage_union_all(change.plane.faces[faces]))
        assert len(parts) == 1
    for edge, roles in zip(change.plane.sides.tolist(), change.roles.tolist(), strict=True):
        for (mine, other), role in zip((edge, edge[::-1]), roles, strict=True):
            assert_role(change, mine, other, role)


def assert_role(change: Change, mine: int, other: int, role: int) -> None:
    before, after, region = (
        [*a.tolist(), NOTHING] for a in (change.before, change.after, change.region)
    )
    if region[mine] == NOTHING:
        assert role == NONE
        return
    assert (role == INNER) == (region[mine] == region[other])
    rests = region[other] == NOTHING
    if rests and before[other] == after[mine]:
        assert role == SOURCE
    if rests and before[other] == before[mine]:
        assert role == SINK
    if not rests:
        assert role in (INNER, NEUTRAL)


def assert_reached(change: Change) -> None:
    """What one thing takes from another hangs together, as its, with a source."""
    sourced = set(change.plane.sides[change.roles == SOURCE].tolist())
    for after in range(len(change.things)):
        taken = np.flatnonzero((change.after == after) & (change.before != after))
        for part in shapely.get_parts(shapely.coverage_union_all(change.plane.faces[taken])):
            members = [f for f in taken if part.contains(change.plane.faces[f].point_on_surface())]
            between_things = [f for f in members if change.before[f] != NOTHING]
            assert not between_things or sourced & set(members)


def cells(count: int, seed: int, keys: str) -> PolygonSet:
    """A tiling whose cells bear some keys, several of them the same one; a few are missing."""
    rng = np.random.default_rng(seed)
    given_ = [(keys[rng.integers(len(keys))], tile) for tile in tiles(count, seed)]
    return keyed(given_[: max(1, count - int(rng.integers(0, 3)))])


tilings = st.tuples(st.integers(1, 9), st.integers(0, 10_000))


@given(tilings, tilings)
def test_any_two_keyed_tilings(origin: tuple[int, int], target: tuple[int, int]) -> None:
    sets = cells(*origin, "abcde"), cells(*target, "cdefg")
    change = changes(*sets)
    assert_consistent(change, *sets)
    assert_reached(change)


@given(tilings, tilings, st.sampled_from([1e9, 1e-9]), st.sampled_from([17.3, 90.0]))
def test_the_story_turns_and_scales_with_the_map(
    origin: tuple[int, int], target: tuple[int, int], scale: float, degrees: float
) -> None:
    sets = cells(*origin, "abcde"), cells(*target, "cdefg")
    here = story(changes(*sets))
    moved = [
        PolygonSet(
            shapely.orient_polygons(np.array(transformed(s.polygons, degrees, scale), object)),
            s.identities,
        )
        for s in sets
    ]
    there = story(changes(*moved))
    assert there.keys() == here.keys()
    for pair, area in here.items():
        assert there[pair] == pytest.approx(area * scale**2, rel=1e-6)


@given(tilings, tilings, st.randoms())
def test_the_story_does_not_depend_on_the_order_of_polygons(
    origin: tuple[int, int], target: tuple[int, int], random: object
) -> None:
    sets = cells(*origin, "abcde"), cells(*target, "cdefg")
    turned = [PolygonSet(s.polygons[::-1], s.identities[::-1]) for s in sets]
    here, there = story(changes(*sets)), story(changes(*turned))
    assert there.keys() == here.keys()
    assert there == pytest.approx(here)


@needs_real_data
def test_a_nation_breaks_up_in_place_down_to_its_states(tmp_path: Path) -> None:
    steps = [s.regions for s in geotween.load(write_scene(tmp_path, "us_regions"))]
    found = [changes(*pair) for pair in pairwise(steps)]
    assert [len(change.things) for change in found] == [4, 9, 49]
    assert all(change.region.max() == NOTHING for change in found)


@needs_real_data
def test_counties_become_states_in_place(tmp_path: Path) -> None:
    counties, states = (
        s.regions for s in geotween.load(write_scene(tmp_path, "scale_us_counties"))
    )
    change = changes(counties, states)
    assert len(change.things) == len({i.key for i in counties.identities})
    assert all(t.origin and t.target and t.origin.class_ == t.target.key for t in change.things)
    assert change.region.max() == NOTHING
