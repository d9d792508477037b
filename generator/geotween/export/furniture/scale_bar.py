"""The scale bar: a round length, as long as it is at the map's centre."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.load import Scene
from geotween.export.furniture.earth import distances
from geotween.export.furniture.language import direction, words_in
from geotween.export.furniture.room import Box, Floats, data_at, drawn_at
from geotween.export.furniture.text import LEADING, text_width
from geotween.export.page_grid import GridTrack, Page

if TYPE_CHECKING:
    from pyproj import CRS

SIZE, TICK = 11.0, 6.0  # px, of the words and of the bar's ends
CORNER = 10.0  # px from the map's edges
LONGEST = 0.2  # of the map's width
ROUND = (1, 2, 5)  # times a power of ten

# Where scales on the map differ by more than the first of these, the bar says where it holds; by
# more than the second, it would mislead: there is none unless the scene asks for it.
EVEN, UNEVEN = 0.05, 0.35

# What parts words that run from left to right from others around them (Unicode's isolates).
APART = ("\u2066", "\u2069")

# Places along each side of the map at which its scale is looked at, the edges left out.
LOOKS = 5

# The bar's ends are put where the distance between them is right: each round is nearer by the
# unevenness of the scale along it.
ROUNDS = 4


@dataclass(frozen=True)
class ScaleBar:
    """The bar's length in px, the length in words that it stands for, and its place on the map.

    ``left`` and ``top``, in px, are those of the box that it takes with its words.
    """

    width: float
    words: str
    left: float = 0.0
    top: float = 0.0

    @property
    def room(self) -> tuple[float, float]:
        """The size of the box in px: the words stand on the bar, in its middle."""
        return max(self.width, text_width(self.words, SIZE)) + 2, SIZE * LEADING + TICK

    @property
    def box(self) -> Box:
        width, height = self.room
        return self.left, self.top, self.left + width, self.top + height


def scale_bar(scene: Scene, page: Page, tracks: Sequence[GridTrack]) -> ScaleBar | None:
    """The scale bar of a map; None where lengths are unknown or it would mislead.

    It lies in the corner in which what rests at the steps covers it least.
    """
    bar = _bar(scene, page)
    if bar is None:
        return None
    if direction(scene.model.lang) == "rtl":
        bar = replace(bar, words=f"{APART[0]}{bar.words}{APART[1]}")
    width, height = bar.room
    right, bottom = page.width - CORNER - width, page.height - CORNER - height
    drawn, _ = drawn_at(tracks, 0.0)
    corners = [(CORNER, bottom), (right, bottom), (CORNER, CORNER), (right, CORNER)]
    return min(
        (replace(bar, left=left, top=top) for left, top in corners),
        key=lambda placed: round(_covered(placed, drawn), 3),
    )


def _covered(bar: ScaleBar, polygons: NDArray[np.object_]) -> float:
    """How often the bar's box, as a share of it, lies over polygons."""
    box = shapely.box(*bar.box)
    parts = shapely.make_valid(polygons[shapely.intersects(polygons, box)])
    return float(shapely.area(shapely.intersection(parts, box)).sum() / box.area)


def _bar(scene: Scene, page: Page) -> ScaleBar | None:
    """The bar without a place."""
    frame = scene.model.map
    if frame.scale_bar == "false" or frame.fit == "each":
        return None
    if scene.crs is None:
        if frame.unit is None:
            return None
        metres = {"m": 1.0, "km": 1000.0}[frame.unit] / page.scale[0]
        length = _round(metres * page.width * LONGEST)
        return ScaleBar(float(length / metres), _words(length))
    uneven = unevenness(scene.crs, page)
    if uneven > UNEVEN and frame.scale_bar == "auto":
        return None
    centre = np.array([[page.width, page.height]]) / 2
    width = page.width * LONGEST
    longest = float(lengths(scene.crs, page, centre, width)[0])
    if not math.isfinite(longest) or longest <= 0:
        return None
    length = _round(longest)
    for _ in range(ROUNDS):
        width *= length / float(lengths(scene.crs, page, centre, width)[0])
    words = _words(length)
    if uneven > EVEN:
        words = words_in(scene.model.lang)["at_centre"].format(length=words)
    return ScaleBar(width, words)


def lengths(crs: CRS, page: Page, middles: Floats, width: float, *, up: bool = False) -> Floats:
    """Metres (n,) between the ends of lines of some px about places (n, 2) in px."""
    half = np.array([0.0, width / 2] if up else [width / 2, 0.0])
    return distances(crs, data_at(page, middles - half), data_at(page, middles + half))


def unevenness(crs: CRS, page: Page) -> float:
    """By which share the largest scale on the map exceeds the smallest; infinite off the globe."""
    along = (np.arange(LOOKS) + 0.5) / LOOKS
    x, y = np.meshgrid(page.width * along, page.height * along)
    places, step = np.column_stack([x.ravel(), y.ravel()]), page.width / 200
    found = np.concatenate([lengths(crs, page, places, step, up=up) for up in (False, True)])
    if not np.isfinite(found).all() or found.min() <= 0:
        return math.inf
    return float(found.max() / found.min() - 1)


def _round(metres: float) -> float:
    """The largest round length that is no longer."""
    power = 10.0 ** math.floor(math.log10(metres))
    return max(part * power for part in ROUND if part * power <= metres * (1 + 1e-9))


def _words(metres: float) -> str:
    if metres >= 1000:
        return f"{metres / 1000:g}\u00a0km"
    return f"{metres:g}\u00a0m" if metres >= 1 else f"{metres * 100:g}\u00a0cm"
