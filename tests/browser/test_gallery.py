"""Every page and every SVG of the gallery, played in a real browser."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from playwright.sync_api import Browser

import geotween
from geotween.export.resources import resource
from tests.browser import drawn

SCENES = sorted(resource("scenes").glob("*.yaml"))
EACH_SCENE = pytest.mark.parametrize("path", SCENES, ids=lambda p: p.stem)


def test_there_are_scenes() -> None:
    assert len(SCENES) >= 5


@EACH_SCENE
@pytest.mark.parametrize("suffix", drawn.HANDS)
def test_what_is_drawn_is_what_frame_says(
    path: Path, suffix: str, gallery: Path, browser: Browser
) -> None:
    scene = geotween.load(path)
    stop, seek = drawn.HANDS[suffix]
    with drawn.open_page(browser, gallery / f"{path.stem}.{suffix}") as page:
        stop(page)
        drawn.assert_plays_as_planned(scene, page, seek, drawn.TOLERANCES[suffix])
        drawn.assert_rests_are_exact(scene, page, seek)


@EACH_SCENE
def test_the_second_round_of_the_svg_is_like_the_first(
    path: Path, gallery: Path, browser: Browser
) -> None:
    scene = geotween.load(path)
    with drawn.open_page(browser, gallery / f"{path.stem}.svg") as page:
        drawn.stop_svg(page)
        duration = page.evaluate("document.querySelector('animate').getSimpleDuration()")
        for _, time, _ in drawn.moments(scene, per_transition=3):
            drawn.seek_svg(page, time)
            first = drawn.drawn(page)
            drawn.seek_svg(page, time + duration)
            drawn.assert_same(drawn.drawn(page), first, tolerance=0.01)


@EACH_SCENE
def test_page_and_svg_move_by_themselves(path: Path, gallery: Path, browser: Browser) -> None:
    first_move = drawn.moments(geotween.load(path), 1)[0][1]
    with drawn.open_page(browser, gallery / f"{path.stem}.html") as page:
        element = "document.querySelector('geotween-map')"
        assert page.evaluate(f"!{element}.paused")
        before = page.evaluate(f"{element}.currentTime")
        page.wait_for_timeout(200)
        assert page.evaluate(f"{element}.currentTime") > before
    with drawn.open_page(browser, gallery / f"{path.stem}.svg") as page:
        drawn.seek_svg(page, first_move)
        before = page.evaluate(drawn.VISIBLE_REGIONS)
        page.wait_for_timeout(200)
        assert page.evaluate(drawn.VISIBLE_REGIONS) != before


@EACH_SCENE
def test_the_svg_plays_in_an_img(path: Path, gallery: Path, browser: Browser) -> None:
    _, moving, _ = drawn.moments(geotween.load(path), 1)[0]
    page = browser.new_page(viewport={"width": 400, "height": 400})
    page.goto((gallery / "index.html").as_uri())
    address = (gallery / f"{path.stem}.svg").as_uri()
    page.set_content(f'<img width="300" alt="" src="{address}">')
    image = page.locator("img")
    first = image.screenshot()
    page.wait_for_timeout(1000 * moving)
    assert page.evaluate("document.images[0].naturalWidth") > 0
    assert image.screenshot() != first
    page.close()


@EACH_SCENE
def test_the_clock_is_written_where_others_can_read_it(
    path: Path, gallery: Path, browser: Browser
) -> None:
    with drawn.open_page(browser, gallery / f"{path.stem}.html") as page:
        steps = page.evaluate("document.querySelector('geotween-map').steps")
    with drawn.open_page(browser, gallery / f"{path.stem}.svg") as page:
        written = json.loads(page.evaluate("document.documentElement.dataset.steps"))
    assert written == steps
    assert [s["label"] for s in steps] == [s.label for s in geotween.load(path).steps]


def test_the_index_shows_a_still_and_a_title_of_each(gallery: Path, browser: Browser) -> None:
    with drawn.open_page(browser, gallery / "index.html") as page:
        titles = page.locator(".card h2").all_inner_texts()
        assert titles == [geotween.load(path).model.title for path in SCENES]
        assert page.locator(".card .still svg path.region").count() >= len(SCENES)
        links = page.locator(".card h2 a").evaluate_all("all => all.map(a => a.href)")
        assert [Path(link).name for link in links] == [f"{path.stem}.html" for path in SCENES]


def test_without_script_the_page_shows_all_steps(gallery: Path, browser: Browser) -> None:
    file = gallery / "lake.html"
    with drawn.open_page(browser, file, java_script_enabled=False) as page:
        stills = page.locator(".multiples figure svg")
        assert stills.count() == len(geotween.load(resource("scenes") / "lake.yaml").steps)
        assert all(still.is_visible() for still in stills.all())
        assert page.locator("geotween-map .controls").count() == 0
