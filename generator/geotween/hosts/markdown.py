"""Python-Markdown, and so MkDocs: a line ``{{ geotween scene.yaml }}`` is a map.

``markdown_extensions: [{geotween.hosts.markdown: {base: docs}}]`` in ``mkdocs.yml`` makes it
known.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from markdown import Markdown
from markdown.extensions import Extension
from markdown.preprocessors import Preprocessor

from geotween.hosts.built import built

LINE = re.compile(r"^ {0,3}\{\{\s*geotween\s+(.+?)\s*\}\}\s*$")
FENCE = re.compile(r"^ {0,3}(`{3,}|~{3,})")


class MapExtension(Extension):
    """Maps in Markdown.

    ``base`` is the folder that paths of scenes are relative to: the one that the tool runs in
    unless given. A scene with errors stops the build, with all of them.
    """

    def __init__(self, **options: Any) -> None:
        self.config = {"base": [".", "the folder that paths of scenes are relative to"]}
        super().__init__(**options)

    def extendMarkdown(self, md: Markdown) -> None:  # noqa: N802 - the library's name
        """Let maps be put in before anything else is read, code blocks excepted."""
        md.preprocessors.register(_Maps(md, Path(self.getConfig("base"))), "geotween", 28)


class _Maps(Preprocessor):
    def __init__(self, md: Markdown, base: Path) -> None:
        super().__init__(md)
        self.base = base

    def run(self, lines: list[str]) -> list[str]:
        found: list[str] = []
        fence = ""
        for line in lines:
            mark = FENCE.match(line)
            if mark and not fence:
                fence = mark[1]
            elif mark and mark[1].startswith(fence):
                fence = ""
            named = None if fence else LINE.match(line)
            found += ["", self._map(named[1]), ""] if named else [line]
        return found

    def _map(self, name: str) -> str:
        # Kept aside: no other part of the library reads on in it.
        return self.md.htmlStash.store(built(self.base / name).html)


def makeExtension(**options: Any) -> MapExtension:  # noqa: N802 - the library's name
    """The extension, as the library asks for it."""
    return MapExtension(**options)
