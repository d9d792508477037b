"""The advancing front: exact, conforming, with the polygon's own edges, and well shaped."""

from __future__ import annotations

from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import affinity
from shapely.geometry import MultiPolygon, Point, Polygon, box

from geotween.mesh.advancing_front import advancing_front
from geotween.mesh.fill import doubled_areas
from geotween.mesh.front_advance import orientation
from geotween.mesh.quality import GOOD, quality
from tests.mesh.outlines import blob, comb, made, pierced, real, rough, star
from tests.real_data import needs_real_data

PLATE = [(0, 0), (4, 0), (4, 4), (0, 4)]
PICTURES = {
    "triangle": Polygon([(0, 0), (1, 0), (0.3, 0.8)]),
    "square": box(0, 0, 1, 1),
    "clockwise": Polygon([(0, 0), (0, 2), (1, 2), (1, 1), (2, 1), (2, 0)]),
    "needle": Polygon([(0, 0), (1, 0), (1, 1e-9)]),
    "sliver": shapely.segmentize(box(0, 0, 1, 1e-6), 0.01),
    "doubled point": Polygon([(0, 0), (1, 0), (1, 0), (1, 1), (0, 0)]),
    "points on a line": shapely.segmentize(Polygon([(0, 0), (1, 0), (0.3, 0.8)]), 0.07),
    "one long edge, many short ones": shapely.union(box(0, 0, 9, 3), Point(9, 1.5).buffer(1.5, 60)),
    "hole": box(0, 0, 3, 3) - Point(1.4, 1.5).buffer(1),
    "hole at a corner of the shell": Polygon(PLATE, [[(0, 0), (1, 2), (2, 1)]]),
    "holes touch each other": Polygon(PLATE, [[(1, 1), (2, 2), (1, 3)], [(2, 2), (3, 1), (3, 3)]]),
    "a hole touches within an edge": Polygon(PLATE, [[(2, 0), (3, 1), (1, 1)]]),
    "two touch at one place": Polygon(
        PLATE, [[(2, 0), (3, 1), (2, 2)], [(2, 0), (1.5, 2), (1, 1)]]
    ),
    "star": star(5, 0.3, 0.2),
    "comb": comb(4, 0.7),
}


def areas_of(mesh):
    return doubled_areas(mesh.points, mesh.triangles) / 2


def sides_of(mesh):
    """How often each directed side occurs, by the places of its ends."""
    sides = np.stack([mesh.triangles, np.roll(mesh.triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    return Counter((tuple(a), tuple(b)) for a, b in mesh.points[sides].tolist())


def edges_of(polygon):
    """The boundary's edges, as they run with the polygon at their left."""
    edges = set()
    for part in shapely.get_parts([shapely.orient_polygons(polygon)]):
        for ring in shapely.get_rings(part):
            places = [tuple(place) for place in shapely.get_coordinates(ring).tolist()]
            edges |= {(a, b) for a, b in pairwise(places) if a != b}
    return edges


def assert_fills(mesh, polygon, *, edges=None):
    """Nothing inverted, area exact, each side of two triangles or an edge of the boundary."""
    corners = mesh.points[mesh.triangles].reshape(-1, 6).tolist()
    assert all(orientation(*places) == 1 for places in corners)
    assert areas_of(mesh).sum() == pytest.approx(polygon.area, rel=1e-12)
    sides = sides_of(mesh)
    assert max(sides.values()) == 1
    rim = {(a, b) for a, b in sides if (b, a) not in sides}
    assert rim == (edges_of(polygon) if edges is None else edges)
    assert len(np.unique(mesh.triangles)) == len(mesh.points)


@pytest.mark.parametrize("name", [n for n in PICTURES if "touch" not in n])
def test_triangles_fill_the_polygon(name):
    assert_fills(advancing_front(PICTURES[name]), PICTURES[name])


def test_holes_that_touch_at_a_vertex_share_it():
    polygon = PICTURES["holes touch each other"]
    mesh = advancing_front(polygon)
    assert_fills(mesh, polygon)
    assert (mesh.points == (2, 2)).all(axis=1).sum() == 1


@pytest.mark.parametrize("name", ["a hole touches within an edge", "two touch at one place"])
def test_an_edge_that_a_hole_touches_is_two_edges(name):
    whole = ((0.0, 0.0), (4.0, 0.0))
    halves = {((0.0, 0.0), (2.0, 0.0)), ((2.0, 0.0), (4.0, 0.0))}
    edges = edges_of(PICTURES[name]) - {whole} | halves
    assert_fills(advancing_front(PICTURES[name]), PICTURES[name], edges=edges)


def test_parts_are_meshed_one_by_one():
    parts = [box(0, 0, 1, 1), comb(3, 0.5), Point(3, 9).buffer(2)]
    shifted = [affinity.translate(part, 20 * k) for k, part in enumerate(parts)]
    mesh = advancing_front(MultiPolygon(shifted))
    assert_fills(mesh, MultiPolygon(shifted))
    assert len(mesh.triangles) == sum(len(advancing_front(part).triangles) for part in shifted)


@pytest.mark.parametrize(
    ("polygon", "size", "words"),
    [
        (Polygon(), None, "empty"),
        (Polygon([(0, 0), (1, 1), (1, 0), (0, 1)]), None, "not valid: Self-intersection"),
        (Point(0, 0), None, "not a Point"),
        (box(0, 0, 1, 1), 0.0, "positive length"),
        (box(0, 0, 1, 1), float("nan"), "positive length"),
        (box(0, 0, 1, 1), 1e-6, "choose a larger"),
    ],
)
def test_what_has_no_mesh_is_said(polygon, size, words):
    with pytest.raises(ValueError, match=words):
        advancing_front(polygon, size)


@pytest.mark.parametrize("size", [0.3, 0.1, 0.05])
def test_a_size_caps_the_triangles_away_from_longer_edges(size):
    polygon = shapely.segmentize(box(0, 0, 2, 2), size)
    mesh = advancing_front(polygon, size)
    assert_fills(mesh, polygon)
    sides = np.diff(mesh.points[mesh.triangles][:, [0, 1, 2, 0]], axis=1)
    assert np.median(np.hypot(*sides.T)) == pytest.approx(size, rel=0.15)
    assert np.hypot(*sides.T).max() < 1.8 * size


def test_triangles_grow_inwards():
    mesh = advancing_front(blob(300, 0, 1))
    far = np.hypot(*mesh.points[mesh.triangles].mean(axis=1).T)
    sizes = np.sqrt(areas_of(mesh))
    rings = [sizes[(far > low) & (far <= low + 0.25)].mean() for low in (0, 0.25, 0.5, 0.75)]
    assert rings == sorted(rings, reverse=True)
    assert rings[0] > 2 * rings[3]


def test_the_same_polygon_gives_the_same_bytes():
    one, other = (advancing_front(rough(120)) for _ in range(2))
    assert one.points.tobytes() == other.points.tobytes()
    assert one.triangles.tobytes() == other.triangles.tobytes()


@pytest.mark.parametrize("power", [-200, -30, 30, 300])
def test_scale_by_a_power_of_two_changes_nothing_else(power):
    polygon = rough(80)
    mesh, scaled = (
        advancing_front(p)
        for p in (polygon, affinity.scale(polygon, *[2.0**power] * 2, origin=(0, 0)))
    )
    assert scaled.points.tolist() == np.ldexp(mesh.points, power).tolist()
    assert scaled.triangles.tolist() == mesh.triangles.tolist()


CHANGES = {
    "smaller": lambda p: affinity.scale(p, 1e-9, 1e-9, origin=(0, 0)),
    "larger": lambda p: affinity.scale(p, 1e9, 1e9, origin=(0, 0)),
    "turned": lambda p: affinity.rotate(p, 37, origin=(0, 0)),
    "mirrored": lambda p: affinity.scale(p, -1, 1, origin=(0, 0)),
    "far away": lambda p: affinity.translate(affinity.scale(p, 0.005, 0.005), 1e6, -3e6),
    "begun elsewhere": lambda p: Polygon(np.roll(shapely.get_coordinates(p)[:-1], 17, axis=0)),
}


@pytest.mark.parametrize("change", CHANGES)
def test_a_changed_polygon_is_filled_as_well(change):
    polygon = rough(200)
    moved = CHANGES[change](polygon)
    mesh, other = advancing_front(polygon), advancing_front(moved)
    assert_fills(other, moved)
    assert len(other.triangles) == pytest.approx(len(mesh.triangles), rel=0.05)
    assert np.mean(quality(other) >= GOOD) > np.mean(quality(mesh) >= GOOD) - 0.02


@st.composite
def outlines(draw):
    """Rough, simple outlines of uneven edges, with holes in some."""
    seed = draw(st.integers(0, 10_000))
    random = np.random.default_rng(seed)
    count = draw(st.integers(3, 60))
    # Irregular steps, some a thousand times others.
    steps = 10 ** random.uniform(-draw(st.sampled_from([0, 3])), 0, count)
    angle = np.cumsum(steps) / steps.sum() * 2 * np.pi
    radius = random.uniform(draw(st.floats(0.1, 1)), 1, count)
    polygon = Polygon(np.column_stack([np.cos(angle), np.sin(angle)]) * radius[:, None])
    holes = [
        Point(*random.uniform(-0.5, 0.5, 2)).buffer(random.uniform(0.01, 0.3), quad_segs=2)
        for _ in range(draw(st.integers(0, 3)))
    ]
    rest = shapely.make_valid(polygon) - shapely.union_all(holes)
    return max([part for part in shapely.get_parts([rest]) if part.area > 0], key=shapely.area)


@settings(max_examples=40, deadline=None)
@given(outlines())
def test_any_outline_is_filled(polygon):
    assert_fills(advancing_front(polygon), polygon)


def assert_well_shaped(polygons):
    shares = {}
    for name, polygon in polygons.items():
        mesh = advancing_front(polygon)
        assert_fills(mesh, polygon)
        shares[name] = np.mean(quality(mesh) >= GOOD)
        assert shares[name] >= 0.88, name
        assert len(mesh.triangles) <= 60 * len(edges_of(polygon)), name
    assert np.mean(list(shares.values())) >= 0.96


def test_made_outlines_get_good_triangles():
    assert_well_shaped(made())


@needs_real_data
def test_real_outlines_get_good_triangles():
    assert_well_shaped(real())


def test_plate_with_holes_has_few_poor_triangles_and_none_away_from_its_edges():
    mesh = advancing_front(pierced())
    on_rim = len(edges_of(pierced()))
    inner = (mesh.triangles >= on_rim).all(axis=1)
    assert np.mean(quality(mesh)[inner] >= GOOD) > 0.99


@pytest.mark.parametrize(
    ("c", "expected"), [((0.5, 0.5), 0), ((0.5, 0.5 + 2**-53), 1), ((0.5 + 2**-53, 0.5), -1)]
)
def test_orientation_is_exact(c, expected):
    assert orientation(0, 0, 1, 1, *c) == expected
    assert orientation(1, 1, 0, 0, *c) == -expected
    # 0.1, 0.3 and their like are no binary fractions: a naive product gets this one wrong.
    assert orientation(0.1, 0.1, 0.3, 0.3, 1e17, 1e17) == 0
