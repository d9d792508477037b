"""Interpolation: matched pieces become tracks, on which vertices travel from end to end."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from geotween.data.polygons import Identity, Key
from geotween.data.problems import Problem
from geotween.motion.divide import NOBODY
from geotween.motion.match import Matching
from geotween.motion.paths import Path, touching, travel_all
from geotween.motion.seams import share_vertices
from geotween.motion.tracks import Track


def interpolate(
    matching: Matching, layer: str, tolerance: float, path: str = "straight", resolution: float = 0
) -> tuple[tuple[Track, ...], list[Problem]]:
    """Tracks on which matched vertices travel along a path (``paths.TECHNIQUES``).

    Both sides of a seam get the same vertices first. ``tolerance`` is how far apart the same place
    may be, ``resolution`` how far from its path a track may be; both are in the data's units.
    """
    division = matching.division
    shared = share_vertices(matching.pieces, division.indices, tolerance)
    problems = []
    if shared.missing:
        message = "seams have vertices on one side only and may show as hairlines"
        problems.append(
            Problem("open seam", "note", message, measure=shared.missing, unit="vertices")
        )
    origin_keys = {i.key for i in division.origin.identities if i.keyed}
    target_keys = {i.key for i in division.target.identities if i.keyed}
    alone = np.zeros(len(shared.pieces), dtype=np.intp)
    groups = alone if path == "straight" else touching(shared.pieces, tolerance)
    ways = travel_all(shared.pieces, groups, path, resolution)
    problems += _gave_way(ways, path)
    tracks = []
    for (i, j), piece, way in zip(division.indices, shared.pieces, ways, strict=True):
        here = division.origin.identities[i] if i != NOBODY else None
        there = division.target.identities[j] if j != NOBODY else None
        ends = (here or there, there or here)
        assert ends[0] is not None
        assert ends[1] is not None
        bearer = _bearer(ends[0], ends[1], origin_keys, target_keys)
        tracks.append(
            Track(
                bearer,
                (ends[0], ends[1]),
                layer,
                way.times,
                way.places,
                piece.offsets,
                piece.seams,
            )
        )
    return tuple(tracks), problems


def _gave_way(ways: Sequence[Path], path: str) -> list[Problem]:
    """A problem for each reason for which pieces took another path than the one asked for."""
    return [
        Problem("path", "note", f"not {path}: {why}", (), "", count, "pieces")
        for why, count in Counter(way.gave_way for way in ways if way.gave_way).items()
    ]


def _bearer(
    origin: Identity, target: Identity, origin_keys: set[Key], target_keys: set[Key]
) -> Identity:
    """Whose key a piece bears: the target's where only the target's lives on, else the origin's.

    A key lives on where both sets have it.
    """
    origin_lives = origin.keyed and origin.key in target_keys
    target_lives = target.keyed and target.key in origin_keys
    return target if target_lives and not origin_lives else origin
