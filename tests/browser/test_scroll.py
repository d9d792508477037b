"""A scrolling story: the map stays in sight, and each step plays as its words arrive."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Page

import geotween
from tests.browser import drawn

# Rests at 0-1, 2-3 and 4-5 s.
SCENE = """
title: Story
layout: scroll
map: {width: 600, height: 500}
timing: {transition: 1, hold: 1}
steps:
  - {label: one, caption: to begin, polygons: [{key: a, polygon: [[0, 0], [4, 0], [4, 4], [0, 4]]}]}
  - {label: two, caption: then, polygons: [{key: a, polygon: [[4, 0], [8, 0], [8, 4], [4, 4]]}]}
  - {label: three, caption: last, polygons: [{key: a, polygon: [[2, 0], [8, 0], [8, 6], [2, 6]]}]}
"""
MAP = "document.querySelector('geotween-map')"
STARTS, ENDS = (0, 2, 4), (1, 3, 5)
SIZES = pytest.mark.parametrize(
    "size",
    [{"width": 390, "height": 844}, {"width": 1280, "height": 800}],
    ids=lambda s: s["width"],
)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    (tmp_path / "story.yaml").write_text(SCENE, encoding="utf-8")
    return geotween.build(geotween.load(tmp_path / "story.yaml"), tmp_path).files[0]


@pytest.fixture
def page(browser: Browser, file: Path) -> Iterator[Page]:
    with drawn.open_page(browser, file) as opened:
        opened.wait_for_selector(".story.scrolls")
        yield opened


def read(page: Page, step: int) -> None:
    """Scroll until a caption is in the middle of the window."""
    chapter = f"document.querySelectorAll('.chapter')[{step}]"
    page.evaluate(f"scrollBy(0, {chapter}.getBoundingClientRect().top - innerHeight / 2)")


def becomes(page: Page, condition: str, patience: int = 5000) -> None:
    """Wait for a condition; Playwright's own way of doing so is what the policy forbids."""
    page.evaluate(
        f"""() => new Promise((done, fail) => {{
          const end = performance.now() + {patience};
          const look = () => ({condition}) ? done() : performance.now() < end
            ? requestAnimationFrame(look) : fail(Error({condition!r}));
          look(); }})"""
    )


def rests_at(page: Page, time: float) -> None:
    becomes(page, f"{MAP}.currentTime === {time}")


def times_on_the_way(page: Page, step: int, goal: float) -> list[float]:
    """Scroll to a caption; the times that are shown until the map is there."""
    page.evaluate(
        f"""window.times = [];
        {MAP}.addEventListener('timeupdate', () => times.push({MAP}.currentTime))"""
    )
    read(page, step)
    rests_at(page, goal)
    return [float(time) for time in page.evaluate("times")]


def test_it_begins_with_the_first_step_and_waits(page: Page) -> None:
    page.wait_for_timeout(200)
    assert page.evaluate(f"[{MAP}.currentTime, {MAP}.paused]") == [0, True]


def test_a_step_plays_as_its_caption_arrives_and_back_as_it_leaves(page: Page) -> None:
    there = times_on_the_way(page, 1, STARTS[1])
    assert there == sorted(there)
    assert sum(ENDS[0] < time < STARTS[1] for time in there) > 5
    back = times_on_the_way(page, 0, ENDS[0])
    assert back == sorted(back, reverse=True)
    assert sum(ENDS[0] < time < STARTS[1] for time in back) > 5


def test_who_turns_round_midway_is_followed(page: Page) -> None:
    read(page, 1)
    becomes(page, f"{MAP}.currentTime > 1.2")
    read(page, 0)
    rests_at(page, ENDS[0])


def test_who_jumps_to_the_end_does_not_wait_for_all_steps(page: Page) -> None:
    page.keyboard.press("End")
    becomes(page, f"{MAP}.currentTime === {STARTS[2]}", patience=2800)


def test_a_page_that_is_opened_midway_shows_that_step_at_once(browser: Browser, file: Path) -> None:
    with drawn.open_page(browser, file) as page:
        story = "document.querySelector('geotween-story')"
        read(page, 2)
        rests_at(page, STARTS[2])
        page.evaluate(f"{MAP}.currentTime = 0; {story}.replaceWith({story})")
        assert page.evaluate(f"{MAP}.currentTime") == STARTS[2]


@SIZES
def test_map_and_caption_are_in_sight_together(
    browser: Browser, file: Path, size: dict[str, int]
) -> None:
    with drawn.open_page(browser, file, viewport=size) as page:
        page.wait_for_selector(".story.scrolls")
        for step in range(3):
            read(page, step)
            if size["width"] < 900:
                page.evaluate("scrollBy(0, -innerHeight / 5)")  # below the map, which is above
            map_ = page.locator("svg.figure").bounding_box()
            words = page.locator(".chapter h2").nth(step).bounding_box()
            assert map_
            assert words
            assert 0 <= words["y"] <= size["height"] - words["height"]
            if step:
                assert 0 <= map_["y"] <= size["height"] - map_["height"]
            beside = words["x"] >= map_["x"] + map_["width"]
            below = words["y"] >= map_["y"] + map_["height"]
            assert (beside, below) == ((True, False) if size["width"] > 900 else (False, True))
        assert page.evaluate("document.documentElement.scrollWidth") <= size["width"]


def test_the_caption_that_arrived_is_the_current_one(page: Page) -> None:
    read(page, 1)
    current = page.locator(".chapter[aria-current=step] h2")
    page.wait_for_function(
        "document.querySelector('.chapter[aria-current] h2').innerText === 'two'"
    )
    assert current.all_inner_texts() == ["two"]


def test_keys_scroll_the_page_even_from_within_the_map(page: Page) -> None:
    page.locator("svg.figure").focus()
    page.keyboard.press("PageDown")
    becomes(page, "scrollY > 100")
    page.keyboard.press("n")
    assert page.locator(".tip").inner_text() == "a"


@pytest.mark.parametrize(
    "options", [{"java_script_enabled": False}, {"reduced_motion": "reduce"}], ids=str
)
def test_without_script_or_motion_there_are_figures_in_a_row(
    browser: Browser, file: Path, options: dict[str, Any]
) -> None:
    with drawn.open_page(browser, file, **options) as page:
        captions = page.locator(".multiples figcaption")
        assert [c.split()[0] for c in captions.all_inner_texts()] == ["one", "two", "three"]
        assert all(caption.is_visible() for caption in captions.all())
        assert not page.locator(".chapters").is_visible()


def test_in_print_there_are_figures_in_a_row(page: Page) -> None:
    page.emulate_media(media="print")
    assert page.locator(".multiples figcaption").last.is_visible()
    assert not page.locator("svg.figure").is_visible()
    assert not page.locator(".chapters").is_visible()


def test_who_asks_for_less_motion_midway_gets_the_player(page: Page) -> None:
    page.emulate_media(reduced_motion="reduce")
    page.wait_for_selector(".story:not(.scrolls)")
    assert page.locator(".controls").is_visible()
    page.emulate_media(reduced_motion="no-preference")
    page.wait_for_selector(".story.scrolls")
    assert not page.locator(".controls").is_visible()
