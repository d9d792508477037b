"""Events for programs, spreadsheets and terminals, and the command that writes them."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from geotween.cli import main
from geotween.data.load import load
from geotween.export.resources import resource
from geotween.story.records import FIELDS, scene_record
from tests.conftest import SCENE, WriteScene


def run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(main, ["events", *map(str, arguments)])


def test_record_has_events_units_and_words(write_scene: WriteScene) -> None:
    text = SCENE.replace("title:", "map: {unit: km}\ntitle:")
    record = scene_record(load(write_scene(text)))
    assert record["units"] == {"area": "m²", "distance": "m"}
    (transition,) = record["transitions"]
    assert (transition["from"], transition["to"]) == ("1", "2")
    (event,) = transition["events"]
    assert event == {
        "kind": "moved",
        "feature": {
            "key": None, "name": "", "called": "polygon 1", "class": None, "layer": "regions",
        },
        "with": [],
        "area_before": 16e6,
        "area_after": 16e6,
        "change": 0.0,
        "distance": 1000.0,
        "bearing": 90.0,
        "before": [0],
        "after": [0],
    }  # fmt: skip
    assert transition["caption"] == "From 1 to 2, the area moved 1 km to the right."
    assert record["alternative"] == [record["opening"], transition["caption"]]


def test_table_has_a_line_for_each_event(write_scene: WriteScene) -> None:
    result = run(write_scene())
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout.splitlines() == [
        "Two squares",
        "",
        "1 → 2",
        "  From 1 to 2, the area moved to the right.",
        "  moved  polygon 1  16 → 16  +0.0%  1 at 90°",
    ]


def test_csv_has_a_line_for_each_event_of_all_scenes(write_scene: WriteScene) -> None:
    result = run(write_scene(name="a.yaml"), write_scene(name="b.yaml"), "--format", "csv")
    rows = list(csv.DictReader(io.StringIO(result.stdout)))
    assert tuple(rows[0]) == FIELDS
    assert [(row["scene"], row["event"], row["distance"]) for row in rows] == [
        ("a", "moved", "1.0"), ("b", "moved", "1.0"),
    ]  # fmt: skip


def test_json_is_a_list_of_records(write_scene: WriteScene, tmp_path: Path) -> None:
    path, out = write_scene(), tmp_path / "events.json"
    result = run(path, "--format", "json", "-o", out)
    assert (result.exit_code, result.output) == (0, "")
    assert json.loads(out.read_text(encoding="utf-8")) == [scene_record(load(path))]


def test_names_cannot_steer_a_terminal(write_scene: WriteScene) -> None:
    ring = "[[0, 0], [4, 0], [4, 4], [0, 4]]"
    step = f'  - {{polygons: [{{key: a, name: "\\u202E\\x9b2J", polygon: {ring}}}]}}\n'
    result = run(write_scene(f"title: t\nsteps:\n{step}{step}"))
    assert result.exit_code == 0
    assert "\x9b" not in result.stdout
    assert "\u202e" not in result.stdout


@pytest.mark.parametrize("text", ["titel: t\n", SCENE + "story: {words: none.yaml}\n"])
def test_a_bad_scene_exits_with_2(write_scene: WriteScene, text: str) -> None:
    result = run(write_scene(text))
    assert (result.exit_code, result.stdout) == (2, "")


def test_bad_words_exit_with_2(write_scene: WriteScene, tmp_path: Path) -> None:
    (tmp_path / "own.yaml").write_text("says: {grew: '{{ wind }}'}", encoding="utf-8")
    result = run(write_scene(SCENE + "story: {words: own.yaml}\n"))
    assert (result.exit_code, result.stdout) == (2, "")
    assert "own.yaml:1:" in result.stderr


def test_a_file_that_cannot_be_written_exits_with_2(
    write_scene: WriteScene, tmp_path: Path
) -> None:
    result = run(write_scene(), "-o", tmp_path / "none" / "events.txt")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "cannot write to" in result.stderr


@pytest.mark.parametrize("path", sorted(resource("scenes").glob("*.yaml")), ids=lambda p: p.stem)
def test_the_gallerys_scenes_have_their_stories(path: Path) -> None:
    record = scene_record(load(path))
    assert all(transition["events"] for transition in record["transitions"])
    assert all(text.endswith(".") and "  " not in text for text in record["alternative"])


def test_help_shows_examples() -> None:
    text = run("--help").stdout
    assert "  geotween events fire.yaml" in text
    assert max(map(len, text.splitlines())) <= 80
