"""Seams: which edges are cuts, and that both of their sides have the same vertices."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from shapely.geometry import Polygon, box

import geotween
from geotween.motion.rings import next_vertex
from geotween.motion.tracks import SEAM_AT_ORIGIN, SEAM_AT_TARGET, Track
from tests.motion.shapes import polygon_sets, star

LEFT, RIGHT = box(0, 3, 1, 5), box(7, 3, 8, 5)


def seam_edges(track: Track, end: int) -> set[tuple[tuple[float, float], ...]]:
    """The edges of a track that are seams at one end, whichever way round."""
    points = track.vertices[-end]
    following = points[next_vertex(track.offsets)]
    chosen = (track.seams & (1 << end)) > 0
    return {
        tuple(sorted((tuple(a), tuple(b))))
        for a, b in zip(points[chosen].tolist(), following[chosen].tolist(), strict=True)
        if a != b
    }


def test_a_square_in_two_has_one_seam_and_only_at_the_origin() -> None:
    one, other = geotween.morph([box(0, 0, 8, 8)], [LEFT, RIGHT], "morph").tracks
    assert seam_edges(one, 0) == seam_edges(other, 0) == {((4.0, 0.0), (4.0, 8.0))}
    assert not (one.seams & SEAM_AT_TARGET).any()


def test_two_into_a_square_has_its_seam_at_the_target() -> None:
    tracks = geotween.morph([LEFT, RIGHT], [box(0, 0, 8, 8)], "morph").tracks
    assert seam_edges(tracks[0], 1) == {((4.0, 0.0), (4.0, 8.0))}
    assert not any((t.seams & SEAM_AT_ORIGIN).any() for t in tracks)


def test_borders_between_two_polygons_are_no_seams() -> None:
    neighbours = {"a": box(0, 0, 1, 1), "b": box(1, 0, 2, 1)}
    tracks = geotween.morph(neighbours, neighbours, "morph", correspondence="key").tracks
    assert not any(t.seams.any() for t in tracks)


def test_vertices_added_on_one_side_of_a_seam_are_added_on_the_other() -> None:
    # The left piece needs many vertices for its rough partner, the right piece none.
    rough = star(60, seed=5, radius=2, x=1.5, y=4)
    one, other = geotween.morph([box(0, 0, 8, 8)], [rough, RIGHT], "morph").tracks
    assert len(seam_edges(one, 0)) > 3
    assert seam_edges(one, 0) == seam_edges(other, 0)


@pytest.mark.parametrize("matching", ["rotation", "trajectory"])
@pytest.mark.parametrize("end", [0, 1])
@given(origin=polygon_sets, target=polygon_sets)
def test_both_sides_of_a_seam_have_the_same_vertices(
    end: int, matching: str, origin: list[Polygon], target: list[Polygon]
) -> None:
    m = geotween.morph(origin, target, "morph", matching=matching)
    if any(p.kind == "open seam" for p in m.layers[0].problems):
        return  # said so: in symmetric shapes vertices may chase each other round
    sides: dict[object, int] = {}
    for track in m.tracks:
        for edge in seam_edges(track, end):
            owner = track.ends[end]
            sides[owner, edge] = sides.get((owner, edge), 0) + 1
    extent = np.ptp([c for p in [*origin, *target] for c in p.exterior.coords])
    single = [
        edge
        for (_, edge), count in sides.items()
        if count == 1 and np.hypot(*np.subtract(*edge)) > 1e-8 * extent
    ]
    assert not single
