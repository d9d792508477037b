"""``geotween events``: what happens in scenes, as a table, CSV or JSON."""

from __future__ import annotations

import json
from pathlib import Path

import click

from geotween.cli.common import SANDBOX, SCENES, fail, load_all


@click.command()
@SCENES
@click.option(
    "--format", "form", default="table", show_default=True,
    type=click.Choice(["table", "csv", "json"]), help="How to write them.",
)  # fmt: skip
@click.option(
    "-o", "--out", metavar="FILE", type=click.Path(dir_okay=False, path_type=Path),
    help="Write to a file instead of the terminal.",
)  # fmt: skip
@SANDBOX
def events(scenes: tuple[Path, ...], form: str, out: Path | None, sandbox: Path | None) -> None:
    """Tell what happens in scenes: what grew, moved, split, merged, came and went.

    \b
    Examples:
      geotween events fire.yaml
      geotween events scenes/*.yaml --format csv -o events.csv
    """
    from geotween.scene.errors import SceneError
    from geotween.story.records import csv_text, scene_record, table_text
    from geotween.story.words import words_of_scene

    try:
        loaded = load_all(scenes, sandbox)
        words = [words_of_scene(scene) for scene in loaded]
    except SceneError as error:
        fail(str(error))
    records = [scene_record(s, words=w) for s, w in zip(loaded, words, strict=True)]
    if form == "json":
        text = json.dumps(records, indent=2, ensure_ascii=False) + "\n"
    else:
        tables = map(table_text, records, words)
        text = csv_text(records) if form == "csv" else "\n".join(tables)
    if out is None:
        click.echo(text, nl=False)
        return
    try:
        out.write_text(text, encoding="utf-8", newline="")
    except OSError as error:
        fail(f"cannot write to {out}: {error.strerror}")
