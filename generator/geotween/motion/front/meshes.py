"""The mesh of a field for the cutting of levels: edges, rims, and band coordinates.

A band coordinate runs from 0 where a region is first swept to its number of bands where it is
swept last: levels lie at whole numbers.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geotween.motion.front.outline import edge_between, on_edges
from geotween.motion.front.plane import NOTHING, SINK, SOURCE, Change, Floats, Ints

if TYPE_CHECKING:
    from geotween.motion.front.field import Field

Flags = NDArray[np.bool_]

TICKS = 1024  # key times are multiples of 1 / TICKS
LEAST_BAND = 4  # multiples: a band has three key times between its ends

# A vertex that is swept this near to a key time is swept then: a sixteenth of a tick.
SNAP = 1 / (16 * TICKS)


@dataclass(frozen=True, eq=False)
class Rim:
    """The boundary edges of the regions' meshes: parts of the plane's edges.

    Attributes
    ----------
    triangle, corner : (r,) the triangle, and its corner where the edge begins.
    edge, left : (r,) the plane's edge, and whether the region is on its left.
    shares : (r, 2) how far along the plane's edge it begins and ends.
    """

    triangle: Ints
    corner: Ints
    edge: Ints
    left: Flags
    shares: Floats

    @property
    def key(self) -> Ints:
        """One number (r,) for the plane's edge and its side."""
        return 2 * self.edge + ~self.left


@dataclass(frozen=True, eq=False)
class Mesh:
    """The triangles of a field; no edge of a rim joins two vertices that all levels run through.

    Attributes
    ----------
    points : (k, 2)
    edge, share : (k,) where points lie on the plane's edges, as in the field.
    triangles : (T, 3)
    region : (T,)
    times : (T, 3) NaN at pivots.
    plain : the number of the plane's points, the first of ``points``.
    """

    points: Floats
    edge: Ints
    share: Floats
    triangles: Ints
    region: Ints
    times: Floats
    plain: int

    def of(self, chosen: Flags) -> Mesh:
        """The mesh of some regions (R,); regions keep their numbers."""
        rows = chosen[self.region]
        return replace(
            self,
            triangles=self.triangles[rows],
            region=self.region[rows],
            times=self.times[rows],
        )

    @cached_property
    def numbered(self) -> tuple[Ints, Flags]:
        """The number (T, 3) of the edge from each corner to the next, and whether it is a rim.

        The same from both sides, but another one for each region.
        """
        start, end = self.triangles, np.roll(self.triangles, -1, axis=1)
        ends = np.minimum(start, end) * len(self.points) + np.maximum(start, end)
        code = ends * (int(self.region.max(initial=0)) + 1) + self.region[:, None]
        _, number, count = np.unique(code, return_inverse=True, return_counts=True)
        number = number.reshape(code.shape)
        return number, count[number] == 1

    def on_plane(self, change: Change, one: Ints, two: Ints) -> tuple[Ints, Floats]:
        """The plane's edges (n,) that lead from one to the other, and the shares (n, 2) of both."""
        edge = np.maximum(self.edge[one], self.edge[two])
        whole = edge == NOTHING
        edge[whole] = edge_between(change.plane, one[whole], two[whole])
        end = change.plane.edges[edge, 1]
        both = np.column_stack([one, two])
        return edge, np.where(self.edge[both] == NOTHING, both == end[:, None], self.share[both])

    def rim(self, change: Change) -> Rim:
        """Its boundary on the edges of the plane."""
        triangle, corner = np.nonzero(self.numbered[1])
        start = self.triangles[triangle, corner]
        end = self.triangles[triangle, (corner + 1) % 3]
        edge, shares = self.on_plane(change, start, end)
        return Rim(triangle, corner, edge, shares[:, 0] < shares[:, 1], shares)


@dataclass(frozen=True, eq=False)
class Spans:
    """When each region is swept, and in how many bands.

    Attributes
    ----------
    first, last : (R,) the field's times.
    counts : (R,) the numbers of bands.
    ticks : (R,) levels lie at multiples of 1 / ticks, which divide ``TICKS``: the fewer different
        times, the fewer key frames.
    """

    first: Floats
    last: Floats
    counts: Ints
    ticks: Ints

    @cached_property
    def base(self) -> Ints:
        """The number (R,) of each region's first band among all bands."""
        return np.asarray(np.cumsum(self.counts) - self.counts)

    @cached_property
    def region(self) -> Ints:
        """The region (B,) of each band."""
        return np.repeat(np.arange(len(self.counts)), self.counts)

    @cached_property
    def ends(self) -> Floats:
        """The key times (B, 2) of the lower and the upper level of each band."""
        level = np.arange(len(self.region)) - self.base[self.region]
        return np.column_stack([self.key_time(level + i, self.region) for i in (0, 1)])

    def band(self, times: Floats, region: Ints) -> Floats:
        """Band coordinates of the field's times; whole numbers where they are all but so."""
        count = self.counts[region]
        span = (self.last - self.first)[region]
        found = (times - self.first[region]) / span * count
        whole = np.rint(found)
        found = np.where(np.abs(found - whole) * span <= SNAP * count, whole, found)
        return np.clip(found, 0, count)

    def key_time(self, level: Ints, region: Ints) -> Floats:
        """The time at which a region's level is swept."""
        start, end = self._start[region], self._end[region]
        return np.rint(start + (end - start) * level / self.counts[region]) / self._ticks[region]

    def within(self, share: Floats, band: Ints) -> Floats:
        """Shares of bands, strictly between 0 and 1, as shares at which a key time is."""
        low, high = self.ends[band].T
        ticks = self._ticks[self.region[band]]
        at = np.rint((low + (high - low) * share) * ticks) / ticks
        return np.asarray((np.clip(at, low + 1 / ticks, high - 1 / ticks) - low) / (high - low))

    @cached_property
    def _ticks(self) -> Floats:
        """Ticks (R,) that give each band its key times."""
        least = LEAST_BAND * self.counts / (self.last - self.first)
        fine = np.exp2(np.ceil(np.log2(np.maximum(least, 1))))
        return np.minimum(np.maximum(fine, self.ticks), TICKS)

    @cached_property
    def _start(self) -> Floats:
        return np.minimum(np.rint(self.first * self._ticks), self._ticks - self._least)

    @cached_property
    def _end(self) -> Floats:
        return np.maximum(np.rint(self.last * self._ticks), self._start + self._least)

    @property
    def _least(self) -> Ints:
        return LEAST_BAND * self.counts


def mesh_of(change: Change, field: Field) -> Mesh:
    """A field's mesh; edges of its rim between two pivots are divided in the middle."""
    mesh = Mesh(
        field.points,
        field.edge,
        field.share,
        field.triangles,
        field.region,
        field.times,
        len(change.plane.points),
    )
    rim = mesh.rim(change)
    pivots = np.isnan(mesh.times)
    both = pivots[rim.triangle, rim.corner] & pivots[rim.triangle, (rim.corner + 1) % 3]
    rows = np.flatnonzero(both)
    _, alone = np.unique(rim.triangle[rows], return_index=True)
    rows = rows[alone]
    if not len(rows):
        return mesh
    return _divided(mesh, rim, rows, change)


def _divided(mesh: Mesh, rim: Rim, rows: Ints, change: Change) -> Mesh:
    triangle, corner, edge = rim.triangle[rows], rim.corner[rows], rim.edge[rows]
    share = rim.shares[rows].mean(axis=1)
    role = change.roles[edge, np.where(rim.left[rows], 0, 1)]
    opposite = mesh.times[triangle, (corner + 2) % 3]
    beside = np.where(np.isnan(opposite), 0.5, opposite)
    time = np.select([role == SOURCE, role == SINK], [0.0, 1.0], beside)
    new = len(mesh.points) + np.arange(len(rows))
    first, second = mesh.triangles[triangle], mesh.triangles[triangle]
    times, others = mesh.times[triangle], mesh.times[triangle]
    row = np.arange(len(rows))
    first[row, (corner + 1) % 3] = second[row, corner] = new
    times[row, (corner + 1) % 3] = others[row, corner] = time
    triangles, every = mesh.triangles.copy(), mesh.times.copy()
    triangles[triangle], every[triangle] = first, times
    return Mesh(
        np.concatenate([mesh.points, on_edges(change.plane, edge, share)]),
        np.append(mesh.edge, edge),
        np.append(mesh.share, share),
        np.concatenate([triangles, second]),
        np.append(mesh.region, mesh.region[triangle]),
        np.concatenate([every, others]),
        mesh.plain,
    )


def spans_of(change: Change, mesh: Mesh) -> Spans:
    """When each region is swept, to begin with in one band.

    A region with a pivot is swept from beginning to end.
    """
    regions = int(change.region.max(initial=-1)) + 1
    first, last = np.full(regions, np.inf), np.full(regions, -np.inf)
    region = np.repeat(mesh.region, 3)
    np.fmin.at(first, region, mesh.times.ravel())
    np.fmax.at(last, region, mesh.times.ravel())
    turning = np.zeros(regions, dtype=bool)
    turning[mesh.region[np.isnan(mesh.times).any(axis=1)]] = True
    flat = turning | ~(first < last)
    first, last = np.where(flat, 0.0, first), np.where(flat, 1.0, last)
    one = np.ones(regions, dtype=np.intp)
    return Spans(first, last, one, TICKS * one)
