"""What is written is valid: HTML as the standard reads it, SVG with attributes that there are."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

import html5lib
import pytest
from svgwrite.data.full11 import elements

from tests.browser import hosts

NAMESPACE = "{http://www.w3.org/2000/svg}"
# In SVG 2, HTML or ARIA, and younger than the table of SVG 1.1.
YOUNGER = {"lang", "role", "tabindex", "direction", "dominant-baseline", "paint-order"}


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Pages of each kind, in both layouts."""
    files: list[Path] = []
    for layout in ("player", "scroll"):
        folder = hosts.build(
            tmp_path_factory.mktemp(layout),
            "--fragment", "--url", "https://example.org",
            scene=f"layout: {layout}\n{hosts.SCENE}",
        )  # fmt: skip
        files += sorted(folder.iterdir())
    return files


def errors(text: str, *, fragment: bool) -> list[tuple[object, object]]:
    parser = html5lib.HTMLParser()
    (parser.parseFragment if fragment else parser.parse)(text)
    return [(place, what) for place, what, _ in parser.errors]


def test_html_has_no_errors_of_syntax(written: list[Path], gallery: Path) -> None:
    pages = [path for path in (*written, *gallery.iterdir()) if path.suffix == ".html"]
    assert len(pages) > 10
    for path in pages:
        text = path.read_text(encoding="utf-8")
        assert errors(text, fragment=".fragment." in path.name) == [], path.name


def test_an_error_would_be_found() -> None:
    assert errors("<!DOCTYPE html><title>t</title><p><b></p>", fragment=False)


def test_svg_has_attributes_that_there_are(written: list[Path], gallery: Path) -> None:
    drawings = [
        ElementTree.parse(path).getroot()
        for path in (*written, *gallery.iterdir())
        if path.suffix == ".svg"
    ]
    for page in (path for path in gallery.iterdir() if path.suffix == ".html"):
        text = page.read_text(encoding="utf-8")
        drawings += map(ElementTree.fromstring, re.findall(r"<svg .*?</svg>", text, re.DOTALL))
    assert len(drawings) > 20
    for drawing in drawings:
        for element in drawing.iter():
            name = element.tag.removeprefix(NAMESPACE)
            assert name in elements, name
            known = elements[name].valid_attributes | YOUNGER
            unknown = [
                attribute
                for attribute in element.attrib
                if attribute not in known and not attribute.startswith(("data-", "aria-"))
            ]
            assert unknown == [], name


def test_pages_have_no_style_attributes_and_no_handlers(written: list[Path]) -> None:
    for path in written:
        if path.suffix in (".html", ".svg"):
            text = path.read_text(encoding="utf-8")
            markup = re.sub(r"<(script|style)[^>]*>.*?</\1>", "", text, flags=re.DOTALL)
            assert not re.search(r"<[^>]*\s(style|on\w+)=", markup), path.name
