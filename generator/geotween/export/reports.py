"""Reports: what is proved, measured and met of planned transitions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace

from geotween.data.load import Scene
from geotween.data.problems import Problem
from geotween.export.plans import Plan
from geotween.motion.measure import measure
from geotween.motion.morph import Morph


@dataclass(frozen=True)
class TransitionReport:
    """What happened between two steps: their labels, the pieces that moved, and measures.

    ``valid`` tells whether it was proved that polygons cross nowhere on the way; ``ways`` how many
    pieces of each layer were moved in which way.
    """

    steps: tuple[str, str]
    pieces: int
    valid: bool
    ways: Mapping[str, Mapping[str, int]]
    measures: Mapping[str, float]


def problems_of(scene: Scene, plans: Sequence[Plan | Morph]) -> list[Problem]:
    """The problems of a scene and of its transitions, with their steps named."""
    problems = list(scene.problems)
    for before, after, planned in zip(scene.steps[:-1], scene.steps[1:], plans, strict=True):
        steps = (before.label, after.label)
        problems += [replace(p, steps=steps) for p in planned.certificate.problems]
    return problems


def transition_reports(
    scene: Scene, plans: Sequence[Plan | Morph], *, in_frames: bool = False
) -> tuple[TransitionReport, ...]:
    """What is proved and measured of each transition; ``in_frames`` looks at 201 frames, too."""
    reports = []
    for before, after, m in zip(scene.steps[:-1], scene.steps[1:], plans, strict=True):
        certificate = m.certificate
        measures = dict(certificate.measures)
        if in_frames:
            found = asdict(measure(m.tracks, before.regions, after.regions))
            measures |= {name.replace("_", " "): value for name, value in found.items()}
        steps = (before.label, after.label)
        reports.append(
            TransitionReport(steps, len(m.tracks), certificate.valid, certificate.ways, measures)
        )
    return tuple(reports)
