"""The player: a media-like element, its controls by every hand, and text that stays text."""

from __future__ import annotations

import gzip
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser, Locator, Page

import geotween
from geotween.export.build import plan_scene
from geotween.export.easing import EASINGS, ease
from geotween.export.resources import resource
from geotween.export.timeline import timeline
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
# Two tiles with names; the border between them moves, and one beyond stays where it is.
TILES = """
title: Tiles
map: {width: 300, labels: none}
motion: {method: front}
timing: {transition: 1, hold: 1}
steps:
  - label: "2000"
    time: "2000"
    polygons:
    - {key: a, name: Aland, polygon: [[0, 0], [5, 0], [5, 5], [0, 5]]}
    - {key: b, name: Bland, polygon: [[5, 0], [9, 0], [9, 5], [5, 5]]}
    - {key: c, name: Cland, polygon: [[10, 0], [12, 0], [12, 5], [10, 5]]}
  - label: "2001"
    time: "2001"
    polygons:
    - {key: a, name: Aland, polygon: [[0, 0], [7, 0], [7, 5], [0, 5]]}
    - {key: b, name: New Bland, polygon: [[7, 0], [9, 0], [9, 5], [7, 5]]}
    - {key: c, name: Cland, polygon: [[10, 0], [12, 0], [12, 5], [10, 5]]}
  - label: "2011"
    time: "2011"
    polygons:
    - {key: a, name: Aland, polygon: [[0, 0], [9, 0], [9, 5], [0, 5]]}
    - {key: c, name: Cland, polygon: [[10, 0], [12, 0], [12, 5], [10, 5]]}
"""
MAP = "document.querySelector('geotween-map')"

# How a reader uses a button or a mark.
HANDS: dict[str, Callable[[Locator], None]] = {
    "mouse": lambda control: control.click(),
    "touch": lambda control: control.tap(),
    "keyboard": lambda control: control.press("Enter"),
}
EACH_HAND = pytest.mark.parametrize("use", HANDS.values(), ids=HANDS)


def build(folder: Path, text: str, name: str = "squares") -> Path:
    (folder / f"{name}.yaml").write_text(text, encoding="utf-8")
    return geotween.build(geotween.load(folder / f"{name}.yaml"), folder).files[0]


@pytest.fixture
def page(browser: Browser, tmp_path: Path) -> Iterator[Page]:
    """The three squares, paused at 0."""
    file = build(tmp_path, SCENE.replace("LOOP", "false"))
    with drawn.open_page(browser, file, has_touch=True) as opened:
        opened.evaluate(f"{MAP}.pause(); {MAP}.currentTime = 0")
        yield opened


@pytest.fixture
def tiles(browser: Browser, tmp_path: Path) -> Iterator[Page]:
    """The tiles, paused at 0."""
    with drawn.open_page(browser, build(tmp_path, TILES), has_touch=True) as opened:
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


@EACH_HAND
def test_buttons_step_and_play(page: Page, use: Callable[[Locator], None]) -> None:
    for name, expected in [
        ("Next step", (2, 1, True)), ("Next step", (4, 2, True)), ("Previous step", (2, 1, True)),
    ]:  # fmt: skip
        use(page.get_by_role("button", name=name))
        assert state(page) == expected
    use(page.get_by_role("button", name="Play"))
    assert not state(page)[2]
    use(page.get_by_role("button", name="Pause"))
    assert state(page)[2]


@EACH_HAND
def test_a_tick_leads_to_its_step(page: Page, use: Callable[[Locator], None]) -> None:
    use(page.get_by_role("button", name="three", exact=True))
    assert state(page) == (4, 2, True)


@EACH_HAND
def test_loop_is_a_toggle(page: Page, use: Callable[[Locator], None]) -> None:
    loop = page.get_by_role("button", name="Loop")
    for pressed in (True, False):
        use(loop)
        assert loop.get_attribute("aria-pressed") == str(pressed).lower()
        assert page.evaluate(f"{MAP}.loop") == pressed


@EACH_HAND
def test_at_the_end_it_plays_again(page: Page, use: Callable[[Locator], None]) -> None:
    page.evaluate(f"{MAP}.currentTime = 5")
    use(page.get_by_role("button", name="Replay"))
    time, _, paused = state(page)
    assert time < 4
    assert not paused


def test_speed_is_chosen_by_name_or_by_keys(page: Page) -> None:
    speed = page.get_by_role("combobox", name="Speed")
    speed.select_option("4×")
    assert page.evaluate(f"{MAP}.playbackRate") == 4
    speed.press("ArrowUp")
    assert page.evaluate(f"{MAP}.playbackRate") == 2
    assert state(page) == (0, 0, True)


def test_speed_makes_time_pass_faster(page: Page) -> None:
    passed = page.evaluate(
        f"""async () => {{
          const map = {MAP}, frame = () => new Promise(requestAnimationFrame);
          map.playbackRate = 4;
          map.play();
          await frame();
          const [t, now] = [map.currentTime, await frame()];
          for (let i = 0; i < 10; i++) await frame();
          return [map.currentTime - t, (await frame()) - now];
        }}"""
    )
    assert passed[0] == pytest.approx(4 * passed[1] / 1000, rel=0.5)


@pytest.mark.parametrize("hand", ["mouse", "touch"])
def test_the_slider_goes_where_it_is_touched(page: Page, hand: str) -> None:
    box = page.get_by_role("slider").bounding_box()
    assert box is not None
    press = page.mouse.click if hand == "mouse" else page.touchscreen.tap
    press(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    assert state(page) == (pytest.approx(2.5, abs=0.02), 1, True)


def test_scrubbing_to_a_hundred_places_draws_the_frame_of_each(
    gallery: Path, browser: Browser
) -> None:
    scene = geotween.load(resource("scenes") / "fire.yaml")
    planned, spans = plan_scene(scene)[0], timeline(scene)
    easing = EASINGS[scene.model.motion.easing]
    with drawn.open_page(browser, gallery / "fire.html") as page:
        slider = page.get_by_role("slider")
        for value in np.random.default_rng(7).uniform(0, spans[-1].end / 1000, 100):
            slider.fill(str(value))
            time = 1000 * state(page)[0]
            span = next(s for s in spans if s.start <= time <= s.end)
            index = min(span.step, len(planned) - 1)
            t = float(span.step > index) if span.rest else (time - span.start) / span.length
            frame = planned[index].frame(t if span.rest else ease(easing, t))
            wanted = drawn.expected(scene, frame, drawn.is_keyed(scene))
            drawn.assert_same(drawn.drawn(page), wanted)


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


def test_the_axis_is_real_time_and_the_thumb_agrees_with_it(tiles: Page) -> None:
    ticks = tiles.locator(".tick").evaluate_all("all => all.map(t => parseFloat(t.style.left))")
    years = [0, 366, 366 + 365 * 10 + 2]  # days since 2000
    assert ticks == pytest.approx([100 * day / years[-1] for day in years], abs=0.1)
    slider = tiles.get_by_role("slider")
    for step, tick in enumerate(ticks):
        for when in ("start", "end"):
            tiles.evaluate(f"{MAP}.currentTime = {MAP}.steps[{step}].{when}")
            assert float(slider.input_value()) == pytest.approx(5 * tick / 100, abs=1e-3)
    slider.fill(str(5 * (ticks[1] + ticks[2]) / 200))
    assert state(tiles)[0] == pytest.approx(3.5, abs=1e-3)


@pytest.mark.parametrize("step", range(12))
def test_first_last_and_current_label_have_room_at_390_px(
    browser: Browser, tmp_path: Path, step: int
) -> None:
    square = "polygons: [[[0, 0], [4, 0], [4, 4]]]"
    steps = "".join(f"  - {{label: The {i}th of September, {square}}}\n" for i in range(12))
    file = build(tmp_path, f"title: Many\nsteps:\n{steps}")
    with drawn.open_page(browser, file, viewport={"width": 390, "height": 800}) as page:
        page.evaluate(f"{MAP}.pause(); {MAP}.currentTime = {MAP}.steps[{step}].start")
        page.wait_for_timeout(50)
        seen = page.locator(".mark").evaluate_all(
            """all => all.map((mark, i) => ({ i, box: mark.getBoundingClientRect() }))
              .filter(({ i }) => all[i].checkVisibility({ visibilityProperty: true }))
              .map(({ i, box }) => [i, box.left, box.right])"""
        )
        assert {0, step, 11} <= {i for i, _, _ in seen}
        seen.sort(key=lambda mark: mark[1])
        assert seen[0][1] >= 0
        assert seen[-1][2] <= 390
        for (_, _, right), (_, left, _) in pairwise(seen):
            assert right <= left + 0.5


def test_it_plays_only_while_it_can_be_seen(browser: Browser, tmp_path: Path) -> None:
    file = build(tmp_path, SCENE.replace("LOOP", "true"))
    with drawn.open_page(browser, file) as page:
        page.wait_for_timeout(200)
        assert state(page)[0] > 0
        page.evaluate(f"{MAP}.style.marginTop = '300vh'")
        page.wait_for_timeout(100)
        before = state(page)[0]
        page.wait_for_timeout(200)
        assert state(page)[0] == before
        page.evaluate(f"{MAP}.scrollIntoView()")
        page.wait_for_timeout(200)
        assert state(page)[0] > before


def test_a_path_of_which_nothing_moved_is_not_touched(tiles: Page) -> None:
    touched = tiles.evaluate(
        f"""async () => {{
          const map = {MAP}, touched = new Set();
          map.currentTime = 1.01;
          const watch = new MutationObserver(all => all.forEach(m => touched.add(m.target)));
          watch.observe(map.querySelector('g.stage'), {{ attributes: true, subtree: true }});
          for (let t = 1.02; t < 1.98; t += 0.02) map.currentTime = t;
          await new Promise(requestAnimationFrame);
          return [...touched].filter(e => e.matches('.region')).map(e => e.dataset.key).sort();
        }}"""
    )
    assert touched == ["a", "b"]


def test_a_mouse_shows_the_name_of_a_region(tiles: Page) -> None:
    box = tiles.locator("path.region[data-key=b]").bounding_box()
    assert box is not None
    tiles.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    assert tiles.locator(".tip").inner_text() == "Bland"
    tiles.mouse.move(1, 1)
    assert tiles.locator(".tip").inner_text() == ""


def test_a_tap_shows_the_name_of_a_region_and_one_beside_it_hides_it(tiles: Page) -> None:
    box = tiles.locator("path.region[data-key=c]").bounding_box()
    assert box is not None
    tiles.touchscreen.tap(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    assert tiles.locator(".tip").inner_text() == "Cland"
    tiles.touchscreen.tap(box["x"] + box["width"] + 4, box["y"] + box["height"] / 2)
    assert tiles.locator(".tip").inner_text() == ""


def test_keys_go_from_region_to_region(tiles: Page) -> None:
    tip = tiles.locator(".tip")
    tiles.locator("svg.figure").focus()
    for key, name in [("n", "Aland"), ("n", "Bland"), ("n", "Cland"), ("Shift+N", "Bland")]:
        tiles.keyboard.press(key)
        assert tip.inner_text() == name
        assert tip.get_attribute("aria-live") == "polite"
    tiles.keyboard.press("ArrowRight")
    assert (state(tiles)[1], tip.inner_text()) == (1, "New Bland")
    tiles.keyboard.press("ArrowRight")
    assert (state(tiles)[1], tip.inner_text()) == (2, "")
    tiles.keyboard.press("n")
    tiles.keyboard.press("Escape")
    assert tip.inner_text() == ""


def test_with_reduced_motion_nothing_moves_even_when_it_plays(
    browser: Browser, tmp_path: Path
) -> None:
    file = build(tmp_path, SCENE.replace("LOOP", "false"))
    with drawn.open_page(browser, file, reduced_motion="reduce") as page:
        page.wait_for_timeout(300)
        assert state(page) == (0, 0, True)
        look = f"{MAP}.querySelector('path.region').getAttribute('d') + {MAP}.currentStep"
        seen = page.evaluate(
            f"""() => new Promise(done => {{
              const map = {MAP}, seen = new Set();
              map.playbackRate = 4;
              map.addEventListener('ended', () => done([...seen]));
              const look = () => {{
                seen.add({look} + ' ' + map.querySelector('.time').value);
                requestAnimationFrame(look);
              }};
              map.play();
              look();
            }})"""
        )
        assert len(seen) == 3
        rests = []
        for time in (0, 2, 4):
            page.evaluate(f"{MAP}.currentTime = {time}")
            rests.append(page.evaluate(f"{look} + ' ' + {time}"))
        assert seen == rests
        page.get_by_role("slider").fill("1.4")
        assert page.evaluate(look) == rests[0][:-2]


def test_two_maps_on_a_page_do_not_disturb_each_other(tiles: Page) -> None:
    tiles.evaluate(
        f"""() => {{
          const map = {MAP}, island = map.querySelector('script').cloneNode(true);
          const other = document.createElement('geotween-map');
          other.id = 'other';
          other.append(map.querySelector('svg.figure').cloneNode(true), island);
          document.querySelector('main').append(other);
          other.pause();
          other.currentTime = 2;
        }}"""
    )
    everyone = "[...document.querySelectorAll('geotween-map')]"
    assert tiles.evaluate(f"{everyone}.map(m => m.currentTime)") == [0, 2]
    other = tiles.locator("#other")
    other.get_by_role("button", name="Next step").click()
    other.locator("svg.figure").focus()
    tiles.keyboard.press("n")
    assert tiles.evaluate(f"{everyone}.map(m => m.currentTime)") == [0, 4]
    assert tiles.locator(".tip").all_inner_texts() == ["", "Aland"]
    assert tiles.locator("[id]").count() == 1


def test_script_and_style_are_small() -> None:
    player = [resource("templates") / f"player.{kind}" for kind in ("js", "css")]
    text = "".join(path.read_text(encoding="utf-8") for path in player)
    assert len(gzip.compress(text.encode(), 9)) <= 12 * 1024
