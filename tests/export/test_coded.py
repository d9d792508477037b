"""Tracks as a page is told of them, and as they are read back."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from shapely.geometry import box

from geotween.data.polygons import Feature, polygon_set
from geotween.export.coded import coded, script
from geotween.export.decoded import Told, read_script, tracks_told
from geotween.export.numerals import heard
from geotween.export.page_grid import GRID, GridTrack, fit_page, on_grid, resting
from geotween.motion.front.film import tracks_of
from geotween.scene.model import Map
from tests.motion.front.filmed import Mesh, by_chance, things

UNIT = polygon_set([Feature(box(0, 0, 1, 1))])
PAGE = fit_page(Map.model_validate({"width": 300}), [UNIT])

meshes = st.builds(
    by_chance,
    st.integers(0, 10_000),
    st.integers(4, 16),
    st.integers(1, 3),
    st.sampled_from([1, 2, 4, 8]),
    st.booleans(),
)


def filmed(mesh: Mesh) -> list[GridTrack]:
    tracks = on_grid(tracks_of(mesh.arrivals(), things(mesh.count), "regions"), PAGE)
    return [track for track in tracks if track.vertices.shape[1]]


def read(tracks: list[GridTrack]) -> list[Told]:
    """The tracks as they come back from JSON."""
    told = coded(tracks)
    data = json.loads(json.dumps({**told.shared, "tracks": told.tracks}))
    back = tracks_told(data)
    return [back[told.numbers[track]] for track in tracks]


@given(meshes, meshes)
def test_a_film_is_read_back_as_it_is(one: Mesh, other: Mesh) -> None:
    tracks = [*filmed(one), *resting(UNIT, PAGE), *filmed(other)]
    for track, told in zip(tracks, read(tracks), strict=True):
        assert told.life == track.life
        assert told.rings == np.diff(track.offsets).tolist()
        for t in (*track.life, sum(track.life) / 2):
            assert np.abs(told.at(t) - track.at(t)).max() < 1e-9


@given(meshes)
def test_what_two_tracks_share_is_on_the_grid_where_its_way_begins_and_ends(mesh: Mesh) -> None:
    """So it moves alike in both, to the last digit, whenever the tracks begin and end."""
    films = {track.film for track in filmed(mesh)} - {None}
    assert len(films) <= 1
    for film in films:
        assert film is not None
        assert film.places.dtype == np.int64
        rows = np.concatenate([film.places[0], film.places[1], film.lives.T], axis=1)
        assert len(np.unique(rows, axis=0)) == len(rows)
        assert (film.lives[:, film.still].T == [0, 1]).all()


@given(meshes, st.floats(0.01, 0.99), st.tuples(st.floats(-1, 1), st.floats(-1, 1)))
def test_on_the_grid_a_film_is_where_it_is_also_if_it_travels(
    mesh: Mesh, t: float, way: tuple[float, float]
) -> None:
    made = tracks_of(mesh.arrivals(), things(mesh.count), "regions")
    for there in (0.0, 1.0):
        moved = [
            replace(track, vertices=track.vertices + there * track.times[:, None, None] * way)
            for track in made
        ]
        for track, drawn in zip(moved, on_grid(moved, PAGE), strict=True):
            if track.is_there(t) and len(drawn.offsets) == len(track.offsets):
                exact = PAGE.pixels(track.at(t)) / GRID
                off = np.abs(exact[:, None] - drawn.at(t)[None]).max(axis=2)
                assert off.min(axis=1).max() <= 0.5 + 1e-6


def test_what_rests_alike_is_told_once_and_places_are_too() -> None:
    first, again = resting(UNIT, PAGE)[0], resting(UNIT, PAGE)[0]
    beside = resting(polygon_set([Feature(box(1, 0, 2, 1))]), PAGE)[0]
    told = coded([first, again, beside])
    assert len(told.tracks) == 2
    assert told.numbers[first] == told.numbers[again] == 0
    assert len(heard(told.shared["points"])) == 2 * 6
    assert len(told.shared["ways"]) == 6


def test_what_moves_has_few_numbers() -> None:
    """The outline of a square that grows by four bands is told as what changes of it."""
    points = [(x, y) for x in range(6) for y in (0, 1)]
    cells = [(2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1) for k in range(5)]
    triangles = [t for a, b, c, d in cells for t in ((a, b, c), (a, c, d))]
    level = [0, 0, 0.25, 0.5, 0.75, 1]
    times = [[level[p // 2] for p in corners] for corners in triangles]
    mesh = Mesh.of(np.array(points) / 5, triangles, times, [0, 0] + [-1] * 8, [0] * 10)
    told = coded(filmed(mesh))
    assert [track["rings"] for track in told.tracks] == [[7], [9], [11], [13]]
    assert max(len(track["nodes"]) for track in told.tracks) <= 6


numbers = st.lists(st.integers(0, 30), max_size=25)


@given(numbers, numbers, st.integers(0, 40))
def test_a_script_writes_its_sequence(sequence: list[int], base: list[int], unseen: int) -> None:
    wanted = np.array(sequence, dtype=np.int64)
    written = script(wanted, np.array(base, dtype=np.int64), unseen)
    assert read_script(written, base or None, unseen) == sequence


def test_scripts_copy_and_run_up_and_down() -> None:
    base = np.array([5, 6, 9, 10, 11])
    assert script(np.array([20, 21, 22]), base[:0], 20) == [0, 3]
    assert script(np.array([7, 6, 5, 9]), base[:0], 4) == [3, -3, 5, 1]
    assert script(np.array([5, 6, 20, 21, 10, 11]), base, 20) == [0, 2, 0, 2, 1, 2]
