"""Pages: a template filled with tables and numbers, and the figures that it shows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import jinja2

from docs.draw.experiments.divisions import FRAMES

TEMPLATES = Path(__file__).parent / "pages"


@dataclass(frozen=True)
class Page:
    """A page by its name, what its template gets, and its figures by name, as SVG.

    ``times`` is a table of how long things took: it differs from run to run and has a page of its
    own. ``told`` is what the first page says of this one.
    """

    name: str
    values: Mapping[str, Any]
    figures: Mapping[str, str]
    times: str = ""
    told: Mapping[str, Any] = field(default_factory=dict)

    def text(self) -> str:
        """The page in Markdown."""
        return written(self.name, self.values)


def written(name: str, values: Mapping[str, Any]) -> str:
    """A template filled in."""
    return _environment().get_template(f"{name}.md.j2").render({"frames": FRAMES} | dict(values))


@cache
def _environment() -> jinja2.Environment:
    return jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES),
        undefined=jinja2.StrictUndefined,
        keep_trailing_newline=True,
        trim_blocks=True,
        lstrip_blocks=True,
        autoescape=False,
    )
