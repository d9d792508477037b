"""Triangles of quadtree cells that lie inside: a rectangle in four triangles, and its kin.

All templates are fans around the centre, with two triangles instead of one on each side at whose
middle a finer neighbour has a corner. So there are sixteen, from four triangles to eight, and
every triangle of every one is a right isosceles one.
"""

from __future__ import annotations

import numpy as np

from geotween.mesh.cells import Floats, Grid, Ints, Leaves, Mask

# Corners and middles of the sides, anticlockwise from the lower left, and the centre; in halves.
PLACES = np.array([(0, 0), (1, 0), (2, 0), (2, 1), (2, 2), (1, 2), (0, 2), (0, 1), (1, 1)])
CENTRE = 8
MOST = 8  # triangles in a template


def _template(halved: Mask) -> list[tuple[int, int, int]]:
    rim = [place for place in range(CENTRE) if place % 2 == 0 or halved[place // 2]]
    return [(CENTRE, *side) for side in zip(rim, rim[1:] + rim[:1], strict=True)]


def _templates() -> tuple[Ints, Ints]:
    """Templates (16, MOST, 3) by the sides that are halved, in bits, and their lengths (16,)."""
    table = np.zeros((16, MOST, 3), dtype=np.int64)
    lengths = np.zeros(16, dtype=np.int64)
    for mask in range(16):
        triangles = _template((mask >> np.arange(4) & 1).astype(bool))
        lengths[mask] = len(triangles)
        table[mask, : len(triangles)] = triangles
    return table, lengths


TEMPLATES, LENGTHS = _templates()


def triangulated(leaves: Leaves, grid: Grid) -> Floats:
    """Triangles (t, 3, 2), anticlockwise, that fill leaves and conform with their neighbours."""
    mask = leaves.halved @ (1 << np.arange(4))
    places = grid.places(leaves.low[:, None] + leaves.size[:, None, None] // 2 * PLACES)
    used = np.arange(MOST) < LENGTHS[mask][:, None]
    leaf = np.repeat(np.arange(len(mask)), LENGTHS[mask])
    return np.asarray(places[leaf[:, None], TEMPLATES[mask][used]])
