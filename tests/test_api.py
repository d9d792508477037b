"""The Python interface: load, build, morph."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from shapely.geometry import LineString, MultiPolygon, Point, Polygon, box

import geotween
from tests.conftest import SCENE, WriteScene

ORIGIN, TARGET = box(0, 0, 4, 4), box(1, 0, 5, 4)


def test_names() -> None:
    assert geotween.__all__ == [
        "BuildReport", "Certificate", "Frame", "Morph", "PiecePair", "Problem", "Scene",
        "SceneError", "Track", "animate", "build", "divide", "load", "mesh", "morph",
    ]  # fmt: skip
    assert all(hasattr(geotween, name) for name in geotween.__all__)


def test_name_that_there_is_not() -> None:
    with pytest.raises(AttributeError, match=r"module 'geotween' has no attribute 'moprh'"):
        geotween.moprh  # noqa: B018 - the look-up is what is tested


def test_import_is_lazy() -> None:
    """Nothing heavy is loaded by the import alone, nor by the command line's help."""
    code = "import {}, sys, json; print(json.dumps(sorted(sys.modules)))"
    for name in ("geotween", "geotween.cli"):
        printed = subprocess.run(
            [sys.executable, "-c", code.format(name)], capture_output=True, check=True, timeout=60
        )
        loaded = set(json.loads(printed.stdout))
        assert name in loaded
        assert not loaded & {"shapely", "numpy", "pydantic", "yaml", "jinja2", "svgwrite"}


# load and build


def test_load_gives_a_scene(write_scene: WriteScene) -> None:
    assert isinstance(geotween.load(write_scene()), geotween.Scene)


def test_load_of_a_bad_scene_raises_all_its_faults(write_scene: WriteScene) -> None:
    with pytest.raises(geotween.SceneError) as caught:
        geotween.load(write_scene("titel: t\n"))
    assert [(fault.line, fault.column) for fault in caught.value.faults] == [(1, 1)] * 3


def test_build_writes_files_and_reports_them(write_scene: WriteScene, tmp_path: Path) -> None:
    out = tmp_path / "deep" / "out"
    report = geotween.build(geotween.load(write_scene(name="lake.yaml")), out)
    assert isinstance(report, geotween.BuildReport)
    assert report.name == "lake"
    assert report.files == (out / "lake.html", out / "lake.svg")
    assert report.bytes == tuple(path.stat().st_size for path in report.files)
    assert [(t.steps, t.pieces) for t in report.transitions] == [(("1", "2"), 1)]
    assert report.problems == ()
    assert sorted(path.name for path in out.iterdir()) == ["lake.html", "lake.svg"]


def test_build_of_one_format(write_scene: WriteScene, tmp_path: Path) -> None:
    scene = geotween.load(write_scene())
    assert geotween.build(scene, str(tmp_path), ["svg"]).files == (tmp_path / "scene.svg",)
    assert not (tmp_path / "scene.html").exists()


def test_build_reports_problems(write_scene: WriteScene, tmp_path: Path) -> None:
    bow_tie = SCENE.replace("[4, 0], [4, 4]", "[4, 4], [4, 0]")
    report = geotween.build(geotween.load(write_scene(bow_tie)), tmp_path)
    assert all(isinstance(problem, geotween.Problem) for problem in report.problems)
    assert ("repaired", ("1",)) in [(p.kind, p.steps) for p in report.problems]


def test_build_of_an_unknown_format_writes_nothing(write_scene: WriteScene, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="unknown format 'doc'; expected html or svg"):
        geotween.build(geotween.load(write_scene()), tmp_path / "out", ["html", "doc"])
    assert not (tmp_path / "out").exists()


def test_build_into_a_file_raises(write_scene: WriteScene, tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("mine")
    with pytest.raises(NotADirectoryError):
        geotween.build(geotween.load(write_scene()), tmp_path / "taken")
    assert (tmp_path / "taken").read_text() == "mine"


# morph


def test_morph_has_tracks_pairs_and_a_certificate() -> None:
    morph = geotween.morph([ORIGIN], [TARGET])
    assert isinstance(morph, geotween.Morph)
    assert [type(track) for track in morph.tracks] == [geotween.Track]
    assert [type(pair) for pair in morph.pairs] == [geotween.PiecePair]
    certificate = morph.certificate
    assert isinstance(certificate, geotween.Certificate)
    assert isinstance(certificate.valid, bool)
    assert all(isinstance(problem, geotween.Problem) for problem in certificate.problems)
    assert all(isinstance(measure, float) for measure in certificate.measures.values())


def test_frames_run_from_the_origin_to_the_target() -> None:
    morph = geotween.morph([ORIGIN], [TARGET])
    for t, place in [(0, 0.0), (0.25, 0.25), (1, 1.0)]:
        frame = morph.frame(t)
        assert isinstance(frame, geotween.Frame)
        assert [p.bounds for p in frame.polygons] == [(place, 0, 4 + place, 4)]


def test_pairs_are_the_pieces_of_both_ends() -> None:
    (pair,) = geotween.morph([ORIGIN], [TARGET]).pairs
    assert pair.origin.equals(ORIGIN)
    assert pair.target.equals(TARGET)
    assert (pair.origin_key, pair.target_key) == (0, 0)


def test_polygon_without_a_partner_is_paired_with_a_point() -> None:
    morph = geotween.morph({"a": ORIGIN}, {"b": box(20, 0, 24, 4)})
    ends = {(type(pair.origin), type(pair.target)): pair for pair in morph.pairs}
    birth, death = ends[Point, Polygon], ends[Polygon, Point]
    assert (birth.origin_key, birth.target_key) == (None, "b")
    assert (death.origin_key, death.target_key) == ("a", None)


@pytest.mark.parametrize("t", [0, 0.5, 1])
def test_polygons_keys_and_layers_are_parallel(t: float) -> None:
    frame = geotween.morph({"a": ORIGIN, "b": box(9, 0, 12, 4)}, {"a": TARGET}).frame(t)
    assert isinstance(frame.polygons, list)
    assert len(frame.polygons) == len(frame.keys) == len(frame.layers)
    assert frame.keys == (["a", "b"] if t < 1 else ["a"])
    assert set(frame.layers) == {"regions"}
    assert all(isinstance(polygon, Polygon) for polygon in frame.polygons)


def test_polygons_without_keys_are_called_by_their_positions() -> None:
    frame = geotween.morph([ORIGIN, box(9, 0, 12, 4)], [TARGET]).frame(0)
    assert frame.keys == [0, 1]


def test_parts_of_a_multipolygon_bear_its_key() -> None:
    lakes = MultiPolygon([ORIGIN, box(9, 0, 12, 4)])
    assert geotween.morph({"a": lakes}, {"a": lakes}).frame(0.5).keys == ["a", "a"]


@pytest.mark.parametrize("empty", [[], {}, [Polygon()], [MultiPolygon()]])
def test_nothing_may_become_something_and_something_nothing(empty: Any) -> None:
    assert [p.area for p in geotween.morph(empty, [TARGET]).frame(1).polygons] == [16]
    assert geotween.morph(empty, [TARGET]).frame(0).polygons == []
    assert [p.area for p in geotween.morph([ORIGIN], empty).frame(0).polygons] == [16]
    assert geotween.morph([ORIGIN], empty).frame(1).polygons == []
    assert geotween.morph(empty, empty).frame(0.5).polygons == []


def test_heights_are_dropped() -> None:
    high = Polygon([(0, 0, 9), (4, 0, 9), (4, 4, 9)])
    morph = geotween.morph([high], [high])
    (polygon,), (pair,) = morph.frame(0.5).polygons, morph.pairs
    assert not any(shape.has_z for shape in (polygon, pair.origin, pair.target))
    assert polygon.area == 8


def test_polygon_that_is_not_valid_is_repaired_and_reported() -> None:
    bow_tie = Polygon([(0, 0), (4, 4), (4, 0), (0, 4)])
    morph = geotween.morph([bow_tie, Polygon([(1, 1)] * 3)], [TARGET])
    assert sum(p.area for p in morph.frame(0).polygons) == pytest.approx(8)
    kinds = [(p.kind, p.steps) for p in morph.certificate.problems]
    assert kinds[:3] == [("repaired", ("origin",))] * 2 + [("no area", ("origin",))]


def test_target_may_be_fitted_into_the_box_of_the_origin() -> None:
    far = box(100, 100, 108, 104)
    (polygon,) = geotween.morph([ORIGIN], [far], fit="each").frame(1).polygons
    assert polygon.bounds == (0, 1, 4, 3)


def test_origin_and_target_are_left_as_they_are() -> None:
    clockwise = Polygon([(0, 0), (0, 4), (4, 4), (4, 0)])
    before = clockwise.wkb
    geotween.morph([clockwise], [TARGET])
    assert clockwise.wkb == before


@pytest.mark.parametrize(
    ("option", "message"),
    [
        ({"method": "papr"}, "unknown method 'papr'; expected one of auto, "),
        ({"correspondence": "keys"}, "unknown correspondence 'keys'; expected one of "),
        ({"division": "cut"}, "unknown division 'cut'; expected one of "),
        ({"matching": "best"}, "unknown matching 'best'; expected one of "),
        ({"fit": "all"}, "fit is shared or each, not 'all'"),
    ],
)
def test_unknown_name_is_refused(option: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        geotween.morph([ORIGIN], [TARGET], **option)


@pytest.mark.parametrize("shape", [Point(0, 0), LineString([(0, 0), (1, 1)]), "POLYGON", None])
@pytest.mark.parametrize("wrap", [lambda shape: [ORIGIN, shape], lambda shape: {1: shape}])
def test_anything_but_a_polygon_is_refused(wrap: Callable[[Any], Any], shape: Any) -> None:
    message = rf"target\[1\] is a {type(shape).__name__}; expected a Polygon or MultiPolygon"
    with pytest.raises(TypeError, match=message):
        geotween.morph([ORIGIN], wrap(shape))


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf])
def test_number_that_is_not_finite_is_refused(number: float) -> None:
    with np.errstate(invalid="ignore"):
        bad = Polygon([(0, 0), (4, 0), (4, number)])
    with pytest.raises(ValueError, match=r"origin\['a'\] has coordinates that are not finite"):
        geotween.morph({"a": bad}, [TARGET])


@pytest.mark.parametrize("t", [-0.001, 1.001, math.nan, math.inf])
def test_time_outside_a_transition_is_refused(t: float) -> None:
    with pytest.raises(ValueError, match="t runs from 0 to 1"):
        geotween.morph([ORIGIN], [TARGET]).frame(t)


def test_tracks_have_the_shapes_that_the_renderers_take() -> None:
    (track,) = geotween.morph({"a": ORIGIN}, {"a": TARGET}).tracks
    count = len(track.times)
    assert track.key == "a"
    assert (track.times[0], track.times[-1]) == (0, 1)
    assert (np.diff(track.times) > 0).all()
    assert track.vertices.shape == (count, track.offsets[-1], 2)
    assert track.seams.shape == (track.offsets[-1],)
