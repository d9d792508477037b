"""Write the data of fire.yaml and hotspots.yaml beside this script.

Both are illustrative. The fire is grown by shortest paths over a seeded map of how readily each
cell burns, with a west wind and a few spot fires; the incidents are seeded random points around a
few places in an invented city. The seeds are fixed, so the files come out the same, byte for byte,
every time.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from datetime import date, timedelta
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter, zoom
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra
from shapely import Polygon, box, union_all
from shapely.geometry.polygon import orient

Grid = NDArray[np.float64]
HERE = Path(__file__).parent


def areas(
    field: Grid, cell: float, round_off: float, smallest: float, hole: float
) -> list[Polygon]:
    """The areas where a field is positive, smoothed, without specks, largest first."""
    finer = 3
    fine = zoom(field, finer, order=1, grid_mode=True, mode="nearest") > 0
    size = cell / finer
    runs = []
    for row, inside in enumerate(fine):
        edges = np.flatnonzero(np.diff(np.r_[0, inside.astype(int), 0]))
        runs += [
            box(a * size, row * size, b * size, (row + 1) * size) for a, b in edges.reshape(-1, 2)
        ]
    merged = union_all(runs).buffer(round_off).buffer(-2 * round_off).buffer(round_off)
    found: list[Polygon] = []
    for part in getattr(merged, "geoms", [merged]):
        if part.area < smallest:
            continue
        kept = [ring for ring in part.interiors if Polygon(ring).area >= hole]
        shape = Polygon(part.exterior, kept).simplify(cell * 0.35)
        if isinstance(shape, Polygon):
            found.append(shape)
    return sorted(found, key=lambda p: -p.area)


def feature(polygon: Polygon, **properties: float) -> str:
    """A polygon as a GeoJSON feature, in one line."""
    rings = []
    for ring in orient(polygon).exterior, *orient(polygon).interiors:
        points = [[round(x, 2) + 0.0, round(y, 2) + 0.0] for x, y in ring.coords]
        rings.append(points)
    geometry = {"type": "Polygon", "coordinates": rings}
    return json.dumps({"type": "Feature", "properties": properties, "geometry": geometry})


def write(name: str, lines: list[str]) -> None:
    (HERE / name).write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")


DAYS = 6
FIRE_SHAPE, FIRE_CELL = (80, 120), 0.1  # rows, columns, kilometres
LAKE = [(6.8, 6.6), (7.6, 6.3), (8.4, 6.4), (9.1, 6.8), (9.2, 7.2), (8.3, 7.4), (7.3, 7.2)]
TOWN = [(9.6, 1.0), (10.2, 0.8), (10.9, 1.0), (11.1, 1.6), (10.7, 2.1), (10.0, 2.0), (9.5, 1.6)]
SPOTS = [
    (4.3, 2.1, 1.6),
    (6.6, 5.2, 2.5),
    (8.3, 2.4, 3.45),
    (9.5, 5.0, 4.5),
]  # x, y, day of ignition
WET = [
    (2.4, 3.6, 0.42),
    (3.9, 4.9, 0.46),
    (5.4, 3.2, 0.44),
    (7.0, 4.3, 0.44),
]  # x, y, radius of patches which burn late


def arrival() -> Grid:
    """The day on which the fire reaches each cell."""
    rng = np.random.default_rng(1917)
    rows, columns = FIRE_SHAPE
    noise = gaussian_filter(rng.normal(size=FIRE_SHAPE), 5)
    slow = np.exp(0.35 * noise / noise.std())
    y, x = (np.indices(FIRE_SHAPE) + 0.5) * FIRE_CELL
    for cx, cy, radius in WET:
        slow[np.hypot(x - cx, y - cy) < radius] *= 11
    slow[y < 0.4] *= 6  # bare ground along the southern edge
    lake, town = Polygon(LAKE).buffer(0.1), Polygon(TOWN).buffer(0.15)
    for r in range(rows):
        for c in range(columns):
            spot = box(x[r, c], y[r, c], x[r, c] + 1e-6, y[r, c] + 1e-6)
            if lake.contains(spot) or town.contains(spot):
                slow[r, c] = 1e3
    index = np.arange(rows * columns).reshape(FIRE_SHAPE)
    starts, ends, days = [], [], []
    steps = [
        (-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1),
        (1, 2), (-1, 2), (1, -2), (-1, -2), (2, 1), (2, -1), (-2, 1), (-2, -1),
    ]  # fmt: skip
    for dr, dc in steps:
        here = (slice(max(0, -dr), rows - max(0, dr)), slice(max(0, -dc), columns - max(0, dc)))
        there = (slice(max(0, dr), rows + min(0, dr)), slice(max(0, dc), columns + min(0, dc)))
        length = FIRE_CELL * np.hypot(dr, dc)
        speed = 0.43 + 0.40 * dc / np.hypot(
            dr, dc
        )  # kilometres a day; the wind blows from the west
        starts.append(index[here].ravel())
        ends.append(index[there].ravel())
        days.append((length / speed * 0.5 * (slow[here] + slow[there])).ravel())
    size = rows * columns
    graph = csr_array(
        (np.concatenate(days), (np.concatenate(starts), np.concatenate(ends))), shape=(size, size)
    )
    day = np.full(size, np.inf)
    for sx, sy, when in [(1.4, 3.9, 0.05), *SPOTS]:
        source = index[int(sy / FIRE_CELL), int(sx / FIRE_CELL)]
        day = np.minimum(day, when + dijkstra(graph, indices=source))
    return day.reshape(FIRE_SHAPE)


def fire() -> None:
    day = arrival()
    rows = []
    before: list[Polygon] = []
    for n in range(1, DAYS + 1):
        field = np.clip(n - gaussian_filter(np.minimum(day, 9), 1.0), -2, 2)
        polygons = areas(field, FIRE_CELL, 0.12, 0.06, 0.035)
        # An island of unburnt forest is mapped only once the front has passed it for a day.
        mapped = [Polygon(p.exterior) for p in before]
        polygons = [
            Polygon(
                p.exterior, [h for h in p.interiors if any(m.contains(Polygon(h)) for m in mapped)]
            )
            for p in polygons
        ]
        rows += [feature(p, day=n) for p in polygons]
        before = polygons
    write(
        "fire.geojson",
        ['{"type": "FeatureCollection", "features": [', ",\n".join(rows), "]}"],
    )


MONTHS = [date(2024, month, 1) for month in range(1, 8)]  # the last one is where June ends
CITY = (0.5, 0.5), (9.5, 6.5)  # south-west and north-east, in kilometres
SCATTERED = 40  # incidents a month, anywhere in it


@dataclass(frozen=True)
class Cluster:
    """Where incidents gather: each month's middle and number, and how they lie around it."""

    x: list[float]
    y: list[float]
    count: list[int]
    spread: float
    radius: float = 0.0  # of a ring
    gap: tuple[float, ...] = (0.0,) * 6  # radians that it is open in the north and in the south


CLUSTERS = {
    "west": Cluster(
        x=[2.3, 2.6, 2.9, 3.2, 3.3, 3.3],
        y=[4.6, 4.5, 4.4, 4.3, 4.3, 4.4],
        count=[105, 115, 125, 120, 80, 15],
        spread=0.42,
    ),
    "centre": Cluster(
        x=[4.6, 4.4, 4.1, 4.0, 4.3, 4.7],
        y=[3.6, 3.6, 3.9, 4.0, 3.6, 3.2],
        count=[75, 90, 110, 120, 105, 80],
        spread=0.4,
    ),
    "stadium": Cluster(
        x=[7.3] * 6,
        y=[4.9] * 6,
        count=[0, 24, 196, 220, 124, 20],
        spread=0.17,
        radius=1.0,
        gap=(0.0, 0.0, 0.0, 0.0, 1.2, 1.2),
    ),
    "south": Cluster(
        x=[6.9, 6.7, 6.5, 6.4, 6.4, 6.4],
        y=[1.6, 1.6, 1.7, 1.7, 1.7, 1.7],
        count=[95, 65, 15, 0, 0, 0],
        spread=0.38,
    ),
    "south-east": Cluster(
        x=[8.3, 8.3, 8.3, 8.3, 8.1, 7.9],
        y=[2.2, 2.2, 2.2, 2.2, 2.3, 2.4],
        count=[0, 0, 0, 60, 90, 115],
        spread=0.38,
    ),
    "south-west": Cluster(
        x=[1.8] * 6,
        y=[1.9] * 6,
        count=[0, 0, 50, 70, 80, 90],
        spread=0.35,
    ),
}


def around(cluster: Cluster, month: int, rng: np.random.Generator) -> Grid:
    """A month's incidents (n, 2) of a cluster, around its middle or along its ring."""
    count, reach = cluster.count[month], (np.pi - cluster.gap[month]) / 2
    # A ring's go to its eastern and its western half in turn.
    angle = np.linspace(-reach, reach, count) + np.pi * (np.arange(count) % 2)
    middle = np.array([cluster.x[month], cluster.y[month]])
    ring = cluster.radius * np.column_stack([np.cos(angle), np.sin(angle)])
    return middle + ring + rng.normal(scale=cluster.spread, size=(count, 2))


def incidents() -> None:
    rng = np.random.default_rng(1839)
    rows = []
    for month, (first, end) in enumerate(pairwise(MONTHS)):
        points = np.concatenate(
            [rng.uniform(*CITY, (SCATTERED, 2))]
            + [around(cluster, month, rng) for cluster in CLUSTERS.values()]
        )
        days = np.sort(rng.integers((end - first).days, size=len(points)))
        rows += [
            f"{first + timedelta(days=int(day))},{x:.2f},{y:.2f}"
            for day, (x, y) in zip(days, rng.permutation(points), strict=True)
        ]
    write("incidents.csv", ["date,x,y", *rows])


if __name__ == "__main__":
    fire()
    incidents()
