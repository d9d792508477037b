"""The steps lie side by side where nothing moves: in print, without script, on demand."""

from __future__ import annotations

import re
import zlib
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Page

import geotween
from tests.browser import drawn

FILLS = {"a": "#ff0000", "b": "#00ff00", "c": "#0000ff"}
SQUARE = "polygon: [[0, 0], [4, 0], [4, 4], [0, 4]]"
LABELS = ["first", "second", "third"]


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """Three steps, each with a colour of its own."""
    style = ", ".join(f'{name}: {{fill: "{fill}"}}' for name, fill in FILLS.items())
    steps = "".join(
        f"  - {{label: {label}, caption: What is {label}, "
        f"polygons: [{{class: {name}, {SQUARE}}}]}}\n"
        for label, name in zip(LABELS, FILLS, strict=True)
    )
    text = f"title: Still\nmap: {{width: 300}}\nstyle: {{opacity: 1, class: {{{style}}}}}\nsteps:\n"
    (tmp_path / "still.yaml").write_text(text + steps, encoding="utf-8")
    return geotween.build(geotween.load(tmp_path / "still.yaml"), tmp_path).files[0]


def visible_captions(page: Page) -> list[str]:
    captions = page.locator(".multiples figcaption")
    return [c.inner_text() for c in captions.all() if c.is_visible()]


def visible_fills(page: Page) -> list[str]:
    paths = page.locator(".multiples svg path")
    return [str(p.get_attribute("fill")) for p in paths.all() if p.is_visible()]


def assert_side_by_side(page: Page) -> None:
    captions = visible_captions(page)
    assert [c.split()[0] for c in captions] == LABELS
    assert all(f"What is {label}" in c for label, c in zip(LABELS, captions, strict=True))
    assert visible_fills(page) == list(FILLS.values())


def test_on_screen_there_is_the_player_alone(browser: Browser, file: Path) -> None:
    with drawn.open_page(browser, file) as page:
        assert visible_captions(page) == []
        assert page.locator("geotween-map svg.figure").is_visible()


@pytest.mark.parametrize(
    "options", [{"java_script_enabled": False}, {"reduced_motion": "reduce"}], ids=str
)
def test_the_steps_lie_side_by_side(browser: Browser, file: Path, options: dict[str, Any]) -> None:
    with drawn.open_page(browser, file, **options) as page:
        assert_side_by_side(page)
        with_script = "java_script_enabled" not in options
        assert page.locator("geotween-map svg.figure").is_visible() == with_script
        assert page.locator(".controls").count() == with_script


def test_in_print_the_steps_lie_side_by_side(browser: Browser, file: Path) -> None:
    with drawn.open_page(browser, file) as page:
        page.emulate_media(media="print", color_scheme="dark")
        assert_side_by_side(page)
        assert not page.locator("geotween-map svg.figure").is_visible()
        assert not page.locator(".transport").is_visible()
        ink = page.evaluate("getComputedStyle(document.body).color")
        assert max(map(int, re.findall(r"\d+", ink))) < 64  # dark, whatever the screen prefers


def test_a_pdf_has_the_colours_of_all_steps(browser: Browser, file: Path) -> None:
    with drawn.open_page(browser, file) as page:
        streams = re.findall(rb"stream\r?\n(.*?)endstream", page.pdf(), re.DOTALL)
    text = b"".join(map(unpacked, streams)).decode("latin-1")
    for colour in ("1 0 0 rg", "0 1 0 rg", "0 0 1 rg"):
        assert colour in text


def unpacked(stream: bytes) -> bytes:
    try:
        return zlib.decompress(stream)
    except zlib.error:
        return b""
