"""A page on other pages: snippets to copy, oEmbed, and cards of social networks."""

from __future__ import annotations

import json
from collections.abc import Iterable

from geotween.export.resources import resource
from geotween.export.site import Site, fill
from geotween.scene.model import SceneFile

HOST_SCRIPT = "embed.js"
WIDTH = 640  # px of a frame, where its height is told beforehand: a common column of text
AROUND = 320  # px of what each page has beside its map and the lines of its texts
TALLEST = 640  # px of a map in a frame: the 40rem of page.css
LINE, LETTERS, MOST_LINES = 25, 78, 60  # px and letters of a line of text


def snippets(model: SceneFile, page: str, height: int, site: Site) -> str:
    """HTML that shows a page on another one, in some ways, with a line on each.

    ``page`` is the name of its file as links have it, ``height`` what a frame of WIDTH takes.
    """
    return fill(
        "embed.txt.j2",
        site,
        src=site.address(page),
        title=model.title,
        height=height,
        page=page,
        script=HOST_SCRIPT,
        host=site.address(HOST_SCRIPT),
        known=bool(site.url),
    )


def oembed(model: SceneFile, page: str, height: int, site: Site) -> str:
    """The answer of an oEmbed provider (https://oembed.com, version 1.0) for a page, as JSON."""
    frame = fill(
        "parts/frame.html.j2", site, src=site.address(page), title=model.title, height=height
    )
    told: dict[str, object] = {
        "version": "1.0",
        "type": "rich",
        "title": model.title,
        "width": WIDTH,
        "height": height,
        "html": frame.strip(),
    }
    if model.credit:
        told["author_name"] = model.credit
    return json.dumps(told, ensure_ascii=False, indent=2) + "\n"


def social(model: SceneFile, page: str, image: str, site: Site) -> dict[str, str]:
    """Meta elements for cards of social networks by name; none where the site has no address.

    ``image`` is the name of a still that networks take, empty where there is none: they want
    pixels, not SVG.
    """
    if not site.url:
        return {}
    found = {
        "og:type": "website",
        "og:url": site.address(page),
        "og:title": model.title,
        "og:description": model.description or model.subtitle,
        "og:locale": model.lang.replace("-", "_"),
        "og:image": site.address(image) if image else "",
        "og:image:alt": model.title if image else "",
        "twitter:card": "summary_large_image" if image else "summary",
    }
    return {name: content for name, content in found.items() if content}


def host_script() -> bytes:
    """The script that sites load for the snippet of one element."""
    return (resource("templates") / HOST_SCRIPT).read_bytes()


def frame_height(size: tuple[float, float], texts: Iterable[str]) -> int:
    """About what a page takes (px) in a frame of WIDTH, for a map of some size and some texts."""
    width, height = size
    lines = sum(-(-len(text) // LETTERS) for text in texts)
    drawn = min(height * min(1.0, WIDTH / width), TALLEST)
    return round(drawn + AROUND + LINE * min(lines, MOST_LINES))
