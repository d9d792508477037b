"""Plans made in other processes, by other executors, or before: the same, to the byte."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from numpy.testing import assert_array_equal

import geotween
from geotween.cli import main
from geotween.export import jobs
from geotween.export.build import plan_scene
from geotween.export.cache import VARIABLE, Cache
from geotween.export.jobs import plan_scenes
from geotween.export.plans import Plan, Task, as_arrays, from_arrays, planned, tasks_of
from geotween.export.resources import resource
from geotween.motion.morph import Morph
from geotween.scene.model import Motion
from tests.conftest import WriteScene

# Two regions with keys and further columns that move, part and meet; four transitions.
STEPS = """\
title: Two
steps:
  - caption: "{caption}"
    polygons: [{{key: x, polygon: [[0, 0], [4, 0], [4, 4], [0, 4]]}}]
  - polygons:
      - {{key: x, polygon: [[1, 0], [5, 0], [5, 4], [1, 4]]}}
      - {{key: y, polygon: [[9, 9], [12, 9], [12, 12]]}}
  - polygons: [{{key: y, polygon: [[0, 0], [{last}, 0], [9, 9]]}}]
  - polygons: [{{key: x, polygon: [[1, 1], [4, 1], [4, 4]]}}]
  - polygons: [{{key: x, polygon: [[0, 0], [4, 0], [4, 4], [0, 4]]}}]
"""


def scene_of(write_scene: WriteScene, caption: str = "", last: int = 9) -> geotween.Scene:
    return geotween.load(write_scene(STEPS.format(caption=caption, last=last)))


def same(one: Plan | Morph, other: Plan | Morph) -> None:
    """All that is drawn and told of two transitions is the same."""
    assert one.certificate == other.certificate
    assert len(one.tracks) == len(other.tracks)
    films: dict[object, object] = {}
    for mine, theirs in zip(one.tracks, other.tracks, strict=True):
        assert (mine.identity, mine.ends, mine.layer) == (
            theirs.identity,
            theirs.ends,
            theirs.layer,
        )
        for name in ("times", "vertices", "offsets", "seams", "nodes"):
            a, b = getattr(mine, name), getattr(theirs, name)
            assert (a is None) == (b is None)
            if a is not None:
                assert_array_equal(a, b)
                assert a.dtype == b.dtype
        assert films.setdefault(mine.film, theirs.film) is theirs.film
        if mine.film and theirs.film:
            assert_array_equal(mine.film.lives, theirs.film.lives)


class Counting(Executor):
    """Plans at once, and counts what it is given."""

    def __init__(self) -> None:
        self.count = 0

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        self.count += 1
        future: Future[Any] = Future()
        future.set_result(fn(*args, **kwargs))
        return future


# Plans as arrays


@pytest.mark.parametrize("name", ["lake", "fire", "archipelago"])
def test_a_plan_as_arrays_is_the_same_plan(name: str) -> None:
    scene = geotween.load(resource("scenes") / f"{name}.yaml")
    for task, morph in zip(tasks_of(scene), plan_scene(scene)[0], strict=True):
        told = as_arrays(Plan(morph.tracks, morph.certificate), task.identities)
        assert all(array.dtype != object for array in told.values())
        same(from_arrays(told, task.identities), morph)


def test_a_plan_has_the_features_of_its_task(write_scene: WriteScene) -> None:
    (first, *_), *_ = plan_scenes([scene := scene_of(write_scene)])
    (track, *_) = first.tracks
    assert track.ends[0] is scene.steps[0].regions.identities[0]
    assert track.ends[1] is scene.steps[1].regions.identities[0]


@pytest.mark.parametrize("name", ["told", "who", "vertices", "offsets"])
def test_arrays_that_tell_no_plan_are_refused(write_scene: WriteScene, name: str) -> None:
    task = tasks_of(scene_of(write_scene))[0]
    told = planned(task)
    with pytest.raises((KeyError, ValueError, IndexError, TypeError)):
        from_arrays({k: v for k, v in told.items() if k != name}, task.identities)
    with pytest.raises((KeyError, ValueError, IndexError, TypeError)):
        from_arrays({**told, name: told[name][:-1]}, task.identities)


# Which tasks are the same


def test_a_key_is_that_of_shapes_names_and_techniques(write_scene: WriteScene) -> None:
    task = tasks_of(scene_of(write_scene))[0]
    again = tasks_of(scene_of(write_scene, caption="Another."))[0]
    assert task.key == again.key
    other = tasks_of(scene_of(write_scene, last=8))
    alike = [a.key == b.key for a, b in zip(tasks_of(scene_of(write_scene)), other, strict=True)]
    assert alike == [True, False, False, True]
    by_paper = replace(task.techniques, method="paper")
    swapped = Task(task.target, task.origin, task.techniques)
    who = tuple(replace(i, key=1) for i in task.origin.identities)
    renamed = Task(replace(task.origin, identities=who), task.target, task.techniques)
    keys = [task.key, replace(task, techniques=by_paper).key, swapped.key, renamed.key]
    assert len(set(keys)) == 4


def test_further_columns_are_not_looked_at(write_scene: WriteScene) -> None:
    task = tasks_of(scene_of(write_scene))[0]
    assert task.without_attributes().key == task.key


# However they are made


@pytest.mark.parametrize(
    "way",
    [
        lambda scene: plan_scenes([scene], executor=ThreadPoolExecutor(2)),
        lambda scene: plan_scenes([scene], executor=Counting()),
        lambda scene: plan_scenes([scene, scene])[1:],
    ],
)
def test_plans_are_the_same(
    write_scene: WriteScene, way: Callable[[geotween.Scene], list[list[Plan]]]
) -> None:
    scene = scene_of(write_scene)
    (found,) = way(scene)
    for one, other in zip(found, plan_scene(scene)[0], strict=True):
        same(one, other)


@pytest.mark.parametrize("alone", [0.0, 1e9])
def test_processes_make_the_same_plans(
    write_scene: WriteScene, monkeypatch: pytest.MonkeyPatch, alone: float
) -> None:
    monkeypatch.setattr(jobs, "ALONE", alone)
    scene = scene_of(write_scene)
    for one, other in zip(plan_scenes([scene], jobs=2)[0], plan_scenes([scene])[0], strict=True):
        same(one, other)


def test_little_work_starts_no_process(
    write_scene: WriteScene, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(jobs, "ALONE", 1e9)
    monkeypatch.setattr(jobs, "ProcessPoolExecutor", None)
    assert len(plan_scenes([scene_of(write_scene)], jobs=2)[0]) == 4


def test_equal_transitions_are_planned_once(write_scene: WriteScene) -> None:
    scene, executor = scene_of(write_scene), Counting()
    ticks = []
    plan_scenes([scene, scene], executor=executor, done=lambda: ticks.append(1))
    assert executor.count == 4
    assert len(ticks) == 8


def test_files_are_the_same_by_any_executor(write_scene: WriteScene, tmp_path: Path) -> None:
    scene = scene_of(write_scene)
    plain = geotween.build(scene, tmp_path / "plain", cache=False)
    with ProcessPoolExecutor(1) as executor:
        other = geotween.build(scene, tmp_path / "other", executor=executor)
    assert [f.read_bytes() for f in plain.files] == [f.read_bytes() for f in other.files]
    assert plain.transitions == other.transitions


def test_files_are_the_same_in_any_process(write_scene: WriteScene, tmp_path: Path) -> None:
    """Hashes of texts differ from process to process; what is built does not."""
    path = write_scene(STEPS.format(caption="", last=9))
    found = []
    for number, options in enumerate((["--jobs", "1"], ["--jobs", "2"])):
        out = tmp_path / str(number)
        command = [sys.executable, "-m", "geotween", "build", path, "-o", out, "-q", *options]
        environment = {**os.environ, "PYTHONHASHSEED": str(number), VARIABLE: ""}
        subprocess.run(command, check=True, env=environment, timeout=120)
        found.append({file.name: file.read_bytes() for file in out.iterdir()})
    assert found[0] == found[1]


def test_dask_plans_on_many_machines(write_scene: WriteScene) -> None:
    distributed = pytest.importorskip("distributed")
    scene = scene_of(write_scene)
    with distributed.Client(processes=False, dashboard_address=None) as client:
        (found,) = plan_scenes([scene], executor=client.get_executor())
    for one, other in zip(found, plan_scenes([scene])[0], strict=True):
        same(one, other)


# What was planned before


def test_one_caption_plans_nothing_anew(write_scene: WriteScene, tmp_path: Path) -> None:
    cache, executor = Cache(tmp_path / "cache"), Counting()
    first = plan_scenes([scene_of(write_scene)], cache=cache, executor=executor)
    assert executor.count == 4
    scene = scene_of(write_scene, caption="Another.")
    again = plan_scenes([scene], cache=cache, executor=executor)
    assert executor.count == 4
    for one, other in zip(first[0], again[0], strict=True):
        same(one, other)


def test_one_step_plans_its_two_transitions_anew(write_scene: WriteScene, tmp_path: Path) -> None:
    cache, executor = Cache(tmp_path / "cache"), Counting()
    plan_scenes([scene_of(write_scene)], cache=cache, executor=executor)
    plan_scenes([scene_of(write_scene, last=8)], cache=cache, executor=executor)
    assert executor.count == 4 + 2


def test_an_entry_that_tells_no_plan_is_planned_anew(
    write_scene: WriteScene, tmp_path: Path
) -> None:
    cache, scene = Cache(tmp_path / "cache"), scene_of(write_scene)
    for task in tasks_of(scene):
        told = planned(task)
        cache.put(task.key, {**told, "vertices": told["vertices"][:-2]})
    executor = Counting()
    plan_scenes([scene], cache=cache, executor=executor)
    plan_scenes([scene], cache=cache, executor=executor)
    assert executor.count == 4


def test_the_command_line_keeps_plans_unless_told_not_to(
    write_scene: WriteScene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(VARIABLE, str(tmp_path / "cache"))
    path, out = str(write_scene(STEPS.format(caption="", last=9))), str(tmp_path / "out")
    build = ["build", path, "-o", out, "-q", "--jobs", "1"]
    assert CliRunner().invoke(main, [*build, "--no-cache"]).exit_code == 0
    assert not (tmp_path / "cache").exists()
    plain = (tmp_path / "out" / "scene.html").read_bytes()
    for _ in range(2):
        assert CliRunner().invoke(main, build).exit_code == 0
        assert len(list((tmp_path / "cache").glob("*/*.npz"))) == 4
        assert (tmp_path / "out" / "scene.html").read_bytes() == plain


def test_what_a_plan_depends_on_is_in_its_task() -> None:
    """A setting of a scene's motion that says how it is planned reaches the techniques."""
    drawn = {"ghost", "easing"}  # how a plan is shown
    assert set(Motion.model_fields) - drawn == {
        "method", "correspondence", "division", "matching", "path", "radius", "annexation",
        "by_layer", "by_class", "by_key",
    }  # fmt: skip
