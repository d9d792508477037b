"""Pages for everyone: what axe-core finds, what targets measure, and what is read aloud."""

from __future__ import annotations

from pathlib import Path

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Browser, Page

from geotween.export.resources import resource
from tests.browser import drawn, hosts

PAGES = [*sorted(path.stem for path in resource("scenes").glob("*.yaml")), "index"]
WIDTHS = (320, 1280)
MAP = "document.querySelector('geotween-map')"


@pytest.mark.parametrize("stem", PAGES)
@pytest.mark.parametrize("colours", ["light", "dark"])
@pytest.mark.parametrize("motion", ["no-preference", "reduce"])
def test_axe_finds_nothing(
    gallery: Path, browser: Browser, stem: str, colours: str, motion: str
) -> None:
    for width in WIDTHS:
        options = {"color_scheme": colours, "reduced_motion": motion}
        viewport = {"width": width, "height": 800}
        file = gallery / f"{stem}.html"
        with drawn.open_page(browser, file, viewport=viewport, **options) as page:
            page.evaluate(f"{MAP}?.pause()")
            show_a_tip(page)
            found = Axe().run(page)
            assert found.violations_count == 0, found.generate_report()


@pytest.mark.parametrize("kind", ["scroll", "fragment"])
@pytest.mark.parametrize("colours", ["light", "dark"])
@pytest.mark.parametrize("motion", ["no-preference", "reduce"])
def test_axe_finds_nothing_in_stories_and_fragments(
    tmp_path: Path, browser: Browser, kind: str, colours: str, motion: str
) -> None:
    layout = "scroll" if kind == "scroll" else "player"
    folder = hosts.build(tmp_path, "--fragment", scene=f"layout: {layout}\n{hosts.SCENE}")
    file = folder / "squares.html"
    if kind == "fragment":
        fragment = (folder / "squares.fragment.html").read_text(encoding="utf-8")
        file = hosts.host(folder, fragment)
    for width in WIDTHS:
        options = {"color_scheme": colours, "reduced_motion": motion}
        viewport = {"width": width, "height": 800}
        with drawn.open_page(browser, file, viewport=viewport, **options) as page:
            page.evaluate(f"{MAP}.pause()")
            show_a_tip(page)
            found = Axe().run(page)
            assert found.violations_count == 0, found.generate_report()
            assert page.evaluate("document.documentElement.scrollWidth") <= width


def show_a_tip(page: Page) -> None:
    figure = page.locator("svg.figure[tabindex]").first
    if figure.count():
        figure.focus()
        page.keyboard.press("n")
        assert page.locator(".tip").inner_text()


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("stem", PAGES[:-1])
def test_targets_are_large_and_nothing_lies_beside_the_page(
    gallery: Path, browser: Browser, stem: str, width: int
) -> None:
    viewport = {"width": width, "height": 800}
    with drawn.open_page(browser, gallery / f"{stem}.html", viewport=viewport) as page:
        boxes = page.locator(".controls :is(button, select, input)").evaluate_all(
            "all => all.map(e => e.getBoundingClientRect()).map(b => [b.width, b.height])"
        )
        assert min(min(box) for box in boxes) >= 44
        assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_focus_is_visible_on_everything_that_takes_it(gallery: Path, browser: Browser) -> None:
    with drawn.open_page(browser, gallery / "lake.html") as page:
        seen = set()
        for _ in range(12):
            page.keyboard.press("Tab")
            name, outline = page.evaluate(
                """() => { const e = document.activeElement, style = getComputedStyle(e);
                  return [e.localName + ' ' + (e.getAttribute('aria-label') ?? e.textContent),
                    style.outlineStyle === 'none' ? 0 : parseFloat(style.outlineWidth)]; }"""
            )
            if name.startswith("body"):
                break
            seen.add(name)
            assert outline >= 2, name
        for control in ("button Next step", "input Time", "select Speed", "button Loop"):
            assert control in seen


def test_the_caption_is_read_aloud_only_where_the_reader_asked(
    gallery: Path, browser: Browser
) -> None:
    with drawn.open_page(browser, gallery / "lake.html") as page:
        caption = page.locator(".caption")
        assert caption.get_attribute("aria-live") == "off"
        page.evaluate(f"{MAP}.pause()")
        assert caption.get_attribute("aria-live") == "polite"
        page.get_by_role("button", name="Next step").click()
        assert caption.inner_text().startswith(page.evaluate(f"{MAP}.steps[1].label"))
