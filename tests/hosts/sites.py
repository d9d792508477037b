"""Real little sites with two maps, each built by the real tool."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import geotween

PACKAGES = Path(geotween.__file__).parents[1]

SCENE = """\
title: {title}
description: A square moves to the right.
map: {{width: 300}}
timing: {{transition: 1, hold: 0.5}}
steps:
  - {{label: one, polygons: [[[0, 0], [4, 0], [4, 4], [0, 4]]]}}
  - {{label: two, polygons: [[[4, 0], [8, 0], [8, 4], [4, 4]]]}}
"""
TITLES = {"first": 'One & "two" <b>', "second": "Another"}

CELL = """\
import geotween
scene = geotween.load("first.yaml")
scene.save("saved.html")
scene
"""
MORPH = """\
from shapely.geometry import box
geotween.morph([box(0, 0, 4, 4)], [box(4, 0, 8, 4)], method="morph")
"""


def write_scenes(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name, title in TITLES.items():
        text = SCENE.format(title=f"'{title}'")
        (folder / f"{name}.yaml").write_text(text, encoding="utf-8")


def run(folder: Path, *command: str) -> None:
    """Run a module of Python in a folder, with nothing read or kept at home."""
    homes = ("HOME", "JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR", "IPYTHONDIR")
    own = {name: str(folder / ".home") for name in homes}
    own["PYTHONPATH"] = os.pathsep.join(filter(None, [str(PACKAGES), os.getenv("PYTHONPATH")]))
    (folder / ".home").mkdir()
    done = subprocess.run(
        [sys.executable, "-m", *command],
        cwd=folder, env={**os.environ, **own}, capture_output=True, encoding="utf-8", check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr


def notebook(folder: Path) -> Path:
    """A notebook with a scene and a motion, run and made a page by nbconvert."""
    import nbformat

    write_scenes(folder)
    cells = [nbformat.v4.new_code_cell(source) for source in (CELL, MORPH)]
    book = nbformat.v4.new_notebook(cells=cells)
    for number, cell in enumerate(cells):
        cell["id"] = f"cell-{number}"
    nbformat.write(book, folder / "maps.ipynb")
    run(folder, "nbconvert", "--execute", "--to", "html", "maps.ipynb")
    return folder / "maps.html"


def sphinx(folder: Path) -> Path:
    """A site of Sphinx."""
    write_scenes(folder)
    (folder / "conf.py").write_text('extensions = ["geotween.hosts.sphinx"]\n', encoding="utf-8")
    text = "Maps\n====\n\n.. geotween:: first.yaml\n\n.. geotween:: /second.yaml\n"
    (folder / "index.rst").write_text(text, encoding="utf-8")
    run(folder, "sphinx", "-W", "-q", ".", "out")
    return folder / "out" / "index.html"


def mkdocs(folder: Path) -> Path:
    """A site of MkDocs."""
    write_scenes(folder / "docs")
    settings = (
        "site_name: Maps\nuse_directory_urls: false\n"
        "theme: {name: mkdocs, highlightjs: false}\n"
        "markdown_extensions: [{geotween.hosts.markdown: {base: docs}}]\n"
    )
    (folder / "mkdocs.yml").write_text(settings, encoding="utf-8")
    text = "# Maps\n\nSome *text*.\n{{ geotween first.yaml }}\nMore.\n\n{{geotween second.yaml}}\n"
    (folder / "docs" / "index.md").write_text(text, encoding="utf-8")
    run(folder, "mkdocs", "build", "--strict", "--quiet")
    return folder / "site" / "index.html"


def pelican(folder: Path) -> Path:
    """A site of Pelican, whose own template asks for the maps."""
    write_scenes(folder / "content")
    settings = (
        "from geotween.hosts.jinja import maps\n"
        'JINJA_GLOBALS = {"geotween": maps("content")}\n'
        'PATH, TIMEZONE, DEFAULT_LANG, SITEURL = "content", "UTC", "en", ""\n'
        'THEME_TEMPLATES_OVERRIDES = ["templates"]\n'
        "FEED_ALL_ATOM = CATEGORY_FEED_ATOM = None\n"
    )
    (folder / "pelicanconf.py").write_text(settings, encoding="utf-8")
    (folder / "templates").mkdir()
    template = (
        "<!doctype html><title>Maps</title>\n"
        '{{ geotween("first.yaml") }}{{ geotween("second.yaml") }}\n'
    )
    (folder / "templates" / "index.html").write_text(template, encoding="utf-8")
    run(folder, "pelican", "--quiet", "--output", "out")
    return folder / "out" / "index.html"


SITES: dict[str, Callable[[Path], Path]] = {
    "notebook": notebook,
    "sphinx": sphinx,
    "mkdocs": mkdocs,
    "pelican": pelican,
}
