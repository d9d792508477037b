"""Territory by weights: borders that give each area a wanted share of a polygon.

The additively weighted Voronoi diagram of areas: a place goes to the area whose distance, less its
weight, is least. Distances are negative within an area, so that one may also lose of its own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon

from geotween.motion.divide.faces import Ints, Points, Shapes
from geotween.motion.divide.nearest import thinned

# The lattice over the polygon's box on which weights are fitted and borders are drawn.
CELLS = 128

# Shares fit when none is off by more than this part of itself; how often weights are corrected,
# and by how much of what seems to be wrong, as its neighbours move, too.
FIT, SWEEPS, DAMPING = 0.01, 100, 0.5

# How densely outlines are sampled to measure distances, in shares of the polygon's extent.
SAMPLES = 1 / 1024


@dataclass(frozen=True, eq=False)
class Weighted:
    """Areas (k,) and their weights (k,), in a box of unit size around ``middle``."""

    areas: Shapes
    weights: Points
    middle: Points
    extent: float

    def label(self, places: Points) -> Ints:
        """The area (f,) that each place goes to."""
        at = (places - self.middle) / self.extent
        return np.asarray((_distances(self.areas, at) - self.weights[:, None]).argmin(axis=0))


def weighted(polygon: Polygon, areas: Shapes, shares: Points) -> tuple[Weighted, Shapes]:
    """Weights that give areas (k,) their shares (k,) of a polygon, and the borders between them.

    Shares fit within ``FIT`` and what the lattice leaves open, some cells along the borders.
    Cost: k distances for each point of the lattice, and up to ``SWEEPS`` sorts of them.
    """
    box = np.array(polygon.bounds)
    middle, extent = (box[:2] + box[2:]) / 2, float((box[2:] - box[:2]).max())
    shapes = shapely.transform(areas, lambda points: (points - middle) / extent)
    # A cell more on all sides, so that borders reach beyond the outline.
    ticks = (np.arange(CELLS + 3) - 1) / CELLS - 0.5
    size = (box[2:] - box[:2]) / extent
    x, y = np.meshgrid(ticks * size[0], ticks * size[1])
    points = np.column_stack([x.ravel(), y.ravel()])
    shapely.prepare(polygon)
    inside = shapely.contains_xy(polygon, *(points * extent + middle).T)
    distances = _distances(shapes, points)
    weights = _fitted(distances[:, inside], shares / shares.sum())
    lines, sides = _between(points, distances - weights[:, None])
    found = Weighted(shapes, weights, middle, extent)
    return found, np.asarray(
        shapely.transform(thinned(lines, sides), lambda points: points * extent + middle),
        dtype=object,
    )


def _distances(areas: Shapes, points: Points) -> Points:
    """The distance (k, n) of each point from the outline of each area, negative within."""
    from scipy.spatial import cKDTree

    found = np.empty((len(areas), len(points)))
    shapely.prepare(areas)
    for row, area in zip(found, areas, strict=True):
        outline = shapely.get_coordinates(shapely.segmentize(shapely.boundary(area), SAMPLES))
        row[:] = cKDTree(outline).query(points)[0]
        row[shapely.contains_xy(area, *points.T)] *= -1
    return found


def _fitted(distances: Points, shares: Points) -> Points:
    """Weights (k,) that give each area its share of some points; ``distances`` is (k, n).

    Each area gets the weight that would fit if the others kept theirs; all at once, half-way.
    """
    count = distances.shape[1]
    weights = np.zeros(len(shares))
    if not count:
        return weights
    wanted = np.rint(shares * count).astype(np.intp).clip(1, count - 1)
    for _ in range(SWEEPS):
        lead = distances - weights[:, None]
        owner = lead.argmin(axis=0)
        sizes = np.bincount(owner, minlength=len(shares))
        if (np.abs(sizes - wanted) <= np.maximum(FIT * wanted, 1)).all():
            break
        least, second = np.partition(lead, 1, axis=0)[:2]
        for k in range(len(shares)):
            # The weight that each point would cost, above which it is this area's.
            price = distances[k] - np.where(owner == k, second, least)
            between = np.partition(price, [wanted[k] - 1, wanted[k]])[wanted[k] - 1 : wanted[k] + 1]
            weights[k] += DAMPING * (between.mean() - weights[k])
        weights -= weights.mean()
    return weights


def _between(points: Points, lead: Points) -> tuple[Shapes, Ints]:
    """The lines on which the least of some fields (k, n) on the lattice changes, and the two."""
    side = CELLS + 3
    corner = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    triangles = np.concatenate(
        [corner[:, None] + [0, 1, side + 1], corner[:, None] + [0, side + 1, side]]
    )
    owner = lead.argmin(axis=0)
    triangles = np.sort(triangles[np.ptp(owner[triangles], axis=1) > 0], axis=1)
    one, other = triangles[:, [0, 0, 1]], triangles[:, [1, 2, 2]]
    differs = owner[one] != owner[other]
    a, b = owner[one], owner[other]
    before, after = lead[b, one] - lead[a, one], lead[b, other] - lead[a, other]
    share = np.where(differs, before, 0) / np.where(differs, before - after, 1)
    crossing = points[one] + share.clip(0, 1)[..., None] * (points[other] - points[one])
    pairs = np.sort(np.stack([a, b], axis=-1), axis=-1)

    two = np.flatnonzero(differs.sum(axis=1) == 2)
    ends, sides = crossing[two][differs[two]].reshape(-1, 2, 2), pairs[two][differs[two]][::2]
    three = np.flatnonzero(differs.all(axis=1))
    centre = np.broadcast_to(crossing[three].mean(axis=1, keepdims=True), (len(three), 3, 2))
    spokes = np.stack([crossing[three], centre], axis=2).reshape(-1, 2, 2)
    ends = np.concatenate([ends, spokes])
    sides = np.concatenate([sides, pairs[three].reshape(-1, 2)])
    real = (ends[:, 0] != ends[:, 1]).any(axis=1)
    lines: NDArray[np.object_] = np.asarray(shapely.linestrings(ends[real]), dtype=object)
    return lines, sides[real]
