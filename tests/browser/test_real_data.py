"""Real data, built and played in a real browser."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Browser

import geotween
from tests.browser import drawn
from tests.real_data import SCENES, needs_real_data, write_scene


@needs_real_data
@pytest.mark.parametrize("name", [name for name in SCENES if name != "scale_us_counties"])
def test_real_data_plays_as_planned(name: str, tmp_path: Path, browser: Browser) -> None:
    scene = geotween.load(write_scene(tmp_path, name))
    report = geotween.build(scene, tmp_path / "public")
    assert all(t.measures["partition error"] <= 1e-9 for t in report.transitions)
    for file in report.files:
        kind = file.suffix[1:]
        stop, seek = drawn.HANDS[kind]
        with drawn.open_page(browser, file) as page:
            stop(page)
            drawn.assert_plays_as_planned(scene, page, seek, drawn.TOLERANCES[kind], 5)
            drawn.assert_rests_are_exact(scene, page, seek)


@needs_real_data
def test_thousands_of_counties_rest_where_they_lie(tmp_path: Path, browser: Browser) -> None:
    scene = geotween.load(write_scene(tmp_path, "scale_us_counties"))
    (file,) = geotween.build(scene, tmp_path / "public", ["html"]).files
    with drawn.open_page(browser, file) as page:
        drawn.stop_page(page)
        drawn.assert_rests_are_exact(scene, page, drawn.seek_page)
