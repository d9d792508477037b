"""Plans: what is drawn and told of a transition, as arrays that processes and caches can keep."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cache, cached_property
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween import __version__
from geotween.data.load import Scene
from geotween.data.polygons import Identity, PolygonSet
from geotween.data.problems import Problem
from geotween.motion.certify import Certificate
from geotween.motion.morph import plan
from geotween.motion.techniques import Techniques, resolve
from geotween.motion.tracks import Film, Track
from geotween.scene.model import Motion

Arrays = dict[str, NDArray[Any]]

NONE = -1  # the film of a track that has none

# What a plan depends on beside its task: these packages, and the code of these folders.
_PACKAGES = ("numpy", "scipy", "shapely")
_CODE = ("data", "mesh", "motion", "export/plans.py")


@dataclass(frozen=True, eq=False)
class Plan:
    """A planned transition: its tracks, and what is proved and measured of them."""

    tracks: tuple[Track, ...]
    certificate: Certificate


@dataclass(frozen=True, eq=False)
class Task:
    """A transition to plan: two polygon sets, and by which techniques."""

    origin: PolygonSet
    target: PolygonSet
    techniques: Techniques

    @property
    def identities(self) -> list[Identity]:
        return [*self.origin.identities, *self.target.identities]

    @property
    def size(self) -> int:
        """How many vertices it has: its work grows with them."""
        return sum(
            int(shapely.get_num_coordinates(end.polygons).sum())
            for end in (self.origin, self.target)
        )

    @cached_property
    def key(self) -> str:
        """The same for tasks whose plans are the same, whatever else their features say."""
        found = hashlib.sha256(_versions())
        found.update(repr(self.techniques).encode())
        for end in (self.origin, self.target):
            named = [(i.key, i.class_, i.keyed, i.name, i.layer) for i in end.identities]
            shapes = shapely.to_wkb(end.polygons)
            found.update(repr((named, [len(shape) for shape in shapes])).encode())
            for shape in shapes:
                found.update(shape)
        return found.hexdigest()

    def without_attributes(self) -> Task:
        """The same task without its features' further columns, which no plan looks at."""
        origin, target = (
            PolygonSet(end.polygons, tuple(replace(i, attributes={}) for i in end.identities))
            for end in (self.origin, self.target)
        )
        return Task(origin, target, self.techniques)


def tasks_of(scene: Scene) -> list[Task]:
    """The transitions of a scene."""
    techniques = techniques_of(scene.model.motion)
    return [
        Task(before.regions, after.regions, techniques)
        for before, after in zip(scene.steps[:-1], scene.steps[1:], strict=True)
    ]


def techniques_of(motion: Motion) -> Techniques:
    """The techniques that a scene names, and the methods for its layers, classes and keys."""
    rules = {"layer": motion.by_layer, "class": motion.by_class, "key": motion.by_key}
    exceptions = {
        (what, name): rule.method for what, those in rules.items() for name, rule in those.items()
    }
    return resolve(
        motion.method,
        motion.correspondence,
        motion.division,
        motion.matching,
        motion.path,
        motion.radius,
        motion.annexation,
        exceptions,
    )


def planned(task: Task) -> Arrays:
    """The plan of a task, as ``as_arrays`` has it."""
    motion = plan(task.origin, task.target, task.techniques)
    return as_arrays(Plan(motion.tracks, motion.certificate), task.identities)


def as_arrays(plan: Plan, identities: Sequence[Identity]) -> Arrays:
    """A plan as a few arrays; identities are told by their places among some. Cost: linear."""
    places = {id(identity): k for k, identity in reversed(list(enumerate(identities)))}
    equal = {identity: k for k, identity in reversed(list(enumerate(identities)))}
    tracks = plan.tracks
    films = {film: k for k, film in enumerate(dict.fromkeys(t.film for t in tracks if t.film))}
    layers = {layer: k for k, layer in enumerate(dict.fromkeys(t.layer for t in tracks))}
    who = [
        (
            *(places.get(id(i), equal[i]) for i in (t.identity, *t.ends)),
            layers[t.layer],
            films[t.film] if t.film else NONE,
            len(t.times),
            len(t.offsets),
        )
        for t in tracks
    ]
    told = {
        "layers": list(layers),
        "certificate": {**asdict(plan.certificate), "valid": bool(plan.certificate.valid)},
    }
    return {
        "told": np.frombuffer(json.dumps(told, default=_plain).encode(), dtype=np.uint8),
        "who": np.array(who, dtype=np.int64).reshape(-1, 7),
        "times": _joined([t.times for t in tracks], np.float64),
        "vertices": _joined([t.vertices for t in tracks], np.float64),
        "offsets": _joined([t.offsets for t in tracks], np.intp),
        "seams": _joined([t.seams for t in tracks], np.uint8),
        "nodes": _joined([t.nodes for t in tracks if t.nodes is not None], np.int32),
        "lives": _joined([film.lives.T for film in films], np.float64),
        "films": np.array([film.lives.shape[1] for film in films], dtype=np.int64),
    }


def from_arrays(arrays: Mapping[str, NDArray[Any]], identities: Sequence[Identity]) -> Plan:
    """The plan that arrays tell, with the identities that its task has.

    Raises
    ------
    KeyError, ValueError, IndexError, TypeError
        Where they tell none.
    """
    told = json.loads(arrays["told"].tobytes())
    lives = np.split(arrays["lives"].reshape(-1, 2), np.cumsum(arrays["films"]))
    films = [Film(np.ascontiguousarray(of.T)) for of in lives[:-1]]
    rest = dict.fromkeys(("times", "vertices", "offsets", "seams", "nodes"), 0)

    def taken(name: str, count: int) -> NDArray[Any]:
        start = rest[name]
        rest[name] += count
        if rest[name] > len(arrays[name]):
            raise ValueError(f"too few {name}")
        return arrays[name][start : start + count]

    tracks = []
    for one, origin, target, layer, film, times, rings in arrays["who"].tolist():
        offsets = taken("offsets", rings)
        count = int(offsets[-1])
        tracks.append(
            Track(
                identities[one],
                (identities[origin], identities[target]),
                told["layers"][layer],
                taken("times", times),
                taken("vertices", times * count * 2).reshape(times, count, 2),
                offsets,
                taken("seams", count),
                None if film == NONE else films[film],
                None if film == NONE else taken("nodes", count),
            )
        )
    if any(count != len(arrays[name]) for name, count in rest.items()):
        raise ValueError("more than its tracks need")
    proved = told["certificate"]
    problems = tuple(Problem(**{**p, "steps": tuple(p["steps"])}) for p in proved["problems"])
    return Plan(tuple(tracks), Certificate(**{**proved, "problems": problems}))


def _plain(number: np.generic) -> Any:
    return number.item()


def _joined(parts: Sequence[NDArray[Any]], kind: type) -> NDArray[Any]:
    return np.concatenate([np.empty(0, dtype=kind), *(part.ravel() for part in parts)])


@cache
def _versions() -> bytes:
    """What was installed and which code planned, as a digest."""
    found = hashlib.sha256(f"{__version__} {shapely.geos_version}".encode())
    found.update(repr([version(name) for name in _PACKAGES]).encode())
    root = Path(__file__).parents[1]
    for name in _CODE:
        place = root / name
        for path in sorted(place.rglob("*.py")) if place.is_dir() else [place]:
            found.update(path.read_bytes())
    return found.digest()
