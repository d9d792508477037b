"""The experiments' measures and pages: what they say is what the code finds."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

import pytest
import shapely
from shapely.geometry import LineString, Polygon, box

import geotween
from benchmarks.flubber_tracks import missing
from docs.draw.experiments import TIMINGS, fronts, splits, trials
from docs.draw.experiments.divisions import (
    CENTROIDS,
    MESHED,
    TERRITORY,
    VORONOI,
    centroid_seeds,
    figures,
    given_away,
    moved,
)
from docs.draw.experiments.seams import compared, seams_of, turning
from docs.draw.experiments.shapes import FAMILIES
from docs.draw.experiments.tables import percent, table

FOLDER = Path(__file__).parents[1] / "docs" / "experiments"
PAGES = sorted(FOLDER.glob("*.md"))
KEPT = sorted(FOLDER.glob("*.svg"))

# What a page may load for a figure.
MOST_BYTES = 60_000

ROUNDING = 1e-9
SQUARE = box(0, 0, 4, 4)


# Seams.


def test_a_straight_line_does_not_turn_a_staircase_does_a_quarter_at_each_corner() -> None:
    assert turning(LineString([(0, 0), (1, 1), (3, 3)])) == pytest.approx(0)
    assert turning(LineString([(0, 0), (1, 0), (1, 1), (2, 1)])) == pytest.approx(0.5)


def test_a_ring_turns_once() -> None:
    assert turning(SQUARE.exterior) == pytest.approx(1)


def test_the_seam_of_two_halves_is_one_line() -> None:
    (seam,) = seams_of([box(0, 0, 2, 4), box(2, 0, 4, 4)])
    assert seam.length == 4


def test_a_staircase_has_turned_for_nothing() -> None:
    stairs = [(0, 0), (1, 0), (1, 1), (2, 1), (2, 2), (3, 2), (3, 3), (4, 3), (4, 4)]
    halves = [Polygon([*stairs, (0, 4)]), Polygon([*stairs, (4, 0)])]
    found = compared(SQUARE, halves)
    assert found.least == 0
    assert found.over == pytest.approx(7 * 90)


def test_a_seam_around_a_corner_must_turn() -> None:
    # An L, cut along its middle from one end to the other: the way inside turns by a right angle
    # at the seam's corner, and the shortest one by less, at the L's own.
    inner = Polygon([(0, 0), (0, 8), (1, 8), (1, 1), (8, 1), (8, 0)])
    whole = Polygon([(0, 0), (0, 8), (2, 8), (2, 2), (8, 2), (8, 0)])
    found = compared(whole, [inner, whole.difference(inner)])
    assert found.turns == pytest.approx(0.25)
    # From (1, 8) past (2, 2) to (8, 1).
    assert found.least == pytest.approx(turning(LineString([(1, 8), (2, 2), (8, 1)])))
    assert 0 < found.least < found.turns


def test_the_hole_of_a_ring_turns_as_little_as_it_can_where_it_is_round() -> None:
    inner = shapely.Point(2, 2).buffer(1)
    found = compared(SQUARE, [inner, SQUARE.difference(inner)])
    assert (found.turns, found.least) == (pytest.approx(1), 1)


# Divisions.


def test_centroid_seeds_cut_half_way_between_the_centroids() -> None:
    pieces, _ = centroid_seeds(SQUARE, [box(0, 0, 1, 4), box(2, 0, 3, 4)])
    assert [piece.area for piece in pieces] == pytest.approx([6, 10])


def test_what_is_cut_off_a_correspondent_is_given_away() -> None:
    # The cut is at x = 2, and half of what the left one covers lies beyond it.
    correspondents = [box(0, 0, 2.5, 4), box(2.5, 0, 3, 4)]
    division = moved(([SQUARE], correspondents), CENTROIDS, "trajectory").layers[0].division
    assert given_away(division) == pytest.approx(0.5 / 3)
    division = moved(([SQUARE], correspondents), TERRITORY, "trajectory").layers[0].division
    assert given_away(division) == pytest.approx(0, abs=1e-12)


def test_own_divisions_are_gone_afterwards() -> None:
    with pytest.raises(ValueError, match="unknown division"):
        geotween.morph([SQUARE], [SQUARE], "morph", division=CENTROIDS)


@pytest.mark.parametrize("family", FAMILIES)
def test_the_polygons_of_a_set_are_valid_and_apart(family: str) -> None:
    for seed in trials.SEEDS:
        for end in FAMILIES[family](seed):
            assert all(polygon.is_valid for polygon in end)
            assert shapely.union_all(end).area == pytest.approx(sum(p.area for p in end))


@pytest.mark.parametrize("family", ["one to four", "drifted", "many to many"])
def test_territory_is_ahead_of_voronoi_and_of_both_meshes(family: str) -> None:
    transition = FAMILIES[family](0)
    ours, *others = (
        figures(moved(transition, name, "trajectory")) for name in (TERRITORY, VORONOI, *MESHED)
    )
    for theirs in others:
        assert ours.overlap <= theirs.overlap + ROUNDING
        assert ours.given_away <= theirs.given_away + ROUNDING
        assert ours.invalid <= theirs.invalid
    assert ours.lost < others[0].lost
    assert all(ours.roughness < theirs.roughness for theirs in others[1:])


# What the first page claims in words.


def test_the_first_page_claims_what_its_table_says() -> None:
    rows = {
        cells[0]: dict(
            zip(("overlap", "given", "lost", "invalid"), map(_share, cells[1:5]), strict=True)
        )
        for line in (FOLDER / "README.md").read_text(encoding="utf-8").splitlines()
        if len(cells := line.strip("| ").split(" | ")) == 6 and cells[0] in splits.NAMES
    }
    assert set(rows) == set(splits.NAMES)
    for measure in ("overlap", "given", "lost", "invalid"):
        assert min(rows, key=lambda name: rows[name][measure]) in (TERRITORY, CENTROIDS)
        assert max(rows, key=lambda name: rows[name][measure]) == VORONOI
    assert rows[TERRITORY]["given"] == 0
    assert rows[TERRITORY]["lost"] == min(row["lost"] for row in rows.values())


def test_the_advancing_front_has_more_good_triangles() -> None:
    mesh = geotween.mesh
    blob = splits.blob()
    assert mesh.share_good(mesh.advancing_front(blob)) > mesh.share_good(mesh.quadtree(blob))


def _share(cell: str) -> float:
    return float(cell.replace("< ", "").strip("%"))


# Pages.


def test_the_pages_show_each_figure_in_words_too_and_none_that_is_not_there() -> None:
    shown = [
        name
        for page in PAGES
        for name in re.findall(r"!\[[^\]]+\]\(([\w-]+\.svg)\)", page.read_text(encoding="utf-8"))
    ]
    assert sorted(shown) == [path.name for path in KEPT]


@pytest.mark.parametrize("path", KEPT, ids=lambda p: p.stem)
def test_a_figure_is_small_and_says_what_it_shows(path: Path) -> None:
    assert len(path.read_bytes()) < MOST_BYTES
    assert ElementTree.parse(path).getroot().get("aria-label")


@pytest.mark.parametrize("path", PAGES, ids=lambda p: p.stem)
def test_the_pages_link_to_what_is_there(path: Path) -> None:
    for target in re.findall(r"\]\(([^)#]+)[^)]*\)", path.read_text(encoding="utf-8")):
        assert (FOLDER / target).exists(), target


@pytest.mark.parametrize("name", ["pipeline", "meshes"])
def test_a_figure_is_what_the_code_draws(name: str) -> None:
    kept = (FOLDER / f"2-{name}.svg").read_text(encoding="utf-8")
    assert getattr(splits, name)() == kept, "make experiments draws them anew"


@pytest.mark.skipif(bool(missing()), reason="the page has flubber's figures")
def test_a_page_is_what_the_code_writes() -> None:
    page = fronts.page()
    assert page.text() == (FOLDER / "4-fronts.md").read_text(encoding="utf-8")
    for name, figure in page.figures.items():
        assert figure == (FOLDER / f"{name}.svg").read_text(encoding="utf-8")


def test_times_are_told_on_one_page_only() -> None:
    told = [page.name for page in PAGES if re.search(r"\d (ms|s)\b", page.read_text("utf-8"))]
    assert told == [TIMINGS]


# Tables.


def test_a_table_in_markdown() -> None:
    assert table(["set", "share"], [["a", "1"]]) == "| set | share |\n| --- | ---: |\n| a | 1 |"


def test_what_rounds_to_nothing_is_told_apart_from_nothing() -> None:
    assert [percent(v) for v in (0, 1e-16, 1e-6, 0.01234)] == ["0", "0", "< 0.01%", "1.23%"]
