"""Make features valid, and say what had to be mended."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely
from shapely.geometry import MultiPolygon, Polygon

from geotween.data.polygons import RELATIVE_TOLERANCE, Feature, name_of
from geotween.data.problems import Problem


def repair(
    features: Sequence[Feature], *, step: str = "", winding: bool = False
) -> tuple[list[Feature], list[Problem]]:
    """Valid features without repeated points, and a problem for each mend.

    Invalid geometry is rebuilt by shapely's structural method: areas covered by outer rings, less
    those covered by holes; a hole that lies outside becomes a polygon. What has no area is left
    out. ``winding`` also reports rings wound against RFC 7946; the winding is settled for all
    input.
    """
    if not features:
        return [], []
    steps = (step,) if step else ()
    problems: list[Problem] = []
    given = np.array([f.geometry for f in features], dtype=object)
    names = [name_of(f, index) for index, f in enumerate(features)]

    if winding:
        problems += _wound_wrongly(given, steps)

    valid = given.copy()
    invalid = np.flatnonzero(~shapely.is_valid(given))
    reasons = shapely.is_valid_reason(given[invalid])
    valid[invalid] = [made_valid(geometry) for geometry in given[invalid]]
    before, after = shapely.area(given), shapely.area(valid)
    for i, reason in zip(invalid.tolist(), reasons, strict=True):
        size = max(before[i], after[i])
        problems.append(
            Problem(
                "repaired", "warning", f"invalid polygon ({_in_words(reason)}), repaired",
                steps, names[i], abs(after[i] - before[i]) / size if size else 0.0,
                "of its area changed", "mend it in the data to be sure of its shape",
            )
        )  # fmt: skip

    clean = valid  # a ring that is one point repeated could not have been cleaned before its repair
    points = shapely.get_coordinates(valid)
    if (points[1:] == points[:-1]).all(axis=1).any():  # much the rarer case, and far cheaper to see
        clean = shapely.remove_repeated_points(valid)
    repeated = shapely.get_num_coordinates(valid) - shapely.get_num_coordinates(clean)
    problems += [
        Problem(
            "repeated points", "note", "points that repeat the one before were dropped",
            steps, names[i], float(repeated[i]), "points",
        )
        for i in np.flatnonzero(repeated)
    ]  # fmt: skip

    box = shapely.total_bounds(clean)
    thinnest = RELATIVE_TOLERANCE * np.nanmax([box[2] - box[0], box[3] - box[1], 0.0])
    parts, owner = shapely.get_parts(clean, return_index=True)
    tiny = shapely.area(parts) <= thinnest * shapely.length(parts) / 2
    lost = np.bincount(owner[tiny], minlength=len(features))
    kept = []
    for i, feature in enumerate(features):
        if lost[i] or not after[i]:
            message = "a polygon without area was left out"
            problems.append(Problem("no area", "warning", message, steps, names[i]))
            clean[i] = MultiPolygon(list(parts[(owner == i) & ~tiny]))
        if not clean[i].is_empty:
            kept.append(replace(feature, geometry=clean[i]))
    return kept, problems


def made_valid(broken: Polygon | MultiPolygon) -> MultiPolygon:
    """A geometry rebuilt by the structural method, or from its lines where that one breaks down.

    With rings that share edges it can leave an edge doubled, or raise.
    """
    try:
        valid = shapely.make_valid(broken, method="structure", keep_collapsed=False)
    except shapely.errors.GEOSException:
        valid = None
    if not shapely.is_valid(valid):
        valid = shapely.make_valid(broken, method="linework")
    parts = shapely.get_parts(shapely.get_parts(valid))
    return MultiPolygon([part for part in parts if isinstance(part, Polygon)])


def _in_words(reason: str) -> str:
    """``Self-intersection[5 5]`` as ``self-intersection at 5, 5``."""
    what, _, place = reason.partition("[")
    return f"{what.lower()} at {', '.join(place.rstrip(']').split())}" if place else what.lower()


def _wound_wrongly(geometries: np.ndarray, steps: tuple[str, ...]) -> list[Problem]:
    parts = shapely.get_parts(geometries)
    outer = shapely.is_ccw(shapely.get_exterior_ring(parts))
    holes = shapely.get_num_interior_rings(parts)
    owner = np.repeat(np.arange(len(parts)), holes)
    inner = shapely.get_interior_ring(
        parts[owner], np.arange(len(owner)) - np.repeat(np.cumsum(holes) - holes, holes)
    )
    wrong = int((~outer).sum() + shapely.is_ccw(inner).sum())
    if not wrong:
        return []
    message = "rings wound against RFC 7946 were turned"
    return [Problem("winding", "note", message, steps, "", float(wrong), "rings")]
