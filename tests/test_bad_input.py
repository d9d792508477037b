"""A scene that cannot be built: told where, shown, with how to mend it; and nothing written."""

from __future__ import annotations

import os
import random
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from hypothesis import given, settings
from hypothesis import strategies as st

from geotween.cli import main
from geotween.data.load import load
from geotween.scene.errors import SceneError
from tests.conftest import SCENE, WriteScene

STEPS = """\
steps:
  - polygons: [[[0, 0], [4, 0], [4, 4], [0, 4]]]
  - polygons: [[[1, 0], [5, 0], [5, 4], [1, 4]]]
"""


def scene(polygons: str) -> str:
    return f"title: t\nsteps:\n  - polygons: {polygons}\n  - polygons: []\n"


def build(*scenes: Path, out: Path | None = None) -> tuple[Result, Path]:
    folder = out or scenes[0].parent / "out"
    result = CliRunner().invoke(main, ["build", *map(str, scenes), "-o", str(folder)])
    return result, folder


def told(result: Result, out: Path, folder: Path) -> str:
    """What was said of a bad scene, without the folder that it lies in."""
    assert result.exit_code == 2
    assert isinstance(result.exception, SystemExit)
    assert result.stdout == ""
    assert not out.exists()
    return result.stderr.replace(f"{folder}/", "")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        pytest.param(
            f"title: Area: 12 ha\n{STEPS}",
            """\
scene.yaml:1:12: this is not YAML: mapping values are not allowed in this context
     1 | title: Area: 12 ha
       |            ^
       = a text with a colon in it needs quotes: "Area: 12 ha"
""",
            id="broken YAML",
        ),
        pytest.param(
            f"titel: t\n{STEPS}",
            """\
scene.yaml:1:1: the scene needs "title"
     1 | titel: t
       | ^
       = for example title: A pond dries up

scene.yaml:1:1: unknown key "titel"
     1 | titel: t
       | ^
       = did you mean "title"?
""",
            id="misspelt key",
        ),
        pytest.param(
            f"title: t\nzoom: 3\n{STEPS}",
            """\
scene.yaml:2:1: unknown key "zoom"
     2 | zoom: 3
       | ^
       = known here: credit, data, description, hotspots, lang, layout, map, motion, source, \
steps, story, style, subtitle, timing, title, url
""",
            id="unknown key",
        ),
        pytest.param(
            "title: t\nsteps:\n  - polygons: []\n",
            """\
scene.yaml:2:1: a scene needs at least two steps, not 1
     2 | steps:
       | ^
       = each begins with - and has polygons, for example - polygons: spring.geojson
""",
            id="one step",
        ),
        pytest.param(
            scene("lak.geojson"),
            """\
scene.yaml:3:15: cannot read lak.geojson: no such file or directory
     3 |   - polygons: lak.geojson
       |               ^
       = did you mean "lake.geojson"?
""",
            id="missing file",
        ),
        pytest.param(
            scene("[[[0, 0], [4, 0], [0, 0]]]"),
            """\
scene.yaml:3:16: a ring needs at least three distinct points, not 2
     3 |   - polygons: [[[0, 0], [4, 0], [0, 0]]]
       |                ^
       = add points: [[x, y], [x, y], [x, y]]
""",
            id="two points",
        ),
        pytest.param(
            scene("[[[0, 0], [4, .nan], [4, 4]]]"),
            """\
scene.yaml:3:25: expected a point [x, y], not [4, .nan]
     3 |   - polygons: [[[0, 0], [4, .nan], [4, 4]]]
       |                         ^
       = two decimal numbers with a comma between, such as [9.5, -37.2]
""",
            id="NaN as YAML writes it",
        ),
        pytest.param(
            scene("[[[0, 0], [4, nan], [4, 4]]]"),
            """\
scene.yaml:3:25: the coordinates 4, nan are beyond any map
     3 |   - polygons: [[[0, 0], [4, nan], [4, 4]]]
       |                         ^
       = expected finite numbers of at most 1e+12
""",
            id="NaN",
        ),
        pytest.param(
            scene("[[[0, 0], [4, 0], [1e300, 4]]]"),
            """\
scene.yaml:3:33: the coordinates 1e+300, 4 are beyond any map
     3 |   - polygons: [[[0, 0], [4, 0], [1e300, 4]]]
       |                                 ^
       = expected finite numbers of at most 1e+12
""",
            id="absurd magnitude",
        ),
        pytest.param(
            f"title: t\nmap: {{width: wide}}\n{STEPS}",
            """\
scene.yaml:2:14: "width": expected a number, not "wide"
     2 | map: {width: wide}
       |              ^
""",
            id="wrong type",
        ),
    ],
)
def test_bad_scene_is_told_at_its_place_with_how_to_mend_it(
    write_scene: WriteScene, text: str, message: str
) -> None:
    path = write_scene(text, lake="{}")
    count = message.count("scene.yaml:")
    total = f"{count} error{'s' if count > 1 else ''}"
    assert told(*build(path), path.parent) == f"{message}\n{total}\n"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        pytest.param(
            "",
            """\
lake.geojson:1:1: not JSON: Expecting value
       = the file is empty
""",
            id="empty",
        ),
        pytest.param(
            '{"type": "FeatureCollection",\n "features": [',
            """\
lake.geojson:2:15: not JSON: Expecting value
     2 |  "features": [
       |               ^
       = the file ends too early
""",
            id="truncated",
        ),
        pytest.param(
            "<!DOCTYPE html>\n",
            """\
lake.geojson:1:1: not JSON: Expecting value
     1 | <!DOCTYPE html>
       | ^
       = expected GeoJSON or TopoJSON: the suffix says which format a file has
""",
            id="HTML",
        ),
        pytest.param(
            '{"type": "Poligon"}',
            """\
lake.geojson:1:10: "Poligon" is no type of GeoJSON
     1 | {"type": "Poligon"}
       |          ^
       = did you mean "Polygon"?
""",
            id="wrong type",
        ),
        pytest.param(
            '{"type": "Polygon", "coordinates": [[[0, 0], [-Infinity, 0], [1, 1]]]}',
            """\
lake.geojson:1:46: the coordinates -inf, 0 are beyond any map
     1 | {"type": "Polygon", "coordinates": [[[0, 0], [-Infinity, 0], [1, 1]]]}
       |                                              ^
       = expected finite numbers of at most 1e+12
""",
            id="infinity",
        ),
    ],
)
def test_file_that_is_no_geojson_is_told_at_its_place(
    write_scene: WriteScene, content: str, message: str
) -> None:
    path = write_scene(scene("lake.geojson"), lake=content)
    assert told(*build(path), path.parent) == f"{message}\n1 error\n"


def test_all_faults_of_all_scenes_come_at_once(write_scene: WriteScene) -> None:
    bad = f"title: [t]\nmap: {{widht: 5, padding: -1}}\n{STEPS.replace('4, 4', '4, x')}"
    first, good = write_scene(bad, name="a.yaml"), write_scene(name="b.yaml")
    last = write_scene("- t\n", name="c.yaml")
    result, out = build(first, good, last)
    lines = told(result, out, first.parent).splitlines()
    assert [line for line in lines if ".yaml:" in line] == [
        'a.yaml:1:8: "title": expected a text, not a list',
        'a.yaml:2:7: unknown key "widht"',
        'a.yaml:2:26: "padding": expected a number greater than or equal to 0, not "-1"',
        "a.yaml:4:33: expected a point [x, y], not [4, x]",
        "c.yaml:1:1: expected a mapping (key: value)",
    ]
    assert lines[-1] == "5 errors"


def test_missing_scene_is_told(tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    assert told(*build(path), tmp_path) == (
        "scene.yaml:1:1: cannot read scene.yaml: no such file or directory\n\n1 error\n"
    )


@pytest.mark.parametrize("inside", ["", "deeper", "deeper/still"])
def test_folder_that_is_a_file_is_told_before_any_work(
    write_scene: WriteScene, tmp_path: Path, inside: str
) -> None:
    taken = tmp_path / "taken"
    taken.write_text("mine")
    result, out = build(write_scene("not even a scene"), out=taken / inside)
    assert result.exit_code == 2
    assert (
        result.stderr
        == f"cannot write to {out}: {taken}: is a file, not a folder; name another with -o\n"
    )
    assert taken.read_text() == "mine"


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_folder_without_permission_is_told(write_scene: WriteScene, tmp_path: Path) -> None:
    locked = tmp_path / "locked"
    locked.mkdir(mode=0o500)
    result, out = build(write_scene(), out=locked / "out")
    assert result.exit_code == 2
    assert result.stderr == f"cannot write to {out}: {locked}: permission denied\n"


def test_folder_that_the_system_refuses_is_told(
    write_scene: WriteScene, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "access", lambda _, mode: not mode & os.W_OK)
    path = write_scene()
    message = told(*build(path), path.parent)
    assert message == f"cannot write to out: {path.parent}: permission denied\n"


def test_polygon_that_is_not_valid_is_repaired_and_reported(write_scene: WriteScene) -> None:
    result, out = build(write_scene(scene("[[[0, 0], [4, 4], [4, 0], [0, 4]]]")))
    assert result.exit_code == 0
    assert "warning: 1, polygon 1: invalid polygon (self-intersection at 2, 2)" in result.stderr
    assert (out / "scene.html").exists()


def test_step_without_polygons_is_allowed(write_scene: WriteScene) -> None:
    result, out = build(write_scene(scene("[[[0, 0], [4, 0], [4, 4], [0, 4]]]")))
    assert (result.exit_code, result.stderr) == (0, "")
    assert (out / "scene.html").exists()


@pytest.mark.parametrize("command", [["build", "-o", "out"], ["check"]])
def test_bad_scene_in_a_real_process(write_scene: WriteScene, command: list[str]) -> None:
    path = write_scene(f"titel: Größe\n{STEPS}")
    result = subprocess.run(
        [sys.executable, "-m", "geotween", *command, path.name],
        cwd=path.parent, capture_output=True, encoding="utf-8", timeout=60, check=False,
    )  # fmt: skip
    assert (result.returncode, result.stdout) == (2, "")
    assert "scene.yaml:1:1: unknown key" in result.stderr
    assert 'did you mean "title"?' in result.stderr
    assert "Traceback" not in result.stderr
    assert [entry.name for entry in path.parent.iterdir()] == ["scene.yaml"]


# Any scene that something happened to

GOOD = """\
# yaml-language-server: $schema=scene.schema.json
title: "Größe: no"
lang: en
map:
  {width: 640, fit: shared, background: "#efe6d3"}
style: {fill: steelblue, opacity: 0.9, class: {lake: {fill: none}}}
motion: {method: paper, easing: ease-in-out}
timing: {transition: [2, 1.5], hold: 1e0, loop: yes}
steps:
  - label: 1960
    time: 1960-01-05
    polygons: &square [[[0, 0], [4, 0], [4, 4], [0, 4]]]
  - time: 1976-02-29
    polygons: *square
  - time: 1989-12-31
    polygons:
      - {key: a, class: lake, polygon: [[[0, 0], [4, 0], [4, 4]], [[2, 1], [3, 1], [3, 2]]]}
      - {type: Feature, geometry: {type: Polygon, coordinates: [[[5, 5], [6, 5], [6, 6]]]}}
      - "POLYGON ((0 0, 4 0, 4 4, 0 0))"
"""

ODD = [*"abc019.-+:,[]{}&*!|>'\"%@#~? \n\t\0é", "\u2028", "\ufeff", "1e999", "nan", "<<: "]


def mutated(seed: int) -> str:
    """The good scene with one or two places deleted, repeated, changed, swapped or cut off."""
    chance = random.Random(seed)
    text = GOOD
    for _ in range(chance.randint(1, 2)):
        start = chance.randrange(len(text))
        end = min(len(text), start + chance.choice([1, 1, 2, 10]))
        lines = text.splitlines(keepends=True)
        one, other = chance.randrange(len(lines)), chance.randrange(len(lines))
        match chance.choice(["delete", "repeat", "change", "swap", "cut"]):
            case "delete":
                text = text[:start] + text[end:]
            case "repeat":
                text = text[:end] + text[start:]
            case "change":
                text = text[:start] + chance.choice(ODD) + text[end:]
            case "swap":
                lines[one], lines[other] = lines[other], lines[one]
                text = "".join(lines)
            case "cut":
                text = text[: max(start, 1)]
    return text


def outcome(path: Path) -> str:
    try:
        load(path)
    except SceneError as error:
        places = [(fault.line, fault.column) for fault in error.faults]
        return "refused" if places and min(map(min, places)) >= 1 else f"without a place: {error}"
    return "read"


def test_good_scene_is_read(write_scene: WriteScene) -> None:
    assert outcome(write_scene(GOOD)) == "read"


def test_mutations_make_scenes_that_are_read_and_scenes_that_are_not(
    write_scene: WriteScene,
) -> None:
    outcomes = [outcome(write_scene(mutated(seed))) for seed in range(300)]
    assert set(outcomes) == {"read", "refused"}
    assert min(outcomes.count("read"), outcomes.count("refused")) > 10


@given(st.binary(max_size=60))
@settings(max_examples=50)
def test_any_bytes_are_read_or_refused_at_a_place(
    tmp_path_factory: pytest.TempPathFactory, content: bytes
) -> None:
    path = tmp_path_factory.mktemp("fuzz") / "scene.yaml"
    path.write_bytes(SCENE.encode() + content)
    assert outcome(path) in ("read", "refused")
