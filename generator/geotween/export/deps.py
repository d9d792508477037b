"""What a build was made of, as a rule for make."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from pathlib import Path

from geotween.export.resources import resource
from geotween.export.site import Site

_SPECIAL = re.compile(r"([\s#%:\\])")


def rule(targets: Iterable[Path], reads: Iterable[Path], site: Site) -> str:
    """The rule that some files are made of others, and of the templates.

    Each of the latter is a target without a rule as well, so that one that is gone makes no error
    but a new build, as with ``-MP`` of C compilers.
    """
    own = site.templates.rglob("*") if site.templates else ()
    templates = [path for path in (*resource("templates").rglob("*"), *own) if path.is_file()]
    needed = list(dict.fromkeys(map(_name, [*sorted(reads), *sorted(templates)])))
    lines = [" ".join(map(_name, targets)) + ":", *needed]
    return " \\\n  ".join(lines) + "\n" + "".join(f"\n{name}:\n" for name in needed)


def _name(path: Path) -> str:
    """A path as make reads it: with its own characters escaped, and a dollar as two."""
    return _SPECIAL.sub(r"\\\1", os.path.normpath(path)).replace("$", "$$")
