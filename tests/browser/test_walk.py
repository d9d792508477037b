"""A walk through page and story, in every browser that is there: Chromium, and Firefox if it is.

``python -m playwright install firefox`` brings the Firefox that Playwright can drive.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Playwright

from tests.browser import drawn, hosts

MAP = "document.querySelector('geotween-map')"


@pytest.fixture(params=["chromium", "firefox"])
def any_browser(
    request: pytest.FixtureRequest, browser: Browser, playwright: Playwright
) -> Iterator[Browser]:
    if request.param == "chromium":
        yield browser
        return
    if not Path(playwright.firefox.executable_path).exists():
        pytest.skip("there is no Firefox that Playwright can drive")
    firefox = playwright.firefox.launch()
    yield firefox
    firefox.close()


def test_a_page_from_start_to_end(any_browser: Browser, tmp_path: Path) -> None:
    folder = hosts.build(tmp_path)
    with drawn.open_page(any_browser, folder / "squares.html") as page:
        page.wait_for_timeout(300)
        assert page.evaluate(f"{MAP}.currentTime") > 0
        page.get_by_role("button", name="Pause").click()
        page.get_by_role("button", name="Next step").click()
        assert page.evaluate(f"[{MAP}.currentTime, {MAP}.currentStep]") == [2, 1]
        page.locator("input.time").press("ArrowLeft")
        assert page.evaluate(f"[{MAP}.currentTime, {MAP}.currentStep]") == [0, 0]
        page.locator("svg.figure").focus()
        page.keyboard.press("n")
        assert page.locator(".tip strong").inner_text() == "Aland"
        page.locator(".speed").select_option("2")
        assert page.evaluate(f"{MAP}.playbackRate") == 2
        page.get_by_role("link", name="Animated SVG").focus()
        page.emulate_media(media="print")
        assert page.locator(".multiples figure").last.is_visible()


def test_a_story_down_and_up(any_browser: Browser, tmp_path: Path) -> None:
    folder = hosts.build(tmp_path, scene=f"layout: scroll\n{hosts.SCENE}")
    with drawn.open_page(any_browser, folder / "squares.html") as page:
        page.locator(".story.scrolls").wait_for()
        for key, time in (("End", 2), ("Home", 1)):
            page.keyboard.press(key)
            page.wait_for_timeout(2500)
            assert page.evaluate(f"{MAP}.currentTime") == time
