"""Adapters for site builders: what they put in, and what becomes of errors."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from jinja2 import Environment, StrictUndefined
from markdown import Markdown

from geotween import SceneError
from geotween.hosts.jinja import maps
from tests.hosts.sites import PACKAGES, write_scenes

BROKEN = "titel: <b>\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_scenes(tmp_path)
    (tmp_path / "broken.yaml").write_text(BROKEN, encoding="utf-8")
    return tmp_path


def converted(folder: Path, text: str) -> str:
    extensions = ["geotween.hosts.markdown", "fenced_code", "toc"]
    options = {"geotween.hosts.markdown": {"base": str(folder)}}
    return Markdown(extensions=extensions, extension_configs=options).convert(text)


def test_markdown_puts_maps_where_they_are_asked_for(folder: Path) -> None:
    text = converted(
        folder, "# Title\nbefore\n{{ geotween first.yaml }}\nafter\n\n{{geotween second.yaml}}"
    )
    parts = text.split("<iframe")
    assert len(parts) == 3
    assert "before</p>" in parts[0]
    assert "<p>after</p>" in parts[1]
    assert text.count('class="geotween-frame"') == 2


@pytest.mark.parametrize(
    "text",
    [
        "```\n{{ geotween first.yaml }}\n```",
        "~~~~\n~~~\n{{ geotween first.yaml }}\n~~~~",
        "    {{ geotween first.yaml }}",
        "see `{{ geotween first.yaml }}`",
    ],
    ids=["fence", "longer fence", "indented", "inline"],
)
def test_markdown_leaves_code_as_it_is(folder: Path, text: str) -> None:
    shown = converted(folder, text)
    assert "{{ geotween first.yaml }}" in shown
    assert "<iframe" not in shown


def test_markdown_stops_at_a_broken_scene(folder: Path) -> None:
    with pytest.raises(SceneError, match=r"broken\.yaml:1:1: unknown key"):
        converted(folder, "{{ geotween broken.yaml }}")


def test_a_template_has_maps_as_markup(folder: Path) -> None:
    environment = Environment(autoescape=True, undefined=StrictUndefined)
    environment.globals["geotween"] = maps(folder)
    shown = environment.from_string("<p>{{ geotween('first.yaml') }}").render()
    assert shown.startswith('<p><div class="geotween-frame"')
    with pytest.raises(SceneError, match=r"broken\.yaml:1:1"):
        environment.from_string("{{ geotween('broken.yaml') }}").render()


def test_sphinx_tells_errors_at_their_place_and_words_where_there_is_no_html(folder: Path) -> None:
    (folder / "conf.py").write_text('extensions = ["geotween.hosts.sphinx"]\n', encoding="utf-8")
    text = "Maps\n====\n\n.. geotween:: first.yaml\n\n.. geotween:: broken.yaml\n"
    (folder / "index.rst").write_text(text, encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "sphinx", "-q", "-b", "text", ".", "out"],
        cwd=folder, env={"PYTHONPATH": str(PACKAGES), "HOME": str(folder)},
        capture_output=True, encoding="utf-8", check=False,
    )  # fmt: skip
    assert "index.rst:6: ERROR: " in done.stderr
    assert "broken.yaml:1:1: unknown key" in done.stderr
    shown = (folder / "out" / "index.txt").read_text(encoding="utf-8")
    assert 'One & "two" <b>. A square moves to the right.' in shown
    assert "iframe" not in shown
