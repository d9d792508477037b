"""Plan transitions: those that are not known yet, one after another or in several processes."""

from __future__ import annotations

import multiprocessing
import os
import sys
import threading
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor, as_completed
from contextlib import AbstractContextManager, contextmanager, nullcontext

from geotween.data.load import Scene
from geotween.export.cache import Cache
from geotween.export.plans import Arrays, Plan, Task, from_arrays, planned, tasks_of

# Seconds of planning before processes are started: a scene that needs no more is done by then.
ALONE = 0.15


def cores() -> int:
    """How many processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def plan_scenes(
    scenes: Sequence[Scene],
    *,
    jobs: int = 1,
    cache: Cache | None = None,
    executor: Executor | None = None,
    done: Callable[[], object] = lambda: None,
) -> list[list[Plan]]:
    """The plans of each scene's transitions, the same ones however they are made.

    Parameters
    ----------
    jobs
        In how many processes, this one included until there is work for more.
    cache
        Where plans are looked up, and kept.
    executor
        Plans all that is not in the cache, wherever it runs; ``jobs`` does not count then.
    done
        Called once for each transition.
    """
    tasks = [tasks_of(scene) for scene in scenes]
    distinct = {task.key: task for of_scene in tasks for task in of_scene}
    found: dict[str, Arrays] = {}
    for key, task in distinct.items():
        known = cache.get(key) if cache else None
        if known is not None and _whole(known, task):
            found[key] = known
    counts = dict.fromkeys(distinct, 0)
    for of_scene in tasks:
        for task in of_scene:
            counts[task.key] += 1
    for key in found:
        _call(done, counts[key])
    missing = [task for key, task in distinct.items() if key not in found]
    for task, arrays in _planned(missing, jobs, executor):
        found[task.key] = arrays
        if cache:
            cache.put(task.key, arrays)
        _call(done, counts[task.key])
    if cache and missing:
        cache.prune()
    return [[from_arrays(found[t.key], t.identities) for t in of_scene] for of_scene in tasks]


def _call(done: Callable[[], object], times: int) -> None:
    for _ in range(times):
        done()


def _whole(arrays: Arrays, task: Task) -> bool:
    """Whether an entry of the cache tells a plan of a task."""
    try:
        from_arrays(arrays, task.identities)
    except (KeyError, ValueError, IndexError, TypeError):
        return False
    return True


def _planned(
    tasks: list[Task], jobs: int, executor: Executor | None
) -> Iterator[tuple[Task, Arrays]]:
    """Tasks with their plans, in the order in which they are ready."""
    waiting = sorted(tasks, key=lambda task: task.size)
    if executor is None:
        start = time.perf_counter()
        while waiting and (jobs < 2 or time.perf_counter() - start < ALONE):
            task = waiting.pop(0)
            yield task, planned(task)
    if not waiting:
        return
    pool: AbstractContextManager[Executor] = (
        nullcontext(executor) if executor else processes(min(jobs, len(waiting)))
    )
    with pool as ready:
        # The largest first, so that no process is left with one of them at the end.
        futures = {
            ready.submit(planned, task.without_attributes()): task for task in reversed(waiting)
        }
        try:
            for future in as_completed(futures):
                yield futures[future], future.result()
        finally:
            for future in futures:
                future.cancel()


@contextmanager
def processes(jobs: int) -> Iterator[Executor]:
    """So many processes. They start as copies of this one where that is quick and safe."""
    alone = sys.platform == "linux" and threading.active_count() == 1
    context = multiprocessing.get_context("fork" if alone else None)
    with ProcessPoolExecutor(jobs, context) as pool:
        with warnings.catch_warnings():
            # Of the threads of NumPy's linear algebra, which are made to be copied.
            warnings.simplefilter("ignore", DeprecationWarning)
            pool.submit(int).result()
        yield pool
