"""Furniture in a real browser: labels go with their regions, in page and SVG alike."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser

import geotween
from geotween.export.build import build, plan_scene
from geotween.export.keyframes import keyframes
from tests.browser import drawn

SCENE = """
title: A square walks
map:
  unit: km
  width: 600
  legend: {walker: The walker, ground: Ground}
  layers: [{name: ground, fill: tan, polygons: [[[0, 0], [100, 0], [100, 60], [0, 60]]]}]
  annotations: [{text: Here it ends, at: [80, 20], steps: [End]}]
motion: {method: morph}
timing: {hold: 1, transition: 2, loop: false}
steps:
  - label: Start
    polygons:
      - {key: a, class: walker, name: Alpha, polygon: [[5, 5], [35, 5], [35, 35], [5, 35]]}
  - label: End
    polygons:
      - {key: a, class: walker, name: Alpha, polygon: [[65, 5], [95, 5], [95, 35], [65, 35]]}
"""

PLACES = """() => [...document.querySelectorAll('.labels text')]
  .filter(text => getComputedStyle(text).visibility === 'visible')
  .map(text => {
    const box = text.getBBox(), moves = text.transform.animVal;
    const { e, f } = moves.numberOfItems ? moves.getItem(0).matrix : { e: 0, f: 0 };
    return [text.textContent, box.x + box.width / 2 + e, box.y + box.height / 2 + f];
  })"""

SHOWN = """() => [...document.querySelectorAll('g.annotation')]
  .map(note => getComputedStyle(note).visibility === 'visible')"""


@pytest.fixture(scope="module")
def walk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("walk")
    file = folder / "walk.yaml"
    file.write_text(SCENE, encoding="utf-8")
    build(geotween.load(file), folder)
    return file


@pytest.mark.parametrize("suffix", ["html", "svg"])
def test_a_label_goes_with_its_region(browser: Browser, walk: Path, suffix: str) -> None:
    scene = geotween.load(walk)
    (label,) = keyframes(scene, plan_scene(scene)[0]).furniture.labels
    (_, start_x, start_y), (_, end_x, end_y) = label.spans[0][0], label.spans[2][0]
    stop, seek = drawn.HANDS[suffix]
    with drawn.open_page(browser, walk.with_suffix(f".{suffix}")) as page:
        stop(page)
        for span, time, t in [(0, 0.5, 0.0), *drawn.moments(scene, 7), (2, 3.5, 1.0)]:
            seek(page, time)
            ((text, x, y),) = page.evaluate(PLACES)
            assert text == "Alpha", span
            assert x == pytest.approx(start_x + (end_x - start_x) * t, abs=1)
            assert y == pytest.approx(start_y + (end_y - start_y) * t, abs=3)  # of the baseline


@pytest.mark.parametrize("suffix", ["html", "svg"])
def test_an_annotation_is_seen_at_its_step(browser: Browser, walk: Path, suffix: str) -> None:
    stop, seek = drawn.HANDS[suffix]
    with drawn.open_page(browser, walk.with_suffix(f".{suffix}")) as page:
        stop(page)
        seen = []
        for time in (0.5, 1.5, 2.5, 3.5):
            seek(page, time)
            seen += page.evaluate(SHOWN)
    assert seen == [False, False, True, True]


def test_without_script_labels_stand_at_the_first_step(browser: Browser, walk: Path) -> None:
    with drawn.open_page(browser, walk.with_suffix(".html"), java_script_enabled=False) as page:
        assert page.locator(".figure .label").all_text_contents() == ["Alpha"]
        assert page.locator(".figure .annotation").get_attribute("visibility") == "hidden"
        assert page.locator(".figure .scale-bar").count() == 1
        assert page.locator(".multiples .still").count() == 2


def test_an_svg_is_whole_inside_an_img(browser: Browser, walk: Path, tmp_path: Path) -> None:
    holder = walk.with_name("holder.html")
    holder.write_text('<!doctype html><body style="margin:0"><img src="walk.svg">', "utf-8")
    page = browser.new_page(viewport={"width": 640, "height": 640})
    page.goto(holder.as_uri())
    height = page.evaluate("document.images[0].naturalHeight")
    svg = walk.with_suffix(".svg").read_text(encoding="utf-8")
    assert f'height="{height}"' in svg
    file = tmp_path / "img.png"
    page.screenshot(path=str(file))
    page.close()
    from PIL import Image

    pixels = np.asarray(Image.open(file).convert("RGB")).astype(int)
    below = pixels[height - 60 : height, :600]
    for colour in ((0, 0x72, 0xB2), (0xD2, 0xB4, 0x8C)):  # the legend's two squares
        assert (np.abs(below - colour).max(axis=2) < 3).sum() > 60


@pytest.mark.parametrize("width", [320, 1280])
def test_legend_and_map_keep_to_the_page(browser: Browser, walk: Path, width: int) -> None:
    size = {"width": width, "height": 800}
    with drawn.open_page(browser, walk.with_suffix(".html"), viewport=size) as page:
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        assert page.locator(".legend li").all_text_contents() == ["The walker", "Ground"]
