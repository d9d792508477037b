"""The files of a scene that are HTML or go with it: page, fragment, snippets, oEmbed."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from urllib.parse import quote

from geotween.export.embed import (
    HOST_SCRIPT,
    frame_height,
    host_script,
    oembed,
    snippets,
    social,
)
from geotween.export.keyframes import Keyframes
from geotween.export.page import page
from geotween.export.site import Site, assets
from geotween.scene.model import SceneFile

PAGE_FORMATS = ("html", "embed", "fragment")


def page_files(
    name: str,
    frames: Keyframes,
    model: SceneFile,
    happened: Sequence[str],
    formats: Collection[str],
    site: Site,
    index_href: str = "",
) -> dict[str, bytes]:
    """The files of a scene by name, those of PAGE_FORMATS that are among the formats.

    ``happened`` tells in a sentence what happens at each step. Snippets are for a page, and there
    are none without it; oEmbed needs to know the page's address.
    """
    site = replace(site, url=site.url or model.url or "")
    page_name = quote(f"{name}.html")
    height = height_in_frame(frames, model, happened)
    # What a caption says already is not said again.
    pairs = zip(happened, frames.captions, strict=True)
    alts = ["" if text == caption else text for text, caption in pairs]
    embedded = "embed" in formats and "html" in formats
    answers = embedded and bool(site.url)
    files: dict[str, str] = {}

    def made(*, fragment: bool) -> str:
        svg = quote(f"{name}.svg") if "svg" in formats else ""
        image = quote(f"{name}.png") if "png" in formats else ""
        return page(
            frames,
            model,
            svg_href="" if fragment else svg,
            index_href="" if fragment else index_href,
            alternative=happened,
            alts=alts,
            social=social(model, page_name, image, site),
            oembed_href=site.address(quote(f"{name}.oembed.json")) if answers else "",
            site=site,
            fragment=fragment,
        )

    if "html" in formats:
        files[f"{name}.html"] = made(fragment=False)
    if "fragment" in formats:
        files[f"{name}.fragment.html"] = made(fragment=True)
    if embedded:
        files[f"{name}.embed.txt"] = snippets(model, page_name, height, site)
    if answers:
        files[f"{name}.oembed.json"] = oembed(model, page_name, height, site)
    return {file: text.encode() for file, text in files.items()}


def height_in_frame(frames: Keyframes, model: SceneFile, happened: Sequence[str]) -> int:
    """About what the page of a scene takes (px) in a frame of the usual width."""
    texts = (model.subtitle, model.description, model.source, model.credit, *happened)
    return frame_height((frames.page.width, frames.page.height), texts)


def shared_files(formats: Collection[str], site: Site) -> dict[str, bytes]:
    """The files that the pages of a folder have in common, by name."""
    scripts = {HOST_SCRIPT: host_script()} if {"embed", "html"} <= {*formats} else {}
    return {**scripts, **(assets(site) if {*PAGE_FORMATS} & {*formats} else {})}
