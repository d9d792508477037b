"""Sphinx: ``.. geotween:: scene.yaml`` is a map where there is HTML, and its words elsewhere.

``extensions = ["geotween.hosts.sphinx"]`` in ``conf.py`` makes the directive known.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.util.docutils import SphinxDirective

from geotween import __version__
from geotween.hosts.built import built
from geotween.scene.errors import SceneError

logger = logging.getLogger(__name__)


class MapDirective(SphinxDirective):
    """A map; the path is relative to the document, or to the sources where it begins with /."""

    required_arguments = 1
    final_argument_whitespace = True

    def run(self) -> list[nodes.Node]:
        _, path = self.env.relfn2path(self.arguments[0])
        reads: set[Path] = set()
        try:
            found = built(Path(path), reads=reads)
        except SceneError as error:
            raise self.error(str(error)) from None
        finally:
            for read in sorted(reads):
                self.env.note_dependency(str(read))
        for problem in found.problems:
            logger.warning("%s", problem, location=self.get_location())
        # What was read is kept for all builders, each of which takes its own of these.
        words = ". ".join(filter(None, (found.title.rstrip("."), found.description)))
        elsewhere = addnodes.only("", nodes.paragraph("", words), expr="not html")
        return [nodes.raw("", str(found.html), format="html"), elsewhere]


def setup(app: Sphinx) -> dict[str, Any]:
    """Make the directive known."""
    app.add_directive("geotween", MapDirective)
    return {"version": __version__, "parallel_read_safe": True, "parallel_write_safe": True}
