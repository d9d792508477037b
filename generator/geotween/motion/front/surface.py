"""The mesh of the regions of change, and what lies on either side of each of its sides."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.mesh.fill import fill, twins
from geotween.motion.front.outline import (
    edge_between,
    numbers_of,
    on_edges,
    outline,
    regions_of,
)
from geotween.motion.front.plane import INNER, SINK, SOURCE, Change, Floats, Ints
from geotween.motion.groups import connected

# Spacings of a region: so many to its mean width, at most so many lattice points, at most so many
# parts of its outline, and nothing finer than this share of the extent: three pixels of a thousand.
ACROSS, MOST_POINTS, MOST_PARTS, FINEST = 5.0, 1500.0, 3000.0, 1 / 300

# A side may have to be halved again after its neighbours were: so often at most.
ROUNDS = 6

Flags = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles over the regions of change.

    A point is as many **nodes** as it is wedges of regions: where a region touches itself or
    another one its corners are apart, unless a side leads from one to the other.

    Attributes
    ----------
    points : (k, 2) those of the plane first.
    edge, share : (k,) the edge of the plane that a point lies on, and how far along; -1 and 0 for
        the plane's own points and for inner ones.
    triangles, region : (T, 3) points counter-clockwise, and (T,).
    roles : (T, 3) of the side from each corner to the next: INNER, or what is on the other side.
    nodes : (T, 3) the node of each corner.
    gains, losses : (l, 2) nodes at one place, on both sides of a border of two regions that become
        the same thing, or that were the same.
    """

    points: Floats
    edge: Ints
    share: Floats
    triangles: Ints
    region: Ints
    roles: NDArray[np.uint8]
    nodes: Ints
    gains: Ints
    losses: Ints

    @property
    def count(self) -> int:
        """How many nodes there are."""
        return int(self.nodes.max(initial=-1)) + 1

    @property
    def places(self) -> Ints:
        """The point (nodes,) that each node is at."""
        found = np.zeros(self.count, dtype=np.intp)
        found[self.nodes] = self.triangles
        return found

    def of_nodes(self, of_triangles: Ints) -> Ints:
        """What is given for each triangle (T,), for each node."""
        found = np.zeros(self.count, dtype=of_triangles.dtype)
        found[self.nodes] = of_triangles[:, None]
        return found

    def touching(self, role: int) -> Flags:
        """Which nodes are ends of sides of a role."""
        found = np.zeros(self.count, dtype=bool)
        for nodes in (self.nodes, np.roll(self.nodes, -1, axis=1)):
            found[nodes[self.roles == role]] = True
        return found

    def joined(self, links: Ints) -> Ints:
        """A number (nodes,) for each node, the same for those that links (l, 2) join."""
        return connected(links, self.count)


def surface(change: Change, spacing: float | None) -> Surface:
    """Mesh the regions of change; no side but a border's own joins two nodes of one border.

    ``spacing`` is that of all regions, in the data's units; by default each has its own.
    """
    regions = regions_of(change)
    each = _spacings(change, regions) if spacing is None else np.full(len(regions), spacing)
    lines = outline(change, regions, each)
    mesh = fill(lines.regions, each)
    number = numbers_of(lines.points, mesh.points)
    inner = number < 0
    number[inner] = len(lines.points) + np.arange(inner.sum())
    found = _linked(
        change,
        np.concatenate([lines.points, mesh.points[inner]]),
        np.concatenate([lines.edge, np.full(inner.sum(), -1)]),
        np.concatenate([lines.share, np.zeros(inner.sum())]),
        number[mesh.triangles],
        mesh.owner,
    )
    for _ in range(ROUNDS):
        source, sink = source_and_sink(found)
        split = _flashing(found, source, sink)
        if not split.any():
            break
        found = _split(change, found, split)
    return found


def source_and_sink(surface: Surface) -> tuple[Flags, Flags]:
    """Which nodes (nodes,) fronts set out from, and which they end at; both: pivots.

    What holds on one side of a border that a front crosses holds on the other.
    """
    return (
        _any_of(surface.touching(SOURCE), surface.joined(surface.gains)),
        _any_of(surface.touching(SINK), surface.joined(surface.losses)),
    )


def _any_of(flags: Flags, group: Ints) -> Flags:
    return np.asarray(np.bincount(group, flags)[group] > 0)


def _spacings(change: Change, regions: NDArray[np.object_]) -> Floats:
    area, length = shapely.area(regions), shapely.length(regions)
    points = change.plane.points
    extent = np.ptp(points, axis=0).max() if len(points) else 0.0
    coarse = np.minimum(2 * area / np.maximum(length, np.finfo(float).tiny) / ACROSS, extent / 25)
    return np.asarray(
        np.maximum.reduce(
            [
                coarse,
                np.sqrt(area / MOST_POINTS),
                length / MOST_PARTS,
                np.full(len(regions), extent * FINEST),
            ]
        )
    )


def _linked(
    change: Change, points: Floats, edge: Ints, share: Floats, triangles: Ints, region: Ints
) -> Surface:
    """A surface from its triangles: roles of its sides, nodes and links."""
    pairs, same = twins(triangles, region)
    roles = np.full(triangles.size, INNER, dtype=np.uint8)
    outer = np.ones(triangles.size, dtype=bool)
    outer[pairs[same]] = False
    roles[outer] = _roles(change, edge, share, triangles, np.flatnonzero(outer))

    corner = np.arange(triangles.size)
    following = corner - corner % 3 + (corner + 1) % 3
    one, other = pairs.T
    ends = np.stack([np.stack([one, following[other]]), np.stack([following[one], other])])
    inner = ends[:, :, same].transpose(0, 2, 1).reshape(-1, 2)
    node = connected(inner, triangles.size)
    across = ends[:, :, ~same].transpose(0, 2, 1).reshape(-1, 2)
    face = np.zeros(int(region.max(initial=-1)) + 1, dtype=np.intp)
    face[change.region[change.region >= 0]] = np.flatnonzero(change.region >= 0)
    faces = face[region[across // 3]]
    gains, losses = (np.equal(*thing[faces].T) for thing in (change.after, change.before))
    return Surface(
        points,
        edge,
        share,
        triangles,
        region,
        roles.reshape(-1, 3),
        node.reshape(-1, 3),
        np.unique(node[across[gains]], axis=0),
        np.unique(node[across[losses]], axis=0),
    )


def _roles(
    change: Change, edge: Ints, share: Floats, triangles: Ints, sides: Ints
) -> NDArray[np.uint8]:
    """The roles of sides that run along edges of the plane."""
    start = triangles.reshape(-1)[sides]
    end = np.roll(triangles, -1, axis=1).reshape(-1)[sides]
    along = np.maximum(edge[start], edge[end])
    whole = along < 0
    along[whole] = edge_between(change.plane, start[whole], end[whole])
    ends = change.plane.edges[along]
    place = [np.where(p == ends[:, 1], 1.0, share[p]) for p in (start, end)]
    return np.asarray(change.roles[along, (place[0] > place[1]).astype(np.intp)])


def _flashing(surface: Surface, source: Flags, sink: Flags) -> Flags:
    """Sides (T, 3) that join two nodes of one border, and are not that border."""
    start, end = surface.nodes, np.roll(surface.nodes, -1, axis=1)
    return np.asarray(
        (source[start] & source[end] & (surface.roles != SOURCE))
        | (sink[start] & sink[end] & (surface.roles != SINK))
    )


def _split(change: Change, surface: Surface, split: Flags) -> Surface:
    """Halve sides, in all triangles that have them."""
    triangles, count = surface.triangles, len(surface.points)
    start, end = triangles, np.roll(triangles, -1, axis=1)
    key = np.minimum(start, end) * count + np.maximum(start, end)
    halved = np.unique(key[split])
    low, high = np.divmod(halved, count)
    edge, share = _halves(change, surface, low, high, halved, key)
    middle = (surface.points[low] + surface.points[high]) / 2
    middle[edge >= 0] = on_edges(change.plane, edge[edge >= 0], share[edge >= 0])
    apart = (middle != surface.points[low]).any(axis=1) & (middle != surface.points[high]).any(1)
    halved, edge, share, middle = halved[apart], edge[apart], share[apart], middle[apart]
    place = np.minimum(np.searchsorted(halved, key), len(halved) - 1)
    has = np.isin(key, halved)
    new = np.where(has, count + place, -1)
    pieces, parent = _pieces(triangles, new)
    return _linked(
        change,
        np.concatenate([surface.points, middle]),
        np.concatenate([surface.edge, edge]),
        np.concatenate([surface.share, share]),
        pieces,
        surface.region[parent],
    )


def _halves(
    change: Change, surface: Surface, low: Ints, high: Ints, halved: Ints, key: Ints
) -> tuple[Ints, Floats]:
    """For the middle of each side (low, high): the edge of the plane, and how far along."""
    outer = np.isin(halved, key[surface.roles != INNER])
    edge = np.where(outer, np.maximum(surface.edge[low], surface.edge[high]), -1)
    whole = outer & (edge < 0)
    edge[whole] = edge_between(change.plane, low[whole], high[whole])
    ends = change.plane.edges[edge, 1]
    share = sum(np.where(p == ends, 1.0, surface.share[p]) for p in (low, high)) / 2
    return edge, np.where(outer, share, 0.0)


def _pieces(triangles: Ints, new: Ints) -> tuple[Ints, Ints]:
    """Triangles cut at new points (T, 3) on their sides (-1: none), and the parent of each."""
    cuts = (new >= 0).sum(axis=1)
    # One cut: the cut side first. Two: the side without a cut last.
    turn = np.where(cuts == 1, (new >= 0).argmax(axis=1), ((new < 0).argmax(axis=1) + 1) % 3)
    turn = np.where(cuts % 3 == 0, 0, turn)
    around = (turn[:, None] + np.arange(3)) % 3
    a, b, c = np.take_along_axis(triangles, around, axis=1).T
    ab, bc, ca = np.take_along_axis(new, around, axis=1).T
    kinds = [
        [(a, b, c)],
        [(a, ab, c), (ab, b, c)],
        [(ab, b, bc), (a, ab, bc), (a, bc, c)],
        [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)],
    ]
    pieces, parents = [], []
    for count, kind in enumerate(kinds):
        mine = np.flatnonzero(cuts == count)
        for corners in kind:
            pieces.append(np.column_stack([points[mine] for points in corners]))
            parents.append(mine)
    parent = np.concatenate(parents)
    order = np.argsort(parent, kind="stable")
    return np.concatenate(pieces)[order], parent[order]
