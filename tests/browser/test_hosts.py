"""Maps in notebooks and sites, as the real tools make them, opened in a browser."""

from __future__ import annotations

import re
import time
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import Browser, Frame, Page, Route

from tests.hosts.sites import SITES

HOST = "maps.test"
MAP = "document.querySelector('geotween-map')"


@pytest.fixture(scope="module", params=SITES)
def site(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The first page of a site with two maps."""
    return SITES[request.param](tmp_path_factory.mktemp(request.param))


@pytest.fixture
def page(browser: Browser, site: Path) -> Iterator[Page]:
    """That page, from its host; other hosts send nothing, and it must have no complaint."""
    said: list[str] = []

    def answer(route: Route) -> None:
        address = urlsplit(route.request.url)
        if address.netloc == HOST:
            route.fulfill(path=site.parent / address.path.removeprefix("/"))
        else:
            route.fulfill(body="")

    page = browser.new_page(viewport={"width": 1200, "height": 2400})
    page.route(re.compile("^http"), answer)
    page.on("console", lambda m: said.append(m.text) if m.type in ("error", "warning") else None)
    page.on("pageerror", lambda error: said.append(str(error)))
    page.goto(f"http://{HOST}/{site.name}")
    yield page
    page.close()
    assert said == []


def maps(page: Page) -> list[Frame]:
    """The frames that hold a map each, once their players have begun."""
    frames = [frame for frame in page.frames if frame.parent_frame is page.main_frame]
    for frame in frames:
        wait_for(frame, f"{MAP}.duration > 0")
    return frames


def wait_for(frame: Frame, truth: str, seconds: float = 10) -> None:
    """Ask until it is so; the page's policy forbids what Playwright waits by."""
    end = time.monotonic() + seconds
    while not frame.evaluate(truth):
        assert time.monotonic() < end, truth
        frame.page.wait_for_timeout(20)


def test_two_maps_play_and_do_not_disturb_each_other(page: Page) -> None:
    first, second = maps(page)
    for frame in (first, second):
        wait_for(frame, f"{MAP}.currentTime > 0.1 && !{MAP}.paused")
    first.evaluate(f"{MAP}.pause(); {MAP}.currentTime = 1")
    second.evaluate(f"{MAP}.currentTime = 0.2")
    wait_for(second, f"{MAP}.currentTime > 0.4")
    assert first.evaluate(f"[{MAP}.currentTime, {MAP}.paused]") == [1, True]


def test_maps_are_whole_and_their_titles_are_text(page: Page) -> None:
    frames = maps(page)
    for frame in frames:
        inner = "document.documentElement"
        wait_for(frame, f"{inner}.scrollHeight <= {inner}.clientHeight + 1")
    titles = [frame.evaluate("document.querySelector('h1').textContent") for frame in frames]
    assert titles[0] == 'One & "two" <b>'


def test_a_map_has_no_hold_on_the_page_around_it(page: Page) -> None:
    reach = "(() => { try { return parent.document.title } catch { return 'out of reach' } })()"
    assert [frame.evaluate(reach) for frame in maps(page)] == ["out of reach"] * 2


@pytest.mark.parametrize("site", ["sphinx", "mkdocs", "pelican"], indirect=True)
def test_frames_on_a_site_are_as_high_as_their_pages_at_any_width(page: Page) -> None:
    for width in (400, 1200):
        page.set_viewport_size({"width": width, "height": 2400})
        for frame in maps(page):
            inner = "document.documentElement"
            wait_for(frame, f"Math.abs({inner}.getBoundingClientRect().height - innerHeight) < 2")
