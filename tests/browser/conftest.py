"""A real Chromium, and the gallery built for it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Playwright, sync_playwright

from geotween.cli import main
from geotween.export.resources import resource
from tests.browser.chromium import HELP, find

# The browser's own calls home are switched off, so that any request is the page's.
ARGUMENTS = ["--no-sandbox", "--disable-quic", "--disable-background-networking"]


@pytest.fixture(scope="session")
def playwright() -> Iterator[Playwright]:
    with sync_playwright() as opened:
        yield opened


@pytest.fixture(scope="session")
def browser(playwright: Playwright) -> Iterator[Browser]:
    path = find()
    if path is None:
        pytest.fail(HELP)
    browser = playwright.chromium.launch(executable_path=path, args=ARGUMENTS)
    yield browser
    browser.close()


@pytest.fixture(scope="session")
def gallery(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The example scenes, built by the command that the README names."""
    folder = tmp_path_factory.mktemp("public")
    scenes = [str(path) for path in sorted(resource("scenes").glob("*.yaml"))]
    with pytest.raises(SystemExit) as exit_:
        main(["build", *scenes, "-o", str(folder), "-q"])
    assert exit_.value.code == 0
    return folder
