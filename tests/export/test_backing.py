"""Backings under what touches at some time between the ends of a transition."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from shapely.geometry import box

from geotween.data.polygons import Feature, polygon_set
from geotween.export.backing import Bundle, backings
from geotween.export.page_grid import fit_page, on_grid
from geotween.export.paint import Paint
from geotween.export.shapes import Group
from geotween.motion.front.film import tracks_of
from geotween.scene.model import Map
from tests.motion.front.filmed import Mesh, things

GROUP = Group("regions", (1.0, 1.0))
BARE, STROKED = Paint("#204060", "none", 0), Paint("#204060", "#ffffff", 1)
PAGE = fit_page(Map.model_validate({"width": 300}), [polygon_set([Feature(box(-1, 0, 1, 2))])])

# On the left of the edge in the middle 2 goes over to 0 first, on the right 1 to 3 later:
# 0 and 1 touch on their way, and at neither end.
MESH = Mesh.of(
    [(0, 0), (1, 1), (0, 2), (-1, 1)],
    [(0, 1, 2), (2, 3, 0)],
    [[0.5, 0.5, 1], [0.5, 0.25, 0]],
    [1, 2],
    [3, 0],
)


def bundles(paint: Paint, *keys: str, mesh: Mesh = MESH) -> list[Bundle]:
    made = tracks_of(mesh.arrivals(), things(4), "regions")
    drawn = list(zip(made, on_grid(made, PAGE), strict=True))
    return [
        Bundle(GROUP, key, 0, (paint, paint), [track for t, track in drawn if t.key == key])
        for key in keys
    ]


def test_what_touches_on_the_way_has_a_backing_for_all_of_it() -> None:
    both = bundles(BARE, "0", "1")
    (backing,) = backings(both)
    assert backing.show is None
    assert set(backing.tracks) == {track for bundle in both for track in bundle.tracks}


def test_what_has_no_edge_in_common_has_none() -> None:
    far = replace(
        MESH,
        triangles=np.array([[0, 1, 2], [4, 5, 6]]),
        points=np.vstack([MESH.points, MESH.points[[2, 3, 0]] - [0.5, 0]]),
    )
    assert backings(bundles(BARE, "0", "1", mesh=far)) == []


def test_what_has_a_stroke_or_another_fill_there_has_none() -> None:
    assert backings(bundles(STROKED, "0", "1")) == []
    one, other = bundles(BARE, "0", "1")
    other = replace(other, paints=(replace(BARE, fill="#ff0000"),) * 2)
    assert backings([one, other]) == []
