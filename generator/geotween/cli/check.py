"""``geotween check``: what is wrong with scenes, and what is proved of their motion."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import click

from geotween.cli.common import (
    CACHE,
    DONE,
    JOBS,
    PROBLEMS,
    QUIET,
    SANDBOX,
    SCENES,
    load_all,
    planned,
    report,
)

if TYPE_CHECKING:
    from geotween.data.load import Scene
    from geotween.data.problems import Problem
    from geotween.export.reports import TransitionReport


@click.command()
@SCENES
@SANDBOX
@JOBS
@CACHE
@QUIET
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
    loaded = load_all(scenes, sandbox)
    for scene, plans in zip(loaded, planned(loaded, jobs, cache), strict=True):
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
        worst |= report(problems, quiet=quiet, notes=True)
    if as_json:
        click.echo(json.dumps(told, indent=2, ensure_ascii=False))
    raise SystemExit(PROBLEMS if worst else DONE)


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
