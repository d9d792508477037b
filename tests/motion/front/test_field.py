"""When each place of the regions of change flips: pictures of single fronts and of borders."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from geotween.data.polygons import Feature, polygon_set
from geotween.mesh.fill import doubled_areas
from geotween.motion.front.borders import agreed, between
from geotween.motion.front.changes import changes
from geotween.motion.front.field import arrival
from geotween.motion.front.surface import source_and_sink, surface
from geotween.motion.groups import connected

DISC, LARGER = shapely.Point(0, 0).buffer(1), shapely.Point(0, 0).buffer(2)
LEFT_AND_RIGHT = {"a": shapely.box(0, 0, 2, 3), "b": shapely.box(2, 0, 4, 3)}
MOVED_RIGHT = {"a": shapely.box(0, 0, 2.5, 3), "b": shapely.box(2.5, 0, 4, 3)}


def fan(x, y):
    """Three tiles of a square that meet in a point."""
    return {
        "a": shapely.Polygon([(0, 0), (x, y), (0, 4)]),
        "b": shapely.Polygon([(0, 0), (4, 0), (4, 4), (x, y)]),
        "c": shapely.Polygon([(0, 4), (x, y), (4, 4)]),
    }


def parts(**features):
    return polygon_set(Feature(shape, key=key) for key, shape in features.items())


def field_of(origin, target, **options):
    change = changes(parts(**origin), parts(**target))
    return change, arrival(change, **options)


def areas_of(field):
    return doubled_areas(field.points, field.triangles) / 2


def swept(field, time, which=slice(None)):
    """The share of the area of some triangles whose time has come."""
    a, b, c = np.sort(field.times[which], axis=1).T
    pivot = np.isnan(c)
    c = np.where(pivot, b, c)
    with np.errstate(divide="ignore", invalid="ignore"):
        part = np.where(
            pivot,
            (time - a) / (c - a),
            np.where(
                time < b,
                (time - a) ** 2 / ((b - a) * (c - a)),
                1 - (c - time) ** 2 / ((c - b) * (c - a)),
            ),
        )
    part = np.where(time <= a, 0.0, np.where(time >= c, 1.0, part))
    area = areas_of(field)[which]
    return (part * area).sum() / area.sum()


def hangs_together(change, times, level, links):
    """Whether all that lies below a level hangs together with what is at 0, pivots left aside."""
    mesh = surface(change, None)
    at = np.full(mesh.count, np.nan)
    at[mesh.nodes] = times
    sides = [np.stack([mesh.nodes, np.roll(mesh.nodes, 1, axis=1)], axis=2).reshape(-1, 2)]
    sides = np.concatenate([*sides, getattr(mesh, links)])
    sides = sides[(at[sides] < level).all(axis=1)]
    group = connected(sides, mesh.count)
    below = np.flatnonzero(at < level)
    return set(group[below]) <= set(group[at == 0])


def times_at(field, place, reach=1e-9):
    """The times of the corners at a place."""
    near = np.hypot(*(field.points[field.triangles] - place).transpose(2, 0, 1)) < reach
    return field.times[near]


PAIRS = {
    "a disc grows": ({"f": DISC}, {"f": LARGER}),
    "a disc shrinks": ({"f": LARGER}, {"f": DISC}),
    "a border moves": (LEFT_AND_RIGHT, MOVED_RIGHT),
    "three tiles meet elsewhere": (fan(2, 2), fan(2.5, 2.2)),
    "a triangle is born": ({}, {"f": shapely.Polygon([(0, 0), (1, 0), (0, 1)])}),
    "a square vanishes": ({"f": shapely.box(0, 0, 1, 1)}, {}),
    "a fire runs through a gap into a pocket": (
        {"f": DISC},
        {
            "f": shapely.union_all(
                [
                    shapely.Point(0, 0).buffer(1.5),
                    shapely.box(0, -0.1, 4, 0.1),
                    shapely.Point(5, 0).buffer(1.5),
                ]
            )
        },
    ),
    "a hole closes": ({"f": LARGER.difference(DISC)}, {"f": LARGER}),
    "a sliver moves": (
        LEFT_AND_RIGHT,
        {"a": shapely.box(0, 0, 2 + 4e-6, 3), "b": shapely.box(2 + 4e-6, 0, 4, 3)},
    ),
    "squares touch at a corner": (
        {"f": shapely.box(0, 0, 1, 1)},
        {"f": shapely.MultiPolygon([shapely.box(0, 0, 1, 1), shapely.box(1, 1, 2, 2)])},
    ),
}


@pytest.fixture(params=PAIRS, scope="module")
def made(request):
    return field_of(*PAIRS[request.param])


def test_triangles_tile_the_regions_counter_clockwise(made):
    change, field = made
    changing = change.region >= 0
    regions = np.bincount(change.region[changing], shapely.area(change.plane.faces[changing]))
    assert areas_of(field).min() > 0
    assert np.bincount(field.region, areas_of(field)) == pytest.approx(regions, rel=1e-12)
    assert len(field.triangles) < 6000


def test_points_begin_with_those_of_the_plane_and_others_lie_on_its_edges(made):
    change, field = made
    plane = change.plane
    assert np.array_equal(field.points[: len(plane.points)], plane.points)
    on = field.edge >= 0
    assert not on[: len(plane.points)].any()
    start, end = plane.points[plane.edges[field.edge[on]]].transpose(1, 0, 2)
    assert np.array_equal(field.points[on], start + field.share[on, None] * (end - start))
    assert (field.share[~on] == 0).all()
    assert ((field.share[on] > 0) & (field.share[on] < 1)).all()


def test_fronts_run_from_first_to_last_and_nothing_flashes(made):
    _, field = made
    assert np.nanmin(field.times) == 0
    assert np.nanmax(field.times) == 1
    assert np.isnan(field.times).sum(axis=1).max() <= 1
    flat = np.nanmax(field.times, axis=1) - np.nanmin(field.times, axis=1) <= 0
    assert not flat.any()


def test_area_grows_evenly(made):
    _, field = made
    for time in np.linspace(0.05, 0.95, 19):
        assert swept(field, time) == pytest.approx(time, abs=0.01)


@pytest.mark.parametrize("level", [0.1, 0.3, 0.5, 0.7, 0.9])
def test_there_are_no_islands(made, level):
    change, field = made
    assert hangs_together(change, field.times, level, "gains")
    assert hangs_together(change, 1 - field.times, level, "losses")


def test_harmonic_fronts_are_as_sound():
    _, field = field_of(fan(2, 2), fan(2.5, 2.2), technique="harmonic")
    assert np.nanmin(field.times) == 0
    assert np.nanmax(field.times) == 1
    assert swept(field, 0.5) == pytest.approx(0.5, abs=0.01)


def test_another_technique_is_refused():
    with pytest.raises(ValueError, match="ratio, harmonic"):
        field_of({"f": DISC}, {"f": LARGER}, technique="magic")


def test_nothing_changes():
    _, field = field_of({"f": DISC}, {"f": DISC})
    assert field.triangles.shape == (0, 3)
    assert field.times.shape == (0, 3)


def test_a_border_sweeps_a_strip_in_straight_lines():
    _, field = field_of(LEFT_AND_RIGHT, MOVED_RIGHT)
    expected = (field.points[field.triangles][..., 0] - 2) / 0.5
    assert field.times == pytest.approx(expected, abs=2e-3)


def test_rings_grow_in_circles():
    _, field = field_of({"f": DISC}, {"f": LARGER})
    radius = np.hypot(*field.points[field.triangles].transpose(2, 0, 1))
    assert field.times == pytest.approx((radius**2 - 1) / 3, abs=0.02)


def test_a_birth_grows_in_circles_from_the_middle():
    _, field = field_of({}, {"f": DISC})
    radius = np.hypot(*field.points[field.triangles].transpose(2, 0, 1))
    assert field.times == pytest.approx(radius**2, abs=0.03)


def test_a_rectangle_closes_in_its_middle():
    hole = shapely.box(-1, -0.5, 1, 0.5)
    _, field = field_of({"f": LARGER.difference(hole)}, {"f": LARGER})
    last = field.points[field.triangles][field.times == 1]
    assert np.abs(last).max() < 0.1


def test_levels_end_where_source_and_sink_meet():
    _, field = field_of(fan(2, 2), fan(2.5, 2.2))
    for corner in ((0, 0), (0, 4), (4, 4)):
        assert np.isnan(times_at(field, corner)).all()
    for place, time in (((2, 2), 0), ((2.5, 2.2), 1)):
        times = times_at(field, place)
        assert times[~np.isnan(times)] == pytest.approx(time)


def test_times_agree_across_the_borders_of_regions_that_share_a_thing():
    change, field = field_of(fan(2, 2), fan(2.5, 2.2))
    mesh = surface(change, None)
    at = np.full(mesh.count, np.nan)
    at[mesh.nodes] = field.times
    links = np.concatenate([mesh.gains, mesh.losses])
    one, other = at[links].T
    # Where fronts set out or end on one side only, no time suits both.
    meeting = ((at[links] > 0) & (at[links] < 1)).all(axis=1)
    assert meeting.sum() >= len(links) - 6 > 20
    assert one[meeting] == pytest.approx(other[meeting], abs=1e-12)


def test_what_differs_at_a_border_is_made_to_agree_and_fades_out_within_the_regions():
    change = changes(parts(**fan(2, 2)), parts(**fan(2.5, 2.2)))
    mesh = surface(change, None)
    source, sink = source_and_sink(mesh)
    values = between(0.3 + 0.1 * mesh.of_nodes(mesh.region), source, sink)
    found = agreed(mesh, mesh.points, values, source, sink)
    for links, extreme in ((mesh.gains, np.minimum), (mesh.losses, np.maximum)):
        free = links[~(source | sink)[links].any(axis=1)]
        once = free[np.bincount(free.ravel())[free].max(axis=1) == 1]
        one, other = found[free].T
        assert one == pytest.approx(other, abs=1e-12)
        assert len(once) > 5
        assert found[once[:, 0]] == pytest.approx(extreme(*values[once].T))
    changed = np.abs(found - values)
    beside = np.isin(mesh.nodes, np.concatenate([mesh.gains, mesh.losses])).any(axis=1)
    beyond = ~np.isin(mesh.nodes, mesh.nodes[beside]).any(axis=1)
    assert changed[mesh.nodes[beside]].mean() > 10 * changed[mesh.nodes[beyond]].mean()
    assert changed[mesh.nodes[beyond]].max() > 0.01


def test_a_spot_fire_waits_its_turn():
    large, small = shapely.Point(1.5, 0).buffer(2.6), shapely.Point(6, 0).buffer(0.2)
    _, field = field_of({"f": DISC}, {"f": shapely.MultiPolygon([large, small])})
    spot = shapely.contains_xy(small, *field.points[field.triangles].mean(axis=1).T)
    assert field.times[~spot].min() == 0
    assert 0.5 < field.times[spot].min() < 1
    assert field.times[spot].max() == 1


def test_what_is_left_apart_goes_early():
    origin = shapely.MultiPolygon([LARGER, shapely.Point(6, 0).buffer(0.2)])
    _, field = field_of({"f": origin}, {"f": DISC})
    apart = field.points[field.triangles].mean(axis=1)[:, 0] > 3
    assert field.times[apart].min() == 0
    assert field.times[apart].max() < 0.5
    assert field.times[~apart].max() == 1


def test_fires_that_share_nothing_have_clocks_of_their_own():
    far = shapely.Point(9, 0)
    _, field = field_of({"f": DISC, "g": far.buffer(1)}, {"f": LARGER, "g": far.buffer(3)})
    right = field.points[field.triangles].mean(axis=1)[:, 0] > 4
    assert swept(field, 0.5, right) == pytest.approx(0.5, abs=0.01)
    assert swept(field, 0.5, ~right) == pytest.approx(0.5, abs=0.01)
