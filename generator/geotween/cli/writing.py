"""The commands of whoever writes a scene: begin one, and see it while it is written."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import click

if TYPE_CHECKING:
    from geotween.hosts.watch.scenes import Watched

FAILED = 2
_FOLDER = click.Path(file_okay=False, path_type=Path)
_THERE = click.Path(exists=True, file_okay=False, path_type=Path)


@click.command()
@click.argument(
    "scenes", nargs=-1, required=True, metavar="SCENE...", type=click.Path(path_type=Path)
)
@click.option(
    "--port", type=click.IntRange(0, 65535), metavar="N",
    help="Serve at this port; any that is free, if not given.",
)  # fmt: skip
@click.option("--templates", metavar="DIR", type=_THERE, help="Your own templates and theme.css.")
@click.option("--sandbox", metavar="DIR", type=_THERE, help="Let scenes read files in it only.")
@click.option("-q", "--quiet", is_flag=True, help="Print the address, and errors.")
def watch(
    scenes: tuple[Path, ...],
    port: int | None,
    templates: Path | None,
    sandbox: Path | None,
    quiet: bool,
) -> None:
    """Show scenes in the browser, built anew whenever a file of theirs changes.

    The page follows by itself, and shows errors with file and line. It is served to this machine
    only, from memory; Ctrl-C ends it.

    \b
    Examples:
      geotween watch fire.yaml
      geotween watch scenes/*.yaml --port 8750
    """
    from geotween.export.site import Site
    from geotween.hosts.watch.loop import watch as watched

    names = [path.stem for path in scenes]
    for name in names:
        if names.count(name) > 1 or name == "index":
            _fail(f"two pages would be called {name}.html; rename the scene {name}.yaml")

    def started(address: str) -> None:
        click.echo(f"open {address}   (Ctrl-C ends it)")

    def tell(scene: Watched, seconds: float) -> None:
        if scene.error:
            click.echo(scene.error, err=True)
        elif not quiet:
            click.echo(f"{scene.path}: built in {seconds:.1f} s")

    try:
        watched(scenes, Site(templates=templates), sandbox, port or 0, started, tell)
    except OSError as error:
        _fail(f"cannot serve at port {port}: {error.strerror}")


@click.command()
@click.argument("folder", default=".", type=_FOLDER)
@click.option("--example", metavar="NAME", help="One of the shipped examples, instead.")
def init(folder: Path, example: str | None) -> None:
    """Write a commented scene with data into a folder, to begin with.

    \b
    Examples:
      geotween init fires
      geotween init lakes --example lake
    """
    from geotween.export.build import writable, write
    from geotween.hosts.starter import examples, starter_files

    try:
        files = starter_files(example)
    except KeyError:
        known = ", ".join(examples())
        raise click.BadParameter(f"expected one of {known}", param_hint="--example") from None
    there = [name for name in files if (folder / name).exists()]
    if there:
        _fail(f"{folder / there[0]} is there already, and was left as it is; name another folder")
    try:
        written = write(writable(folder), files)
    except OSError as error:
        _fail(f"cannot write to {folder}: {error.strerror}")
    for path in written:
        click.echo(f"wrote {path}")
    (scene,) = (path for path in written if path.suffix == ".yaml")
    click.echo(f"next: geotween watch {scene}")


def _fail(message: str) -> NoReturn:
    click.echo(message, err=True)
    raise SystemExit(FAILED)
