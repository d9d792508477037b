"""The player: a media-like element, its controls, its keyboard, and text that stays text."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page

import geotween
from tests.browser import drawn

# Rests at 0-1, 2-3 and 4-5 s; a square moves right, then grows.
SCENE = """
title: Three squares
map: {width: 300}
timing: {transition: 1, hold: 1, loop: LOOP}
steps:
  - {label: one, caption: to begin, polygons: [[[0, 0], [4, 0], [4, 4], [0, 4]]]}
  - {label: two, polygons: [[[4, 0], [8, 0], [8, 4], [4, 4]]]}
  - {label: three, polygons: [[[2, 0], [8, 0], [8, 6], [2, 6]]]}
"""
MAP = "document.querySelector('geotween-map')"


def build(folder: Path, text: str, name: str = "squares") -> Path:
    (folder / f"{name}.yaml").write_text(text, encoding="utf-8")
    return geotween.build(geotween.load(folder / f"{name}.yaml"), folder).files[0]


@pytest.fixture
def page(browser: Browser, tmp_path: Path) -> Iterator[Page]:
    """The three squares, paused at 0."""
    file = build(tmp_path, SCENE.replace("LOOP", "false"))
    with drawn.open_page(browser, file) as opened:
        opened.evaluate(f"{MAP}.pause(); {MAP}.currentTime = 0")
        yield opened


def state(page: Page) -> tuple[float, int, bool]:
    found = page.evaluate(f"[{MAP}.currentTime, {MAP}.currentStep, {MAP}.paused]")
    return found[0], found[1], found[2]


def test_it_has_the_interface_of_a_media_element(page: Page) -> None:
    assert page.evaluate(f"[{MAP}.duration, {MAP}.paused, {MAP}.ended]") == [5, True, False]
    assert page.evaluate(f"{MAP}.steps") == [
        {"label": "one", "start": 0, "end": 1},
        {"label": "two", "start": 2, "end": 3},
        {"label": "three", "start": 4, "end": 5},
    ]


def test_setting_the_time_while_paused_draws_at_once(page: Page) -> None:
    drawn_at = {}
    for time in (0, 1.5, 2):
        page.evaluate(f"{MAP}.currentTime = {time}")
        drawn_at[time] = page.evaluate(drawn.VISIBLE_REGIONS)
    assert len({str(value) for value in drawn_at.values()}) == 3
    assert state(page) == (2, 1, True)


def test_events_tell_what_happens(page: Page) -> None:
    told = page.evaluate(
        f"""() => new Promise(done => {{
          const map = {MAP}, told = [];
          for (const name of ['play', 'pause', 'ended', 'stepchange'])
            map.addEventListener(name, event => told.push(event.type));
          map.addEventListener('ended', () => setTimeout(() => done(told)));
          map.currentTime = 4.9;
          map.play();
        }})"""
    )
    assert told == ["stepchange", "play", "pause", "ended"]
    assert page.evaluate(f"{MAP}.ended")


def test_it_loops_if_asked(browser: Browser, tmp_path: Path) -> None:
    with drawn.open_page(browser, build(tmp_path, SCENE.replace("LOOP", "true"))) as page:
        page.evaluate(f"{MAP}.currentTime = 4.9")
        page.wait_for_timeout(400)
        time, step, paused = state(page)
        assert time < 1
        assert (step, paused) == (0, False)


def test_buttons_step_and_play(page: Page) -> None:
    for name, expected in [
        ("Next step", (2, 1, True)), ("Next step", (4, 2, True)), ("Previous step", (2, 1, True)),
    ]:  # fmt: skip
        page.get_by_role("button", name=name).click()
        assert state(page) == expected
    page.get_by_role("button", name="Play").click()
    assert not state(page)[2]
    page.get_by_role("button", name="Pause").click()
    assert state(page)[2]


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        (["ArrowRight"], (2, 1, True)),
        (["End"], (4, 2, True)),
        (["End", "ArrowLeft"], (2, 1, True)),
        (["PageDown", "PageDown", "Home"], (0, 0, True)),
        (["PageDown", "PageUp"], (0, 0, True)),
    ],
)
def test_the_keyboard_steps(page: Page, keys: list[str], expected: tuple[float, int, bool]) -> None:
    page.get_by_role("slider").focus()
    for key in keys:
        page.keyboard.press(key)
    assert state(page) == expected


@pytest.mark.parametrize("key", ["Space", "k"])
def test_the_keyboard_plays_and_pauses_only_inside(page: Page, key: str) -> None:
    page.keyboard.press(key)
    assert state(page)[2]
    page.get_by_role("slider").focus()
    page.keyboard.press(key)
    assert not state(page)[2]
    page.keyboard.press(key)
    assert state(page)[2]


def test_the_slider_names_the_step(page: Page) -> None:
    slider = page.get_by_role("slider")
    slider.fill("2.5")
    assert slider.get_attribute("aria-valuetext") == "two, step 2 of 3"
    assert state(page) == (2.5, 1, True)


def test_the_caption_follows_the_step(page: Page) -> None:
    assert page.locator(".caption").inner_text().split("\n")[0].strip() == "one to begin"
    page.evaluate(f"{MAP}.currentTime = 2")
    assert page.locator(".caption strong").inner_text() == "two"


def test_with_reduced_motion_it_waits(browser: Browser, tmp_path: Path) -> None:
    file = build(tmp_path, SCENE.replace("LOOP", "true"))
    with drawn.open_page(browser, file, reduced_motion="reduce") as page:
        page.wait_for_timeout(300)
        assert state(page) == (0, 0, True)


def test_two_maps_on_a_page_do_not_disturb_each_other(page: Page) -> None:
    page.evaluate(
        f"""() => {{
          const map = {MAP}, island = map.querySelector('script').cloneNode(true);
          const other = document.createElement('geotween-map');
          other.append(map.querySelector('svg.figure').cloneNode(true), island);
          document.body.append(other);
          other.pause();
          other.currentTime = 2;
        }}"""
    )
    times = page.evaluate("[...document.querySelectorAll('geotween-map')].map(m => m.currentTime)")
    assert times == [0, 2]


HOSTILE = [
    "</script><script>document.title='owned'</script>",
    "<img src=x onerror=\"document.title='owned'\">",
    "\"'><svg onload=alert(1)>",
    "&lt;b&gt; &amp; ]]> --> {{ 7 * 7 }} ${1}",
    "\u202egnirts\u2066\u2028\u2029 \U0001f600",
    "x" * 100_000,
]


@pytest.mark.parametrize("text", HOSTILE, ids=range(len(HOSTILE)))
def test_hostile_text_stays_text(browser: Browser, tmp_path: Path, text: str) -> None:
    quoted = json.dumps(text).replace("\\ud83d\\ude00", "\U0001f600")
    square = "polygon: [[0, 0], [4, 0], [4, 4]]"
    feature = f"{{key: {quoted}, class: {quoted}, name: {quoted}, {square}}}"
    layer = f"{{name: {quoted}, polygons: [[0, 0], [9, 0], [9, 9]]}}"
    scene = (
        f"title: {quoted}\nsubtitle: {quoted}\ndescription: {quoted}\nsource: {quoted}\n"
        f"credit: {quoted}\nmap: {{layers: [{layer}]}}\n"
        f"steps:\n  - {{label: {quoted}, caption: {quoted}, polygons: [{feature}]}}\n"
        f"  - {{label: {quoted}, polygons: [{feature}]}}\n"
    )
    file = build(tmp_path, scene)
    with drawn.open_page(browser, file) as page:
        assert page.locator("h1").evaluate("h => h.textContent") == text
        assert page.evaluate(f"{MAP}.steps[0].label") == text
        keys = page.locator("path.region").evaluate_all("all => all.map(p => p.dataset.key)")
        assert set(keys) == {text}
        assert page.locator("img, script:not(geotween-map script)").count() == 1
        assert page.title() != "owned"
    with drawn.open_page(browser, file.with_suffix(".svg")) as page:
        assert page.evaluate("document.querySelector('title').textContent") == text
        assert page.evaluate("document.querySelectorAll('script, img, [onload]').length") == 0
