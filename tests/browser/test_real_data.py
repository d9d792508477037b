"""Real data, built and played in a real browser."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Browser

import geotween
from tests.browser import drawn
from tests.real_data import needs_real_data, write_scene

SETS = {
    "us_fig9_split/albers-px": "map: {fit: each, y: down}",
    "us_regions": "map: {width: 960}",
    "wildfire_creek2020": "timing: {transition: 1, hold: 0.5}",
}


@needs_real_data
@pytest.mark.parametrize(("name", "rest"), SETS.items(), ids=SETS)
def test_real_data_plays_as_planned(name: str, rest: str, tmp_path: Path, browser: Browser) -> None:
    scene = geotween.load(write_scene(tmp_path, name, rest))
    report = geotween.build(scene, tmp_path / "public")
    assert all(t.measures["partition error"] <= 1e-9 for t in report.transitions)
    for file in report.files:
        stop, seek = drawn.HANDS[file.suffix[1:]]
        with drawn.open_page(browser, file) as page:
            stop(page)
            drawn.assert_plays_as_planned(scene, page, seek, per_transition=5)
            drawn.assert_rests_are_exact(scene, page, seek)
