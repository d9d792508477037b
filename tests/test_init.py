"""`geotween init`: something to begin with, that builds as it is."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner, Result

import geotween
from geotween.cli import main
from geotween.hosts.starter import SCHEMA, examples


def run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(main, list(map(str, arguments)))


def test_starter_scene_is_sound(tmp_path: Path) -> None:
    result = run("init", tmp_path / "new")
    assert result.exit_code == 0, result.output
    written = sorted(path.name for path in (tmp_path / "new").iterdir())
    assert written == ["perimeters.geojson", "scene.schema.json", "scene.yaml"]
    assert result.stdout.endswith(f"next: geotween watch {tmp_path / 'new' / 'scene.yaml'}\n")
    scene = geotween.load(tmp_path / "new" / "scene.yaml")
    assert len(scene.steps) == 6
    assert [problem for problem in scene.problems if problem.severity != "note"] == []


def test_starter_scene_explains_each_of_its_parts(tmp_path: Path) -> None:
    run("init", tmp_path)
    lines = (tmp_path / "scene.yaml").read_text(encoding="utf-8").splitlines()
    assert lines[0] == f"# yaml-language-server: $schema={SCHEMA}"
    assert sum("#" in line for line in lines) > 15


@pytest.mark.parametrize("name", examples())
def test_examples_come_with_their_data(tmp_path: Path, name: str) -> None:
    assert run("init", tmp_path, "--example", name).exit_code == 0
    geotween.load(tmp_path / f"{name}.yaml")


def test_unknown_example_exits_with_2_and_writes_nothing(tmp_path: Path) -> None:
    result = run("init", tmp_path / "new", "--example", "atlantis")
    assert result.exit_code == 2
    assert "expected one of archipelago, fire," in result.stderr
    assert not (tmp_path / "new").exists()


def test_what_is_there_is_left_as_it_is(tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text("mine", encoding="utf-8")
    result = run("init", tmp_path)
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr.startswith(f"{tmp_path / 'scene.yaml'} is there already")
    assert [path.name for path in tmp_path.iterdir()] == ["scene.yaml"]
    assert (tmp_path / "scene.yaml").read_text(encoding="utf-8") == "mine"
