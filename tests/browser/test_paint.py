"""Page and SVG paint alike, at any time: fill, stroke, width, opacity."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page

import geotween
from tests.browser import drawn

SQUARE = "polygon: [[0, 0], [4, 0], [4, 4], [0, 4]]"
CHANGES = {
    "colour to colour": ('{fill: "#ff0000"}', '{fill: "#0000ff"}'),
    "none to colour": ("{fill: none}", '{fill: "#0000ff"}'),
    "colour to none": ('{fill: "#0000ff"}', "{fill: none}"),
    "stroke appears": ("{stroke: none}", "{stroke: black, width: 3}"),
    "stroke goes": ("{stroke: black, width: 3}", "{stroke: none}"),
    "stroke grows": ("{stroke: red, width: 1}", "{stroke: blue, width: 5}"),
    "opacity": ("{opacity: 1}", "{opacity: 0.2}"),
}
PAINTED = """() => [...document.querySelectorAll('g.stage path')]
  .filter(path => getComputedStyle(path).visibility === 'visible')
  .map(path => {
    const of = getComputedStyle(path), group = getComputedStyle(path.parentNode);
    const stroked = of.stroke !== 'none' && parseFloat(of.strokeWidth) > 0;
    const filled = parseFloat(of.fillOpacity) > 0;
    return [path.getAttribute('class'), filled ? of.fill : 'none', stroked ? of.stroke : 'none',
      stroked ? parseFloat(of.strokeWidth) : 0, parseFloat(of.strokeOpacity),
      parseFloat(group.opacity)];
  })"""


def build(folder: Path, one: str, other: str, second: str) -> Path:
    text = (
        f"title: Paint\nstyle: {{stroke: none, class: {{a: {one}, b: {other}}}}}\n"
        f"timing: {{transition: 2, hold: 1}}\n"
        f"steps:\n  - polygons: [{{key: k, class: a, {SQUARE}}}]\n  - polygons: {second}\n"
        f"  - polygons: [{{key: k, class: a, {SQUARE}}}]\n"
    )
    (folder / "paint.yaml").write_text(text, encoding="utf-8")
    return geotween.build(geotween.load(folder / "paint.yaml"), folder).files[0]


def numbers(value: object) -> list[float]:
    """The numbers of a colour or a length, so that they can be compared nearly."""
    return [float(n) for n in re.findall(r"[\d.]+", str(value))]


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
@pytest.mark.parametrize(
    "second",
    [
        f"[{{key: k, class: b, {SQUARE}}}]",
        "[{class: b, polygon: [[0, 0], [1, 0], [1, 4]]}, "
        "{class: a, polygon: [[3, 0], [4, 0], [4, 4]]}]",
    ],
    ids=["whole", "split"],
)
def test_page_and_svg_paint_alike(
    browser: Browser, tmp_path: Path, change: tuple[str, str], second: str
) -> None:
    file = build(tmp_path, *change, second)
    seen: dict[str, list[list[list[object]]]] = {}
    for suffix, (stop, seek) in drawn.HANDS.items():
        with drawn.open_page(browser, file.with_suffix(f".{suffix}")) as page:
            stop(page)
            seen[suffix] = [painted(page, seek, t) for t in (0.5, 1.05, 1.7, 2.4, 2.97, 3.5, 4.7)]
    for one, other in zip(seen["html"], seen["svg"], strict=True):
        assert [row[0] for row in one] == [row[0] for row in other]
        for mine, theirs in zip(one, other, strict=True):
            assert [("none" in str(a)) for a in mine] == [("none" in str(b)) for b in theirs]
            tolerances = (0, 2, 2, 0.02, 0.02, 0.02)
            for a, b, tolerance in zip(mine, theirs, tolerances, strict=True):
                assert numbers(a) == pytest.approx(numbers(b), abs=tolerance)


def painted(page: Page, seek: Callable[[Page, float], None], time: float) -> list[list[object]]:
    seek(page, time)
    page.wait_for_timeout(30)
    found: list[list[object]] = page.evaluate(PAINTED)
    return found
