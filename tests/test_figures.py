"""The figures of the documentation: kept as they are drawn, small, and all of them shown."""

from __future__ import annotations

import gzip
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest

from docs.draw import FIGURES
from docs.draw.scenes import REAL, SETS

DOCS = Path(__file__).parents[1] / "docs"
KEPT = sorted((DOCS / "figures").glob("*"))

# What a page of the documentation may load for a figure.
MOST_BYTES = 30_000  # compressed


def needed(name: str) -> None:
    if name in REAL and not SETS.is_dir():
        pytest.skip("the real polygon sets are not present beside the project")


@pytest.mark.parametrize("name", FIGURES)
def test_a_figure_is_what_the_code_draws(name: str) -> None:
    needed(name)
    kept = (DOCS / "figures" / f"{name}.svg").read_text(encoding="utf-8")
    assert FIGURES[name]() == kept, "make figures draws them anew; look at the difference"


def test_no_figure_is_kept_that_nothing_draws() -> None:
    assert {path.name for path in KEPT} == {f"{name}.svg" for name in FIGURES}


@pytest.mark.parametrize("path", KEPT, ids=lambda p: p.stem)
def test_a_figure_is_small_and_says_what_it_shows(path: Path) -> None:
    assert len(gzip.compress(path.read_bytes())) < MOST_BYTES
    assert ElementTree.parse(path).getroot().get("aria-label")


def test_the_pages_show_each_figure_and_none_that_is_not_there() -> None:
    pages = "".join(path.read_text(encoding="utf-8") for path in DOCS.glob("*.md"))
    shown = set(re.findall(r"!\[[^\]]+\]\(figures/([\w-]+)\.svg\)", pages))
    assert shown == set(FIGURES)
