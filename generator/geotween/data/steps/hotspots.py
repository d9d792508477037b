"""Points with a period each, as hotspots: contours of their kernel density."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon

# Sides of a grid cell in a bandwidth. With 4, half of the vertices lie within 0.003 bandwidths of
# the contour of the exact density and 99 of 100 within 0.02, the others where it is all but flat;
# the peak is right to 1%. More cells would add vertices, not shape.
CELLS_PER_BANDWIDTH = 4

# The kernel ends at so many bandwidths, where it has fallen to FAINTEST of its height: a contour
# at less than this share of the peak would follow that end.
REACH = 5
FAINTEST = 4e-6
PADDING = CELLS_PER_BANDWIDTH * REACH + 2  # cells around the points; the outermost stay 0

# Nodes of the grids of all periods together: 256 MB.
MOST_NODES = 2**25

# Share of a cell, and of a threshold, that rounding may not decide about: whether the points'
# extent asks for one more cell, and on which side of a contour a node lies.
TOLERANCE = 1e-6

# A polygon of fewer square cells than this is none: it is smaller than the grid's accuracy.
SLIVER = 1e-4

# Farther from the origin than this, in bandwidths, double precision moves vertices by more than
# a tenth of what TOLERANCE keeps them apart.
FARTHEST = 1e8


@dataclass(frozen=True, eq=False)
class Hotspots:
    """The areas in which points lie densest, period by period and level by level.

    ``polygons[p][k]`` is where the density of period ``p`` exceeds ``thresholds[k]``: valid,
    outer rings counter-clockwise, within ``polygons[p][k - 1]``, empty where there is none.
    Thresholds ascend; they and ``peak``, the highest density of any period, are in points per
    square unit of the map and period. ``bandwidth``, the standard deviation of the Gaussian
    kernel, and ``cell``, the side of a grid cell, are in units of the map.
    """

    polygons: tuple[tuple[MultiPolygon, ...], ...]
    thresholds: tuple[float, ...]
    bandwidth: float
    cell: float
    peak: float


@dataclass(frozen=True, eq=False)
class Grid:
    """Square cells centred on ``centre`` (2,), in map units; ``shape`` counts nodes in y and x."""

    centre: NDArray[np.float64]
    cell: float
    shape: tuple[int, int]

    @property
    def middle(self) -> NDArray[np.float64]:
        """The node coordinates (2,), x and y, of the centre: whole or half numbers."""
        return (np.array(self.shape[::-1]) - 1) / 2

    def on_grid(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Points (n, 2) of the map in node coordinates."""
        return (points - self.centre) / self.cell + self.middle

    def on_map(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Points (n, 2) in node coordinates on the map."""
        return (points - self.middle) * self.cell + self.centre


def hotspots(
    points: NDArray[np.float64],
    period: NDArray[np.intp],
    periods: int,
    *,
    levels: Sequence[float],
    relative: bool,
    bandwidth: float | None = None,
) -> Hotspots:
    """Contour the kernel density of points, with one bandwidth and one scale for all periods.

    Binned kernel density estimation (M. P. Wand, Fast computation of multivariate kernel
    estimators, 1994): each point is shared out linearly among the four nodes around it, the
    counts are convolved with a Gaussian, and marching squares trace the thresholds. Linear in
    the nodes of the grid, whatever the number of points, but for sorting these. The order of
    the points does not matter.

    Parameters
    ----------
    points : array of shape (n, 2), in a projection whose units are equally long in x and y
    period : array of shape (n,), the period of each point, from 0 to ``periods`` - 1
    periods : how many there are
    levels : thresholds, in any order
    relative : whether levels are shares, between 0 and 1, of the highest density of any period,
        or else points per square unit and period
    bandwidth : standard deviation of the kernel in map units; `scott_bandwidth` by default

    Raises
    ------
    ValueError
        There are no points, or one is not finite or lies too far from the origin for the
        bandwidth; the levels are none, repeated or out of range; the bandwidth is not positive,
        too small for the extent of the points (the message says the smallest that works), or
        not given where all points lie in one place.
    """
    _check_points(points, period, periods)
    shares = _checked_levels(levels, relative)
    order = np.lexsort(points.T)  # sums depend on the order, by rounding
    points, period = points[order], period[order]
    h = scott_bandwidth(points, period) if bandwidth is None else float(bandwidth)
    grid = grid_over(points, h, periods)

    densities = [density(points[period == p], grid) for p in range(periods)]
    peak = max(_peak(d) for d in densities)
    square = grid.cell**2
    thresholds = shares * (peak if relative else square)
    if thresholds[0] < FAINTEST * peak:
        share = thresholds[0] / peak
        raise ValueError(
            f"a level is too low: {share:.1g} of the highest density; it must be {FAINTEST:g} of it"
        )
    polygons = tuple(_above(d, thresholds, grid) for d in densities)
    return Hotspots(
        polygons, tuple((thresholds / square).tolist()), h, grid.cell, float(peak / square)
    )


def scott_bandwidth(points: NDArray[np.float64], period: NDArray[np.intp]) -> float:
    """Scott's rule for two dimensions, the spread times n to the power -1/6, in map units.

    The spread is that of all points (n, 2) together, and n their mean number in the periods
    (n,) that have any, so that the bandwidth suits each period. The spread is the smaller of the
    standard deviation per axis and the one that a normal distribution with the same median
    distance from the median point would have; so a few points far away do not count, and
    neither does the orientation of the axes.

    Raises
    ------
    ValueError
        All points lie in one place.
    """
    if not np.ptp(points, axis=0).any():
        raise ValueError("all points lie in the same place: give a bandwidth")
    deviation = np.sqrt(((points - points.mean(axis=0)) ** 2).sum(axis=1).mean() / 2)
    squares = ((points - np.median(points, axis=0)) ** 2).sum(axis=1)
    typical = np.sqrt(np.median(squares) / (2 * np.log(2)))
    # Where half of the points coincide, only the others tell of a spread.
    spread = min(deviation, typical) if typical else deviation
    return float(spread * (len(points) / len(np.unique(period))) ** (-1 / 6))


def grid_over(points: NDArray[np.float64], bandwidth: float, periods: int) -> Grid:
    """The grid on which the density of points (n, 2) is computed: common to all periods.

    It is centred on the points and reaches so far beyond them that the density is 0 on its rim.

    Raises
    ------
    ValueError
        The bandwidth is not positive, or too small for the extent of the points or for their
        distance from the origin.
    """
    if not 0 < bandwidth < np.inf:
        raise ValueError(f"the bandwidth must be a positive number, not {bandwidth:g}")
    if bandwidth * FARTHEST < np.abs(points).max():
        raise ValueError(
            f"the bandwidth, {bandwidth:g}, is too small to tell places apart "
            f"at coordinates of {np.abs(points).max():g}"
        )
    low, high = points.min(axis=0), points.max(axis=0)
    cells = (high - low) * CELLS_PER_BANDWIDTH / bandwidth
    nodes = np.ceil(cells - TOLERANCE) + 2 * PADDING + 1
    if nodes.prod() * periods > MOST_NODES:
        raise ValueError(_too_fine(high - low, bandwidth, periods))
    columns, rows = nodes.astype(int).tolist()
    return Grid(low + (high - low) / 2, bandwidth / CELLS_PER_BANDWIDTH, (rows, columns))


def density(points: NDArray[np.float64], grid: Grid) -> NDArray[np.float64]:
    """The density of points (n, 2) at the nodes of a grid, in points per cell; its sum is n."""
    from scipy.ndimage import gaussian_filter

    if not len(points):
        return np.zeros(grid.shape)
    placed = grid.on_grid(points)
    corner = np.floor(placed).astype(np.intp)
    right, up = (placed - corner).T
    columns = grid.shape[1]
    node = corner[:, 1] * columns + corner[:, 0]
    nodes = np.concatenate([node, node + 1, node + columns, node + columns + 1])
    shares = np.concatenate(
        [(1 - right) * (1 - up), right * (1 - up), (1 - right) * up, right * up]
    )
    counts = np.bincount(nodes, shares, minlength=grid.shape[0] * columns).reshape(grid.shape)
    # Sharing out widens each point by a sixth of a squared cell on average: the kernel has less.
    sigma = np.sqrt(CELLS_PER_BANDWIDTH**2 - 1 / 6)
    radius = CELLS_PER_BANDWIDTH * REACH
    return gaussian_filter(counts, sigma, output=np.float64, mode="constant", radius=radius)


def _peak(field: NDArray[np.float64]) -> float:
    """The highest value of a field, between its nodes too.

    By parabolas through the logarithms at the highest node and its neighbours in x and y, which
    is exact for a single Gaussian.
    """
    y, x = np.unravel_index(field.argmax(), field.shape)
    if not field[y, x]:
        return 0.0
    rise = 0.0
    for before, after in ((field[y, x - 1], field[y, x + 1]), (field[y - 1, x], field[y + 1, x])):
        low, high = np.log(before / field[y, x]), np.log(after / field[y, x])
        if low + high < 0:
            rise -= (high - low) ** 2 / (8 * (low + high))
    return float(field[y, x] * np.exp(rise))


def _above(
    field: NDArray[np.float64], thresholds: NDArray[np.float64], grid: Grid
) -> tuple[MultiPolygon, ...]:
    """Where a field (in points per cell) exceeds each threshold, on the map.

    Values of the field that all but equal a threshold are put just below it, in place.
    """
    from contourpy import FillType, contour_generator

    if field.max() <= thresholds[0]:
        return (MultiPolygon(),) * len(thresholds)
    for threshold in thresholds:  # a contour through a node would meet itself there, invalid
        field[np.abs(field - threshold) < TOLERANCE * threshold] = threshold * (1 - TOLERANCE)
    tracer = contour_generator(z=field, fill_type=FillType.ChunkCombinedOffsetOffset)
    found = []
    for threshold in thresholds:
        traced: Any = tracer.filled(threshold, np.inf)  # the type depends on fill_type
        [vertices], [rings], [polygons] = traced
        if vertices is None:
            found.append(MultiPolygon())
        else:
            found.append(_polygons(grid.on_map(vertices), (rings, polygons), grid.cell))
    return tuple(found)


def _polygons(
    vertices: NDArray[np.float64], offsets: tuple[NDArray[np.uint32], ...], cell: float
) -> MultiPolygon:
    """Polygons from vertices (n, 2) and the offsets of rings and polygons in them, no slivers."""
    ragged = tuple(part.astype(np.int64) for part in offsets)
    traced = shapely.from_ragged_array(shapely.GeometryType.POLYGON, vertices, ragged)
    parts = traced[shapely.area(traced) > SLIVER * cell**2]
    return MultiPolygon(list(shapely.orient_polygons(parts, exterior_cw=False)))


def _check_points(points: NDArray[np.float64], period: NDArray[np.intp], periods: int) -> None:
    if not len(points):
        raise ValueError("there are no points")
    if points.shape != (len(period), 2):
        raise ValueError(f"points {points.shape} and periods {period.shape} do not go together")
    wrong = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(wrong):
        raise ValueError(f"point {wrong[0] + 1} has a coordinate that is not a finite number")
    outside = np.flatnonzero((period < 0) | (period >= periods))
    if len(outside):
        raise ValueError(f"point {outside[0] + 1} lies in none of the {periods} periods")


def _checked_levels(levels: Sequence[float], relative: bool) -> NDArray[np.float64]:
    """Levels in ascending order."""
    if not len(levels):
        raise ValueError("there are no levels")
    most, means = (1, "between 0 and 1") if relative else (np.inf, "a positive number")
    for level in levels:
        if not 0 < level < most:
            raise ValueError(f"a level must be {means}, not {level:g}")
    ascending = np.unique(np.asarray(levels, dtype=float))
    if len(ascending) < len(levels):
        raise ValueError("a level is given twice")
    return ascending


def _too_fine(sides: NDArray[np.float64], bandwidth: float, periods: int) -> str:
    """What to say of a bandwidth that asks for too large a grid, with the smallest that works."""
    rim = 2 * PADDING + 2  # a node more than needed, for what is rounded up to a whole cell
    room = MOST_NODES / periods - rim**2
    if room <= 0:
        return f"{periods} periods are too many: at most {MOST_NODES // (rim + 1) ** 2} work"
    # (rim + a k) (rim + b k) = MOST_NODES / periods, for k cells per unit
    linear, square = rim * sides.sum(), sides.prod()
    finest = 2 * room / (linear + np.sqrt(linear**2 + 4 * square * room))
    smallest = CELLS_PER_BANDWIDTH / finest
    digit = 10.0 ** (np.floor(np.log10(smallest)) - 2)
    return (
        f"the bandwidth, {bandwidth:g}, is too small for points that spread over "
        f"{sides[0]:g} by {sides[1]:g}: at least {np.ceil(smallest / digit) * digit:.3g} works"
    )
