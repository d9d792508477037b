"""What notebooks are given, and what is saved."""

from __future__ import annotations

import html
import re
from base64 import b64decode
from pathlib import Path
from xml.etree import ElementTree

import pytest
from IPython.core.formatters import DisplayFormatter
from shapely.geometry import box

import geotween
from tests.conftest import SCENE, WriteScene

TITLE = "<b>\"Two\" & 'squares'</b>"


@pytest.fixture
def scene(write_scene: WriteScene) -> geotween.Scene:
    quoted = TITLE.replace("'", "''")
    return geotween.load(write_scene(SCENE.replace("Two squares", f"'{quoted}'")))


@pytest.fixture
def motion() -> geotween.Morph:
    return geotween.morph({"a": box(0, 0, 4, 4)}, {"a": box(9e6, 0, 9e6 + 5, 5)})


def framed(shown: str) -> str:
    """The page inside a frame."""
    found = re.search(r'srcdoc="([^"]*)"', shown)
    assert found
    return html.unescape(found[1])


def test_ipython_is_given_a_page_a_picture_and_a_line(scene: geotween.Scene) -> None:
    shown, _ = DisplayFormatter().format(scene)
    assert shown["text/plain"] == f"Scene of 2 steps: {TITLE}"
    assert ElementTree.fromstring(shown["image/svg+xml"]).tag.endswith("svg")
    assert "<geotween-map" in framed(shown["text/html"])


def test_the_page_is_the_one_that_is_saved(scene: geotween.Scene, tmp_path: Path) -> None:
    saved = scene.save(tmp_path / "map.html").read_text(encoding="utf-8")
    assert framed(scene._repr_html_()) == saved


def test_the_frame_is_isolated_and_all_words_are_text(scene: geotween.Scene) -> None:
    shown = scene._repr_html_()
    assert 'sandbox="allow-scripts"' in shown
    assert "<script" not in shown
    assert "<b>" not in shown
    assert shown.isascii()


def test_where_frames_are_stripped_a_still_is_left(scene: geotween.Scene) -> None:
    stripped = re.sub("<iframe.*</iframe>", "", scene._repr_html_(), flags=re.DOTALL)
    address = re.search(r'<img src="data:image/svg\+xml;base64,([^"]+)"', stripped)
    assert address
    assert "absolute" not in stripped  # it takes its room without any other style
    still = ElementTree.fromstring(b64decode(address[1]))
    assert still.findall(".//{http://www.w3.org/2000/svg}path")


def test_a_motion_shows_itself_too(motion: geotween.Morph, tmp_path: Path) -> None:
    shown, _ = DisplayFormatter().format(motion)
    assert shown["text/plain"] == "Morph of 2 steps: From origin to target"
    page = framed(shown["text/html"])
    assert page == motion.save(tmp_path / "morph.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("suffix", [".html", ".svg", ".keyframes.json", ".paths.json"])
def test_saved_as_the_suffix_says(scene: geotween.Scene, tmp_path: Path, suffix: str) -> None:
    built = geotween.build(scene, tmp_path / "built", ["html", "svg", "json", "paths"])
    same = next(file for file in built.files if file.name == f"scene{suffix}")
    if suffix == ".html":  # it stands alone, without a link to the SVG
        same = geotween.build(scene, tmp_path / "alone", ["html"]).files[0]
    path = tmp_path / "deep" / f"map{suffix}"
    assert scene.save(path).read_bytes() == same.read_bytes()


def test_unknown_suffix_is_refused(scene: geotween.Scene, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"map\.doc says no format; known are \.html, "):
        scene.save(tmp_path / "map.doc")
    assert [*tmp_path.glob("map*")] == []
