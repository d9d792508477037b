"""Captions: what happened between two steps, in a few sentences; and a whole scene in words."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

from geotween.data.load import Scene, Step
from geotween.story.descent import things_of
from geotween.story.events import Transition, scene_events
from geotween.story.fates import Fate, proper_name
from geotween.story.measure import Measure, measure_of
from geotween.story.speaker import MOST_NAMES, Speaker
from geotween.story.words import Words, words_of_scene

LEADS = 3  # things that are told one by one
MANY = 8  # where more than so many changed, they are summed up


def captions(
    scene: Scene, transitions: Sequence[Transition] | None = None, words: Words | None = None
) -> tuple[str, ...]:
    """A caption for each step: its own where the scene has one, else what happened before it.

    Plain text: a page has to escape it. It is in the language ``words.lang``, unless the scene has
    written it.

    Raises
    ------
    SceneError
        Where the scene's file of words has faults.
    """
    made = told(scene, transitions, words)
    return tuple(step.caption or text for step, text in zip(scene.steps, made, strict=True))


def alternative(
    scene: Scene, transitions: Sequence[Transition] | None = None, words: Words | None = None
) -> tuple[str, ...]:
    """The text alternative of a map: a paragraph for each step, its own caption first.

    Raises
    ------
    SceneError
        Where the scene's file of words has faults.
    """
    made = told(scene, transitions, words)
    return tuple(
        " ".join(filter(None, (step.caption, text)))
        for step, text in zip(scene.steps, made, strict=True)
    )


def told(
    scene: Scene, transitions: Sequence[Transition] | None = None, words: Words | None = None
) -> tuple[str, ...]:
    """What happened up to each step, in words; of the first step, what is there.

    Raises
    ------
    SceneError
        Where the scene's file of words has faults.
    """
    words = words or words_of_scene(scene)
    found = scene_events(scene) if transitions is None else transitions
    first = _opening(scene.steps[0], words, measure_of(scene))
    return (first, *(caption(transition, words) for transition in found))


def caption(transition: Transition, words: Words) -> str:
    """What happened in a transition: the largest thing, then the others, then how many more."""
    speaker = Speaker(transition, words)
    changed = [fate for fate in speaker.fates if fate.changed]
    leads = _leads(changed, speaker)
    clauses = [speaker.clause(fate) for fate in leads]
    rest = speaker.summed([f for f in changed if f not in leads], others=bool(leads))
    if len(changed) > MANY:
        return _sentence(speaker, [speaker.summary(len(changed), [*clauses, *rest])])
    if not clauses:
        return _sentence(speaker, [words.row(rest) if rest else words.say("unchanged")])
    sentences = [_sentence(speaker, clauses)]
    if rest:
        sentences.append(words.say("further", told=words.row(rest)))
    return " ".join(sentences)


def _sentence(speaker: Speaker, clauses: Iterable[str]) -> str:
    transition = speaker.transition
    period = speaker.words.period(transition.origin, transition.target)
    return speaker.words.say("caption", period=period, told="; ".join(clauses))


def _leads(changed: Sequence[Fate], speaker: Speaker) -> list[Fate]:
    """What is told one by one: the largest that can be told apart, then what came, went, joined.

    Of many only one that is larger than all others together.
    """
    named = [fate for fate in changed if speaker.name(fate)]
    if not named:
        return []
    largest = max(named, key=lambda fate: fate.size)
    if len(changed) > MANY:
        dominant = 2 * largest.size > sum(fate.size for fate in changed)
        return [largest] if dominant else []
    others = [fate for fate in named if fate is not largest]
    others.sort(key=lambda fate: (not fate.branches, -fate.size))
    return [largest, *others][:LEADS]


def _opening(step: Step, words: Words, measure: Measure | None) -> str:
    """What is there at the first step."""
    things = things_of(step.regions)
    counts = Counter(identity.name for identity in things.identities)
    names = [proper_name(identity, counts) for identity in things.identities]
    few = 0 < len(names) <= MOST_NAMES and all(names)
    area = ""
    layers = {identity.layer for identity in things.identities}
    if measure is not None and measure.real and len(layers) == 1:  # layers may overlap
        area = words.area(float(measure.areas(step.exact.polygons).sum()))
    here = words.row(names) if few else words.things(len(things))
    return words.say("opening", len(things), when=words.when(step), things=here, area=area)
