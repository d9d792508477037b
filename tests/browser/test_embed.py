"""Maps on other pages: frames as high as their content, fragments, oEmbed, cards."""

from __future__ import annotations

import json
import re
from pathlib import Path
from urllib.parse import quote

import pytest
from playwright.sync_api import Browser, Page

from tests.browser import drawn, hosts

URL = "https://example.org/maps"
MAP = "document.querySelector('geotween-map')"

# Hosts, as others write them: by the window that speaks, by the name in the address, as Pym does.
DATAWRAPPER = """addEventListener('message', ({data, source}) => {
  for (const height of Object.values(data['datawrapper-height'] ?? {}))
    for (const frame of document.querySelectorAll('iframe'))
      if (frame.contentWindow === source) frame.style.height = height + 'px'; })"""
DATAWRAPPER_BY_NAME = """addEventListener('message', ({data}) => {
  for (const id in data['datawrapper-height'] ?? {})
    document.querySelector(`iframe[src*='${id}']`)
      .style.height = data['datawrapper-height'][id] + 'px'; })"""
PYM = """addEventListener('message', ({data}) => {
  const found = String(data).match(/^pymxPYMxmap-1xPYMx(\\S+)xPYMx(.*)$/);
  if (found?.[1] === 'height')
    document.querySelector('iframe').setAttribute('height', parseInt(found[2]) + 'px'); })"""
PYM_QUERY = "?initialWidth=640&childId=map-1&parentTitle=Host&parentUrl=https%3A%2F%2Fexample.com"


def framed(page: Page, *, width: int) -> tuple[float, float]:
    """The height of the frame and that of its content, at a width of the window."""
    page.set_viewport_size({"width": width, "height": 500})
    page.wait_for_timeout(300)
    frame = page.locator("iframe").evaluate("f => f.getBoundingClientRect().height")
    (child,) = page.frames[1:]
    return frame, child.evaluate("document.documentElement.getBoundingClientRect().height")


def snippet(folder: Path, number: int, name: str = "squares") -> str:
    """One of the snippets beside a page."""
    return (folder / f"{name}.embed.txt").read_text(encoding="utf-8").split("\n\n\n")[number]


@pytest.mark.parametrize("number", [1, 2], ids=["frame", "script"])
def test_a_snippet_gives_a_frame_the_height_of_its_content(
    browser: Browser, tmp_path: Path, number: int
) -> None:
    folder = hosts.build(tmp_path)
    markup = snippet(folder, number).partition("\n\n")[2]
    page = browser.new_page()
    page.goto(hosts.host(folder, markup).as_uri())
    page.locator("iframe").wait_for()
    for width in (1000, 360, 1000):
        frame, content = framed(page, width=width)
        assert abs(frame - content) <= 1
    assert page.locator("iframe").get_attribute("title") == "Two squares"
    assert page.evaluate("document.documentElement.scrollWidth") <= 1000
    page.close()


@pytest.mark.parametrize(
    ("listener", "query"),
    [(DATAWRAPPER, ""), (DATAWRAPPER_BY_NAME, ""), (PYM, PYM_QUERY)],
    ids=["datawrapper", "datawrapper by name", "pym"],
)
def test_hosts_of_others_understand_the_height(
    browser: Browser, tmp_path: Path, listener: str, query: str
) -> None:
    folder = hosts.build(tmp_path, name="my map")
    source = quote("my map.html") + query
    frame_part = (
        f'<script>{listener}</script><iframe src="{source}" title="Map" width="600"></iframe>'
    )
    page = browser.new_page()
    page.goto(hosts.host(folder, f"<script>{listener}</script>{frame_part}").as_uri())
    frame, content = framed(page, width=900)
    assert abs(frame - content) <= 5  # a border that it has unless told
    page.close()


def test_in_a_frame_a_story_is_a_map_with_controls(browser: Browser, tmp_path: Path) -> None:
    folder = hosts.build(tmp_path, scene=f"layout: scroll\n{hosts.SCENE}")
    page = browser.new_page()
    page.goto(hosts.host(folder, snippet(folder, 1).partition("\n\n")[2]).as_uri())
    controls = page.frame_locator("iframe").locator(".controls")
    controls.wait_for()
    assert controls.is_visible()
    page.close()


def test_the_told_height_is_about_right(browser: Browser, gallery: Path) -> None:
    for path in gallery.glob("*.embed.txt"):
        told = int(re.findall(r'height="(\d+)"', path.read_text(encoding="utf-8"))[0])
        page = browser.new_page(viewport={"width": 640, "height": 3000})
        page.goto((gallery / path.name.replace(".embed.txt", ".html")).as_uri())
        height = page.evaluate("document.documentElement.getBoundingClientRect().height")
        assert 0.6 * height <= told <= 1.4 * height, path.name
        page.close()


@pytest.mark.parametrize("layout", ["player", "scroll"])
def test_a_fragment_plays_in_a_page_of_others_and_leaves_it_alone(
    browser: Browser, tmp_path: Path, layout: str
) -> None:
    folder = hosts.build(tmp_path, "--fragment", scene=f"layout: {layout}\n{hosts.SCENE}")
    fragment = (folder / "squares.fragment.html").read_text(encoding="utf-8")
    looks = """[...document.querySelectorAll('html, body, h1, .caption')].map(
      e => ['color', 'font', 'margin', 'background-color', 'padding'].map(
        name => getComputedStyle(e)[name]))"""
    found = []
    for name, content in (("bare", ""), ("with", fragment)):
        file = hosts.host(folder, f'<p class="caption">Ours</p>{content}', f"{name}.html")
        with drawn.open_page(browser, file, color_scheme="dark") as page:
            found.append(page.evaluate(looks)[:4])
            if content:
                assert page.evaluate(f"{MAP}.duration") == 3
                assert page.locator("geotween-map svg path.region").count() == 1
    assert found[0] == found[1]


def test_two_fragments_on_a_page_both_play(browser: Browser, tmp_path: Path) -> None:
    folder = hosts.build(tmp_path, "--fragment")
    fragment = (folder / "squares.fragment.html").read_text(encoding="utf-8")
    with drawn.open_page(browser, hosts.host(folder, fragment + fragment)) as page:
        found = "[...document.querySelectorAll('geotween-map')].map(map => map.duration)"
        assert page.evaluate(found) == [3, 3]


def test_oembed_tells_the_frame(tmp_path: Path) -> None:
    folder = hosts.build(tmp_path, "--url", URL)
    told = json.loads((folder / "squares.oembed.json").read_text(encoding="utf-8"))
    assert (told["version"], told["type"], told["title"]) == ("1.0", "rich", "Two squares")
    assert f'src="{URL}/squares.html"' in told["html"]
    assert f'height="{told["height"]}"' in told["html"]
    text = (folder / "squares.html").read_text(encoding="utf-8")
    assert f'type="application/json+oembed" href="{URL}/squares.oembed.json"' in text


def test_cards_are_told_where_the_address_is_known(tmp_path: Path) -> None:
    named = hosts.build(tmp_path / "a", scene=f"url: {URL}\n{hosts.SCENE}")
    text = (named / "squares.html").read_text(encoding="utf-8")
    cards = dict(
        re.findall(r'<meta (?:property|name)="((?:og|twitter):\w+)" content="(.*?)">', text)
    )
    assert cards == {
        "og:type": "website",
        "og:url": f"{URL}/squares.html",
        "og:title": "Two squares",
        "og:description": "A square, and where it goes.",
        "og:locale": "en",
        "twitter:card": "summary",
    }
    bare = (hosts.build(tmp_path / "b") / "squares.html").read_text(encoding="utf-8")
    assert "og:" not in bare
    assert "oembed" not in bare


def test_the_address_on_the_command_line_comes_before_the_scenes(tmp_path: Path) -> None:
    scene = f"url: https://example.net\n{hosts.SCENE}"
    folder = hosts.build(tmp_path, "--url", f"{URL}/", scene=scene)
    assert f'src="{URL}/squares.html"' in snippet(folder, 1)


def test_style_and_script_lie_beside_the_pages_where_asked(
    browser: Browser, tmp_path: Path
) -> None:
    folder = hosts.build(tmp_path, "--assets", "external")
    for file in folder.glob("*.html"):
        text = file.read_text(encoding="utf-8")
        assert "<style" not in text
        assert not re.search(r"<script(?! type=\"application/json\"| src=)", text)
    said: list[str] = []
    with hosts.served(folder) as address:
        page = browser.new_page()
        page.on("console", lambda message: said.append(message.text))
        page.goto(f"{address}/squares.html")
        page.locator(".controls").wait_for()
        assert page.evaluate("getComputedStyle(document.querySelector('main')).maxWidth") != "none"
        page.goto(f"{address}/index.html")
        assert page.locator(".card").is_visible()
        page.close()
    assert said == []


def test_a_sites_templates_and_theme_come_before_ours(browser: Browser, tmp_path: Path) -> None:
    own = tmp_path / "own"
    own.mkdir()
    (own / "theme.css").write_text("html { --geotween-accent: rgb(1 2 3); }", encoding="utf-8")
    (own / "page.html.j2").write_text(
        '{% extends "geotween/page.html.j2" %}'
        "{% block header %}<h1 class=own>{{ title }}!</h1>{% endblock %}",
        encoding="utf-8",
    )
    (own / "parts").mkdir()
    (own / "parts" / "sources.html.j2").write_text("<p>{{ source }}</p>", encoding="utf-8")
    scene = hosts.SCENE.replace("Nobody", "'<b>Nobody</b>'")
    folder = hosts.build(tmp_path, "--templates", str(own), scene=scene)
    with drawn.open_page(browser, folder / "squares.html") as page:
        assert page.locator("h1.own").inner_text() == "Two squares!"
        assert page.locator("main > p").last.inner_text() == "<b>Nobody</b>"
        thumb = "getComputedStyle(document.querySelector('.geotween')).getPropertyValue('--accent')"
        assert page.evaluate(thumb) == "rgb(1 2 3)"


@pytest.mark.parametrize(
    ("template", "message"),
    [("{% block %}", "page.html.j2:1: "), ("{{ nothing }}", "'nothing' is undefined")],
)
def test_a_wrong_template_is_told_in_a_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], template: str, message: str
) -> None:
    (tmp_path / "page.html.j2").write_text(template, encoding="utf-8")
    with pytest.raises(AssertionError):
        hosts.build(tmp_path, "--templates", str(tmp_path))
    told = capsys.readouterr().err
    assert message in told
    assert told.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("url", ["javascript:alert(1)", "example.org", "https://x y", 'http://"'])
def test_what_is_no_address_is_refused(tmp_path: Path, url: str) -> None:
    with pytest.raises(AssertionError):
        hosts.build(tmp_path, "--url", url)
