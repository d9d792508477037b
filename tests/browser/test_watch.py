"""`geotween watch`: the open page follows the scene, shows its errors, and nothing stays behind."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from http.client import HTTPConnection
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

import geotween

SCENE = """\
title: Two squares
map: {width: 300}
timing: {transition: 1, hold: 1}
steps:
  - {label: one, caption: to begin, polygons: a.geojson}
  - {label: two, polygons: [[[4, 0], [8, 0], [8, 4], [4, 4]]]}
"""
SQUARE = '{"type":"Polygon","coordinates":[[[0,0],[4,0],[4,4],[0,4],[0,0]]]}'
MAP = "document.querySelector('geotween-map')"
SOON = 10_000  # ms; an idle machine takes a tenth of it


@dataclass
class Watch:
    folder: Path
    process: subprocess.Popen[str]
    address: str

    @property
    def port(self) -> int:
        return int(self.address.rstrip("/").rpartition(":")[2])

    def edit(self, text: str) -> None:
        (self.folder / "scene.yaml").write_text(text, encoding="utf-8")

    def get(self, path: str, **headers: str) -> int:
        connection = HTTPConnection("127.0.0.1", self.port, timeout=10)
        connection.request("GET", path, headers=headers)
        return connection.getresponse().status


@pytest.fixture
def watch(tmp_path: Path) -> Iterator[Watch]:
    """A scene that is watched, in a process of its own with its own temporary folder."""
    folder, temporary = tmp_path / "work", tmp_path / "temporary"
    folder.mkdir()
    temporary.mkdir()
    (folder / "a.geojson").write_text(SQUARE, encoding="utf-8")
    (folder / "scene.yaml").write_text(SCENE, encoding="utf-8")
    packages = str(Path(geotween.__file__).parents[1])
    process = subprocess.Popen(
        [sys.executable, "-u", "-m", "geotween", "watch", "scene.yaml"],
        cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8",
        env={**os.environ, "PYTHONPATH": packages, "TMPDIR": str(temporary)},
    )  # fmt: skip
    assert process.stdout is not None
    lines = iter(process.stdout.readline, "")
    address = next(line.split()[1] for line in lines if line.startswith("open "))
    yield Watch(folder, process, address)
    process.kill()
    process.wait()
    process.stdout.close()


@pytest.fixture
def page(browser: Browser, watch: Watch) -> Iterator[Page]:
    """The page of that scene, which must have no complaint."""
    said: list[str] = []
    page = browser.new_page()
    page.on("console", lambda message: said.append(message.text))
    page.on("pageerror", lambda error: said.append(str(error)))
    page.goto(watch.address)
    yield page
    page.close()
    assert said == []


def test_an_edited_caption_is_on_the_open_page(watch: Watch, page: Page) -> None:
    page.evaluate(f"{MAP}.pause(); {MAP}.currentTime = 0.5")
    expect(page.get_by_text("to begin").first).to_be_visible()
    watch.edit(SCENE.replace("to begin", "<b>it's edited</b>"))
    edited = page.locator("geotween-map").get_by_text("<b>it's edited</b>").first
    expect(edited).to_be_visible(timeout=SOON)
    assert page.evaluate(f"[{MAP}.currentTime, {MAP}.paused]") == [0.5, True]


def test_an_edited_data_file_is_on_the_open_page(watch: Watch, page: Page) -> None:
    drawn = "document.querySelector('path.region').getAttribute('d')"
    before = page.evaluate(drawn)
    (watch.folder / "a.geojson").write_text(SQUARE.replace("[0,4]", "[2,4]"), encoding="utf-8")
    page.wait_for_event("load", timeout=SOON)
    assert page.evaluate(drawn) != before


def test_a_broken_scene_shows_its_error_and_recovers(watch: Watch, page: Page) -> None:
    watch.edit(SCENE.replace("title: Two squares", "titel: <b>Two</b>"))
    note = page.get_by_role("alert")
    expect(note).to_contain_text("scene.yaml:1:1: unknown key", timeout=SOON)
    expect(note).to_contain_text("titel: <b>Two</b>")
    expect(page.get_by_text("to begin").first).to_be_visible()
    watch.edit(SCENE)
    expect(note).to_be_hidden(timeout=SOON)


def test_a_file_that_is_missing_is_waited_for(watch: Watch, page: Page) -> None:
    (watch.folder / "a.geojson").rename(watch.folder / "b.geojson")
    note = page.get_by_role("alert")
    expect(note).to_contain_text("scene.yaml:5:47: cannot read a.geojson", timeout=SOON)
    (watch.folder / "b.geojson").rename(watch.folder / "a.geojson")
    expect(note).to_be_hidden(timeout=SOON)


def test_served_to_this_machine_only_and_only_what_was_built(watch: Watch) -> None:
    own = f"127.0.0.1:{watch.port}"
    assert watch.get("/scene.html", Host=own) == 200
    assert watch.get("/scene.svg", Host=f"localhost:{watch.port}") == 200
    assert watch.get("/index.html", Host=own) == 200
    assert watch.get("/scene.html", Host=f"evil.example:{watch.port}") == 421
    for path in ("/scene.yaml", "/../scene.yaml", "/%2e%2e/scene.yaml", "/a.geojson", "//etc"):
        assert watch.get(path, Host=own) == 404
    with socket.socket() as other:
        other.settimeout(5)
        assert other.connect_ex((_own_address(), watch.port)) != 0


def _own_address() -> str:
    """The address of this machine for others; one where nobody answers if it has none."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))
            return str(probe.getsockname()[0])
        except OSError:
            return "127.0.0.2"


def test_ctrl_c_leaves_nothing_behind(watch: Watch, page: Page) -> None:
    watch.edit(SCENE.replace("to begin", "again"))
    expect(page.get_by_text("again").first).to_be_visible(timeout=SOON)
    page.evaluate("window.stop()")
    page.goto("about:blank")
    watch.process.send_signal(signal.SIGINT)
    assert watch.process.wait(timeout=5) == 0
    assert sorted(p.name for p in watch.folder.iterdir()) == ["a.geojson", "scene.yaml"]
    assert [*(watch.folder.parent / "temporary").iterdir()] == []
    with socket.socket() as again:
        time.sleep(0.1)
        assert again.connect_ex(("127.0.0.1", watch.port)) != 0
