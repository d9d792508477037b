"""``geotween frames``: frames of a scene as still pictures."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import click

from geotween.cli.common import (
    CACHE,
    JOBS,
    QUIET,
    SANDBOX,
    fail,
    have_what_is_needed,
    load_all,
    planned,
)


@click.command()
@click.argument("scene", metavar="SCENE", type=click.Path(path_type=Path))
@click.option("-o", "--out", required=True, metavar="DIR", help="Folder for the files.")
@click.option(
    "--at", metavar="LIST",
    help="Places between steps: 0 is the first one, 1.5 half-way from the second to the third.",
)  # fmt: skip
@click.option(
    "--count", type=click.IntRange(1, 1000), metavar="N",
    help="So many frames, from the first step to the last.",
)  # fmt: skip
@click.option(
    "--per-step", type=click.IntRange(1, 100), metavar="N",
    help="The steps (1, if nothing is given), and so many less one between each two.",
)  # fmt: skip
@click.option(
    "--superpose", nargs=2, metavar="A B",
    help="Two steps over each other in two colours, by label or number from 0.",
)  # fmt: skip
@click.option(
    "--layout", type=click.Choice(["frames", "strip", "grid"]), default="frames",
    show_default=True, help="A file for each, or one with all of them.",
)  # fmt: skip
@click.option(
    "--format", "form", type=click.Choice(["svg", "png", "pdf"]), default="svg", show_default=True,
)  # fmt: skip
@click.option(
    "--scale", type=click.FloatRange(0.1, 10), metavar="X",
    help="Pixels of a PNG to a px of the map; two, if not given.",
)  # fmt: skip
@SANDBOX
@JOBS
@CACHE
@QUIET
def frames(
    scene: Path,
    out: str,
    at: str | None,
    count: int | None,
    per_step: int | None,
    superpose: tuple[str, str] | None,
    layout: Literal["frames", "strip", "grid"],
    form: Literal["svg", "png", "pdf"],
    scale: float | None,
    sandbox: Path | None,
    jobs: int | None,
    cache: bool,
    quiet: bool,
) -> None:
    """Write frames of a scene as still pictures, apart or side by side.

    \b
    Examples:
      geotween frames fire.yaml -o figures --layout strip --format pdf
      geotween frames fire.yaml -o figures --at 0,0.5,1 --format png --scale 3
      geotween frames fire.yaml -o figures --superpose "Day 1" "Day 6"
    """
    from geotween.export import build as export
    from geotween.export.pictures import formats, moments

    if sum(choice is not None for choice in (at, count, per_step, superpose)) > 1:
        raise click.UsageError("name one of --at, --count, --per-step and --superpose")
    have_what_is_needed(["svg-still" if form == "svg" else form])
    try:
        folder = export.writable(out)
    except OSError as error:
        fail(f"cannot write to {out}: {error.filename}: {error.strerror}")
    (loaded,) = load_all([scene], sandbox)
    (plans,) = planned([loaded], jobs, cache)
    shown = export.shown_scene(loaded, plans)
    scale = formats.SCALE if scale is None else scale
    try:
        if superpose is not None:
            one, other = (moments.step_of(shown.frames, name) for name in superpose)
            files = formats.superposed_files(loaded.name, shown, (one, other), form, scale)
        else:
            places = moments.places(shown.frames, at, count, per_step)
            files = formats.frame_files(loaded.name, shown, places, form, layout, scale)
    except ValueError as error:
        raise click.UsageError(str(error)) from None
    try:
        written = export.write(folder, files)
    except OSError as error:
        fail(f"cannot write to {out}: {error.strerror}")
    if not quiet:
        for path in written:
            click.echo(str(path))
