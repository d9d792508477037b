"""The wheel: built, installed into an empty environment, and put to work there."""

from __future__ import annotations

import subprocess
import sys
import venv
from pathlib import Path

import pytest
import shapely

CHECKOUT = Path(__file__).parents[1]
# Where the dependencies lie; the checkout is not importable from there by a path alone.
DEPENDENCIES = Path(shapely.__file__).parents[1]


def run(*command: str | Path, cwd: Path) -> str:
    done = subprocess.run(command, cwd=cwd, capture_output=True, encoding="utf-8", check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def python(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The Python of an environment that holds the wheel; dependencies are lent to it."""
    folder = tmp_path_factory.mktemp("wheel")
    run(
        sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", folder, CHECKOUT,
        cwd=folder,
    )  # fmt: skip
    (wheel,) = folder.glob("*.whl")
    venv.create(folder / "venv", with_pip=False)
    (python,) = (folder / "venv").glob("*/python")
    run(
        sys.executable, "-m", "pip", "--python", python, "install", "--quiet", "--no-index",
        "--no-deps", "--disable-pip-version-check", wheel,
        cwd=folder,
    )  # fmt: skip
    (packages,) = (folder / "venv").glob("lib/*/site-packages")
    (packages / "dependencies.pth").write_text(f"{DEPENDENCIES}\n", encoding="utf-8")
    return python


def test_wheel_is_what_is_imported(python: Path, tmp_path: Path) -> None:
    code = "import geotween; print(geotween.__file__)"
    installed = Path(run(python, "-I", "-c", code, cwd=tmp_path).strip())
    assert installed.is_relative_to(python.parents[1])


@pytest.mark.parametrize("name", ["templates", "scenes"])
def test_wheel_holds_every_shipped_file(python: Path, tmp_path: Path, name: str) -> None:
    code = f"""if True:
        from geotween.export.resources import resource
        print(resource({name!r}))"""
    found = Path(run(python, "-I", "-c", code, cwd=tmp_path).strip())
    assert found.is_relative_to(python.parents[1])
    for path in (CHECKOUT / name).rglob("*"):
        if path.is_file():
            assert (found / path.relative_to(CHECKOUT / name)).read_bytes() == path.read_bytes()


def test_wheel_builds_a_scene_that_it_ships(python: Path, tmp_path: Path) -> None:
    (scene,) = python.parents[1].glob("lib/*/site-packages/geotween/scenes/archipelago.yaml")
    run(python, "-I", "-m", "geotween", "build", scene, "-o", "out", cwd=tmp_path)
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == [
        "archipelago.embed.txt", "archipelago.html", "archipelago.svg", "embed.js", "index.html",
    ]  # fmt: skip
    assert "Maui Nui" in (tmp_path / "out" / "archipelago.html").read_text(encoding="utf-8")


def test_wheel_has_its_command(python: Path, tmp_path: Path) -> None:
    assert run(python.parent / "geotween", "--version", cwd=tmp_path).startswith("geotween ")
