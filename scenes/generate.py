"""Write fire.yaml and hotspots.yaml beside this script.

Both scenes are illustrative. The fire is grown by shortest paths over a seeded map of how readily each cell burns,
with a west wind and a few spot fires; the hotspots are contours of the density of seeded random incidents. The seeds
are fixed, so the files come out the same, byte for byte, every time.
"""

from __future__ import annotations

import textwrap
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter, zoom
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra
from shapely import Polygon, box, union_all

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


def flow(polygon: Polygon, decimals: int) -> str:
    """A polygon as a YAML flow sequence: a ring, or rings when it has holes."""
    rings = []
    for ring in (polygon.exterior, *polygon.interiors):
        points = [f"[{x:.{decimals}f},~{y:.{decimals}f}]" for x, y in ring.coords[:-1]]
        rings.append("[" + ", ".join(points) + "]")
    return rings[0] if len(rings) == 1 else "[" + ", ".join(rings) + "]"


def wrapped(head: str, body: str, indent: int) -> str:
    lines = textwrap.fill(
        body,
        width=110,
        initial_indent=head,
        subsequent_indent=" " * indent,
        break_long_words=False,
        break_on_hyphens=False,
    )
    return lines.replace("~", " ")


def write(
    name: str, head: str, steps: list[tuple[str, str, str, list[Polygon]]], decimals: int
) -> None:
    """Write a scene: its head, then its steps of label, time, caption and polygons."""
    out = [head.strip("\n"), "steps:"]
    for label, time, caption, polygons in steps:
        out += [f'  - label: "{label}"', f"    time: {time}", f"    caption: {caption}"]
        out.append("    polygons:" if polygons else "    polygons: []")
        out += [wrapped("      - ", flow(p, decimals), 8) for p in polygons]
    (HERE / f"{name}.yaml").write_text("\n".join(out) + "\n", encoding="utf-8", newline="\n")


# --- the wildfire ---------------------------------------------------------------------------------------------------

FIRE_HEAD = """
# yaml-language-server: $schema=scene.schema.json
# Written by generate.py. Local plane in kilometres.
title: Six days of a wildfire
subtitle: "Illustrative: grown by a seeded script, not a real fire."
description: >-
  A burnt area grows from the west for six days. Spot fires start ahead of it and most are swallowed;
  islands of unburnt forest open inside it and burn out later.
source: Illustrative. Seeded script generate.py.
credit: All shapes are invented, the lake and the town too.
lang: en
map:
  width: 900
  padding: 16
  background: "#dfe5d0"
  y: up
  layers:
    - name: forest
      fill: "#cfdabb"
      stroke: none
      polygons:
        - [[0, 0], [12, 0], [12, 8], [0, 8]]
    - name: lake
      fill: "#9fc3d6"
      stroke: "#7ea9bf"
      width: 0.8
      polygons:
        - [[6.8, 6.6], [7.6, 6.3], [8.4, 6.4], [9.1, 6.8], [9.2, 7.2], [8.3, 7.4], [7.3, 7.2]]
    - name: town
      fill: "#b9b2a6"
      stroke: "#8f887c"
      width: 0.8
      polygons:
        - [[9.6, 1], [10.2, 0.8], [10.9, 1], [11.1, 1.6], [10.7, 2.1], [10, 2], [9.5, 1.6]]
style:
  fill: "#c1440e"
  stroke: "#7c2606"
  width: 1
  opacity: 0.85
motion: {correspondence: intersects, easing: linear}
timing: {transition: 2, hold: 0.6, loop: true}
"""

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
    for dr, dc in [(-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1), (1, 2), (-1, 2), (1, -2),
                   (-1, -2), (2, 1), (2, -1), (-2, 1), (-2, -1)]:  # fmt: skip
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
    captions = [
        "The fire starts in the west, and a west wind drives it.",
        "Sparks carry ahead of the front and light a spot fire.",
        "The spot fire grows, and a second one is lit to the north-east.",
        "The front swallows the first spot fire. Behind it lies an island of unburnt forest.",
        "The second spot fire is swallowed and the island burns out. A third fire starts near the town.",
        "The fire lies along the lake, with two more islands inside it. The third fire still burns apart.",
    ]
    steps: list[tuple[str, str, str, list[Polygon]]] = []
    for n, caption in enumerate(captions, 1):
        field = np.clip(n - gaussian_filter(np.minimum(day, 9), 1.0), -2, 2)
        polygons = areas(field, FIRE_CELL, 0.12, 0.06, 0.035)
        # An island of unburnt forest is mapped only once the front has passed it for a day.
        mapped = [Polygon(p.exterior) for _, _, _, before in steps[-1:] for p in before]
        polygons = [
            Polygon(
                p.exterior, [h for h in p.interiors if any(m.contains(Polygon(h)) for m in mapped)]
            )
            for p in polygons
        ]
        steps.append((f"Day {n}", str(n), caption, polygons))
    write("fire", FIRE_HEAD, steps, 2)


# --- the hotspots ---------------------------------------------------------------------------------------------------

HOTSPOTS_HEAD = """
# yaml-language-server: $schema=scene.schema.json
# Written by generate.py. Local plane in kilometres.
title: Hotspots of crime, January to June
subtitle: "Illustrative: seeded random incidents in an invented city."
description: >-
  Patches of dense incidents drift over a city for six months. Two of them merge, a ring forms around a stadium,
  breaks in two and vanishes, one patch fades away and two others appear.
source: Illustrative. Seeded script generate.py; areas with more than 42 incidents per square kilometre and month.
credit: City, river and incidents are invented.
lang: en
map:
  width: 900
  padding: 16
  background: "#f2f0ec"
  y: up
  layers:
    - name: city
      fill: "#e3dfd6"
      stroke: "#c8c1b2"
      width: 1
      polygons:
        - [[0.7, 1.2], [2.2, 0.5], [4.4, 0.3], [6.6, 0.4], [8.6, 0.9], [9.6, 2.2], [9.7, 4.1], [9.2, 5.7], [8, 6.6],
          [5.9, 6.8], [3.8, 6.4], [2, 6.2], [0.8, 5.2], [0.4, 3.2]]
    - name: river
      fill: "#bdd3dd"
      stroke: none
      polygons:
        - [[0, 2.9], [1.5, 2.95], [3, 2.6], [4.6, 2.35], [6.2, 2.75], [7.6, 3.15], [9, 3.1], [10, 3.3], [10, 3.5],
          [9, 3.3], [7.5, 3.35], [6.1, 2.95], [4.6, 2.55], [3, 2.8], [1.5, 3.15], [0, 3.1]]
style:
  fill: "#7b2d6b"
  stroke: "#53184a"
  width: 1
  opacity: 0.8
motion: {correspondence: intersects, easing: ease-in-out}
timing: {transition: 2.2, hold: 1.2, loop: true}
"""

CITY_SHAPE, CITY_CELL = (70, 100), 0.1
MONTHS = ["January", "February", "March", "April", "May", "June"]
# x, y and spread in kilometres, ring radius, then incidents a month
CLUSTERS = [
    (
        [2.3, 2.6, 2.9, 3.2, 3.3, 3.3],
        [4.6, 4.5, 4.4, 4.3, 4.3, 4.4],
        0.45,
        0.0,
        [150, 170, 180, 170, 120, 30],
    ),
    (
        [4.6, 4.4, 4.1, 4.0, 4.3, 4.7],
        [3.4, 3.6, 3.9, 4.0, 3.6, 3.2],
        0.42,
        0.0,
        [110, 130, 160, 170, 150, 120],
    ),
    (
        [7.3, 7.3, 7.3, 7.3, 7.3, 7.3],
        [4.9, 4.9, 4.9, 4.9, 4.9, 4.9],
        0.2,
        0.95,
        [0, 110, 330, 360, 230, 60],
    ),
    (
        [6.9, 6.7, 6.5, 6.4, 6.4, 6.4],
        [1.6, 1.6, 1.7, 1.7, 1.7, 1.7],
        0.4,
        0.0,
        [140, 110, 60, 0, 0, 0],
    ),
    (
        [8.3, 8.3, 8.3, 8.3, 8.1, 7.9],
        [2.2, 2.2, 2.2, 2.2, 2.3, 2.4],
        0.4,
        0.0,
        [0, 0, 0, 90, 130, 160],
    ),
    (
        [1.6, 1.6, 1.6, 1.6, 1.6, 1.7],
        [1.9, 1.9, 1.9, 1.9, 1.9, 1.9],
        0.36,
        0.0,
        [0, 0, 70, 110, 120, 130],
    ),
]


def density(month: int) -> Grid:
    """Incidents per square kilometre in one month, smoothed."""
    rng = np.random.default_rng(1829 + month)
    rows, columns = CITY_SHAPE
    points = [rng.uniform((0, 0), (columns * CITY_CELL, rows * CITY_CELL), (160, 2))]
    for xs, ys, spread, ring, counts in CLUSTERS:
        count = counts[month]
        angle = np.linspace(0, 2 * np.pi, count, endpoint=False)
        centre = np.c_[xs[month] + ring * np.cos(angle), ys[month] + ring * np.sin(angle)]
        points.append(centre + rng.normal(scale=spread, size=(count, 2)))
    x, y = np.concatenate(points).T
    extent = ((0, rows * CITY_CELL), (0, columns * CITY_CELL))
    counted, _, _ = np.histogram2d(y, x, bins=CITY_SHAPE, range=extent)
    return gaussian_filter(counted, 3.2) / CITY_CELL**2


def hotspots() -> None:
    captions = [
        "Three separate hotspots, two north of the river and one south of it.",
        "The two in the north have drifted together and merged.",
        "A ring forms around the stadium in the north-east. The southern hotspot is gone, one shows in the south-west.",
        "The ring stays quiet in the middle. Another hotspot appears in the south-east.",
        "The ring breaks into two halves.",
        "Both halves have vanished, and the merged hotspot has shrunk and moved on. Three are left.",
    ]
    steps = []
    for n, caption in enumerate(captions):
        polygons = areas(density(n) - 42, CITY_CELL, 0.08, 0.15, 0.12)
        steps.append((MONTHS[n], str(n + 1), caption, polygons))
    write("hotspots", HOTSPOTS_HEAD, steps, 2)


if __name__ == "__main__":
    fire()
    hotspots()
