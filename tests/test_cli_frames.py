"""``geotween frames``, and the pictures among the formats of ``geotween build``."""

from __future__ import annotations

import sys
from io import BytesIO
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from PIL import Image

from geotween.cli import main
from tests.conftest import WriteScene


def run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(main, list(map(str, arguments)))


def files(folder: Path) -> list[str]:
    return sorted(entry.name for entry in folder.iterdir())


@pytest.mark.parametrize(
    ("choice", "expected"),
    [
        ([], ["scene-1.svg", "scene-2.svg"]),
        (["--per-step", "2"], ["scene-1.svg", "scene-2.svg", "scene-3.svg"]),
        (["--count", "3", "--format", "png"], ["scene-1.png", "scene-2.png", "scene-3.png"]),
        (["--at", "0.5", "--format", "pdf"], ["scene-1.pdf"]),
        (["--count", "5", "--layout", "strip"], ["scene-strip.svg"]),
        (["--layout", "grid", "--format", "png"], ["scene-grid.png"]),
        (["--superpose", "1", "2", "--format", "pdf"], ["scene-superposed.pdf"]),
    ],
)
def test_frames_are_written(
    write_scene: WriteScene, tmp_path: Path, choice: list[str], expected: list[str]
) -> None:
    result = run("frames", write_scene(), "-o", tmp_path / "out", *choice)
    assert (result.exit_code, result.stderr) == (0, "")
    assert files(tmp_path / "out") == expected
    assert result.stdout.split() == [str(tmp_path / "out" / name) for name in expected]


def test_frames_are_numbered_in_order(write_scene: WriteScene, tmp_path: Path) -> None:
    run("frames", write_scene(), "-o", tmp_path / "out", "--count", "11", "-q")
    assert files(tmp_path / "out")[::5] == ["scene-01.svg", "scene-06.svg", "scene-11.svg"]


def test_scale_is_the_size_of_a_png(write_scene: WriteScene, tmp_path: Path) -> None:
    for scale in ("0.5", "1"):
        out = tmp_path / scale
        run("frames", write_scene(), "-o", out, "--at", "0", "--format", "png", "--scale", scale)
        content = (out / "scene-1.png").read_bytes()
        assert Image.open(BytesIO(content)).width == 960 * float(scale)


@pytest.mark.parametrize(
    ("choice", "message"),
    [
        (["--at", "0,x"], "'x' is not a number; expected such as 0,0.5,1"),
        (["--at", "3"], "3 is not a place between steps, which go from 0 to 1"),
        (["--superpose", "1", "x"], "no step 'x'; there are 1, 2"),
        (["--at", "0", "--count", "2"], "name one of --at, --count, --per-step and --superpose"),
        (["--format", "gif"], "'gif' is not one of"),
    ],
)
def test_wrong_usage_exits_with_2_and_writes_nothing(
    write_scene: WriteScene, tmp_path: Path, choice: list[str], message: str
) -> None:
    result = run("frames", write_scene(), "-o", tmp_path / "out", *choice)
    assert result.exit_code == 2
    assert message in result.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("command", "module", "message"),
    [
        (["frames", "--format", "pdf"], "typst", "format pdf needs typst: pip install"),
        (["build", "--format", "mp4"], "imageio_ffmpeg", "format mp4 needs imageio_ffmpeg"),
    ],
)
def test_without_a_library_it_says_what_to_install(
    write_scene: WriteScene,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    command: list[str],
    module: str,
    message: str,
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    result = run(*command, write_scene(), "-o", tmp_path / "out")
    assert result.exit_code == 2
    assert result.stderr.startswith(message)
    assert "Traceback" not in result.stderr
    assert not (tmp_path / "out").exists()


def test_build_writes_pictures_beside_the_page(write_scene: WriteScene, tmp_path: Path) -> None:
    formats = "html,png,pdf,svg-still,gif,mp4"
    how = ("--width", "120", "--fps", "2", "--shape", "square")
    result = run("build", write_scene(), "-o", tmp_path / "out", "--format", formats, *how)
    assert (result.exit_code, result.stderr) == (0, "")
    made = {"scene.png", "scene.pdf", "scene-still.svg", "scene.gif", "scene.mp4"}
    assert made <= {*files(tmp_path / "out")}
    for name in ("scene.png", "scene.gif"):
        content = (tmp_path / "out" / name).read_bytes()
        assert Image.open(BytesIO(content)).size == (120, 120)


def test_a_gallery_of_pictures_alone_leads_to_them(write_scene: WriteScene, tmp_path: Path) -> None:
    run("build", write_scene(), "-o", tmp_path / "out", "--format", "png", "--width", "64", "-q")
    assert 'href="scene.png"' in (tmp_path / "out" / "index.html").read_text(encoding="utf-8")
