"""Seams do not show: pixels along a closed seam have the colour of the region."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from playwright.sync_api import Browser, Page

import geotween
from tests.browser import drawn

# A square that parts into three rough pieces along slanting seams.
THREE = """
      - {class: a, polygon: [[1, 1], [3, 0.5], [4, 1.5], [6, 0.4], [7, 1.2], [9, 0.6],
        [10, 2], [13, 2], [12, 4], [12.6, 5], [11, 6], [11.5, 8], [11, 9], [10, 7.5], [9, 8],
        [8, 6], [7, 5], [6, 6.5], [5, 6], [5, 8], [4, 8], [3, 11],
        [2.5, 9], [1.5, 8], [2, 6], [1, 4]]}
      - {class: b, polygon: [[18, 3], [29, 1], [28, 14], [22, 11], [20, 13], [17, 7]]}
      - {class: c, polygon: [[9, 19], [23, 18], [26, 27], [14, 24], [11, 29]]}
"""
SCENE = """
title: Seams
map: {{width: 400, background: "#ffffff"}}
style: {{stroke: {stroke}, width: 2, opacity: 1, fill: "#204060", {style}}}
motion: {{easing: linear}}
timing: {{transition: 3600, hold: 1}}
steps:
  - polygons: [{{class: whole, polygon: [[0, 0], [30, 0], [30, 30], [0, 30]]}}]
  - polygons: {three}
  - polygons: [{{class: whole, polygon: [[0, 0], [30, 0], [30, 30], [0, 30]]}}]
"""
COLOURS = 'class: {a: {fill: "#803020"}, b: {fill: "#208030"}, c: {fill: "#704090"}}'
FORMATS = pytest.mark.parametrize("suffix", drawn.HANDS)


@pytest.fixture(params=["one colour", "three colours"])
def style(request: pytest.FixtureRequest) -> str:
    return COLOURS if request.param == "three colours" else ""


def inside(page: Page) -> NDArray[np.int64]:
    """The pixels of the square, (m, m, 3), without its rim."""
    selector = "svg" if page.url.endswith("svg") else "svg.figure"
    box = page.locator(selector).bounding_box()
    assert box is not None
    pixels = np.array(Image.open(io.BytesIO(page.screenshot())).convert("RGB"), dtype=int)
    scale = box["width"] / 400
    top = box["y"] - scale * page.evaluate(
        f"document.querySelector('{selector}').viewBox.baseVal.y"
    )
    low, high = 24 * scale, 376 * scale
    return pixels[int(top + low) : int(top + high), int(box["x"] + low) : int(box["x"] + high)]


def assert_one_colour(pixels: NDArray[np.int64]) -> None:
    """No hairline: Chromium may miss single pixels at a vertex of a seam, never a line of them."""
    usual = np.median(pixels.reshape(-1, 3), axis=0)
    different = (np.abs(pixels - usual) > 3).any(axis=2)
    assert different.sum() <= 2


def at(browser: Browser, folder: Path, text: str, suffix: str, time: float) -> NDArray[np.int64]:
    (folder / "seams.yaml").write_text(text, encoding="utf-8")
    geotween.build(geotween.load(folder / "seams.yaml"), folder)
    size = {"width": 440, "height": 700}
    with drawn.open_page(browser, folder / f"seams.{suffix}", viewport=size) as page:
        stop, seek = drawn.HANDS[suffix]
        stop(page)
        seek(page, time)
        page.wait_for_timeout(50)
        return inside(page)


# The first and the last millisecond of an hour: the pieces move, and have not come apart yet.
@FORMATS
@pytest.mark.parametrize("stroke", ["none", '"#ffffff"'], ids=["bare", "stroked"])
@pytest.mark.parametrize("time", [1.001, 7201.999], ids=["just parted", "almost joined"])
def test_a_closed_seam_does_not_show(
    browser: Browser, tmp_path: Path, suffix: str, stroke: str, time: float, style: str
) -> None:
    text = SCENE.format(stroke=stroke, style=style, three=THREE)
    assert_one_colour(at(browser, tmp_path, text, suffix, time))


@FORMATS
def test_an_open_seam_is_stroked(browser: Browser, tmp_path: Path, suffix: str) -> None:
    text = SCENE.format(stroke='"#ffff00"', style="", three=THREE)
    pixels = at(browser, tmp_path, text, suffix, 1000)
    yellow = (pixels[..., 0] > 200) & (pixels[..., 1] > 200) & (pixels[..., 2] < 60)
    assert yellow.sum() > 100


# Tilings whose cells meet along one line.
A = "{key: a, polygon: [[0, 0], [13, 0], [19, 30], [0, 30]]}"
TILINGS = {
    "a beside b": f"[{A}, {{key: b, polygon: [[13, 0], [30, 0], [30, 30], [19, 30]]}}]",
    # b and c each lie along half of a's edge, which has no vertex where they meet.
    "a beside b and c": f"[{A}, {{key: b, polygon: [[13, 0], [30, 0], [30, 15], [16, 15]]}}, "
    "{key: c, polygon: [[16, 15], [30, 15], [30, 30], [19, 30]]}]",
}


@FORMATS
@pytest.mark.parametrize("tiles", TILINGS.values(), ids=TILINGS)
def test_abutting_regions_of_one_fill_and_different_keys_show_no_hairline(
    browser: Browser, tmp_path: Path, suffix: str, tiles: str
) -> None:
    text = (
        "title: Seams\nmap: {width: 400}\nmotion: {correspondence: key}\n"
        f'style: {{stroke: none, opacity: 1, fill: "#204060"}}\n'
        f"steps: [{{polygons: {tiles}}}, {{polygons: {tiles}}}]\n"
    )
    for time in (0.5, 1.8):
        assert_one_colour(at(browser, tmp_path, text, suffix, time))
