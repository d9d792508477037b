"""Rows of panels for the experiments: sets, divisions, meshes and frames."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon

from docs.draw.canvas import FAINT, INK, Box, Canvas
from geotween.mesh import Mesh, quality
from geotween.motion.looks import rebuilt
from geotween.motion.tracks import Track, frame

BEFORE, AFTER, WRONG = "#7fb3d5", "#f2c57c", "#c0392b"
PIECES = (
    "#7fb3d5", "#f2c57c", "#a9cf9b", "#d7a3c4", "#c9b79c", "#8fd0c8", "#e59a8b", "#b3b3dd",
    "#d6d67a", "#9fb8ad", "#e0b7d8",
)  # fmt: skip
# Ranges of a triangle's quality, and their colours: from a sliver to a good one, and a better.
RANGES = ((0.0, "#7b3294"), (0.4, "#c2a5cf"), (0.6, "#e6e0e9"), (0.8, "#a6dba0"), (0.9, "#1b7837"))
MOMENTS = (0.0, 0.25, 0.5, 0.75, 1.0)
WIDTH = 165.0  # px of a panel, of five
OFF = 0.2  # px by which outlines in frames may be off
EDGE = 0.03  # of the extent, around what is shown


def box_of(*shapes: Any) -> Box:
    """A box around shapes, with an edge."""
    low_x, low_y, high_x, high_y = shapely.total_bounds(np.concatenate([*map(_array, shapes)]))
    edge = EDGE * max(high_x - low_x, high_y - low_y)
    return low_x - edge, low_y - edge, high_x + edge, high_y + edge


def superposed(origin: Any, target: Any, label: str, width: float = 2 * WIDTH) -> str:
    """Two sets over each other, in two colours."""
    legend = ((BEFORE, "before"), (AFTER, "after"))
    canvas = Canvas(box_of(origin, target), ("both periods",), width, legend, label)
    for shapes, colour in ((origin, BEFORE), (target, AFTER)):
        canvas.area(0, _array(shapes), colour, fill_opacity=0.6, stroke=INK, stroke_width=0.7)
    return canvas.svg()


def divisions(polygon: Any, targets: Any, rows: Mapping[str, Sequence[Any]], label: str) -> str:
    """A polygon's pieces by each technique, each in a colour, under its correspondents' outlines.

    What is given away is red: what a correspondent covers and another one's piece has.
    """
    width = WIDTH if len(rows) > 2 else 1.5 * WIDTH
    legend = [(INK, "outlines of the correspondents")]
    if any(_given_away(targets, pieces).area > 0 for pieces in rows.values()):
        legend.append((WRONG, "covered by one, given to another"))
    canvas = Canvas(box_of(polygon, targets), list(rows), width, legend, label)
    for panel, pieces in enumerate(rows.values()):
        for k, piece in enumerate(pieces):
            canvas.area(panel, piece, PIECES[k % len(PIECES)], stroke="#ffffff", stroke_width=1.2)
        canvas.area(panel, _given_away(targets, pieces), WRONG, fill_opacity=0.75)
        canvas.lines(panel, shapely.get_rings(_array(targets)), INK, 0.8)
    return canvas.svg()


def meshes(found: Mapping[str, Mesh], label: str) -> str:
    """Meshes whose triangles are coloured by their quality."""
    ends = [*[low for low, _ in RANGES[1:]], 1.0]
    legend = [(c, f"{low:g} to {high:g}") for (low, c), high in zip(RANGES, ends, strict=True)]
    corners = [mesh.points[mesh.triangles] for mesh in found.values()]
    shapes: list[Any] = [shapely.polygons(places) for places in corners]
    canvas = Canvas(box_of(*shapes), list(found), 2.4 * WIDTH, legend, label)
    for panel, (mesh, triangles) in enumerate(zip(found.values(), shapes, strict=True)):
        which = np.digitize(quality(mesh) + ROUNDING, [low for low, _ in RANGES]) - 1
        for k, (_, colour) in enumerate(RANGES):
            canvas.area(panel, triangles[which == k], colour, stroke=FAINT, stroke_width=0.3)
    return canvas.svg()


# Triangles whose quality is that of a range's end but for rounding are in it.
ROUNDING = 1e-12


def frames(
    tracks: Sequence[Track],
    ends: tuple[Any, Any],
    label: str,
    moments: Sequence[float] = MOMENTS,
    titles: Sequence[str] = (),
) -> str:
    """The frames of a motion at some moments; both ends' outlines are kept, faint.

    A piece has the colour of what it becomes; what is covered twice is red.
    """
    box = box_of(*(end for end in ends if len(end)))
    canvas = Canvas(box, list(titles) or [f"t = {t:g}" for t in moments], WIDTH, label=label)
    for panel, t in enumerate(moments):
        _draw(canvas, panel, tracks, t, ends)
    return canvas.svg()


def beside(ways: Mapping[str, Sequence[Track]], ends: tuple[Any, Any], label: str) -> str:
    """The frames of two motions at the same two moments, in one row."""
    moments = (0.25, 0.5)
    titles = [f"{name}, t = {t:g}" for name in ways for t in moments]
    canvas = Canvas(box_of(*ends), titles, 1.2 * WIDTH, _MARKS, label)
    common = shapely.intersection_all([shapely.union_all(_array(end)) for end in ends])
    for number, tracks in enumerate(ways.values()):
        for k, t in enumerate(moments):
            _draw(canvas, len(moments) * number + k, tracks, t, ends)
            bare = shapely.difference(common, _covered(tracks, t))
            canvas.area(len(moments) * number + k, shapely.buffer(bare, -SEEN / 2), BARE)
    return canvas.svg()


BARE = "#6b1f8f"
_MARKS = ((WRONG, "covered twice"), (BARE, "covered at both ends, and bare now"))


def _covered(tracks: Sequence[Track], t: float) -> Any:
    return shapely.union_all(rebuilt(_array(frame(tracks, t).polygons)))


def _draw(
    canvas: Canvas, panel: int, tracks: Sequence[Track], t: float, ends: tuple[Any, Any]
) -> None:
    """A frame, in colours by what pieces become; over it, what is covered twice."""
    names = list(dict.fromkeys(track.ends[1] for track in tracks))
    for end in ends:
        canvas.lines(panel, shapely.get_rings(_array(end)), "#d5d5d5", 0.7)
    shown = []
    for track in tracks:
        polygons = rebuilt(_array(frame([track], t).polygons))
        colour = PIECES[names.index(track.ends[1]) % len(PIECES)]
        drawn = shapely.simplify(polygons, OFF / canvas.scale)
        canvas.area(panel, drawn, colour, stroke=INK, stroke_width=0.4)
        shown.append(shapely.union_all(polygons))
    canvas.area(panel, _twice(_array(shown)), WRONG)


def _given_away(targets: Any, pieces: Any) -> Any:
    return shapely.union_all(
        [
            shapely.intersection(target, piece)
            for i, target in enumerate(targets)
            for j, piece in enumerate(pieces)
            if i != j
        ]
    ).buffer(-SEEN)


# Strips narrower than twice this, in units of the drawings, are not drawn.
SEEN = 0.01


def _twice(shapes: NDArray[np.object_]) -> Any:
    """What several shapes cover."""
    one, other = shapely.STRtree(shapes).query(shapes, predicate="intersects")
    pairs = one < other
    common = shapely.intersection(shapes[one[pairs]], shapes[other[pairs]])
    return (
        shapely.buffer(shapely.union_all(common), -SEEN / 2) if pairs.any() else shapely.Polygon()
    )


def _array(shapes: Any) -> NDArray[np.object_]:
    if isinstance(shapes, np.ndarray):
        return shapes
    return np.array([shapes] if isinstance(shapes, Polygon) else list(shapes), dtype=object)
