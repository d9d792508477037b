"""What a scene says that its data do not bear out: no error, but hardly meant."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from geotween.data.polygons import PolygonSet
from geotween.data.problems import Problem
from geotween.data.steps.series import Member
from geotween.scene.model import SceneFile

SHOWN = 8  # names listed in a hint


def doubts(
    model: SceneFile, sets: Sequence[PolygonSet], members: Sequence[Member]
) -> list[Problem]:
    """Rules and keys that no feature answers to, empty files, times that run backwards."""
    identities = [i for polygons in sets for i in polygons.identities]
    classes = dict.fromkeys(i.class_ for i in identities if i.class_ is not None)
    keys = dict.fromkeys(str(i.key) for i in identities if i.keyed)
    problems = []
    layers = dict.fromkeys(i.layer for i in identities)
    for word, rules, known in (
        ("style for the class", model.style.by_class, classes),
        ("class_order: the class", model.map.class_order, classes),
        ("style for the key", model.style.by_key, keys),
        ("motion for the layer", model.motion.by_layer, layers),
        ("motion for the class", model.motion.by_class, classes),
        ("motion for the key", model.motion.by_key, keys),
    ):
        for name in rules:
            if name not in known:
                there = ", ".join([*known][:SHOWN]) + (", …" if len(known) > SHOWN else "")
                hint = f"there are {there}" if known else f"no feature has a {word.split()[-1]}"
                message = f'{word} "{name}", which no feature has'
                problems.append(Problem("unused rule", "warning", message, hint=hint))
    if model.motion.correspondence == "key" and not keys:
        hint = "give features the same key in each step"
        message = "correspondence by key, but no feature has a key"
        problems.append(Problem("no keys", "warning", message, hint=hint))
    for one, other in pairwise(members):
        if one.time is not None and other.time is not None and other.time < one.time:  # type: ignore[operator]  # one kind in all steps
            message = "time runs backwards between these steps"
            problems.append(Problem("time order", "note", message, (one.label, other.label)))
    return problems
