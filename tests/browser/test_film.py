"""Fronts in the browser: tracks that last for a part of a transition, one after the other."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Page

import geotween
from geotween.data.load import Scene
from geotween.export.build import plan_scene
from geotween.export.easing import EASINGS, share_at
from geotween.motion.tracks import frame
from tests.browser import drawn

FORMATS = pytest.mark.parametrize("suffix", drawn.HANDS)

# A fire with an unburnt island that closes, which takes in a spot fire.
FIRE = """
title: Fire
map: {width: 400}
motion: {method: front, easing: EASING}
style: {stroke: none}
timing: {transition: 2, hold: 1}
steps:
  - polygons: [[[0, 0], [4, 0], [5, 2], [4, 4], [0, 4]], [[9, 1], [10, 1], [10, 2], [9, 2]]]
  - polygons:
    - polygon: [[[-1, -1], [5, -2], [12, -1], [11, 5], [-1, 6]], [[6, 3], [6, 4], [8, 3]]]
  - polygons: [[[-1, -1], [5, -2], [12, -1], [11, 5], [-1, 6]]]
"""
# Three tiles of which two give way to the third; strokes beside borders that move.
TILES = """
title: Tiles
map: {width: 400}
motion: {method: front, easing: EASING}
style: {stroke: white, width: 1}
timing: {transition: 2, hold: 1}
steps:
  - polygons:
    - {key: a, polygon: [[0, 0], [5, 0], [5, 5], [0, 5]]}
    - {key: b, polygon: [[5, 0], [10, 0], [10, 10], [5, 10], [5, 5]]}
    - {key: c, polygon: [[0, 5], [5, 5], [5, 10], [0, 10]]}
  - polygons:
    - {key: a, polygon: [[0, 0], [8, 0], [8, 4], [4, 7], [0, 7]]}
    - {key: b, polygon: [[8, 0], [10, 0], [10, 10], [5, 10], [4, 7], [8, 4]]}
    - {key: c, polygon: [[0, 7], [4, 7], [5, 10], [0, 10]]}
"""


@pytest.fixture(params=[(FIRE, "linear"), (FIRE, "ease-in-out"), (TILES, "ease-in-out")])
def scene(request: pytest.FixtureRequest, tmp_path: Path) -> Scene:
    text, easing = request.param
    (tmp_path / "film.yaml").write_text(text.replace("EASING", easing), encoding="utf-8")
    found = geotween.load(tmp_path / "film.yaml")
    geotween.build(found, tmp_path)
    return found


def compare(scene: Scene, page: Page, seek: Any, moments: list[tuple[int, float, float]]) -> None:
    planned, keyed = plan_scene(scene)[0], drawn.is_keyed(scene)
    for index, time, t in moments:
        seek(page, time)
        wanted = frame(planned[index].tracks, t)
        drawn.assert_same(drawn.drawn(page), drawn.expected(scene, wanted, keyed))


@FORMATS
def test_what_is_drawn_is_the_frame(
    browser: Browser, scene: Scene, suffix: str, tmp_path: Path
) -> None:
    stop, seek = drawn.HANDS[suffix]
    with drawn.open_page(browser, tmp_path / f"film.{suffix}") as page:
        stop(page)
        compare(scene, page, seek, drawn.moments(scene, 29))
        drawn.assert_rests_are_exact(scene, page, seek)


@FORMATS
def test_where_one_track_gives_way_to_the_next_there_is_one(
    browser: Browser, scene: Scene, suffix: str, tmp_path: Path
) -> None:
    stop, seek = drawn.HANDS[suffix]
    counting = """() => [...document.querySelectorAll('path.region')].filter(
      path => getComputedStyle(path).visibility === 'visible' && path.getBBox().width > 0
    ).map(path => path.dataset.key)"""
    spans = [span for span in geotween.export.timeline.timeline(scene) if not span.rest]
    easing = EASINGS[scene.model.motion.easing]
    with drawn.open_page(browser, tmp_path / f"film.{suffix}") as page:
        stop(page)
        for span, planned in zip(spans, plan_scene(scene)[0], strict=True):
            keys = sorted({str(t.key) if t.identity.keyed else "" for t in planned.tracks})
            for moment in sorted({m for t in planned.tracks for m in t.life} - {0.0, 1.0}):
                time = (span.start + share_at(easing, moment) * span.length) / 1000
                for near in (-2e-6, 0, 2e-6):
                    seek(page, time + near)
                    assert sorted(page.evaluate(counting)) == keys, (moment, near)
