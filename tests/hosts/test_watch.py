"""What is served of watched scenes, and when they are built anew."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

from geotween.export.build import INDEX
from geotween.export.site import Site
from geotween.hosts.watch.scenes import Watched, errors_of, files_of
from geotween.hosts.watch.server import SCRIPT, Shelf, followed, version
from tests.conftest import SCENE, WriteScene

BROKEN = "titel: <b>\n"


def built(path: Path) -> Watched:
    watched = Watched(path)
    watched.rebuild(Site())
    return watched


def test_built_pages_know_nothing_of_being_watched(write_scene: WriteScene) -> None:
    files = files_of([built(write_scene())], Site())
    assert sorted(files) == [INDEX, "scene.html", "scene.svg"]
    assert b"geotween-watch" not in b"".join(files.values())


@pytest.mark.parametrize("name", ["scene.html", INDEX])
def test_served_pages_admit_the_script_that_follows_and_no_other(
    write_scene: WriteScene, name: str
) -> None:
    page = files_of([built(write_scene())], Site())[name]
    served = followed(page, name).decode()
    found = re.search(r'Content-Security-Policy" content="([^"]*)"', served)
    assert found
    rules = dict(rule.strip().split(" ", 1) for rule in found[1].replace("&#x27;", "'").split(";"))
    assert rules["default-src"] == "'none'"
    assert rules["connect-src"] == "'self'"
    assert re.fullmatch(r"('sha256-\S+' )?'self'", rules["script-src"])
    assert f'<script src="{SCRIPT}" data-page="{name}" data-version="{version(page)}">' in served
    assert served.index(SCRIPT) < served.index("</body>")


def test_a_scene_that_was_never_right_has_a_page_with_its_error(write_scene: WriteScene) -> None:
    watched = built(write_scene(BROKEN))
    shelf = Shelf()
    shelf.put(files_of([watched], Site()), errors_of([watched]))
    page = shelf.content("scene.html")
    assert page is not None
    number, told = shelf.news("scene.html", 0)
    assert number == 1
    assert told is not None
    assert version(page) in told
    assert "unknown key" in told
    assert shelf.content("other.html") is None


def test_a_broken_scene_keeps_its_last_good_page(write_scene: WriteScene) -> None:
    path = write_scene()
    watched = built(path)
    page = files_of([watched], Site())["scene.html"]
    write_scene(BROKEN)
    watched.rebuild(Site())
    assert f"{path}:1:1: unknown key" in watched.error
    assert files_of([watched], Site())["scene.html"] == page
    assert errors_of([watched])[INDEX] == watched.error
    write_scene()
    watched.rebuild(Site())
    assert (watched.error, dict(errors_of([watched]))) == ("", {})


def test_only_what_a_scene_names_makes_it_stale(write_scene: WriteScene, tmp_path: Path) -> None:
    square = '{"type":"Polygon","coordinates":[[[0,0],[4,0],[4,4],[0,4],[0,0]]]}'
    text = SCENE.replace("[[[0, 0], [4, 0], [4, 4], [0, 4]]]", "a.geojson")
    watched = built(write_scene(text, a=square))
    assert not watched.is_stale()
    (tmp_path / "b.geojson").write_text(square, encoding="utf-8")
    assert not watched.is_stale()
    later = (tmp_path / "a.geojson").stat().st_mtime + 10
    os.utime(tmp_path / "a.geojson", (later, later))
    assert watched.is_stale()
    (tmp_path / "a.geojson").unlink()
    assert watched.is_stale()


def test_a_file_that_comes_into_a_folder_makes_its_scene_stale(
    write_scene: WriteScene, tmp_path: Path
) -> None:
    (tmp_path / "days").mkdir()
    square = '{"type":"Polygon","coordinates":[[[0,0],[400,0],[400,400],[0,0]]]}'
    for day in (1, 2):
        (tmp_path / "days" / f"2024-01-0{day}.geojson").write_text(square, encoding="utf-8")
    watched = built(write_scene("title: t\ndata: days\nmap: {projection: none}\n"))
    assert (watched.error, watched.is_stale()) == ("", False)
    (tmp_path / "days" / "2024-01-03.geojson").write_text(square, encoding="utf-8")
    assert watched.is_stale()


def test_readers_are_let_go_when_it_ends() -> None:
    shelf = Shelf()
    shelf.close()
    assert shelf.news("scene.html", 0) == (0, None)
