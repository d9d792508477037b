"""What a browser draws, beside what Python says it should."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from playwright.sync_api import Browser, Page
from shapely.geometry import Polygon

from geotween.data.load import Scene
from geotween.export.build import plan_scene
from geotween.export.easing import EASINGS, ease
from geotween.export.page_grid import fit_page
from geotween.export.timeline import timeline
from geotween.motion.tracks import Frame

Points = NDArray[np.float64]
Drawn = dict[str, list[Points]]  # the rings of each key

# Rounding to a tenth of a pixel moves a vertex by 0.071 at most; the player writes two decimals,
# and Chromium solves an easing's curve to 1 / (200 × duration) of its parameter.
VERTEX_TOLERANCE = 0.08

# A front parts a transition into many short animations, and its vertices are fast: in SVGs 0.124
# was the most, where pages stay within the other bound.
TOLERANCES = {"html": VERTEX_TOLERANCE, "svg": 0.13}

VISIBLE_REGIONS = """() => [...document.querySelectorAll('path.region')]
  .filter(path => getComputedStyle(path).visibility === 'visible')
  .map(path => [path.dataset.layer, path.dataset.key, getComputedStyle(path).d])"""


class Watched:
    """A page that notes everything it says and asks for."""

    def __init__(self, browser: Browser, address: str, **options: Any) -> None:
        self.said: list[str] = []
        self.asked: list[str] = []
        self.page: Page = browser.new_page(**options)
        self.page.on("console", lambda message: self.said.append(message.text))
        self.page.on("pageerror", lambda error: self.said.append(str(error)))
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.page.goto(address)

    def __enter__(self) -> Page:
        return self.page

    def __exit__(self, *_: object) -> None:
        self.page.close()
        assert self.said == []
        assert len(self.asked) == 1, self.asked


def open_page(browser: Browser, file: Path, **options: Any) -> Watched:
    return Watched(browser, file.as_uri(), **options)


def seek_page(page: Page, seconds: float) -> None:
    page.evaluate("t => { document.querySelector('geotween-map').currentTime = t }", seconds)


def seek_svg(page: Page, seconds: float) -> None:
    page.evaluate("t => document.documentElement.setCurrentTime(t)", seconds)


def stop_page(page: Page) -> None:
    page.evaluate("document.querySelector('geotween-map').pause()")


def stop_svg(page: Page) -> None:
    page.evaluate("document.documentElement.pauseAnimations()")


# How to stop a page or an SVG, and how to set its time.
HANDS = {"html": (stop_page, seek_page), "svg": (stop_svg, seek_svg)}


def drawn(page: Page, only: str | None = None) -> Drawn:
    """The rings of all region paths, or those of a layer, that are to be seen, in px.

    They are as the browser computes them.
    """
    found: Drawn = {}
    for layer, key, text in page.evaluate(VISIBLE_REGIONS):
        if only in (None, layer):
            found.setdefault(key or "", []).extend(rings_of_path(text))
    return found


def rings_of_path(text: str) -> list[Points]:
    """The rings of a computed ``path("M … L … Z")``, which is absolute."""
    rings = []
    for ring in re.findall(r"M([^MZ]*)", text):
        points = np.array(re.findall(r"-?[\d.]+(?:e-?\d+)?", ring), dtype=float).reshape(-1, 2)
        rings.append(_without_repeats(points))
    return [ring for ring in rings if len(ring) > 2]


def expected(scene: Scene, frame: Frame, keyed: bool) -> Drawn:
    """The rings of a frame, in px."""
    page = _page(scene)
    found: Drawn = {}
    for polygon, key in zip(frame.polygons, frame.keys, strict=True):
        rings = found.setdefault(str(key) if keyed else "", [])
        for ring in (polygon.exterior, *polygon.interiors):
            rings.append(_without_repeats(page.pixels(shapely.get_coordinates(ring)[:-1])))
    return found


def assert_same(one: Drawn, other: Drawn, tolerance: float = VERTEX_TOLERANCE) -> None:
    """Each vertex of one lies at a vertex of the other, and areas agree as well as that allows."""
    for key in {*one, *other}:
        a, b = (np.concatenate([*side.get(key, []), np.empty((0, 2))]) for side in (one, other))
        big_a, big_b = (
            [ring for ring in side.get(key, []) if np.ptp(ring, axis=0).max() > 4 * tolerance]
            for side in (one, other)
        )
        # Rings that touch at a moment may be one or two then: vertices and areas tell.
        assert bool(big_a) == bool(big_b), key
        if not big_a:
            continue
        assert _farthest(np.concatenate(big_a), b) <= tolerance, key
        assert _farthest(np.concatenate(big_b), a) <= tolerance, key
        length = sum(np.hypot(*(np.roll(r, 1, axis=0) - r).T).sum() for r in big_b)
        areas = [abs(sum(_area(ring) for ring in rings)) for rings in (big_a, big_b)]
        assert abs(areas[0] - areas[1]) <= tolerance * length


def moments(scene: Scene, per_transition: int = 11) -> list[tuple[int, float, float]]:
    """For each transition: its index, a time in seconds, and t after easing."""
    easing = EASINGS[scene.model.motion.easing]
    found = []
    for span in timeline(scene):
        if not span.rest:
            for share in np.linspace(0, 1, per_transition + 2)[1:-1]:
                time = round(span.start + share * span.length) / 1000
                exact = (1000 * time - span.start) / span.length
                found.append((span.step, time, ease(easing, exact)))
    return found


def rests(scene: Scene) -> list[tuple[int, float]]:
    """The index of each step and a time at which it rests, in seconds."""
    return [(s.step, (s.start + s.end) / 2000) for s in timeline(scene) if s.rest]


def is_keyed(scene: Scene) -> bool:
    return all(i.keyed for step in scene.steps for i in step.regions.identities)


def assert_plays_as_planned(
    scene: Scene,
    page: Page,
    seek: Callable[[Page, float], None],
    tolerance: float,
    per_transition: int = 11,
) -> None:
    """Compare the drawn paths of every transition with ``frame(t)`` of its plan."""
    planned, keyed = plan_scene(scene)[0], is_keyed(scene)
    for index, time, t in moments(scene, per_transition):
        seek(page, time)
        assert_same(drawn(page), expected(scene, planned[index].frame(t), keyed), tolerance)


def assert_rests_are_exact(scene: Scene, page: Page, seek: Callable[[Page, float], None]) -> None:
    """At a step's time the input is drawn: each vertex, and the area but for the rounding."""
    to_page = _page(scene)
    for index, time in rests(scene):
        seek(page, time)
        for layer in scene.layer_order:
            rings = [ring for of_key in drawn(page, layer).values() for ring in of_key]
            regions = scene.steps[index].regions.in_layer(layer)
            given = [shapely.transform(p, to_page.pixels) for p in regions.polygons]
            _assert_same_area(rings, given)


def _assert_same_area(rings: list[Points], given: list[Polygon]) -> None:
    if not given:
        assert not rings
        return
    vertices = np.concatenate([shapely.get_coordinates(p) for p in given])
    assert _farthest(np.concatenate(rings), vertices) <= VERTEX_TOLERANCE
    assert _farthest(vertices, np.concatenate(rings)) <= VERTEX_TOLERANCE
    wanted = shapely.union_all(given)
    length = sum(p.length for p in given)
    assert _area_of(rings).symmetric_difference(wanted).area <= 0.05 * length


def _page(scene: Scene) -> Any:
    sets = [step.regions for step in scene.steps] + [polygons for _, polygons in scene.layers]
    return fit_page(scene.model.map, sets)


def _area_of(rings: list[Points]) -> Any:
    """The area of rings: outer ones less holes, told apart by their winding on the page."""
    areas = [_area(ring) for ring in rings]
    outward = np.sign(areas[int(np.argmax(np.abs(areas)))])
    polygons = [shapely.make_valid(Polygon(ring)) for ring in rings]
    outer = [p for p, a in zip(polygons, areas, strict=True) if np.sign(a) == outward]
    holes = [p for p, a in zip(polygons, areas, strict=True) if np.sign(a) == -outward]
    islands = [p for p in outer if any(hole.covers(p) for hole in holes)]
    area = shapely.union_all([p for p in outer if p not in islands])
    return area.difference(shapely.union_all(holes)).union(shapely.union_all(islands))


def _without_repeats(points: Points) -> Points:
    return points[(points != np.roll(points, -1, axis=0)).any(axis=1)]


def _area(ring: Points) -> float:
    x, y = ring.T
    return float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2)


def _farthest(points: Points, others: Points) -> float:
    """The largest distance from one of some points to the nearest of others."""
    tree = shapely.STRtree(shapely.points(others))
    _, distances = tree.query_nearest(
        shapely.points(points), return_distance=True, all_matches=False
    )
    return float(distances.max())
