"""How pages fit into a site: their address, its own templates, and where style and script are."""

from __future__ import annotations

import base64
import hashlib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import (
    BaseLoader,
    ChoiceLoader,
    Environment,
    FileSystemLoader,
    PrefixLoader,
    StrictUndefined,
)
from markupsafe import Markup, escape

from geotween.export.resources import resource

# What each kind of page is styled and moved by, in this order.
STYLES = {
    "player": ("page.css", "player.css"),
    "scroll": ("page.css", "player.css", "scroll.css"),
    "index": ("page.css", "gallery.css"),
}
SCRIPTS = {
    "player": ("player.js", "frame.js"),
    "scroll": ("player.js", "frame.js", "scroll.js"),
    "index": (),
}
THEME = "theme.css"  # a site's own style, after ours
STYLE_FILE, SCRIPT_FILE = "geotween.css", "geotween.js"


@dataclass(frozen=True)
class Site:
    """What a site wants of all pages.

    ``url`` is the address of the folder they will stand in, empty where it is not known.
    ``templates`` is a folder whose templates come before ours. ``external`` puts style and script
    into files beside the pages.
    """

    url: str = ""
    templates: Path | None = None
    external: bool = False

    def address(self, href: str) -> str:
        """A file beside the pages as other sites name it; as it is where the site is not known."""
        return f"{self.url.rstrip('/')}/{href}" if self.url else href


def render(template: str, site: Site, kind: str, *, elsewhere: bool = False, **context: Any) -> str:
    """A template filled in, with style, script and the policy that admits them and nothing else.

    ``elsewhere`` is what will not stand beside the files of style and script.

    Raises
    ------
    jinja2.TemplateError
        Where a site's own template is wrong.
    """
    style, script = _style(site, kind), _script(kind)
    if site.external:
        css, js = (site.address(f) if elsewhere else f for f in (STYLE_FILE, SCRIPT_FILE))
        style_part = f'<link rel="stylesheet" href="{escape(css)}">'
        script_part = f'<script src="{escape(js)}" defer></script>'
        style_source = script_source = "'self'"
    else:
        style_part, script_part = f"<style>{style}</style>", f"<script>{script}</script>"
        style_source, script_source = _hash(style), _hash(script)
    policy = [
        "default-src 'none'",
        *([f"script-src {script_source}"] if script else []),
        f"style-src {style_source}",
        "img-src 'self' data:" if kind == "index" else "img-src data:",
        "base-uri 'none'",
        "form-action 'none'",
    ]
    return fill(
        template,
        site,
        **context,
        style=Markup(style_part),
        script=Markup(script_part if script else ""),
        policy="; ".join(policy),
    )


def fill(template: str, site: Site, **context: Any) -> str:
    """A template filled in; what is no markup is escaped."""
    return _environment(site.templates).get_template(template).render(context)


def assets(site: Site) -> dict[str, bytes]:
    """The files that pages share, by name: none where each page carries its own."""
    if not site.external:
        return {}
    names = dict.fromkeys(name for names in STYLES.values() for name in names)
    style = "\n".join([*map(_text, names), *_theme(site)])
    return {STYLE_FILE: style.encode(), SCRIPT_FILE: _script("scroll").encode()}


def _style(site: Site, kind: str) -> str:
    return "\n".join([*map(_text, STYLES[kind]), *_theme(site)])


def _script(kind: str) -> str:
    return "\n".join(map(_text, SCRIPTS[kind]))


def _theme(site: Site) -> list[str]:
    theme = site.templates / THEME if site.templates else None
    return [theme.read_text(encoding="utf-8")] if theme and theme.is_file() else []


@cache
def _environment(own: Path | None) -> Environment:
    ours = FileSystemLoader(resource("templates"))
    loaders: list[BaseLoader] = [ours, PrefixLoader({"geotween": ours})]
    return Environment(
        loader=ChoiceLoader([FileSystemLoader(own), *loaders] if own else loaders),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )


@cache
def _text(name: str) -> str:
    return (resource("templates") / name).read_text(encoding="utf-8")


def _hash(text: str) -> str:
    digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
    return f"'sha256-{digest}'"
