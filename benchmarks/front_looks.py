"""Looks at the frames of a transition, whatever moved it: what fronts promise, in figures.

overlap, gap        what is covered twice, and of a tiling left bare, as shares of the area
on grid             the larger of both, after rounding to a page of ``WIDTH`` pixels
ends, lost, moved   as motion/measure.py has them: how far the ends are missed, what is common
                    and bare, how far common boundary moves
retreat             what is left though it is in the end, or entered though it is not, from a
                    frame to the next, as a share of what changes
apart               the area in a frame of islands, parts that the ends do not explain, as a
                    share of what changes
flash               the largest change from a frame to the next, in multiples of the mean: of
                    all together, or of a key in a tiling
sweep off           by how much what has changed by then is off the straight way, as a share of
                    all that changes
area off            by how much the area of a group of correspondents is off its straight way,
                    as a share of its larger end
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.polygons import bounds_of, extent
from geotween.export.page_grid import GridTrack, fit_page, on_grid
from geotween.motion.areas import area_over_time
from geotween.motion.correspond import correspond
from geotween.motion.groups import grouped
from geotween.motion.looks import rebuilt
from geotween.motion.measure import measure
from geotween.motion.rings import to_polygons
from geotween.motion.tracks import Track
from geotween.scene.model import Map
from tests.motion.front.tilings import (
    SQUARE,
    Geometry,
    Transition,
    islands,
    polygons_at,
    regions_at,
    retreat,
    territories_at,
    twice_and_bare,
)

Objects = NDArray[np.object_]
Tracks = Sequence[Track]

FRAMES = 201
EVERY = 4  # frames from one in which islands and retreat are looked for to the next
SAMPLES = 2049  # of areas over time; key times of fronts are among them
WIDTH = 960  # of the page, in pixels
SEEN = 100  # square pixels
NOTHING = shapely.Polygon()


@dataclass(frozen=True)
class Look:
    """The figures of a motion; NaN where there is none."""

    overlap: float
    gap: float
    on_grid: float
    ends: float
    lost: float
    moved: float
    retreat: float
    islands: float
    flash: float
    sweep_off: float
    area_off: float
    group_off: float


def look(
    tracks: Tracks, transition: Transition, frames: int, *, tiled: bool, stills: bool = False
) -> Look:
    """The figures of one motion; without those of changes where not all ``FRAMES`` are looked at.

    ``stills`` are a track for each frame, whose areas mean nothing in between.
    """
    found = measure(tracks, *transition, frames)
    page = fit_page(Map(width=WIDTH), transition)
    rounded = on_grid(tracks, page)
    square = shapely.Polygon(page.grid(shapely.get_coordinates(SQUARE)))
    gap, off_grid = 0.0 if tiled else np.nan, 0.0
    for t in np.linspace(0, 1, frames).tolist():
        there = _rounded_at(rounded, t)
        if tiled:
            gap = max(gap, twice_and_bare(polygons_at(tracks, t)[0], SQUARE.area)[1])
            off_grid = max(off_grid, *twice_and_bare(there, square.area))
        else:
            off_grid = max(off_grid, twice_and_bare(there, shapely.area(there).sum())[0])
    changes = (np.nan,) * 4 if frames < FRAMES else _changes(tracks, transition, tiled=tiled)
    return Look(
        found.overlap,
        gap,
        off_grid,
        found.inexact_ends,
        found.lost,
        found.boundary_moved,
        *changes,
        *_area_off(tracks, transition, FRAMES if stills else SAMPLES),
    )


def _changes(
    tracks: Tracks, transition: Transition, *, tiled: bool
) -> tuple[float, float, float, float]:
    """Retreat, islands, flash, sweep: of each tile, or else of what is covered and what is not."""
    box = bounds_of(transition)
    around = shapely.box(*box).buffer(extent(box))

    def shapes_at(t: float, of: Callable[[float], Mapping[Any, Geometry]]) -> dict[Any, Geometry]:
        if tiled:
            return dict(of(t))
        covered = shapely.union_all(list(of(t).values()))
        return {"covered": covered, "bare": shapely.difference(around, covered)}

    things = partial(regions_at, tracks)
    ends = [shapes_at(t, things) for t in (0.0, 1.0)]
    names = list({**ends[0], **ends[1]})
    start, end = (_in_order(shapes, names) for shapes in ends)
    changes, swept = [], []
    then = start
    times = np.linspace(0, 1, FRAMES)
    for t in times[1:].tolist():
        now = _in_order(shapes_at(t, things), names)
        changes.append(shapely.area(shapely.symmetric_difference(then, now)))
        swept.append(shapely.area(shapely.difference(now, start)).sum())
        then = now
    whole = shapely.area(shapely.difference(end, start)).sum() or 1.0
    steps = np.array(changes) if tiled else np.array(changes)[:, :1]
    steps = steps[:, steps.sum(axis=0) > SEEN * (extent(box) / WIDTH) ** 2]
    flash = (steps.max(axis=0) / steps.mean(axis=0)).max(initial=1.0)
    off = np.abs(np.array(swept) / whole - times[1:]).max()

    lone, retreats = 0.0, [0.0]
    then = start
    for t in times[EVERY::EVERY].tolist():
        now = _in_order(shapes_at(t, things), names)
        retreats.append(sum(map(retreat, then, now, end)))
        then = now
    for root in (0, 1):  # what is gained hangs together by its new owner, what is left by its old
        of = partial(territories_at, tracks, end=1 - root)
        roots, others = (shapes_at(float(at), of) for at in (root, 1 - root))
        for t in times[EVERY::EVERY].tolist():
            there = shapes_at(t, of).items()
            found = [
                islands(shape, roots.get(name, NOTHING), others.get(name, NOTHING))
                for name, shape in there
            ]
            lone = max(lone, sum(map(sum, found)))
    return max(retreats) / whole, lone / whole, float(flash), float(off)


def _in_order(shapes: Mapping[Any, Geometry], names: Sequence[Any]) -> Objects:
    return np.array([shapes.get(name, NOTHING) for name in names], dtype=object)


def _area_off(tracks: Tracks, transition: Transition, samples: int) -> tuple[float, float]:
    """Of all polygons together, and of the worst group of them."""
    related = correspond(*transition, "auto")
    groups = grouped(related)
    number = dict(zip(related.target.identities, groups.of_target.tolist(), strict=True))
    number |= dict(zip(related.origin.identities, groups.of_origin.tolist(), strict=True))
    theirs: dict[int, list[Track]] = {}
    for track in tracks:
        theirs.setdefault(number[track.ends[0]], []).append(track)
    t = np.linspace(0, 1, samples)
    found = []
    for mine in (tracks, *theirs.values()):
        area = area_over_time(mine)
        place = np.searchsorted(area.times, t, side="right").clip(1, len(area.times) - 1) - 1
        values = (area.coefficients[place] * t[:, None] ** [0, 1, 2]).sum(axis=1)
        straight = values[0] + (values[-1] - values[0]) * t
        found.append(float(np.abs(values - straight).max() / max(values[0], values[-1])))
    return found[0], max(found)


def _rounded_at(tracks: Sequence[GridTrack], t: float) -> Objects:
    """The polygons that are drawn on a page's grid at t; invalid ones are mended."""
    there = [k for k in tracks if k.life[0] <= t < k.life[1] or t == k.life[1] == 1]
    there = [track for track in there if track.vertices.shape[1]]
    counts = [np.diff(track.offsets) for track in there]
    owner = np.repeat(np.arange(len(there)), [len(count) for count in counts])
    offsets = np.concatenate([[0], np.cumsum(np.concatenate(counts))]).astype(np.intp)
    found = to_polygons(np.concatenate([track.at(t) for track in there]), offsets, owner)
    return rebuilt(found[[polygon is not None for polygon in found]])
