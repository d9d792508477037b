"""The command line: parse, call, print."""

from __future__ import annotations

import json
import re
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from functools import partial
from io import TextIOWrapper
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NoReturn

import click

from geotween import __version__
from geotween.hosts.commands import init, watch

if TYPE_CHECKING:
    from geotween.data.load import Scene
    from geotween.data.problems import Problem
    from geotween.export.build import Rendered
    from geotween.export.plans import Plan
    from geotween.export.reports import TransitionReport
    from geotween.export.site import Site
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
_JOBS = click.option(
    "-j", "--jobs", type=click.IntRange(min=1), metavar="N",
    help="Plan in so many processes; as many as there are processors, if not given.",
)  # fmt: skip
_CACHE = click.option(
    "--cache/--no-cache", default=True, help="Whether to use what was planned before.",
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


@main.command()
@_SCENES
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
@_SANDBOX
@_JOBS
@_CACHE
@_QUIET
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
    _have_what_is_needed(wanted)
    try:
        folder = export.writable(out)
    except OSError as error:
        _fail(f"cannot write to {out}: {error.filename}: {error.strerror}")
    reads: set[Path] = set()
    loaded = _load(scenes, sandbox, reads)
    names = [scene.name for scene in loaded]
    for name in names:
        if names.count(name) > 1 or name == Path(export.INDEX).stem:
            _fail(f"two files would be called {name}.html; rename the scene {name}.yaml")
    rendered: list[Rendered] = []
    parts = sum(len(scene.steps) for scene in loaded)  # transitions, and the scenes as files
    with click.progressbar(length=parts, label="building", file=sys.stderr, hidden=hidden) as bar:
        plans = _planned(loaded, jobs, cache, partial(bar.update, 1))
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
    worst = _report_problems((p for r in rendered for p in r.problems), quiet=quiet)
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
        _fail(f"cannot write to {out}: {error.strerror}")
    if not quiet:
        for result in rendered:
            _print_built(result, folder)
        click.echo(f"open {folder / export.INDEX}")


@main.command()
@_SCENES
@_SANDBOX
@_JOBS
@_CACHE
@_QUIET
@click.option("--frames", "in_frames", is_flag=True, help="Measure 201 frames of each, too.")
@click.option("--json", "as_json", is_flag=True, help="Print all of it as JSON.")
def check(
    scenes: tuple[Path, ...],
    sandbox: Path | None,
    jobs: int | None,
    cache: bool,
    quiet: bool,
    in_frames: bool,
    as_json: bool,
) -> None:
    """Validate scenes, plan their motion and prove it; print problems and measures.

    A transition is proved where no polygon crosses itself or another one at any time.

    \b
    Examples:
      geotween check scenes/*.yaml
      geotween check fire.yaml --frames --json
    """
    from geotween.export.reports import problems_of, transition_reports

    worst = False
    told: list[dict[str, object]] = []
    loaded = _load(scenes, sandbox)
    for scene, plans in zip(loaded, _planned(loaded, jobs, cache), strict=True):
        problems = problems_of(scene, plans)
        if as_json:
            transitions = transition_reports(scene, plans, in_frames=in_frames)
            told.append(_as_json(scene, transitions, problems))
            worst |= any(problem.severity != "note" for problem in problems)
            continue
        if not quiet:
            click.echo(f"{scene.path}: {len(scene.steps)} steps, {len(plans)} transitions")
            if scene.projection:
                click.echo(f"  projection: {scene.projection}")
            for transition in transition_reports(scene, plans, in_frames=in_frames):
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
@_SANDBOX
@_JOBS
@_CACHE
@_QUIET
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
    _have_what_is_needed(["svg-still" if form == "svg" else form])
    try:
        folder = export.writable(out)
    except OSError as error:
        _fail(f"cannot write to {out}: {error.filename}: {error.strerror}")
    (loaded,) = _load([scene], sandbox)
    (plans,) = _planned([loaded], jobs, cache)
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
        _fail(f"cannot write to {out}: {error.strerror}")
    if not quiet:
        for path in written:
            click.echo(str(path))


main.add_command(watch)
main.add_command(init)


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


def _load(
    paths: Sequence[Path], sandbox: Path | None, reads: set[Path] | None = None
) -> list[Scene]:
    """All scenes, or every fault of all of them on stderr and the end."""
    from geotween.data.load import load
    from geotween.scene.errors import SceneError

    loaded: list[Scene] = []
    faults: list[Fault] = []
    for path in paths:
        try:
            loaded.append(load(path, sandbox, reads=reads))
        except SceneError as error:
            faults += error.faults
    if faults:
        _fail(str(SceneError(faults)))
    return loaded


def _planned(
    scenes: Sequence[Scene],
    jobs: int | None,
    cache: bool,
    done: Callable[[], object] = lambda: None,
) -> list[list[Plan]]:
    """The plans of all scenes, together."""
    from geotween.export.cache import default_cache
    from geotween.export.jobs import cores, plan_scenes

    kept = default_cache() if cache else None
    return plan_scenes(scenes, jobs=jobs or cores(), cache=kept, done=done)


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


def _have_what_is_needed(formats: Iterable[str]) -> None:
    """End where a format needs a library that is not installed; say what installs it."""
    from geotween.export.pictures.extras import MissingExtraError
    from geotween.export.pictures.formats import require

    try:
        require(formats)
    except MissingExtraError as error:
        _fail(str(error))


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
        _fail(str(error))
    except TemplateSyntaxError as error:
        _fail(f"{error.filename or error.name}:{error.lineno}: {error.message}")
    except TemplateError as error:
        _fail(f"templates: {error.message or type(error).__name__}")


def _fail(message: str) -> NoReturn:
    click.echo(message, err=True)
    raise SystemExit(BAD_SCENE)
