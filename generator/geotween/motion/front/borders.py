"""Times on both sides of borders agree, and no level leaves an island ahead or behind."""

from __future__ import annotations

import numpy as np

from geotween.motion.front.flood import filled
from geotween.motion.front.harmonic import harmonic
from geotween.motion.front.plane import INNER, Floats, Ints
from geotween.motion.front.surface import Flags, Surface

# What a way down must fall from node to node, from coarse to fine: each round mends what the one
# before it left. Only in the first does what agrees on a border stay together: no islands is more.
STEPS = ((1e-6, True), (1e-8, False), (1e-10, False))

# What differs by less on both sides of a border is made the same again.
SAME = 1e-5


def between(values: Floats, source: Flags, sink: Flags) -> Floats:
    """Values between 0 and 1: 0 where fronts set out, 1 where they end, half at pivots."""
    values = np.where(source, 0.0, np.where(sink, 1.0, np.clip(values, 0.0, 1.0)))
    return np.where(source & sink, 0.5, values)


def agreed(mesh: Surface, unit: Floats, values: Floats, source: Flags, sink: Flags) -> Floats:
    """Values that are the same on both sides of borders of regions that share a thing.

    Where both become the same, the earlier of two times is no island: the front comes from there;
    where both were the same, the later one. Within the regions the difference fades out.
    """
    fixed = source | sink
    gains, losses = (links[~fixed[links].any(axis=1)] for links in (mesh.gains, mesh.losses))
    group = mesh.joined(np.concatenate([gains, losses]))
    least, most = _extreme(np.minimum, values, group), _extreme(np.maximum, values, group)
    gained, lost = (np.isin(group, group[links]) for links in (gains, losses))
    wanted = np.where(gained & lost, (least + most) / 2, np.where(gained, least, most))
    linked = gained | lost
    off = wanted - values
    if not (np.abs(off) > 1e-9).any():
        return values
    given = np.where(fixed, 0.0, np.where(linked, off, np.nan))
    touched = np.bincount(mesh.of_nodes(mesh.region), np.abs(np.nan_to_num(given))) > 0
    some = touched[mesh.region]
    shift = harmonic(unit, mesh.triangles[some], mesh.nodes[some], given)
    return between(values + shift, source, sink)


def without_islands(mesh: Surface, values: Floats, source: Flags, sink: Flags) -> Floats:
    """Values of which each level parts what hangs together with one end from the other."""
    pivot = source & sink
    start, end = mesh.nodes.reshape(-1), np.roll(mesh.nodes, -1, axis=1).reshape(-1)
    within = np.column_stack([start, end])
    # Nothing hangs together by a single point.
    sides = [
        np.concatenate([part[~pivot[part].any(axis=1)] for part in (within, links)])
        for links in (mesh.gains, mesh.losses)
    ]
    pairs = np.concatenate([mesh.gains, mesh.losses])
    group = mesh.joined(pairs[~(source | sink)[pairs].any(axis=1)])
    for step, together in STEPS:
        values = np.minimum(filled(values, sides[0], source & ~pivot, step), 1.0)
        if together:
            values = _extreme(np.maximum, values, group)
        values = 1 - np.minimum(filled(1 - values, sides[1], sink & ~pivot, step), 1.0)
        if together:
            values = _extreme(np.minimum, values, group)
        values = _in_turn(mesh, between(values, source, sink), pivot, step)
    least, most = _extreme(np.minimum, values, group), _extreme(np.maximum, values, group)
    return np.where(most - least < SAME, (least + most) / 2, values)


def _extreme(which: np.ufunc, values: Floats, group: Ints) -> Floats:
    """Of each value the least or the most in its group."""
    found = np.zeros(int(group.max()) + 1)
    found[group] = values
    which.at(found, group, values)
    return found[group]


def _in_turn(mesh: Surface, values: Floats, pivot: Flags, step: float) -> Floats:
    """Values that only rise, around each pivot, from where fronts set out to where they end."""
    corner = np.flatnonzero(pivot[mesh.nodes])
    if not len(corner):
        return values
    triangle, place = np.divmod(corner, 3)
    fan = mesh.nodes[triangle, place]
    one, other = mesh.nodes[triangle, place - 2], mesh.nodes[triangle, place - 1]
    begin, end = np.zeros(mesh.count), np.zeros(mesh.count)
    first = mesh.roles[triangle, place] != INNER
    last = mesh.roles[triangle, place - 1] != INNER
    begin[fan[first]] = values[one[first]]
    end[fan[last]] = values[other[last]]
    rising, falling = (begin < end)[fan], (begin > end)[fan]
    lower = np.concatenate([one[rising], other[falling]])
    upper = np.concatenate([other[rising], one[falling]])
    values = values.copy()
    for _ in range(int(np.bincount(fan).max())):
        wrong = values[upper] < values[lower]
        if not wrong.any():
            break
        np.maximum.at(values, upper[wrong], np.minimum(values[lower[wrong]] + step, 1.0))
    return values
