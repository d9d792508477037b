"""What commands share: their options, scenes read and planned, problems told."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import click

if TYPE_CHECKING:
    from geotween.data.load import Scene
    from geotween.data.problems import Problem
    from geotween.export.plans import Plan
    from geotween.scene.errors import Fault

DONE, PROBLEMS, BAD_SCENE = 0, 1, 2

SCENES = click.argument(
    "scenes", nargs=-1, required=True, metavar="SCENE...", type=click.Path(path_type=Path)
)
QUIET = click.option("-q", "--quiet", is_flag=True, help="Print errors only.")
SANDBOX = click.option(
    "--sandbox", metavar="DIR", type=click.Path(exists=True, file_okay=False, path_type=Path),
    help="Let scenes read files in this folder only.",
)  # fmt: skip
JOBS = click.option(
    "-j", "--jobs", type=click.IntRange(min=1), metavar="N",
    help="Plan in so many processes; as many as there are processors, if not given.",
)  # fmt: skip
CACHE = click.option(
    "--cache/--no-cache", default=True, help="Whether to use what was planned before.",
)  # fmt: skip


def load_all(
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
        fail(str(SceneError(faults)))
    return loaded


def planned(
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


def report(problems: Iterable[Problem], *, quiet: bool, notes: bool = False) -> bool:
    """Print problems, notes one by one or counted; True where one is more than a note."""
    listed = list(problems)
    serious = [problem for problem in listed if problem.severity != "note"]
    if not quiet:
        for problem in listed if notes else serious:
            click.echo(f"  {problem}" if notes else str(problem), err=not notes)
        count = len(listed) - len(serious)
        if count and not notes:
            click.echo(f"{count_of(count, 'note')}: see geotween check", err=True)
    return bool(serious)


def have_what_is_needed(formats: Iterable[str]) -> None:
    """End where a format needs a library that is not installed; say what installs it."""
    from geotween.export.pictures.extras import MissingExtraError
    from geotween.export.pictures.formats import require

    try:
        require(formats)
    except MissingExtraError as error:
        fail(str(error))


def count_of(number: int, noun: str) -> str:
    return f"{number} {noun}{'s' * (number != 1)}"


def fail(message: str) -> NoReturn:
    click.echo(message, err=True)
    raise SystemExit(BAD_SCENE)
