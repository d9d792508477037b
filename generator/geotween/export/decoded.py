"""Keyframes read back from a page's JSON as its player reads them: for whoever draws elsewhere.

docs/format.md says what the JSON holds.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geotween.export.numerals import Numbers, heard

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Vertices:
    """What tracks share: ``points`` (p, 2) in steps of the grid, and vertices that use them.

    ``ways`` (v, 2) are the points from which to which each goes, ``lives`` (v, 2) when.
    """

    points: Floats
    ways: Numbers
    lives: Floats

    def at(self, nodes: Sequence[int], t: float) -> Floats:
        """The places (n, 2) of some vertices at t."""
        some = np.asarray(nodes, dtype=np.intp)
        one, other = self.points[self.ways[some]].transpose(1, 0, 2)
        since, until = self.lives[some].T[..., None]
        return np.asarray(one + (other - one) * ((t - since) / (until - since)))


@dataclass(frozen=True, eq=False)
class Told:
    """A track: the lengths of its rings, since when and until when it is there, its vertices.

    They are ``nodes`` of shared vertices, or have their own ``frames`` at key ``times``.
    """

    rings: list[int]
    life: tuple[float, float]
    nodes: list[int]
    shared: Vertices
    times: list[float]
    frames: list[Floats]

    def at(self, t: float) -> Floats:
        """The vertices (n, 2) at t, the eased share of the span, in steps of the grid."""
        if not self.frames:
            return self.shared.at(self.nodes, t)
        k = max(k for k, start in enumerate(self.times[:-1]) if start <= t or k == 0)
        share = (t - self.times[k]) / (self.times[k + 1] - self.times[k])
        return np.asarray(self.frames[k] * (1 - share) + self.frames[k + 1] * share)


def tracks_told(data: Mapping[str, Any]) -> list[Told]:
    """All tracks of a page's JSON."""
    shared, found = _vertices(data), list[Told]()
    unseen = 0
    for track in data["tracks"]:
        base = found[len(found) - track["base"]].nodes if "base" in track else None
        nodes = read_script(heard(track.get("nodes", "")).tolist(), base, unseen)
        unseen = max([unseen, *(node + 1 for node in nodes)])
        life = [data["moments"][k] for k in track.get("life", ())] or [0.0, 1.0]
        moves = [np.cumsum(heard(v).reshape(-1, 2), axis=0) for v in track.get("places", [])]
        frames = list(np.cumsum(moves, axis=0)) if moves else []
        times = track.get("times", [])
        found.append(Told(track["rings"], (life[0], life[1]), nodes, shared, times, frames))
    return found


def _vertices(data: Mapping[str, Any]) -> Vertices:
    jumps = iter(heard(data["jumps"]).tolist())
    new = [0, data["starts"]]
    ways: list[tuple[int, int]] = []
    start = end = 0
    for code in heard(data["ways"]).tolist():
        start = _next(start, code // 5, new[0], jumps)
        end = start if code % 5 == 4 else _next(end, code % 5, new[1], jumps)
        new = [max(new[0], start + 1) if start < data["starts"] else new[0], max(new[1], end + 1)]
        ways.append((start, end))
    spells = heard(data["lives"]).reshape(-1, 3)
    ends = np.repeat(np.cumsum(spells[:, :2], axis=0), spells[:, 2], axis=0)
    both = np.array(ways, dtype=np.int64).reshape(-1, 2)
    lives = np.tile([0.0, 1.0], (len(both), 1))
    if len(both):
        lives[both[:, 0] != both[:, 1]] = np.array(data["moments"])[ends]
    points = np.cumsum(heard(data["points"]).reshape(-1, 2), axis=0)
    return Vertices(points.astype(np.float64), both, lives)


def _next(last: int, code: int, new: int, jumps: Iterator[int]) -> int:
    return last + code if code < 2 else new if code == 2 else last + next(jumps)


def read_script(script: list[int], base: list[int] | None, unseen: int) -> list[int]:
    """The numbers that a script writes."""
    found: list[int] = []
    cursor, node = 0, unseen
    for place, (skip, count) in enumerate(zip(script[::2], script[1::2], strict=True)):
        if base is not None and place % 2 == 0:
            cursor += skip
            found += base[cursor : cursor + count]
            cursor += count
        else:
            node += skip
            way = 1 if count > 0 else -1
            found += range(node, node + count, way)
            node += count
    return found
