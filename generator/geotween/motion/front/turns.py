"""Whose turn it is: a spot apart starts when the front comes near, a rest apart ends likewise."""

from __future__ import annotations

import numpy as np
import shapely

from geotween.motion.front.plane import NOTHING, SINK, SOURCE, Change, Floats, Ints
from geotween.motion.front.surface import Surface
from geotween.motion.groups import connected

# The latest that something apart starts, as a share of the transition.
LATEST = 0.8


def turns(change: Change, mesh: Surface, values: Floats, reach: Floats) -> Floats:
    """Values (nodes,) between 0 and 1, for what waits its turn from then to 1.

    A region that a front sets out in by itself, though its thing lies elsewhere at the origin,
    waits as long as the front that goes farthest takes to come so far, but not after ``LATEST``.
    One that a front ends in by itself is done as much earlier.

    Parameters
    ----------
    reach
        (nodes,) how far nodes are from where their front set out, in extents.
    """
    region = mesh.of_nodes(mesh.region)
    start = _waits(change, mesh, reach, change.after, change.before, SOURCE, mesh.gains)
    end = 1 - _waits(change, mesh, reach, change.before, change.after, SINK, mesh.losses)
    start = np.minimum(start, end)
    return start[region] + (end - start)[region] * values


def _waits(
    change: Change,
    mesh: Surface,
    reach: Floats,
    becomes: Ints,
    was: Ints,
    role: int,
    links: Ints,
) -> Floats:
    """How long each region (r,) waits for the thing that it becomes and that borders nowhere."""
    region = mesh.of_nodes(mesh.region)
    count = int(region.max()) + 1
    realm = connected(region[links], count)
    reached = np.bincount(realm[region], mesh.touching(role)) > 0
    apart = ~reached[realm]
    wait = np.zeros(count)
    thing = np.full(count, NOTHING)
    face = np.flatnonzero(change.region >= 0)
    thing[change.region[face]] = becomes[face]
    extent = np.ptp(mesh.points, axis=0).max()
    for one in np.unique(thing[apart & (thing != NOTHING)]):
        there, others = np.flatnonzero(was == one), thing == one
        farthest = reach[(others & ~apart)[region]].max(initial=0.0)
        if not len(there) or not farthest:
            continue
        mine = face[(others & apart)[change.region[face]]]
        tree = shapely.STRtree(change.plane.faces[there])
        (near, _), away = tree.query_nearest(
            change.plane.faces[mine], return_distance=True, all_matches=False
        )
        distance = np.full(int(realm.max()) + 1, np.inf)
        np.minimum.at(distance, realm[change.region[mine[near]]], away / extent)
        which = np.flatnonzero(others & apart)
        wait[which] = LATEST * np.minimum(distance[realm[which]] / farthest, 1.0)
    return wait
