"""Nothing that a scene says runs or escapes: texts arrive as texts, and the policy is silent."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Page

from geotween.cli import main
from tests.browser import hosts

OWNED = "document.title='owned'"
HOSTILE = {
    "script": f"</script><script>{OWNED}</script>",
    "handler": f'<img src=x onerror="{OWNED}">',
    "quotes": f"\"'`><svg onload={OWNED}>",
    "style": "</style><style>body{display:none}</style>",
    "css": "red;} body{background:url(https://example.org/x)} a{",
    "comment": "<!--<script>--><!-- ]]> ?> %>",
    "entities": "&lt;b&gt; &amp;amp; &#x3c;script&#x3e; &copy",
    "templates": "{{ 7 * 7 }} {% include 'x' %} ${1} #{1} {label} {n}",
    "address": f"javascript:{OWNED}",
    "bidi": "\u202egnirts\u2066\u2069\u200f \u2028\u2029 \U0001f600",
    "long": "x" * 100_000,
}
EACH_TEXT = pytest.mark.parametrize("text", HOSTILE.values(), ids=HOSTILE)


class Guarded:
    """A page that notes what it says, asks for, and what its policy refuses."""

    def __init__(self, browser: Browser, address: str, **options: Any) -> None:
        self.said: list[str] = []
        self.asked: list[str] = []
        self.page: Page = browser.new_page(**options)
        self.page.on("console", lambda message: self.said.append(message.text))
        self.page.on("pageerror", lambda error: self.said.append(str(error)))
        self.page.on("dialog", lambda dialog: self.said.append(dialog.message))
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.page.add_init_script(
            """window.refused = [];
            addEventListener('securitypolicyviolation', e => refused.push(e.violatedDirective))"""
        )
        self.page.goto(address)

    def __enter__(self) -> Page:
        return self.page

    def __exit__(self, *error: object) -> None:
        refused = self.page.evaluate("window.refused")
        title = self.page.title()
        self.page.close()
        if error[0] is None:
            assert (refused, self.said, title == "owned") == ([], [], False)
            assert all(url.startswith(("file:", "data:")) for url in self.asked)


def in_yaml(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\u2028", "\\L").replace("\u2029", "\\P")


def scene(text: str) -> str:
    """A scene that says the same thing wherever it may say something."""
    quoted = in_yaml(text)
    square = "polygon: [[0, 0], [4, 0], [4, 4]]"
    feature = f"{{key: {quoted}, class: {quoted}, name: {quoted}, {square}}}"
    layer = f"{{name: {quoted}, polygons: [[0, 0], [9, 0], [9, 9]]}}"
    return f"""
layout: scroll
title: {quoted}
subtitle: {quoted}
description: {quoted}
source: {quoted}
credit: {quoted}
map:
  labels: names
  legend: {{? {quoted} : {quoted}}}
  layers: [{layer}]
  annotations: [{{text: {quoted}, at: [1, 1], steps: [{quoted}]}}]
story: {{noun: {quoted}, nouns: {quoted}}}
steps:
  - {{label: {quoted}, caption: {quoted}, polygons: [{feature}]}}
  - {{label: {quoted}, polygons: [{feature}]}}
"""


@EACH_TEXT
def test_texts_arrive_as_texts(browser: Browser, tmp_path: Path, text: str) -> None:
    folder = hosts.build(tmp_path, "--fragment", scene=scene(text))
    with Guarded(browser, (folder / "squares.html").as_uri()) as page:
        content = "document.querySelector('{}').textContent"
        places = ("h1", ".subtitle", ".description", ".source", ".credit")
        for place in (*places, "figcaption strong", ".chapter p"):
            assert page.evaluate(content.format(place)) == text, place
        attributes = "document.querySelector('{}').getAttribute('{}')"
        for place, name in (("geotween-map", "aria-label"), ("path.region", "data-key")):
            assert page.evaluate(attributes.format(place, name)) == text
        assert page.evaluate("document.querySelector('geotween-map').steps[0].label") == text
        assert page.locator("img, object, iframe, embed, [onerror], [onload]").count() == 0
        assert page.locator("script").count() == 2
        assert page.locator("style").count() == 1
    with Guarded(browser, (folder / "index.html").as_uri()) as page:
        assert page.evaluate(content.format(".card h2")) == text
        assert page.locator("script, [onerror], [onload]").count() == 0
    fragment = (folder / "squares.fragment.html").read_text(encoding="utf-8")
    with Guarded(browser, hosts.host(folder, fragment).as_uri()) as page:
        assert page.evaluate(attributes.format("geotween-map", "aria-label")) == text
        assert page.evaluate(content.format("body > main > h1")) == "A site"
        assert page.locator("img, object, iframe, embed, [onerror], [onload]").count() == 0
    with Guarded(browser, (folder / "squares.svg").as_uri()) as page:
        assert page.evaluate(content.format("title")) == text
        assert page.evaluate("document.querySelectorAll('script, img, [onload]').length") == 0


@EACH_TEXT
def test_snippets_and_oembed_hold_texts_as_texts(
    browser: Browser, tmp_path: Path, text: str
) -> None:
    folder = hosts.build(tmp_path, "--url", "https://example.org", scene=scene(text))
    snippet = (folder / "squares.embed.txt").read_text(encoding="utf-8").split("\n\n\n")[1]
    told = json.loads((folder / "squares.oembed.json").read_text(encoding="utf-8"))
    assert told["title"] == text
    for markup in (snippet.partition("\n\n")[2], told["html"]):
        local = markup.replace("https://example.org/squares.html", "data:text/html,")
        with Guarded(browser, hosts.host(folder, local).as_uri()) as page:
            assert page.evaluate("document.querySelector('iframe').title") == text
            assert page.locator("img, svg, [onerror], [onload]").count() == 0


@pytest.mark.parametrize(
    "name", ["a\"onload='x", "<b>&amp;", "a b #1?x=%20", "java:script", "ä\u202eü"]
)
def test_file_names_become_addresses(browser: Browser, tmp_path: Path, name: str) -> None:
    folder = hosts.build(tmp_path, name=name)
    with Guarded(browser, (folder / "index.html").as_uri()) as page:
        page.locator(".card a").click()
        assert page.locator("h1").inner_text() == "Two squares"
        page.locator(".links a").first.click()
        assert page.locator("svg > title").count() == 1
        page.go_back()


@pytest.mark.parametrize(
    "colour", ["red;fill:blue", "url(https://example.org/x)", '"><script>', "expression(1)"]
)
def test_what_is_no_colour_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], colour: str
) -> None:
    (tmp_path / "x.yaml").write_text(
        f"style: {{fill: {json.dumps(colour)}}}\n{hosts.SCENE}", "utf-8"
    )
    with pytest.raises(SystemExit) as exit_:
        main(["build", str(tmp_path / "x.yaml"), "-o", str(tmp_path / "out")])
    assert exit_.value.code == 2
    assert "colour" in capsys.readouterr().err


@EACH_TEXT
def test_columns_of_files_are_told_as_texts(browser: Browser, tmp_path: Path, text: str) -> None:
    square = {"type": "Polygon", "coordinates": [[[0, 0], [4, 0], [4, 4], [0, 0]]]}
    row = {"key": text, text[:50]: text}
    features = [{"type": "Feature", "properties": row, "geometry": square}]
    data = {"type": "FeatureCollection", "features": features}
    (tmp_path / "x.geojson").write_text(json.dumps(data), encoding="utf-8")
    asked = in_yaml(text[:50])
    text_of_scene = (
        f"title: t\nmap: {{tooltip: [{asked}]}}\n"
        "steps: [{polygons: x.geojson}, {polygons: x.geojson}]\n"
    )
    folder = hosts.build(tmp_path, scene=text_of_scene)
    with Guarded(browser, (folder / "squares.html").as_uri()) as page:
        page.locator("svg.figure").focus()
        page.keyboard.press("n")
        assert page.evaluate("document.querySelector('.tip dd').textContent") == text
        assert page.evaluate("document.querySelector('.tip strong').textContent") == text


def test_the_policy_names_the_pages_own_script_and_nothing_else(tmp_path: Path) -> None:
    for option, script in (("inline", "'sha256-"), ("external", "'self'")):
        folder = hosts.build(tmp_path / option, "--assets", option)
        text = (folder / "squares.html").read_text(encoding="utf-8")
        policy = text.split('http-equiv="Content-Security-Policy" content="')[1].split('"')[0]
        rules = dict(rule.split(" ", 1) for rule in policy.replace("&#39;", "'").split("; "))
        assert rules.pop("script-src").startswith(script)
        assert rules.pop("style-src").startswith(script)
        none = dict.fromkeys(["default-src", "base-uri", "form-action"], "'none'")
        assert rules == {**none, "img-src": "data:"}


def test_the_policy_refuses_what_is_put_into_the_page_later(
    browser: Browser, tmp_path: Path
) -> None:
    folder = hosts.build(tmp_path)
    file = folder / "squares.html"
    text = file.read_text(encoding="utf-8")
    file.write_text(
        text.replace("</main>", f"<p style='color: red'><script>{OWNED}</script></main>")
    )
    page = browser.new_page()
    page.goto(file.as_uri())
    assert page.title() == "Two squares"
    assert page.evaluate("document.querySelector('main > p[style]').style.length") == 0
    page.close()


def test_scripts_neither_evaluate_text_nor_write_markup() -> None:
    from geotween.export.resources import resource

    for path in resource("templates").glob("*.js"):
        text = path.read_text(encoding="utf-8")
        for word in (
            "eval(",
            "Function(",
            "innerHTML",
            "outerHTML",
            "insertAdjacent",
            "document.write",
        ):
            assert word not in text, path.name
    for path in resource("templates").rglob("*.j2"):
        assert "|safe" not in path.read_text(encoding="utf-8").replace(" ", ""), path.name
