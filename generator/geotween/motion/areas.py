"""Area over time: exactly, for vertices that move on straight lines between key times.

The signed area of a ring is then a quadratic between key times, and so is a sum of areas.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geotween.motion.rings import next_vertex
from geotween.motion.tracks import Track

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class AreaOverTime:
    """A sum of areas: between ``times[k]`` and the next it is c0 + c1 t + c2 t², c in row k.

    ``times`` (k + 1,) run from 0 to 1; ``coefficients`` (k, 3) are in square units of the data.
    """

    times: Floats
    coefficients: Floats

    @property
    def ends(self) -> tuple[float, float]:
        """The areas at 0 and at 1."""
        return float(self.coefficients[0, 0]), float(self.coefficients[-1].sum())

    def extremes(self, linear: bool = False) -> tuple[float, float]:
        """The least and the largest over all t; of what is off the straight way if ``linear``."""
        c = self.coefficients.copy()
        if linear:
            start, end = self.ends
            c[:, :2] -= start, end - start
        bent = np.where(np.abs(c[:, 2]) > 0, c[:, 2], np.inf)
        low, high = self.times[:-1], self.times[1:]
        moments = np.stack([low, high, np.clip(-c[:, 1] / (2 * bent), low, high)])
        values = c[:, 0] + moments * (c[:, 1] + moments * c[:, 2])
        return float(values.min()), float(values.max())


def area_over_time(tracks: Sequence[Track]) -> AreaOverTime:
    """The sum of the areas of some tracks. Cost: linear in their vertices and key times."""
    starts, ends, rows = [np.array([0.0])], [np.array([1.0])], [np.zeros((1, 3))]
    for track in tracks:
        low, high = track.times[:-1], track.times[1:]
        areas = _areas(track.vertices, next_vertex(track.offsets))
        middle = _areas((track.vertices[:-1] + track.vertices[1:]) / 2, next_vertex(track.offsets))
        first, last, length = areas[:-1], areas[1:], high - low
        bend = 2 * (first + last - 2 * middle)  # of s in first + slope s + bend s², s from 0 to 1
        slope = last - first - bend
        quadratic = bend / length**2
        linear = slope / length - 2 * quadratic * low
        starts.append(low)
        ends.append(high)
        rows.append(
            np.stack([first - linear * low - quadratic * low**2, linear, quadratic], axis=1)
        )
    start, end, row = np.concatenate(starts), np.concatenate(ends), np.concatenate(rows)
    times = np.unique(np.concatenate([start, end]))
    changes = np.zeros((len(times), 3))
    np.add.at(changes, np.searchsorted(times, start), row)
    np.add.at(changes, np.searchsorted(times, end), -row)
    return AreaOverTime(times, np.cumsum(changes, axis=0)[:-1])


def _areas(vertices: Floats, following: NDArray[np.intp]) -> Floats:
    """The signed area (k,) of rings at k moments; relative to their first vertex."""
    places = vertices - vertices[:, :1]
    after = places[:, following]
    return np.asarray((places[..., 0] * after[..., 1] - places[..., 1] * after[..., 0]).sum(1) / 2)
