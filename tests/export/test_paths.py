"""Path data: short, relative, and the same commands at every key time."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from geotween.export.page_grid import GridFilm, GridTrack
from geotween.export.paint import Paint
from geotween.export.paths import closed_path, path_texts, runs
from geotween.export.shapes import Group, Shape, Slot

PAINT = Paint("#000000", "none", 0)
OFFSETS = np.array([0, 4])


def track(*key_times: list[list[int]], seams: str = "0000") -> GridTrack:
    vertices = np.array(key_times)
    times = tuple(np.linspace(0, 1, len(key_times)).tolist()) if len(key_times) > 1 else (0.0,)
    flags = np.array(list(seams), dtype=np.uint8)
    return GridTrack(times, vertices, np.array([0, vertices.shape[1]]), flags)


def shape(*tracks: GridTrack, kind: str = "region", code: int = 0) -> Shape:
    slot = Slot(Group("regions", (1, 1)), kind, "", 0, code)  # type: ignore[arg-type]
    return Shape(slot, tracks, (PAINT, PAINT))


SQUARE = [[0, 0], [105, 0], [105, 100], [-3, 100]]
LARGER = [[0, 0], [205, 0], [205, 200], [-3, 200]]


def test_a_square_in_tenths_of_a_pixel() -> None:
    assert path_texts(shape(track(SQUARE))) == [(0.0, "M0 0l10.5 0 0 10-10.8 0z")]


def test_a_moving_square_has_a_text_for_each_key_time() -> None:
    (start, one), (end, other) = path_texts(shape(track(SQUARE, LARGER)))
    assert (start, end) == (0, 1)
    assert one == "M0 0l10.5 0 0 10-10.8 0z"
    assert other == "M0 0l20.5 0 0 20-20.8 0z"


def test_a_still_track_beside_a_moving_one_is_written_at_each_key_time() -> None:
    texts = [text for _, text in path_texts(shape(track(SQUARE, LARGER), track(SQUARE)))]
    assert [text.count("M") for text in texts] == [2, 2]
    assert texts[1].endswith("M0 0l10.5 0 0 10-10.8 0z")


def test_key_times_of_one_track_are_written_for_all() -> None:
    twice = GridTrack((0.0, 1.0), np.array([SQUARE, LARGER]), OFFSETS, np.zeros(4, np.uint8))
    thrice = GridTrack((0.0, 0.5, 1.0), np.array([SQUARE] * 3), OFFSETS, np.zeros(4, np.uint8))
    middle = path_texts(shape(twice, thrice))[1]
    assert middle == (0.5, "M0 0l15.5 0 0 15-15.8 0zM0 0l10.5 0 0 10-10.8 0z")


def test_tracks_that_come_and_go_make_parts() -> None:
    def lasting(*life: float) -> GridTrack:
        return replace(track(SQUARE, LARGER), times=life, life=life)

    early, late, always = lasting(0, 0.25), lasting(0.25, 0.5), track(SQUARE)
    assert shape(early, late).parts() == [((0, 0.25), (early,)), ((0.25, 0.5), (late,))]
    assert shape(late, always).parts() == [
        ((0, 0.25), (always,)),
        ((0.25, 0.5), (late, always)),
        ((0.5, 1), (always,)),
    ]
    assert not replace(shape(always), tracks=(replace(always, life=(0, 0.5)),)).still


def test_a_part_is_written_from_its_beginning_to_its_end() -> None:
    late = replace(track(SQUARE, LARGER), times=(0.25, 0.5), life=(0.25, 0.5))
    (start, one), (end, other) = path_texts(shape(late), late.life)
    assert (start, end) == late.life
    assert one == "M0 0l10.5 0 0 10-10.8 0z"
    assert other == "M0 0l20.5 0 0 20-20.8 0z"


def test_what_moves_on_a_line_of_a_film_is_written_to_a_hundredth() -> None:
    """From (0, 0) to (1, 0.3) px, seen when a third of the way is done."""
    places = np.array([[[0, 0], [50, 0], [0, 50]], [[10, 3], [50, 0], [0, 50]]])
    film = GridFilm(places, np.array([[0.0, 0, 0], [0.75, 1, 1]]))
    nodes = np.arange(3, dtype=np.int32)
    seen = (np.rint(film.at(nodes, 0.25))[None]).astype(np.int64)
    filmed = GridTrack(
        (0.25, 0.75), seen, np.array([0, 3]), np.zeros(3, np.uint8), (0.25, 0.75), film, nodes
    )
    texts = dict(path_texts(shape(filmed), filmed.life))
    assert texts[0.25] == "M.33 .1l4.67-.1-5 5z"
    assert texts[0.75] == "M1 .3l4-.3-5 5z"


def test_a_border_leaves_out_the_seam() -> None:
    # Edges 0 and 3 are border; they are joined across the ring's end.
    border = shape(track(SQUARE, seams="0110"), kind="border")
    assert path_texts(border)[0][1] == "M-.3 10l.3-10 10.5 0"


def test_a_seam_is_only_the_seam() -> None:
    seam = shape(track(SQUARE, seams="0120"), kind="seam", code=1)
    assert path_texts(seam)[0][1] == "M10.5 0l0 10"


def test_closed_path_writes_all_rings() -> None:
    assert closed_path([track(SQUARE), track(SQUARE)]).count("z") == 2


@given(arrays(bool, st.integers(3, 12)))
def test_runs_cover_each_chosen_edge_once(chosen: np.ndarray) -> None:
    offsets = np.array([0, len(chosen)])
    edges = []
    for line, closed in runs(chosen, offsets):
        edges += line.tolist() if closed else line[:-1].tolist()
        assert closed == chosen.all()
    assert sorted(edges) == np.flatnonzero(chosen).tolist()


@given(arrays(np.int64, (2, 6, 2), elements=st.integers(-20_000, 20_000)))
def test_texts_are_exact_and_have_the_same_commands(vertices: np.ndarray) -> None:
    both = path_texts(shape(track(*vertices.tolist(), seams="000000")))
    assert len({re.sub(r"[^a-zA-Z]", "", text) for _, text in both}) == 1
    for (_, text), wanted in zip(both, vertices, strict=True):
        numbers = np.array(re.findall(r"-?(?:\d*\.)?\d+", text), dtype=float).reshape(-1, 2)
        assert np.rint(10 * np.cumsum(numbers, axis=0)).tolist() == wanted.tolist()
