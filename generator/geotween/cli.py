"""The command line: parse, call, print."""

from __future__ import annotations

import json
import sys
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from io import TextIOWrapper
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import click

from geotween import __version__

if TYPE_CHECKING:
    from geotween.data.load import Scene
    from geotween.data.problems import Problem
    from geotween.export.build import Rendered, TransitionReport
    from geotween.scene.errors import Fault

DONE, PROBLEMS, BAD_SCENE = 0, 1, 2

_SCENES = click.argument(
    "scenes", nargs=-1, required=True, metavar="SCENE...", type=click.Path(path_type=Path)
)
_QUIET = click.option("-q", "--quiet", is_flag=True, help="Print errors only.")
_SANDBOX = click.option(
    "--sandbox", metavar="DIR", type=click.Path(exists=True, file_okay=False, path_type=Path),
    help="Let scenes read files in this folder only.",
)  # fmt: skip


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
      geotween check fire.yaml                  what is wrong with it, if anything
      geotween events fire.yaml                 what happens in it
      geotween schema > scene.schema.json       for your editor
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without an arrow still gets the rest


@main.command()
@_SCENES
@click.option("-o", "--out", required=True, metavar="DIR", help="Folder for the files.")
@click.option(
    "--format", "formats", default="html,svg", show_default=True, metavar="LIST",
    help="What to write: html, svg, or both.",
)  # fmt: skip
@click.option("--strict", is_flag=True, help="Exit with 1 where there are warnings; write nothing.")
@_SANDBOX
@_QUIET
def build(
    scenes: tuple[Path, ...],
    out: str,
    formats: str,
    strict: bool,
    sandbox: Path | None,
    quiet: bool,
) -> None:
    """Build scenes into standalone pages and SVGs, with an index of those named.

    \b
    Examples:
      geotween build fire.yaml -o public
      geotween build scenes/*.yaml -o public --format svg
      geotween build fire.yaml -o public --strict -q     in CI
    """
    from geotween.export import build as export

    wanted = [name.strip() for name in formats.split(",") if name.strip()]
    unknown = sorted(set(wanted) - set(export.FORMATS))
    if unknown or not wanted:
        expected = ", ".join(export.FORMATS)
        raise click.BadParameter(f"expected some of {expected}", param_hint="--format")
    try:
        folder = export.writable(out)
    except OSError as error:
        _fail(f"cannot write to {out}: {error.filename}: {error.strerror}")
    loaded = _load(scenes, sandbox)
    names = [scene.name for scene in loaded]
    for name in names:
        if names.count(name) > 1 or name == Path(export.INDEX).stem:
            _fail(f"two files would be called {name}.html; rename the scene {name}.yaml")
    rendered: list[Rendered] = []
    hidden = quiet or not sys.stderr.isatty()
    with click.progressbar(loaded, label="building", file=sys.stderr, hidden=hidden) as bar:
        rendered += (export.render_scene(s, wanted, index_href=export.INDEX) for s in bar)
    worst = _report_problems((p for r in rendered for p in r.problems), quiet=quiet)
    if strict and worst:
        click.echo("nothing written: --strict, and there are warnings", err=True)
        raise SystemExit(PROBLEMS)
    title = loaded[0].model.title if len(loaded) == 1 else "Maps"
    lang = loaded[0].model.lang
    index = export.gallery([r.card for r in rendered], title, lang)
    files = {name: text for r in rendered for name, text in r.files.items()}
    try:
        export.write(folder, {**files, export.INDEX: index})
    except OSError as error:
        _fail(f"cannot write to {out}: {error.strerror}")
    if not quiet:
        for result in rendered:
            _print_built(result, folder)
        click.echo(f"open {folder / export.INDEX}")


@main.command()
@_SCENES
@_SANDBOX
@_QUIET
@click.option("--frames", "in_frames", is_flag=True, help="Measure 201 frames of each, too.")
@click.option("--json", "as_json", is_flag=True, help="Print all of it as JSON.")
def check(
    scenes: tuple[Path, ...], sandbox: Path | None, quiet: bool, in_frames: bool, as_json: bool
) -> None:
    """Validate scenes, plan their motion and prove it; print problems and measures.

    A transition is proved where no polygon crosses itself or another one at any time.

    \b
    Examples:
      geotween check scenes/*.yaml
      geotween check fire.yaml --frames --json
    """
    from geotween.export.build import plan_scene, transition_reports

    worst = False
    told: list[dict[str, object]] = []
    for scene in _load(scenes, sandbox):
        morphs, problems = plan_scene(scene)
        if as_json:
            transitions = transition_reports(scene, morphs, in_frames=in_frames)
            told.append(_as_json(scene, transitions, problems))
            worst |= any(problem.severity != "note" for problem in problems)
            continue
        if not quiet:
            click.echo(f"{scene.path}: {len(scene.steps)} steps, {len(morphs)} transitions")
            if scene.projection:
                click.echo(f"  projection: {scene.projection}")
            for transition in transition_reports(scene, morphs, in_frames=in_frames):
                proved = f"{'' if transition.valid else 'not '}proved, {_ways(transition)}"
                measures = ", ".join(f"{k} {v:.3g}" for k, v in transition.measures.items())
                click.echo(f"  {' → '.join(transition.steps)}: {proved}, {measures}")
        worst |= _report_problems(problems, quiet=quiet, notes=True)
    if as_json:
        click.echo(json.dumps(told, indent=2, ensure_ascii=False))
    raise SystemExit(PROBLEMS if worst else DONE)


@main.command()
@_SCENES
@click.option(
    "--format", "form", default="table", show_default=True,
    type=click.Choice(["table", "csv", "json"]), help="How to write them.",
)  # fmt: skip
@click.option(
    "-o", "--out", metavar="FILE", type=click.Path(dir_okay=False, path_type=Path),
    help="Write to a file instead of the terminal.",
)  # fmt: skip
@_SANDBOX
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
        loaded = _load(scenes, sandbox)
        words = [words_of_scene(scene) for scene in loaded]
    except SceneError as error:
        _fail(str(error))
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
        _fail(f"cannot write to {out}: {error.strerror}")


@main.command()
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


def _ways(transition: TransitionReport) -> str:
    """In which ways the pieces were moved, the most frequent first."""
    total: Counter[str] = Counter()
    for ways in transition.ways.values():
        total.update(ways)
    found = [way if len(total) == 1 else f"{way} ({n})" for way, n in total.most_common()]
    return f"by {' and '.join(found)}" if found else "empty"


def _as_json(
    scene: Scene, transitions: Sequence[TransitionReport], problems: Sequence[Problem]
) -> dict[str, object]:
    return {
        "scene": str(scene.path),
        "steps": [step.label for step in scene.steps],
        "projection": scene.projection,
        "transitions": [asdict(transition) for transition in transitions],
        "problems": [asdict(problem) for problem in problems],
    }


def _load(paths: Sequence[Path], sandbox: Path | None) -> list[Scene]:
    """All scenes, or every fault of all of them on stderr and the end."""
    from geotween.data.load import load
    from geotween.scene.errors import SceneError

    loaded: list[Scene] = []
    faults: list[Fault] = []
    for path in paths:
        try:
            loaded.append(load(path, sandbox))
        except SceneError as error:
            faults += error.faults
    if faults:
        _fail(str(SceneError(faults)))
    return loaded


def _report_problems(problems: Iterable[Problem], *, quiet: bool, notes: bool = False) -> bool:
    """Print problems, notes one by one or counted; True where one is more than a note."""
    listed = list(problems)
    serious = [problem for problem in listed if problem.severity != "note"]
    if not quiet:
        for problem in listed if notes else serious:
            click.echo(f"  {problem}" if notes else str(problem), err=not notes)
        count = len(listed) - len(serious)
        if count and not notes:
            click.echo(f"{_count(count, 'note')}: see geotween check", err=True)
    return bool(serious)


def _print_built(result: Rendered, folder: Path) -> None:
    count = len(result.transitions)
    pieces = sum(t.pieces for t in result.transitions)
    sizes = ", ".join(
        f"{folder / name} ({len(content) / 1000:.0f} kB)" for name, content in result.files.items()
    )
    click.echo(f"{result.name}: {_count(count, 'transition')}, {_count(pieces, 'piece')} → {sizes}")
    if result.projection:
        click.echo(f"  projection: {result.projection}")


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'s' * (number != 1)}"


def _fail(message: str) -> NoReturn:
    click.echo(message, err=True)
    raise SystemExit(BAD_SCENE)
