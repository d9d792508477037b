"""The arrival field: when each place of the regions of change flips from one thing to another."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geotween.mesh.fill import doubled_areas
from geotween.motion.front.borders import agreed, between, without_islands
from geotween.motion.front.clock import even
from geotween.motion.front.distance import distances, waves
from geotween.motion.front.harmonic import harmonic
from geotween.motion.front.plane import NEUTRAL, SINK, SOURCE, Change, Floats, Ints
from geotween.motion.front.surface import Flags, Surface, source_and_sink, surface
from geotween.motion.front.turns import turns
from geotween.motion.groups import connected

TECHNIQUES = ("ratio", "harmonic")

# As good as innermost is what is so near to it, as a share of how far that is from the rim.
NEARLY = 0.95


@dataclass(frozen=True, eq=False)
class Field:
    """When each place of the regions of change flips: linear on each triangle.

    Attributes
    ----------
    points : (k, 2) those of the plane first.
    edge : (k,) the edge of the plane that a point was put on; -1 for the plane's own points and
        for inner ones.
    share : (k,) how far along that edge, between 0 and 1; 0 for the others.
    triangles : (T, 3) corners, counter-clockwise; they tile the regions of change.
    region : (T,) the region of each.
    times : (T, 3) the arrival at each corner, in [0, 1]. NaN at a pivot, where the front sets out
        and ends: every level runs through it. Across a border of regions times may differ.
    """

    points: Floats
    edge: Ints
    share: Floats
    triangles: Ints
    region: Ints
    times: Floats


@dataclass(frozen=True, eq=False)
class _Ends:
    """Which nodes fronts set out from and end at, and how far each node is from these (nodes,)."""

    source: Flags
    sink: Flags
    since: Floats
    until: Floats


def arrival(change: Change, spacing: float | None = None, technique: str = "ratio") -> Field:
    """When each place of the regions of change flips.

    Parameters
    ----------
    spacing
        Of the mesh, in the data's units; by default each region has its own.
    technique
        ``ratio`` of the distances to where a front sets out and to where it ends, within what
        becomes the same, and was the same, thing; or ``harmonic``.

    Raises
    ------
    ValueError
        For another technique.

    Notes
    -----
    Fronts set out at time 0 from all that is the new thing already, or from the innermost point
    where nothing is, and run on from region to region. A spot apart waits its turn. Where two
    regions border that share a thing, times agree. There are no islands: what has flipped hangs
    together with where the front set out, and what has not with where it ends. The area swept
    grows evenly. O(n log n) for n mesh points.
    """
    if technique not in TECHNIQUES:
        raise ValueError(f"technique is one of {', '.join(TECHNIQUES)}, not {technique!r}")
    mesh = surface(change, spacing)
    if not len(mesh.triangles):
        return Field(
            mesh.points, mesh.edge, mesh.share, mesh.triangles, mesh.region, np.empty((0, 3))
        )
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    unit = (mesh.points - (low + high) / 2) / (high - low).max()
    ends = _ends(mesh, unit)
    values = _ratio(ends) if technique == "ratio" else _harmonic(mesh, unit, ends)
    values = between(values, ends.source, ends.sink)
    values = agreed(mesh, unit, values, ends.source, ends.sink)
    values = without_islands(mesh, values, ends.source, ends.sink)
    values = turns(change, mesh, values, ends.since)
    values[ends.source & ends.sink] = np.nan
    areas = doubled_areas(unit, mesh.triangles) / 2
    times = even(values[mesh.nodes], areas, _clocks(change, mesh)[mesh.region])
    return Field(mesh.points, mesh.edge, mesh.share, mesh.triangles, mesh.region, times)


def _ends(mesh: Surface, unit: Floats) -> _Ends:
    """Where fronts set out and end, and how far nodes are from where they set out.

    A front that has nowhere to set out from does so from the innermost node, one that has nowhere
    to end at the farthest.
    """
    source, sink = source_and_sink(mesh)
    region = mesh.of_nodes(mesh.region)
    count = int(region.max()) + 1
    becoming, leaving = (
        connected(region[links], count)[region] for links in (mesh.gains, mesh.losses)
    )
    unset = np.bincount(becoming, source)[becoming] == 0
    endless = np.bincount(leaving, sink)[leaving] == 0
    depth = np.full(mesh.count, np.inf)
    if (unset | endless).any():
        rim = mesh.touching(SOURCE) | mesh.touching(SINK) | mesh.touching(NEUTRAL)
        depth = distances(
            waves(unit, mesh.triangles, mesh.nodes, mesh.count),
            np.where(rim & (unset | endless), 0.0, np.inf),
        )
    place = unit[mesh.places]
    seeds = _innermost(depth, ~sink, becoming, unset, place)
    source[seeds] = True
    since = _distances(mesh, unit, mesh.gains, _start(mesh, unit, source, seeds, depth))
    last = _innermost(since, ~source, leaving, endless, place)
    sink[last] = True
    until = _distances(mesh, unit, mesh.losses, _start(mesh, unit, sink, last, depth))
    return _Ends(source, sink, since, until)


def _start(mesh: Surface, unit: Floats, ends: Flags, lone: Ints, depth: Floats) -> Floats:
    """What is known of the distances from some ends: around lone ones all as far as the rim.

    Waves would leave a single node in the shape of its neighbourhood.
    """
    start = np.where(ends, 0.0, np.inf)
    if not len(lone):
        return start
    region = mesh.of_nodes(mesh.region)
    centre = np.full(int(region.max()) + 1, -1)
    centre[region[lone]] = lone
    centre = centre[region]
    place = unit[mesh.places]
    away = np.hypot(*(place - place[centre]).T)
    round_ = (centre >= 0) & (away < depth[centre])
    return np.where(round_, np.minimum(away, start), start)


def _innermost(values: Floats, better: Flags, group: Ints, which: Flags, place: Floats) -> Ints:
    """Of each group among some nodes (n,) one of the highest value, a better one if there is any.

    Of those that are nearly as high the one in their middle: where it is does not hang on chance.
    """
    nodes = np.flatnonzero(which)
    if not len(nodes):
        return nodes
    count = int(group.max()) + 1
    able = np.bincount(group[nodes], better[nodes], count) > 0
    nodes = nodes[better[nodes] | ~able[group[nodes]]]
    highest = np.zeros(count)
    np.maximum.at(highest, group[nodes], values[nodes])
    nodes = nodes[values[nodes] >= NEARLY * highest[group[nodes]]]
    mine = group[nodes]
    number = np.maximum(np.bincount(mine, minlength=count), 1)
    middle = np.stack([np.bincount(mine, part, count) / number for part in place[nodes].T], axis=1)
    away = np.hypot(*(place[nodes] - middle[mine]).T)
    nodes = nodes[np.lexsort((away, mine))]
    return nodes[np.unique(group[nodes], return_index=True)[1]]


def _distances(mesh: Surface, unit: Floats, links: Ints, start: Floats) -> Floats:
    """How far each node is from those where something is known, where links are no distance."""
    group = mesh.joined(links)
    count = int(group.max()) + 1
    known = np.full(count, np.inf)
    np.minimum.at(known, group, start)
    return distances(waves(unit, mesh.triangles, group[mesh.nodes], count), known)[group]


def _ratio(ends: _Ends) -> Floats:
    return ends.since / np.maximum(ends.since + ends.until, np.finfo(float).tiny)


def _harmonic(mesh: Surface, unit: Floats, ends: _Ends) -> Floats:
    group = mesh.joined(np.concatenate([mesh.gains, mesh.losses]))
    given = np.full(int(group.max()) + 1, np.nan)
    given[group[ends.source]] = 0.0
    given[group[ends.sink]] = np.where(np.isnan(given[group[ends.sink]]), 1.0, 0.5)
    return harmonic(unit, mesh.triangles, group[mesh.nodes], given)[group]


def _clocks(change: Change, mesh: Surface) -> Ints:
    """The clock of each region (r,): one for all that change alike, or agree on a border.

    What a thing gains and what it loses go by clocks of their own: so its area is linear, too.
    """
    count = int(mesh.region.max()) + 1
    changing = change.region >= 0
    region = mesh.of_nodes(mesh.region)
    alike = np.column_stack([change.before, change.after])[changing]
    kinds, kind = np.unique(alike, axis=0, return_inverse=True)
    same = np.column_stack([change.region[changing], count + kind.reshape(-1)])
    pairs = np.concatenate([region[mesh.gains], region[mesh.losses], same])
    group = connected(pairs, count + len(kinds))[:count]
    return np.unique(group, return_inverse=True)[1].reshape(-1)
