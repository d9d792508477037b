"""TopoJSON of a scene's steps on the page's grid: a floor for the size of a page.

Borders that rings share, within a step or between steps, are told once, as arcs of differences.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from itertools import pairwise
from typing import Any

from geotween.data.load import Scene
from geotween.export.page_grid import GRID, fit_page, resting

Place = tuple[int, int]
Ring = list[Place]


def topojson(scene: Scene) -> str:
    """All steps of a scene as they are drawn, as one topology. Cost: linear in the vertices."""
    page = fit_page(
        scene.model.map, [s.regions for s in scene.steps] + [s for _, s in scene.layers]
    )
    steps = [
        [
            (who, list(_rings(track)))
            for who, track in zip(step.regions.identities, still, strict=True)
        ]
        for step in scene.steps
        for still in [resting(step.regions, page)]
    ]
    every = [ring for step in steps for _, rings in step for ring in rings]
    junctions = _junctions(every)
    arcs: list[Ring] = []
    known: dict[tuple[Place, ...], int] = {}

    def numbers(ring: Ring) -> list[int]:
        found = []
        for arc in _cut(ring, junctions):
            forth, back = tuple(arc), tuple(reversed(arc))
            if forth not in known and back not in known:
                known[forth] = len(arcs)
                arcs.append(arc)
            found.append(known[forth] if forth in known else ~known[back])
        return found

    objects: dict[str, Any] = {}
    for number, step in enumerate(steps):
        geometries = [
            {"type": "Polygon", "id": who.key, "arcs": [numbers(ring) for ring in rings]}
            for who, rings in step
            if rings
        ]
        objects[str(number)] = {"type": "GeometryCollection", "geometries": geometries}
    told = {
        "type": "Topology",
        "transform": {"scale": [GRID, GRID], "translate": [0, 0]},
        "objects": objects,
        "arcs": [_differences(arc) for arc in arcs],
    }
    return json.dumps(told, separators=(",", ":"), ensure_ascii=False)


def _rings(track: Any) -> Iterable[Ring]:
    places = list(map(tuple, track.vertices[0].tolist()))
    return (places[start:end] for start, end in pairwise(track.offsets.tolist()))


def _junctions(rings: Iterable[Ring]) -> set[Place]:
    """Places where rings part or meet: those with other than two neighbours in all of them."""
    neighbours: dict[Place, set[Place]] = {}
    for ring in rings:
        for one, other in pairwise([*ring, ring[0]]):
            neighbours.setdefault(one, set()).add(other)
            neighbours.setdefault(other, set()).add(one)
    return {place for place, near in neighbours.items() if len(near) != 2}


def _cut(ring: Ring, junctions: set[Place]) -> list[Ring]:
    """A ring as arcs from junction to junction; a closed one, from its least place, without any."""
    cuts = [k for k, place in enumerate(ring) if place in junctions]
    first = cuts[0] if cuts else min(range(len(ring)), key=ring.__getitem__)
    turned = ring[first:] + ring[: first + 1]
    places = [k - first for k in cuts] or [0]
    return [turned[start : end + 1] for start, end in pairwise([*places, len(ring)])]


def _differences(arc: Ring) -> list[list[int]]:
    steps = [[b[0] - a[0], b[1] - a[1]] for a, b in pairwise(arc)]
    return [list(arc[0]), *steps]
