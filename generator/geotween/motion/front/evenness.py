"""The clock of coarse triangles, set right: what bands leave uneven in the growth of area."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from geotween.motion.front.coarse import Coarse
from geotween.motion.front.exact import turns
from geotween.motion.front.knots import below
from geotween.motion.front.meshes import TICKS
from geotween.motion.front.plane import NOTHING, Change, Floats, Ints
from geotween.motion.groups import connected

# At how many moments areas are looked at; in between they are taken to grow evenly.
MOMENTS = 64

# What changes less than this share of all keeps its clock.
LEAST = 0.01


def set_right(change: Change, found: Coarse) -> Coarse:
    """Coarse triangles with key times at which the area swept has grown evenly.

    For all regions that hang together by things at once; their key times keep their order.
    """
    if not len(found.triangles):
        return found
    group = _groups(change)[found.region]
    area = turns(found.points, found.triangles)
    groups = int(group.max()) + 1
    whole = np.bincount(group, area, groups)
    swept = np.zeros((MOMENTS + 1, groups))
    for i in range(1, MOMENTS + 1):
        share = below(found.times, np.full(len(area), i / MOMENTS))
        swept[i] = np.bincount(group, share * area, groups) / whole
    times = found.times.copy()
    for number in np.flatnonzero(whole >= LEAST * whole.sum()).tolist():
        mine = group == number
        times[mine] = _evened(times[mine], swept[:, number])
    return replace(found, times=times)


def _evened(times: Floats, swept: Floats) -> Floats:
    """Times at which the clock shows what was swept, in ticks, and different where they were."""
    known, place = np.unique(times, return_inverse=True)
    wanted = np.rint(np.interp(known, np.linspace(0, 1, MOMENTS + 1), swept) * TICKS)
    wanted[0], wanted[-1] = known[0] * TICKS, known[-1] * TICKS
    step = np.arange(len(known))
    wanted = np.maximum.accumulate(wanted - step) + step
    wanted = np.minimum(wanted, wanted[-1] if len(known) == 1 else known[-1] * TICKS - step[::-1])
    return np.asarray(wanted[place.reshape(times.shape)] / TICKS)


def _groups(change: Change) -> Ints:
    """The number (R,) of all that each region hangs together with by things."""
    changing = np.flatnonzero(change.region != NOTHING)
    count = int(change.region.max()) + 1
    pairs = [
        np.column_stack([change.region[changing], count + thing[changing]])[
            thing[changing] != NOTHING
        ]
        for thing in (change.before, change.after)
    ]
    found = connected(np.concatenate(pairs), count + len(change.things))[:count]
    return np.unique(found, return_inverse=True)[1].reshape(-1)
