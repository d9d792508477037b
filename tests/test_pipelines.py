"""What make, CI and pre-commit ask of the command line."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from click.testing import CliRunner, Result

from geotween.cli import main
from geotween.data.load import load
from tests.conftest import SCENE, WriteScene

CHECKOUT = Path(__file__).parents[1]


def run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(main, list(map(str, arguments)))


def test_all_files_of_a_scene_are_known(write_scene: WriteScene, tmp_path: Path) -> None:
    (tmp_path / "words.yaml").write_text("{}", encoding="utf-8")
    (tmp_path / "days").mkdir()
    square = '{"type":"Polygon","coordinates":[[[0,0],[400,0],[400,400],[0,0]]]}'
    for day in (1, 2):
        (tmp_path / "days" / f"2024-01-0{day}.geojson").write_text(square, encoding="utf-8")
    text = (
        "title: t\nstory: {words: words.yaml}\ndata: days\n"
        "map: {projection: none, layers: [{polygons: land.geojson}]}\n"
    )
    reads: set[Path] = set()
    load(write_scene(text, land=square), reads=reads)
    assert sorted(path.relative_to(tmp_path).as_posix() for path in reads) == [
        "days", "days/2024-01-01.geojson", "days/2024-01-02.geojson", "land.geojson",
        "scene.yaml", "words.yaml",
    ]  # fmt: skip


@pytest.mark.skipif(shutil.which("make") is None, reason="needs make")
def test_make_builds_what_is_out_of_date_and_nothing_else(
    write_scene: WriteScene, tmp_path: Path
) -> None:
    square = '{"type":"Polygon","coordinates":[[[0,0],[4,0],[4,4],[0,4],[0,0]]]}'
    scene = write_scene(
        SCENE.replace("[[[0, 0], [4, 0], [4, 4], [0, 4]]]", "'a b $c.geojson'"),
        "my scene.yaml",
        **{"a b $c": square},
    )
    command = f"{sys.executable} -m geotween build '$<' -o out -q --deps deps.mk"
    (tmp_path / "Makefile").write_text(
        f"out/my\\ scene.html: my\\ scene.yaml\n\t@echo built\n\t@{command}\n-include deps.mk\n",
        encoding="utf-8",
    )

    def made() -> str:
        packages = os.pathsep.join(sys.path)
        done = subprocess.run(
            ["make"], cwd=tmp_path, env={**os.environ, "PYTHONPATH": packages},
            capture_output=True, encoding="utf-8", check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        return done.stdout

    assert "built" in made()
    assert "up to date" in made()
    later = scene.stat().st_mtime + 10
    os.utime(tmp_path / "a b $c.geojson", (later, later))
    assert "built" in made()


def test_deps_name_every_file_that_was_written(write_scene: WriteScene, tmp_path: Path) -> None:
    out = tmp_path / "out"
    deps = tmp_path / "build.d"
    assert run("build", write_scene(), "-o", out, "--deps", deps).exit_code == 0
    targets = deps.read_text(encoding="utf-8").partition(":")[0].split()
    assert sorted(map(Path, targets)) == sorted(out.iterdir())
    assert "templates/player.js" in deps.read_text(encoding="utf-8")


def hook() -> list[str]:
    (found,) = yaml.safe_load((CHECKOUT / ".pre-commit-hooks.yaml").read_text(encoding="utf-8"))
    program, *arguments = found["entry"].split()
    assert (program, found["language"]) == ("geotween", "python")
    return arguments


def test_hook_passes_sound_scenes_and_stops_at_others(write_scene: WriteScene) -> None:
    sound, broken = write_scene(name="sound.yaml"), write_scene("titel: t\n", name="broken.yaml")
    mended = write_scene(SCENE.replace("[4, 0], [4, 4]", "[4, 4], [4, 0]"), name="mended.yaml")
    assert run(*hook(), sound).exit_code == 0
    assert run(*hook(), sound, mended).exit_code == 1
    assert run(*hook(), sound, broken).exit_code == 2
