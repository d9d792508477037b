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

# A vertex given to one side at the origin may land on a seam at the target, whose other side then
# needs it, and so on; such chains end where a piece's own border begins.
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
            additions = _additions(pieces, indices[:, end], end, tolerance)
            for piece, (edges, shares, points) in additions.items():
                pieces[piece] = _with_vertices(pieces[piece], end, edges, shares, points)
                missing += len(edges)
        if not missing:
            break
    return SharedPieces(tuple(pieces), missing)


Additions = dict[int, tuple[NDArray[np.intp], NDArray[np.float64], Vertices]]


def _additions(
    pieces: Sequence[MatchedPiece], owner: NDArray[np.intp], end: int, tolerance: float
) -> Additions:
    """Per piece the edges to part, the share along each, and the vertices to put there."""
    seamed = [i for i, piece in enumerate(pieces) if (piece.seams & (1 << end)).any()]
    if not seamed:
        return {}
    starts, ends, piece_of, edge_of = [], [], [], []
    for i in seamed:
        piece = pieces[i]
        edges = np.flatnonzero(piece.seams & (1 << end))
        starts.append(piece.vertices[end][edges])
        ends.append(piece.vertices[end][next_vertex(piece.offsets)[edges]])
        piece_of.append(np.full(len(edges), i))
        edge_of.append(edges)
    start, stop = np.concatenate(starts), np.concatenate(ends)
    of_piece, edge = np.concatenate(piece_of), np.concatenate(edge_of)

    corners = np.concatenate([start, stop])
    corner_owner = np.concatenate([owner[of_piece], owner[of_piece]])
    _, first = np.unique(np.column_stack([corners, corner_owner]), axis=0, return_index=True)
    corners, corner_owner = corners[first], corner_owner[first]

    lines: Any = shapely.linestrings(np.stack([start, stop], axis=1))
    tree = shapely.STRtree(lines)
    corner, hit = tree.query(shapely.points(corners), predicate="dwithin", distance=tolerance)
    mine = corner_owner[corner] == owner[of_piece[hit]]
    corner, hit = corner[mine], hit[mine]
    way = stop[hit] - start[hit]
    length = np.hypot(*way.T)
    along = ((corners[corner] - start[hit]) * way).sum(axis=1) / np.where(length > 0, length, 1)
    inner = (along > tolerance) & (along < length - tolerance)
    corner, hit = corner[inner], hit[inner]
    share = along[inner] / length[inner]

    found: Additions = {}
    for i in np.unique(of_piece[hit]):
        these = np.flatnonzero(of_piece[hit] == i)
        these = these[np.lexsort((share[these], edge[hit[these]]))]
        found[int(i)] = (edge[hit[these]], share[these], corners[corner[these]])
    return found


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
