"""Seams: the cut edges of divisions, and vertices that both of their sides share.

A seam is an edge that two pieces of one polygon have in common. Matching adds vertices to
one piece at a time, so that a seam ab may become axb on one side only; after rounding, x
would lie off ab and the seam would gape. Here the other side gets x as well.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.motion.rings import MatchedPiece, Rings, Vertices, next_vertex, undirected
from geotween.motion.tracks import SEAM_AT

# A vertex given to one side at the origin may land on a seam at the target, whose other side then
# needs it, and so on. Such chains nearly always end soon, where a piece's own border begins; a few,
# in symmetric shapes, go round in a circle.
MAX_ROUNDS = 50


def seam_edges(rings: Rings, owner: NDArray[np.intp]) -> NDArray[np.uint8]:
    """1 for each edge that two pieces of one owner share, else 0.

    ``owner`` (m,) says for each piece of ``rings`` of which polygon it is a piece.
    """
    flags = np.zeros(len(rings.vertices), dtype=np.uint8)
    if len(np.unique(owner)) == len(owner):
        return flags
    edges = undirected(rings.vertices, rings.vertices[next_vertex(rings.offsets)])
    owner_of_edge = np.repeat(owner[rings.polygon_of], np.diff(rings.offsets))
    order = np.lexsort((*edges.T, owner_of_edge))
    alike = (edges[order][1:] == edges[order][:-1]).all(axis=1)
    alike &= owner_of_edge[order][1:] == owner_of_edge[order][:-1]
    flags[order[1:][alike]] = 1
    flags[order[:-1][alike]] = 1
    return flags


@dataclass(frozen=True, eq=False)
class SharedPieces:
    """Pieces whose seams have the same vertices on both sides; and how many are still missing."""

    pieces: tuple[MatchedPiece, ...]
    missing: int


@dataclass(frozen=True, eq=False)
class _Seams:
    """The seam edges of all pieces at one end; arrays are parallel, one entry an edge.

    ``piece`` and ``edge`` are numbers, ``owner`` that of the polygon which the piece is cut from;
    ``start`` and ``stop`` (m, 2) are places.
    """

    piece: NDArray[np.intp]
    edge: NDArray[np.intp]
    following: NDArray[np.intp]
    owner: NDArray[np.intp]
    start: Vertices
    stop: Vertices

    @classmethod
    def at(cls, pieces: Sequence[MatchedPiece], owner: NDArray[np.intp], end: int) -> _Seams | None:
        """The seams at one end, or None where there are none."""
        found = [(i, p, np.flatnonzero(p.seams & SEAM_AT[end])) for i, p in enumerate(pieces)]
        found = [(i, p, edges) for i, p, edges in found if len(edges)]
        if not found:
            return None
        piece = np.repeat([i for i, _, _ in found], [len(edges) for _, _, edges in found])
        nexts = [next_vertex(p.offsets)[edges] for _, p, edges in found]
        return cls(
            piece,
            np.concatenate([edges for _, _, edges in found]),
            np.concatenate(nexts),
            owner[piece],
            np.concatenate([p.vertices[end][edges] for _, p, edges in found]),
            np.concatenate(
                [p.vertices[end][after] for (_, p, _), after in zip(found, nexts, strict=True)]
            ),
        )

    def corners(self) -> tuple[Vertices, NDArray[np.intp]]:
        """The different places of seam vertices, and the polygon of each."""
        places = np.concatenate([self.start, self.stop])
        owner = np.concatenate([self.owner, self.owner])
        rows = np.unique(np.column_stack([places, owner]), axis=0)
        return rows[:, :2], rows[:, 2].astype(np.intp)


def share_vertices(
    pieces: Sequence[MatchedPiece], indices: NDArray[np.intp], tolerance: float
) -> SharedPieces:
    """Give each seam the vertices of both of its sides, at both ends of the transition.

    ``indices`` (m, 2) are the polygons whose pieces these are; ``tolerance`` is in the data's
    units. Cost: n log n for n seam vertices, times the length of the longest chain.
    """
    pieces = list(pieces)
    missing = 0
    for _ in range(MAX_ROUNDS):
        missing = 0
        for end in (0, 1):
            seams = _Seams.at(pieces, indices[:, end], end)
            if seams is None:
                continue
            if _snap(pieces, seams, end, tolerance):
                seams = _Seams.at(pieces, indices[:, end], end)
                assert seams is not None
            for piece, (edges, shares, points) in _additions(seams, tolerance).items():
                pieces[piece] = _with_vertices(pieces[piece], end, edges, shares, points)
                missing += len(edges)
        if not missing:
            break
    return SharedPieces(tuple(pieces), missing)


def _snap(pieces: list[MatchedPiece], seams: _Seams, end: int, tolerance: float) -> bool:
    """Make seam vertices of one polygon that are the same but for rounding equal to the bit."""
    corners, owner = seams.corners()
    tree = shapely.STRtree(_points(corners))
    one, other = tree.query(_points(corners), predicate="dwithin", distance=tolerance)
    near = (one < other) & (owner[one] == owner[other])
    if not near.any():
        return False
    canonical = np.arange(len(corners))
    np.minimum.at(canonical, other[near], one[near])
    moved = {
        (int(owner[i]), *corners[i].tolist()): corners[canonical[i]] for i in np.unique(other[near])
    }
    for piece in np.unique(seams.piece):
        vertices = pieces[piece].vertices.copy()
        mine = seams.piece == piece
        number = int(seams.owner[np.argmax(mine)])
        for k in np.unique(np.concatenate([seams.edge[mine], seams.following[mine]])):
            place = moved.get((number, *vertices[end, k].tolist()))
            if place is not None:
                vertices[end, k] = place
        pieces[piece] = replace(pieces[piece], vertices=vertices)
    return True


Additions = dict[int, tuple[NDArray[np.intp], NDArray[np.float64], Vertices]]


def _additions(seams: _Seams, tolerance: float) -> Additions:
    """Per piece the edges to part, the share along each, and the vertices to put there."""
    corners, corner_owner = seams.corners()
    lines: Any = shapely.linestrings(np.stack([seams.start, seams.stop], axis=1))
    tree = shapely.STRtree(lines)
    corner, hit = tree.query(_points(corners), predicate="dwithin", distance=tolerance)
    mine = corner_owner[corner] == seams.owner[hit]
    corner, hit = corner[mine], hit[mine]
    way = seams.stop[hit] - seams.start[hit]
    length = np.hypot(*way.T)
    along = ((corners[corner] - seams.start[hit]) * way).sum(axis=1) / np.where(
        length > 0, length, 1
    )
    inner = (along > tolerance) & (along < length - tolerance)
    corner, hit, share = corner[inner], hit[inner], along[inner] / length[inner]

    found: Additions = {}
    for piece in np.unique(seams.piece[hit]):
        these = np.flatnonzero(seams.piece[hit] == piece)
        these = these[np.lexsort((share[these], seams.edge[hit[these]]))]
        found[int(piece)] = (seams.edge[hit[these]], share[these], corners[corner[these]])
    return found


def _points(places: Vertices) -> Any:
    return shapely.points(places)


def _with_vertices(
    piece: MatchedPiece,
    end: int,
    edges: NDArray[np.intp],
    shares: NDArray[np.float64],
    points: Vertices,
) -> MatchedPiece:
    """A piece with vertices put into edges.

    At one end they are the given points, at the other the same share of the way along the matched
    edge.
    """
    following = next_vertex(piece.offsets)[edges]
    added = np.empty((2, len(edges), 2))
    added[end] = points
    start, stop = piece.vertices[1 - end][edges], piece.vertices[1 - end][following]
    added[1 - end] = start + shares[:, None] * (stop - start)
    return replace(
        piece,
        vertices=np.insert(piece.vertices, edges + 1, added, axis=1),
        offsets=piece.offsets + np.searchsorted(edges, piece.offsets),
        seams=np.insert(piece.seams, edges + 1, piece.seams[edges]),
    )
