"""The scenes that are watched: what was built of each, from which files, and when these change."""

from __future__ import annotations

import traceback
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from jinja2 import TemplateError

from geotween.data.load import load
from geotween.export.build import INDEX, Rendered, gallery, render_scene
from geotween.export.cache import default_cache
from geotween.export.jobs import plan_scenes
from geotween.export.site import Site
from geotween.scene.errors import SceneError

Stamp = tuple[int, int] | None  # when it was changed and how long it is; None: it is not there


@dataclass
class Watched:
    """A scene: its last good build, what is wrong with it now, and the files it was read from."""

    path: Path
    rendered: Rendered | None = None
    error: str = ""
    stamps: dict[Path, Stamp] = field(default_factory=dict)

    @property
    def name(self) -> str:
        return self.path.stem

    def is_stale(self) -> bool:
        """Whether a file that it was read from has changed since."""
        return any(stamp(path) != then for path, then in self.stamps.items())

    def rebuild(self, site: Site, sandbox: Path | None = None) -> None:
        """Build it; where that fails the last good build stays, and ``error`` says why."""
        before = stamps(self.stamps)
        reads: set[Path] = {self.path, *_own(site)}
        try:
            scene = load(self.path, sandbox, reads=reads)
            (plans,) = plan_scenes([scene], cache=default_cache())
            self.rendered = render_scene(scene, index_href=INDEX, plans=plans, site=site)
            self.error = ""
        except (SceneError, TemplateError) as error:
            self.error = str(error)
        except Exception:  # the next version of the scene may be built all the same
            self.error = traceback.format_exc()
        # Stamped before they were read: what changed in the meantime is seen.
        self.stamps = {**stamps(reads - before.keys()), **{p: before[p] for p in reads & {*before}}}


def files_of(scenes: Sequence[Watched], site: Site) -> dict[str, bytes]:
    """All that was built, with an index, by name."""
    good = [watched.rendered for watched in scenes if watched.rendered is not None]
    files = {name: content for rendered in good for name, content in rendered.files.items()}
    return {**files, INDEX: gallery([rendered.card for rendered in good], "Maps", site=site)}


def errors_of(scenes: Iterable[Watched]) -> Mapping[str, str]:
    """What is wrong, by the page that says so; the index says all."""
    found = {f"{watched.name}.html": watched.error for watched in scenes if watched.error}
    return {**found, INDEX: "\n\n".join(found.values())} if found else {}


def stamps(paths: Iterable[Path]) -> dict[Path, Stamp]:
    """The stamps of some files and folders."""
    return {path: stamp(path) for path in paths}


def stamp(path: Path) -> Stamp:
    """What changes with a file, and with the names in a folder."""
    try:
        found = path.stat()
    except (OSError, ValueError):
        return None
    return found.st_mtime_ns, found.st_size


def _own(site: Site) -> list[Path]:
    """A site's own templates."""
    return sorted(site.templates.rglob("*")) if site.templates else []
