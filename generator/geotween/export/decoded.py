"""What a page is told of tracks, read back as its player reads it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Told:
    """A track as told: the lengths of its rings, its life, and where its vertices are."""

    rings: list[int]
    life: tuple[float, float]
    nodes: list[int]
    table: Mapping[str, Any]
    times: list[float]
    frames: list[Floats]

    def at(self, t: float) -> Floats:
        """The vertices (n, 2) at t, in steps of the grid."""
        if self.frames:
            k = max(k for k, start in enumerate(self.times[:-1]) if start <= t or k == 0)
            share = (t - self.times[k]) / (self.times[k + 1] - self.times[k])
            return self.frames[k] * (1 - share) + self.frames[k + 1] * share
        return np.array([self._place(node, t) for node in self.nodes]).reshape(-1, 2)

    def _place(self, node: int, t: float) -> Floats:
        one, other = (self.table["points"][end] for end in self.table["ways"][node])
        since, until = self.table["lives"][node]
        return np.asarray(one + (other - one) * (t - since) / (until - since))


def tracks_told(data: Mapping[str, Any]) -> list[Told]:
    """All tracks of a page."""
    table, found = _table(data), list[Told]()
    unseen = 0
    for track in data["tracks"]:
        base = found[len(found) - track["base"]].nodes if "base" in track else None
        nodes = read_script(track["nodes"], base, unseen) if "nodes" in track else []
        unseen = max([unseen, *(node + 1 for node in nodes)])
        life = [data["moments"][k] for k in track.get("life", ())] or [0.0, 1.0]
        moves = [np.cumsum(np.reshape(v, (-1, 2)), axis=0) for v in track.get("places", [])]
        frames = list(np.cumsum(moves, axis=0)) if moves else []
        found.append(
            Told(track["rings"], (life[0], life[1]), nodes, table, track.get("times", []), frames)
        )
    return found


def _table(data: Mapping[str, Any]) -> dict[str, Any]:
    jumps = iter(data["jumps"])
    steps = [divmod(int(d), 2) if d != "0" else (next(jumps), next(jumps)) for d in data["ways"]]
    ways = np.cumsum(np.array(steps, dtype=int).reshape(-1, 2), axis=0)
    spells = np.array(data["lives"], dtype=int).reshape(-1, 3)
    ends = np.repeat(np.cumsum(spells[:, :2], axis=0), spells[:, 2], axis=0)
    lives = np.tile([0.0, 1.0], (len(ways), 1))
    if len(ways):
        lives[ways[:, 0] != ways[:, 1]] = np.array(data["moments"])[ends]
    points = np.cumsum(np.reshape(data["points"], (-1, 2)), axis=0)
    return {"points": points, "ways": ways, "lives": lives}


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
