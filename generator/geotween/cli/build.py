"""``geotween build``: scenes become pages, SVGs, pictures and films."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from geotween.cli.common import (
    CACHE,
    JOBS,
    PROBLEMS,
    QUIET,
    SANDBOX,
    SCENES,
    count_of,
    fail,
    have_what_is_needed,
    load_all,
    planned,
    report,
)

if TYPE_CHECKING:
    from geotween.export.build import Rendered
    from geotween.export.site import Site


@click.command()
@SCENES
@click.option("-o", "--out", required=True, metavar="DIR", help="Folder for the files.")
@click.option(
    "--format", "formats", default="html,svg,embed", show_default=True, metavar="LIST",
    help="What to write; embed: how to show the page on others.",
)  # fmt: skip
@click.option(
    "--between", type=click.IntRange(0, 1000), metavar="N",
    help="Frames between two steps, of format geojson; nine, if not given.",
)  # fmt: skip
@click.option("--fragment", is_flag=True, help="Write the map for a template of yours, too.")
@click.option(
    "--url", metavar="BASE", help="Where the pages will stand, for what other sites are told."
)
@click.option(
    "--templates", metavar="DIR", type=click.Path(exists=True, file_okay=False, path_type=Path),
    help="Your own templates and theme.css; they run as code.",
)  # fmt: skip
@click.option(
    "--assets", type=click.Choice(["inline", "external"]), default="inline", show_default=True,
    help="Style and script in each page, or in files beside them.",
)  # fmt: skip
@click.option(
    "--deps", metavar="FILE", type=click.Path(dir_okay=False, path_type=Path),
    help="Write a rule for make: which files depend on which.",
)  # fmt: skip
@click.option(
    "--width", type=click.IntRange(16, 8000), metavar="PX", help="Of pictures, in pixels.",
)  # fmt: skip
@click.option(
    "--fps", type=click.FloatRange(1, 60), metavar="N", help="Frames a second of moving pictures.",
)  # fmt: skip
@click.option(
    "--shape", type=click.Choice(["landscape", "square", "vertical"]),
    help="Of pictures; as the map is, if not given.",
)  # fmt: skip
@click.option(
    "--max-size", type=click.FloatRange(0, min_open=True), metavar="MB",
    help="Of a GIF: colours and frames are given up for it.",
)  # fmt: skip
@click.option("--strict", is_flag=True, help="Exit with 1 where there are warnings; write nothing.")
@SANDBOX
@JOBS
@CACHE
@QUIET
def build(
    scenes: tuple[Path, ...],
    out: str,
    formats: str,
    between: int | None,
    fragment: bool,
    url: str | None,
    templates: Path | None,
    assets: str,
    deps: Path | None,
    width: int | None,
    fps: float | None,
    shape: Literal["landscape", "square", "vertical"] | None,
    max_size: float | None,
    strict: bool,
    sandbox: Path | None,
    jobs: int | None,
    cache: bool,
    quiet: bool,
) -> None:
    """Build scenes into standalone pages and SVGs, with an index of those named.

    \b
    Examples:
      geotween build fire.yaml -o public
      geotween build scenes/*.yaml -o public --format svg
      geotween build fire.yaml -o public --format mp4,gif --shape square
      geotween build fire.yaml -o public --url https://example.org/maps
      geotween build fire.yaml -o public --strict -q     in CI
    """
    from geotween.export import build as export
    from geotween.export.between import BETWEEN
    from geotween.export.deps import rule
    from geotween.export.jobs import cores
    from geotween.export.pages import shared_files
    from geotween.export.pictures.formats import Pictures

    wanted = [name.strip() for name in formats.split(",") if name.strip()]
    unknown = sorted(set(wanted) - set(export.KNOWN_FORMATS))
    if unknown or not wanted:
        expected = ", ".join(export.KNOWN_FORMATS)
        raise click.BadParameter(f"expected some of {expected}", param_hint="--format")
    if fragment:
        wanted.append("fragment")
    site = _site(url, templates, assets)
    hidden = quiet or not sys.stderr.isatty()
    pictures = Pictures(fps, width, shape, max_size, jobs or cores(), partial(_film_bar, hidden))
    have_what_is_needed(wanted)
    try:
        folder = export.writable(out)
    except OSError as error:
        fail(f"cannot write to {out}: {error.filename}: {error.strerror}")
    reads: set[Path] = set()
    loaded = load_all(scenes, sandbox, reads)
    names = [scene.name for scene in loaded]
    for name in names:
        if names.count(name) > 1 or name == Path(export.INDEX).stem:
            fail(f"two files would be called {name}.html; rename the scene {name}.yaml")
    rendered: list[Rendered] = []
    parts = sum(len(scene.steps) for scene in loaded)  # transitions, and the scenes as files
    with click.progressbar(length=parts, label="building", file=sys.stderr, hidden=hidden) as bar:
        plans = planned(loaded, jobs, cache, partial(bar.update, 1))
        for scene, of_scene in zip(loaded, plans, strict=True):
            with _own_templates():
                made = export.render_scene(
                    scene,
                    wanted,
                    index_href=export.INDEX,
                    plans=of_scene,
                    site=site,
                    between=BETWEEN if between is None else between,
                    pictures=pictures,
                )
            rendered.append(made)
            bar.update(1)
    worst = report((p for r in rendered for p in r.problems), quiet=quiet)
    if strict and worst:
        click.echo("nothing written: --strict, and there are warnings", err=True)
        raise SystemExit(PROBLEMS)
    title = loaded[0].model.title if len(loaded) == 1 else "Maps"
    lang = loaded[0].model.lang
    with _own_templates():
        index = export.gallery([r.card for r in rendered], title, lang, site)
    files = {name: text for r in rendered for name, text in r.files.items()}
    try:
        written = export.write(folder, {**files, **shared_files(wanted, site), export.INDEX: index})
        if deps is not None:
            export.write(deps.parent, {deps.name: rule(written, reads, site).encode()})
    except OSError as error:
        fail(f"cannot write to {out}: {error.strerror}")
    if not quiet:
        for result in rendered:
            _print_built(result, folder)
        click.echo(f"open {folder / export.INDEX}")


def _print_built(result: Rendered, folder: Path) -> None:
    count = len(result.transitions)
    pieces = sum(t.pieces for t in result.transitions)
    sizes = ", ".join(
        f"{folder / name} ({len(content) / 1000:.0f} kB)" for name, content in result.files.items()
    )
    click.echo(
        f"{result.name}: {count_of(count, 'transition')}, {count_of(pieces, 'piece')} → {sizes}"
    )
    if result.projection:
        click.echo(f"  projection: {result.projection}")


@contextmanager
def _film_bar(hidden: bool, name: str, count: int) -> Iterator[Callable[[int], object]]:
    """A progress bar of its own for each film, in a line below the others."""
    if not hidden:
        click.echo(err=True)
    with click.progressbar(length=count, label=name, file=sys.stderr, hidden=hidden) as bar:
        yield bar.update


def _site(url: str | None, templates: Path | None, assets: str) -> Site:
    """The site that pages are for, if its address is one."""
    from geotween.export.site import Site
    from geotween.scene.model import ADDRESS

    if url is not None and not re.fullmatch(ADDRESS, url):
        raise click.BadParameter("expected https://… (or http)", param_hint="--url")
    return Site(url or "", templates, assets == "external")


@contextmanager
def _own_templates() -> Iterator[None]:
    """What is wrong in a site's own templates, in one line that says where; or in a scene yet."""
    from jinja2 import TemplateError, TemplateSyntaxError

    from geotween.scene.errors import SceneError

    try:
        yield
    except SceneError as error:
        fail(str(error))
    except TemplateSyntaxError as error:
        fail(f"{error.filename or error.name}:{error.lineno}: {error.message}")
    except TemplateError as error:
        fail(f"templates: {error.message or type(error).__name__}")
