"""The command line: what it prints, what it writes, and its exit status."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from geotween import __version__
from geotween.cli import main
from tests.conftest import SCENE, WriteScene

BOW_TIE = SCENE.replace("[4, 0], [4, 4]", "[4, 4], [4, 0]")
SPIKE = SCENE.replace("[4, 4], [0, 4]", "[4, 4], [4, 4], [0, 4]")
WRITTEN = ["embed.js", "index.html", "scene.embed.txt", "scene.html", "scene.svg"]
WARNING = "warning: 1, polygon 1: invalid polygon (self-intersection at 2, 2), repaired"


def run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(main, list(map(str, arguments)))


def files(folder: Path) -> list[str]:
    return sorted(entry.name for entry in folder.iterdir())


# What it says of itself


def test_version() -> None:
    result = run("--version")
    assert (result.exit_code, result.stdout) == (0, f"geotween {__version__}\n")


@pytest.mark.parametrize("flag", ["-h", "--help"])
@pytest.mark.parametrize("command", ["", "build", "check", "events", "schema"])
def test_help_shows_examples(command: str, flag: str) -> None:
    result = run(*command.split(), flag)
    assert result.exit_code == 0
    assert "Example" in result.stdout
    assert f"  geotween {command}" in result.stdout
    assert max(map(len, result.stdout.splitlines())) <= 80


def test_help_lists_the_commands_and_the_exit_status() -> None:
    text = run("--help").stdout
    assert [word for word in ("build", "check", "events", "schema") if f"\n  {word}  " in text] == [
        "build", "check", "events", "schema",
    ]  # fmt: skip
    assert "0 done, 1 warnings (check, build --strict), 2 wrong usage, or errors" in " ".join(
        text.split()
    )


def test_schema_is_json() -> None:
    result = run("schema")
    assert (result.exit_code, result.stderr) == (0, "")
    assert json.loads(result.stdout)["title"] == "geotween scene"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["bild"], "No such command 'bild'"),
        (["build", "-o", "out"], "Missing argument 'SCENE...'"),
        (["build", "scene.yaml"], "Missing option '-o'"),
        (
            ["build", "scene.yaml", "-o", "out", "--format", "html,docx"],
            "expected some of html, svg",
        ),
        (["build", "scene.yaml", "-o", "out", "--format", ","], "expected some of html, svg"),
        (["check"], "Missing argument 'SCENE...'"),
        (["schema", "scene.yaml"], "unexpected extra argument"),
    ],
)
def test_wrong_usage_exits_with_2(arguments: list[str], message: str) -> None:
    result = run(*arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    assert message in result.stderr


# build


def test_build_writes_page_svg_and_index(write_scene: WriteScene, tmp_path: Path) -> None:
    out = tmp_path / "deep" / "out"
    result = run("build", write_scene(name="lake.yaml"), "-o", out)
    assert result.exit_code == 0
    assert files(out) == ["embed.js", "index.html", "lake.embed.txt", "lake.html", "lake.svg"]
    assert (out / "lake.html").read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    assert (out / "lake.svg").read_text(encoding="utf-8").rstrip().endswith("</svg>")
    assert 'href="lake.html"' in (out / "index.html").read_text(encoding="utf-8")
    assert result.stdout.splitlines()[0].startswith("lake: 1 transition, 1 piece → ")
    assert result.stdout.splitlines()[-1] == f"open {out / 'index.html'}"
    assert result.stderr == ""


@pytest.mark.parametrize(
    ("formats", "written"),
    [
        ("html", ["index.html", "scene.html"]),
        ("svg", ["index.html", "scene.svg"]),
        (" svg , html,", ["index.html", "scene.html", "scene.svg"]),
        ("html,embed", ["embed.js", "index.html", "scene.embed.txt", "scene.html"]),
        ("fragment,html", ["index.html", "scene.fragment.html", "scene.html"]),
    ],
)
def test_build_writes_the_formats_that_are_wanted(
    write_scene: WriteScene, tmp_path: Path, formats: str, written: list[str]
) -> None:
    out = tmp_path / "out"
    assert run("build", write_scene(), "-o", out, "--format", formats).exit_code == 0
    assert files(out) == written
    shown = "scene.html" if "html" in formats else "scene.svg"
    assert f'href="{shown}"' in (out / "index.html").read_text(encoding="utf-8")


def test_quiet_build_prints_nothing(write_scene: WriteScene, tmp_path: Path) -> None:
    result = run("build", write_scene(BOW_TIE), "-o", tmp_path / "out", "-q")
    assert (result.exit_code, result.output) == (0, "")
    assert files(tmp_path / "out") == WRITTEN


def test_several_scenes_have_one_index(write_scene: WriteScene, tmp_path: Path) -> None:
    out = tmp_path / "out"
    result = run("build", write_scene(name="a.yaml"), write_scene(name="b.yml"), "-o", out)
    assert result.exit_code == 0
    scenes = [name for name in files(out) if name.startswith(("a.", "b."))]
    assert scenes == ["a.embed.txt", "a.html", "a.svg", "b.embed.txt", "b.html", "b.svg"]
    index = (out / "index.html").read_text(encoding="utf-8")
    assert index.index('href="a.html"') < index.index('href="b.html"')


@pytest.mark.parametrize(
    ("names", "double"), [(["a.yaml", "a.yml"], "a"), (["index.yaml"], "index")]
)
def test_two_files_of_one_name_are_refused(
    write_scene: WriteScene, tmp_path: Path, names: list[str], double: str
) -> None:
    result = run("build", *[write_scene(name=name) for name in names], "-o", tmp_path / "out")
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr.startswith(f"two files would be called {double}.html; rename ")
    assert not (tmp_path / "out").exists()


def test_build_tells_of_warnings_and_counts_notes(write_scene: WriteScene, tmp_path: Path) -> None:
    result = run("build", write_scene(BOW_TIE), "-o", tmp_path / "out")
    assert result.exit_code == 0
    assert result.stderr.startswith(WARNING)
    result = run("build", write_scene(SPIKE), "-o", tmp_path / "out")
    assert (result.exit_code, result.stderr) == (0, "1 note: see geotween check\n")


def test_strict_build_of_a_repaired_polygon_exits_with_1_and_writes_nothing(
    write_scene: WriteScene, tmp_path: Path
) -> None:
    result = run("build", write_scene(BOW_TIE), "-o", tmp_path / "out", "--strict")
    assert (result.exit_code, result.stdout) == (1, "")
    assert result.stderr.startswith(WARNING)
    assert result.stderr.endswith("nothing written: --strict, and there are warnings\n")
    assert not (tmp_path / "out").exists()


def test_strict_build_forgives_what_was_mended_without_harm(
    write_scene: WriteScene, tmp_path: Path
) -> None:
    result = run("build", write_scene(SPIKE), "-o", tmp_path / "out", "--strict")
    assert result.exit_code == 0
    assert (tmp_path / "out" / "scene.html").exists()


# check


def test_check_of_a_sound_scene_exits_with_0(write_scene: WriteScene) -> None:
    path = write_scene()
    result = run("check", path)
    assert (result.exit_code, result.stderr) == (0, "")
    lines = result.stdout.splitlines()
    assert lines[0] == f"{path}: 2 steps, 1 transitions"
    assert lines[1].startswith("  1 → 2: ")
    assert "partition error 0" in lines[1]
    assert len(lines) == 2


def test_check_of_a_repaired_scene_exits_with_1(write_scene: WriteScene) -> None:
    result = run("check", write_scene(BOW_TIE))
    assert result.exit_code == 1
    assert f"  {WARNING}" in result.stdout


def test_check_prints_notes_and_exits_with_0(write_scene: WriteScene) -> None:
    result = run("check", write_scene(SPIKE))
    assert result.exit_code == 0
    assert "  note: 1, polygon 1: points that repeat the one before" in result.stdout


def test_check_of_a_bad_scene_exits_with_2(write_scene: WriteScene) -> None:
    good, bad = write_scene(name="good.yaml"), write_scene("titel: t\n", name="bad.yaml")
    result = run("check", good, bad)
    assert (result.exit_code, result.stdout) == (2, "")
    assert f"{bad}:1:1: unknown key" in result.stderr


def test_check_looks_at_every_scene(write_scene: WriteScene) -> None:
    sound, mended = write_scene(name="a.yaml"), write_scene(BOW_TIE, name="b.yaml")
    for order in ([sound, mended], [mended, sound]):
        result = run("check", *order)
        assert result.exit_code == 1
        assert all(f"{path}: 2 steps" in result.stdout for path in order)


@pytest.mark.parametrize(("text", "status"), [(SCENE, 0), (BOW_TIE, 1)])
def test_quiet_check_has_its_status_only(write_scene: WriteScene, text: str, status: int) -> None:
    result = run("check", "-q", write_scene(text))
    assert (result.exit_code, result.output) == (status, "")


# In a process of its own


def process(*arguments: str | Path, **environment: str) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run(
        [sys.executable, "-m", "geotween", *arguments],
        env={**os.environ, **environment}, capture_output=True, timeout=120, check=False,
    )  # fmt: skip


def test_same_scene_gives_the_same_bytes(write_scene: WriteScene, tmp_path: Path) -> None:
    text = SCENE.replace(
        "[[[1, 0]", "[{key: ä, class: x, polygon: [[[7, 0], [9, 0], [9, 9]]]}, [[1, 0]"
    )
    path = write_scene(f"style: {{class: {{x: {{fill: red}}, y: {{}}}}}}\n{text}")
    built = []
    for number, environment in enumerate(
        [
            {"PYTHONHASHSEED": "1", "LC_ALL": "C"},
            {"PYTHONHASHSEED": "1", "LC_ALL": "C"},
            {"PYTHONHASHSEED": "2", "LC_ALL": "C.UTF-8", "TZ": "Asia/Tokyo"},
        ]
    ):
        out = tmp_path / str(number)
        assert process("build", path, "-o", out, "-q", **environment).returncode == 0
        built.append({name: (out / name).read_bytes() for name in files(out)})
    assert sorted(built[0]) == WRITTEN
    assert built[0] == built[1] == built[2]


def test_terminal_that_has_no_arrow_still_gets_the_rest(write_scene: WriteScene) -> None:
    result = process("check", write_scene(), PYTHONIOENCODING="cp1252")
    assert (result.returncode, result.stderr) == (0, b"")
    assert b"1 ? 2: proved, by trajectory, partition error" in result.stdout


# Whole or not at all


def test_files_that_cannot_be_put_in_place_leave_nothing_behind(
    write_scene: WriteScene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    out = tmp_path / "out"
    out.mkdir()
    (out / "scene.html").write_text("old")
    monkeypatch.setattr(Path, "replace", full)
    result = run("build", write_scene(), "-o", out)
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr == f"cannot write to {out}: No space left on device\n"
    assert files(out) == ["scene.html"]
    assert (out / "scene.html").read_text() == "old"


def test_file_that_cannot_be_written_leaves_the_old_ones(
    write_scene: WriteScene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out"
    assert run("build", write_scene(), "-o", out).exit_code == 0
    before = {name: (out / name).read_bytes() for name in files(out)}

    opened, fdopen = [], os.fdopen

    def full_at_the_third(handle: int, *mode: str) -> object:
        opened.append(handle)
        if len(opened) == 3:
            os.close(handle)
            raise OSError(28, "No space left on device")
        return fdopen(handle, *mode)

    monkeypatch.setattr(os, "fdopen", full_at_the_third)
    result = run("build", write_scene(SCENE.replace("Two", "Other")), "-o", out)
    assert result.exit_code == 2
    assert len(opened) == 3
    assert {name: (out / name).read_bytes() for name in files(out)} == before


def test_rebuilt_files_take_the_place_of_the_old_ones(
    write_scene: WriteScene, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    assert run("build", write_scene(), "-o", out).exit_code == 0
    assert run("build", write_scene(SCENE.replace("Two", "Other")), "-o", out).exit_code == 0
    assert files(out) == WRITTEN
    for name in files(out)[1:]:
        text = (out / name).read_text(encoding="utf-8")
        assert "Other squares" in text
        assert "Two squares" not in text


def test_files_get_the_permissions_of_new_files(write_scene: WriteScene, tmp_path: Path) -> None:
    assert run("build", write_scene(), "-o", tmp_path / "out").exit_code == 0
    (tmp_path / "new").touch()
    usual = (tmp_path / "new").stat().st_mode
    assert {(tmp_path / "out" / name).stat().st_mode for name in files(tmp_path / "out")} == {usual}


def test_check_measures_frames_where_asked(write_scene: WriteScene) -> None:
    (told,) = json.loads(run("check", "--json", "--frames", write_scene()).stdout)
    measures = told["transitions"][0]["measures"]
    assert measures["overlap"] == 0
    assert measures["lost"] == pytest.approx(0, abs=1e-12)
    (told,) = json.loads(run("check", "--json", write_scene()).stdout)
    assert "overlap" not in told["transitions"][0]["measures"]


def test_check_as_json_says_what_is_proved(write_scene: WriteScene) -> None:
    result = run("check", "--json", write_scene())
    (told,) = json.loads(result.stdout)
    assert told["steps"] == ["1", "2"]
    (transition,) = told["transitions"]
    assert (transition["steps"], transition["valid"]) == (["1", "2"], True)
    assert told["problems"] == []
    assert result.exit_code == 0
