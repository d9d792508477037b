"""Divide a polygon by the Voronoi cells of one seed for each of its correspondents.

The seeds are the paper's: of each correspondent the vertex nearest to the centroid of the polygon
that is divided. What degenerates is mended, so that the pieces partition the polygon, each is one
polygon, and none is empty. Cost: n log n for n vertices and seeds together, times the mended cells.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString, MultiPoint, Point, Polygon

from geotween.data.polygons import RELATIVE_TOLERANCE
from geotween.motion.rings import next_vertex, rings_of, undirected

Points = NDArray[np.float64]

# A cell below this share of the polygon's area is rounding, not a piece.
SLIVER = 1e-12

# How far lines are nudged where noding fails, in shares of the extent, how often, and which way:
# along no axis and no diagonal.
NUDGE, NUDGES, ASKEW = 1e-8, 9, np.array([0.618, 0.786])

# A piece below this share of an equal part of the area is no host for empty cells.
HOST = 1e-3


@dataclass(frozen=True)
class Mend:
    """What had to be mended for the cell of one correspondent, and the share of area it moved."""

    kind: str
    cell: int
    share: float = 0.0


@dataclass(frozen=True, eq=False)
class _Cut:
    """A line through a piece; its side nearest to an empty cell's seed becomes that cell.

    ``won`` is what the cell got by it; a later cut may take a part of that.
    """

    cell: int
    piece: Polygon
    near: Points
    inward: Points
    middle: Points
    lines: NDArray[np.object_]
    won: Polygon | None = None


def voronoi(
    polygon: Polygon, correspondents: Sequence[Polygon]
) -> tuple[list[Polygon], list[Mend]]:
    """One piece of the polygon for each correspondent, in their order, and what was mended."""
    seeds, mends = _seeds(polygon, correspondents)
    lines = _voronoi_lines(polygon, seeds)
    faces, labels = _faces(polygon, lines, seeds, [])
    pieces, moved = _assemble(faces, labels, polygon.area, len(seeds))
    hosts = _hosts(pieces, seeds, polygon.area)
    families = {host: [host] for host in hosts.values()}
    cuts: list[_Cut] = []
    for cell, host in hosts.items():
        family = families[host]
        # The largest of what the host was cut into so far, so that no piece becomes a crumb.
        largest = max((pieces[member] for member in family), key=lambda p: p.area if p else 0)
        assert largest is not None
        cuts.append(_cut(cell, Point(seeds[cell]), largest, first=len(family) == 1))
        faces, labels = _faces(polygon, lines, seeds, cuts)
        pieces, moved = _assemble(faces, labels, polygon.area, len(seeds))
        cuts[-1] = replace(cuts[-1], won=pieces[cell])
        family.append(cell)
    whole = [piece for piece in pieces if piece is not None]
    if len(whole) < len(seeds):
        raise ArithmeticError("a Voronoi cell could not be cut; the polygon is too small to divide")
    mends += [Mend("cell in parts", cell, share) for cell, share in moved]
    mends += [Mend("empty cell", c.cell, whole[c.cell].area / polygon.area) for c in cuts]
    return list(shapely.orient_polygons(np.array(whole, dtype=object))), mends


def _hosts(pieces: list[Polygon | None], seeds: Points, area: float) -> dict[int, int]:
    """For each empty cell the piece to cut it from: the one its seed lies in or is nearest to.

    Pieces that are too small to be shared out are passed over.
    """
    enough = HOST / len(pieces) * area
    able = [i for i, piece in enumerate(pieces) if piece is not None and piece.area >= enough]
    return {
        cell: able[int(np.argmin(shapely.distance([pieces[i] for i in able], Point(seeds[cell]))))]
        for cell, piece in enumerate(pieces)
        if piece is None
    }


def _seeds(polygon: Polygon, correspondents: Sequence[Polygon]) -> tuple[Points, list[Mend]]:
    """A distinct seed for each correspondent, (k, 2): its vertex nearest to the centroid.

    Of vertices equally near, the leftmost, then the lowest: no matter where a ring begins.
    """
    centre = shapely.get_coordinates(polygon.centroid)[0]
    reach = np.ptp(shapely.get_coordinates(polygon), axis=0).max()
    tolerance = RELATIVE_TOLERANCE * reach
    seeds = np.empty((0, 2))
    mends = []
    for cell, correspondent in enumerate(correspondents):
        candidates, clashed = shapely.get_coordinates(correspondent), False
        longest = correspondent.exterior.length
        while True:
            distances = np.rint(np.hypot(*(candidates - centre).T) / tolerance)
            order = np.lexsort((candidates[:, 1], candidates[:, 0], distances))
            gaps = np.hypot(*(candidates[order][:, None] - seeds[None]).T).T
            free = (gaps > tolerance).all(axis=1)
            clashed |= not free[0]
            if free.any():
                break
            # All its vertices are others' seeds: take points along its edges, then around it.
            longest /= 2
            if longest > tolerance:
                candidates = shapely.get_coordinates(shapely.segmentize(correspondent, longest))
            else:
                steps = np.arange(1, len(seeds) + 2)[:, None]
                candidates = candidates[:1] + 2 * tolerance * steps * [1.0, 0.0]
        seeds = np.vstack([seeds, candidates[order[np.argmax(free)]]])
        if clashed:
            mends.append(Mend("coincident seeds", cell))
    return seeds, mends


def _voronoi_lines(polygon: Polygon, seeds: Points) -> NDArray[np.object_]:
    """The borders between the cells, reaching beyond the polygon on all sides."""
    box = np.array(shapely.total_bounds([polygon, MultiPoint(seeds)]))
    middle, size = (box[:2] + box[2:]) / 2, (box[2:] - box[:2]).max()
    # In a unit box of its own, whatever the data's scale and place.
    edges = shapely.voronoi_polygons(
        MultiPoint((seeds - middle) / size), extend_to=shapely.box(-2, -2, 2, 2), only_edges=True
    )
    lines = shapely.transform(shapely.get_parts(edges), lambda points: points * size + middle)
    return np.asarray(lines, dtype=object)


def _faces(
    polygon: Polygon, lines: NDArray[np.object_], seeds: Points, cuts: list[_Cut]
) -> tuple[NDArray[np.object_], NDArray[np.intp]]:
    """The faces into which lines and cuts part the polygon, and the cell that each belongs to.

    All linework is noded at once, so that faces share their vertices to the bit.
    """
    faces = _faces_between(polygon, np.concatenate([lines, *(cut.lines for cut in cuts)]))
    places = shapely.get_coordinates(shapely.point_on_surface(faces))
    distances = ((places[:, None] - seeds[None]) ** 2).sum(axis=2)
    labels = distances.argmin(axis=1)
    for cut in cuts:
        if cut.won is not None:
            labels[shapely.contains_xy(cut.won, *places.T)] = cut.cell
            continue
        side = (places - cut.middle) @ cut.inward < 0
        side &= shapely.area(faces) > SLIVER * polygon.area
        there = np.flatnonzero(side & shapely.contains_xy(cut.piece, *places.T))
        nearest = shapely.distance(faces[there], Point(cut.near))
        labels[there[np.lexsort((-shapely.area(faces[there]), nearest))[:1]]] = cut.cell
    return faces, labels


def _faces_between(polygon: Polygon, lines: NDArray[np.object_]) -> NDArray[np.object_]:
    """The faces into which lines part a polygon.

    A line that all but meets a vertex can be noded wrongly and lose a face. Then all lines are
    nudged together, by less than anybody can see.
    """
    reach = np.ptp(shapely.get_coordinates(polygon), axis=0).max()
    shapely.prepare(polygon)
    found = []
    for nudge in range(NUDGES):
        moved = shapely.transform(lines, partial(np.add, nudge * NUDGE * reach * ASKEW))
        noded = shapely.union_all(np.concatenate([[polygon.boundary], moved]))
        faces = shapely.get_parts(shapely.polygonize([noded]))
        faces = faces[shapely.contains(polygon, shapely.point_on_surface(faces))]
        found.append((abs(shapely.area(faces).sum() / polygon.area - 1), nudge, faces))
        if found[-1][0] < SLIVER * 100:
            break
    return min(found, key=lambda attempt: attempt[:2])[2]


def _assemble(
    faces: NDArray[np.object_], labels: NDArray[np.intp], area: float, count: int
) -> tuple[list[Polygon | None], list[tuple[int, float]]]:
    """One connected piece for each label (None where it has no face of any size).

    The largest face of a label stays; every other goes to the neighbour with the longest common
    seam. Also returned: the labels that lost faces, with the share of area that went.
    """
    areas = shapely.area(faces)
    owner = np.full(len(faces), -1)
    for face in np.argsort(-areas, kind="stable"):
        if areas[face] > SLIVER * area and labels[face] not in owner:
            owner[face] = labels[face]
    moved: dict[int, float] = {}
    left, right, lengths = _common_seams(faces)
    while (owner < 0).any():
        open_ = (owner[left] < 0) & (owner[right] >= 0)
        if not open_.any():  # a sliver that shares no whole edge with anything
            owner[owner < 0] = owner[np.argmax(areas)]
            break
        for face in np.unique(left[open_]):
            seams = np.zeros(count)
            mine = open_ & (left == face)
            np.add.at(seams, owner[right[mine]], lengths[mine])
            owner[face] = seams.argmax()
            if owner[face] != labels[face] and areas[face] > SLIVER * area:
                cell = int(labels[face])
                moved[cell] = moved.get(cell, 0.0) + float(areas[face] / area)
    pieces: list[Polygon | None] = []
    for cell in range(count):
        mine = faces[owner == cell]
        pieces.append(_joined(mine) if len(mine) else None)
    return pieces, sorted(moved.items())


def _joined(faces: NDArray[np.object_]) -> Polygon:
    """Faces that hang together by common edges, as one polygon."""
    parts = shapely.get_parts(shapely.coverage_union_all(faces) if len(faces) > 1 else faces[0])
    largest: Polygon = parts[np.argmax(shapely.area(parts))]
    return largest


def _common_seams(
    faces: NDArray[np.object_],
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.float64]]:
    """Pairs of faces with a common edge, both ways round, with that edge's length."""
    rings = rings_of(faces)
    start, end = rings.vertices, rings.vertices[next_vertex(rings.offsets)]
    face = np.repeat(rings.polygon_of, np.diff(rings.offsets))
    ends = undirected(start, end)
    order = np.lexsort(ends.T)
    twin = np.flatnonzero((ends[order][1:] == ends[order][:-1]).all(axis=1))
    one, other = order[twin], order[twin + 1]
    lengths = np.hypot(*(end - start)[one].T)
    return (
        np.concatenate([face[one], face[other]]),
        np.concatenate([face[other], face[one]]),
        np.concatenate([lengths, lengths]),
    )


def _cut(cell: int, seed: Point, piece: Polygon, *, first: bool) -> _Cut:
    """A straight cut through a piece, for the cell of a seed.

    The first takes a corner, half-way from the point nearest to the seed to the innermost one.
    Further ones go through the innermost point, across the longer axis: halves, more or less.
    """
    reach = np.ptp(shapely.get_coordinates(piece), axis=0).max()
    circle = shapely.maximum_inscribed_circle(piece, tolerance=reach * 1e-3)
    inner = shapely.get_coordinates(circle)[0]
    near = shapely.get_coordinates(shapely.shortest_line(piece, seed))[0]
    inward, middle = inner - near, (inner + near) / 2
    if not first or np.hypot(*inward) < RELATIVE_TOLERANCE * reach:
        sides = np.diff(shapely.get_coordinates(shapely.oriented_envelope(piece))[:3], axis=0)
        axis = sides[np.argmax(np.hypot(*sides.T))]
        inward, middle = (axis if axis @ inward >= 0 else -axis), inner
    along = np.array([-inward[1], inward[0]]) * 4 * reach / np.hypot(*inward)
    crossing = shapely.intersection(LineString([middle - along, middle + along]), piece)
    chords = [c for c in shapely.get_parts(crossing) if isinstance(c, LineString)]
    # A little beyond both ends, so that noding meets the piece's border for sure.
    beyond = along * 1e-7
    ends = shapely.get_coordinates(chords).reshape(-1, 2, 2)
    forward = ((ends[:, 1] - ends[:, 0]) @ along > 0)[:, None]
    ends[:, 0] += np.where(forward, -beyond, beyond)
    ends[:, 1] += np.where(forward, beyond, -beyond)
    return _Cut(cell, piece, near, inward, middle, np.asarray(shapely.linestrings(ends)))
