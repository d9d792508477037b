"""The command line: parse, call, print. A file for each command."""

from __future__ import annotations

import json
import sys
from io import TextIOWrapper

import click

from geotween import __version__
from geotween.cli.build import build
from geotween.cli.check import check
from geotween.cli.events import events
from geotween.cli.frames import frames
from geotween.cli.writing import init, watch


@click.group(
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="Exit status: 0 done, 1 warnings (check, build --strict), 2 wrong usage, or errors.",
)
@click.version_option(__version__, prog_name="geotween", message="%(prog)s %(version)s")
def main() -> None:
    """Turn polygon sets at successive times into an animated map in one file.

    \b
    Examples:
      geotween build fire.yaml -o public        fire.html, fire.svg and index.html
      geotween build scenes/*.yaml -o public -q
      geotween init fires                       a scene to begin with
      geotween watch fires/scene.yaml           see it while you write
      geotween check fire.yaml                  what is wrong with it, if anything
      geotween events fire.yaml                 what happens in it
      geotween frames fire.yaml -o figures      its steps as pictures
      geotween schema > scene.schema.json       for your editor
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without an arrow still gets the rest


@click.command()
def schema() -> None:
    """Print the JSON Schema of scene files, for editors.

    \b
    Example:
      geotween schema > scene.schema.json
      and as first line of a scene:
      # yaml-language-server: $schema=scene.schema.json
    """
    from geotween.scene.read import scene_schema

    click.echo(json.dumps(scene_schema(), indent=2, ensure_ascii=False))


for command in (build, check, events, frames, init, schema, watch):
    main.add_command(command)
