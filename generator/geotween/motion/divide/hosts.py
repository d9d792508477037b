"""Hosts: the pieces from which cells are cut that would be empty."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from geotween.motion.divide.cuts import cut_off
from geotween.motion.divide.faces import Piece, Shapes, array_of, largest_part, together

# So much of an equal part of the area each cell needs that is cut from a host.
HOST = 1e-2


def filled(
    pieces: Sequence[Piece | None], aims: Sequence[BaseGeometry], area: float
) -> tuple[list[Piece], list[Shapes]]:
    """Pieces without a gap, those missing cut from hosts; and the lines of these cuts.

    A host gives a corner first; then always the largest of what it was cut into is halved, so
    that no piece becomes a crumb.
    """
    whole: list[Any] = list(pieces)
    families: dict[int, list[int]] = {}
    lines: list[Shapes] = []
    for cell, host in _hosts(pieces, aims, area).items():
        family = families.setdefault(host, [host])
        giver = max(family, key=lambda member: largest_part(shapely.get_parts(whole[member])).area)
        parts = shapely.get_parts(whole[giver])
        main = int(np.argmax(shapely.area(parts)))
        cut = cut_off(parts[main], aims[cell], corner=len(family) == 1)
        if cut is None:
            raise ArithmeticError("a piece could not be cut; the polygon is too small to divide")
        whole[cell] = cut.won
        parts[main] = cut.left
        whole[giver] = together(parts)
        lines.append(cut.lines)
        family.append(cell)
    return whole, lines


def _hosts(
    pieces: Sequence[Piece | None], aims: Sequence[BaseGeometry], area: float
) -> dict[int, int]:
    """For each empty cell the piece to cut it from: the one nearest to its aim.

    Of several that its aim meets, the one that shares most with it. A piece is passed over where
    it is too small to be shared by one more.
    """
    able = [k for k, piece in enumerate(pieces) if piece is not None]
    candidates = array_of(pieces[k] for k in able)
    room = np.floor(shapely.area(candidates) / (HOST * area / len(pieces)))
    hosts = {}
    for cell in (k for k, piece in enumerate(pieces) if piece is None):
        gaps = np.where(room >= 1, shapely.distance(candidates, aims[cell]), np.inf)
        ties = np.flatnonzero(gaps == gaps.min())
        if len(ties) > 1:
            shared = shapely.area(shapely.intersection(candidates[ties], aims[cell]))
            ties = ties[[np.argmax(shared)]]
        hosts[cell] = able[int(ties[0])]
        room[ties[0]] -= 1
    return hosts
