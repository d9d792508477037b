"""Matching by least trajectory cost: corners go to corners, and common boundary stays.

1. Boundary that both rings have in common is pinned; only the arcs between are matched. Rings
   without any are moved onto each other and cut open where they fit best.
2. Each pair of arcs is sampled finely and aligned, stiff at first; where its frames cross
   themselves, more supple, and then so that little is swept twice.
3. Vertices are put where the alignment sends them, in between in proportion.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely

from geotween.motion.alignment import Points, Work, align, path_work
from geotween.motion.arcs import (
    Places,
    complex_points,
    matched,
    outer_places,
    points_along,
    size_of,
    stretch,
)
from geotween.motion.pins import common_runs
from geotween.motion.rings import Vertices

# The work to try, one after the other, until no frame looked at crosses itself. Stiff alignments
# keep the area between their ends' (0.4% off on smooth outlines, 2% with the most supple one), but
# on rough ones the directions of edges are noise, and a stiff one folds. What folds all the same
# is mostly a bay or a spit, for which sweeping no area twice is the better rule.
BEND = 0.03  # of the strain: on crescents, combs and fires a little is better than none or much
ATTEMPTS = tuple(
    Work(strain, BEND * strain, sweep)
    for strain, sweep in (
        (1, 0), (0.3, 0), (0.1, 0), (0.03, 0), (0.01, 0), (0.1, 1), (0.01, 1), (1, 30), (0.1, 30),
    )
)  # fmt: skip
# Longer arcs, in samples of both, get only this many: each takes a good part of a second.
LONG, ATTEMPTS_IF_LONG = 8_000, 3

# Of the attempts, how many are made with rings laid on each other.
SHIFTED = 3

# Moments at which frames are looked at.
MOMENTS = np.linspace(0, 1, 17)[1:-1, None]

# Rings without common boundary are cut open by a look at so many samples of each, for so many of
# the turns that bring them nearest to each other.
ROUND, TURNS = 32, 4

# Points of a ring whose distances from its middle differ by less are equally far.
TIE = 1e-9


def trajectory(one: Vertices, other: Vertices) -> tuple[Places, Places]:
    """The matching of two open rings (n, 2) and (m, 2), wound alike, of least trajectory cost.

    Returns
    -------
    Ring parameters of the matched vertices of both, two equally long, cyclically rising arrays:
    k + s for s of the way along edge k. All vertices of both rings are among them, and vertices
    are added where the other ring has one, at most n + m in all.

    Squared displacement by the length of boundary it stands for, the work of bending and that of
    stretching are weighed relative to size, after Sederberg and Greenwood 1992: the result does
    not depend on where the rings start, and turns and grows with them. Cost: n log n for common
    boundary, n for the rest, where small arcs (alignment.WHOLE) are aligned exactly.
    """
    here, there = complex_points(one), complex_points(other)
    pins = common_runs(one, other)
    if len(pins.here):
        parts = [
            (pins.here[k : k + 1], pins.there[k : k + 1])
            if common
            else _between(
                here, there, _ends(pins.here, k, len(one)), _ends(pins.there, k, len(other))
            )
            for k, common in enumerate(pins.common.tolist())
        ]
    else:
        parts = [_all_round(here, there)]
    first = np.concatenate([part[0] for part in parts]) % len(one)
    second = np.concatenate([part[1] for part in parts]) % len(other)
    start = -int(np.argmin(first))
    return np.roll(first, start), np.roll(second, start)


def _ends(places: Places, k: int, count: int) -> tuple[float, float]:
    """Where the arc behind a place starts and ends; the end is the larger number."""
    start, end = float(places[k]), float(places[(k + 1) % len(places)])
    return start, end if end > start else end + count


def _between(
    one: Points, other: Points, first: tuple[float, float], second: tuple[float, float]
) -> tuple[Places, Places]:
    """Matched places of two arcs that have their ends in common, without the last ones."""
    (here, a), (there, b) = stretch(one, *first), stretch(other, *second)
    if len(a) == len(b) == 2:
        return here[:1], there[:1]
    found = _best(a, b, [(b, work) for work in ATTEMPTS])
    return outer_places(here, found[0])[:-1], outer_places(there, found[1])[:-1]


def _all_round(one: Points, other: Points) -> tuple[Places, Places]:
    """Matched places of two rings that have no boundary in common.

    They are matched as if they lay on each other, so that what travels keeps its shape; where
    that folds, as they lie. The cut starts from the longer one, so that it is the same both ways.
    """
    if _length(one) < _length(other):
        there_and_back = _all_round(other, one)
        return there_and_back[1], there_and_back[0]
    shift = _middle(other) - _middle(one)
    start, begin = _cut(one, other - shift)
    (here, a), (there, b) = _opened(one, start), _opened(other, begin)
    first, second = matched(a, b - shift, ATTEMPTS[0])
    # The ends of an alignment are given and its middle is found, so the cut is laid there.
    misfit = np.abs(points_along(a, first) - points_along(b, second) + shift)
    corners = (first % 1 == 0) & (second % 1 == 0)
    misfit[~corners] += misfit.max()
    third = len(first) // 3
    cut = third + int(np.argmin(misfit[third : len(first) - third]))
    start, begin = float(outer_places(here, first)[cut]), float(outer_places(there, second)[cut])
    (here, a), (there, b) = _opened(one, start), _opened(other, begin)
    laid = [(b - shift, work) for work in ATTEMPTS[:SHIFTED]] + [(b, work) for work in ATTEMPTS]
    found = _best(a, b, laid)
    return outer_places(here, found[0])[:-1], outer_places(there, found[1])[:-1]


def matched_curves(a: Points, b: Points) -> tuple[Places, Places]:
    """Matched places of two open curves whose ends match, from end to end.

    Curves that lie apart are matched as if they lay on each other, as rings are. The points that
    go to a single edge go there in proportion, unless frames cross themselves then.
    """
    if len(b) == 2:
        here, there = np.arange(float(len(a))), _shares(a)
        if len(a) == 2 or not _crossed(a, points_along(b, there)):
            return here, there
    elif len(a) == 2:
        there, here = matched_curves(b, a)
        return here, there
    shift = (b[0] - a[0] + b[-1] - a[-1]) / 2
    laid = [(b - shift, work) for work in ATTEMPTS[:SHIFTED]] if shift else []
    return _best(a, b, laid + [(b, work) for work in ATTEMPTS])


def _shares(curve: Points) -> Places:
    """How far along an open curve its points are, from 0 to 1; without length, in equal steps."""
    along = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(curve)))])
    if not along[-1]:
        return np.linspace(0, 1, len(curve))
    return np.asarray(along / along[-1])


def _length(ring: Points) -> float:
    return float(np.abs(np.roll(ring, -1) - ring).sum())


def _middle(ring: Points) -> complex:
    """The centroid of a ring's boundary."""
    after = np.roll(ring, -1)
    lengths = np.abs(after - ring)
    return complex((lengths * (ring + after)).sum() / (2 * lengths.sum()))


def _opened(ring: Points, start: float) -> tuple[Places, Points]:
    return stretch(ring, start % len(ring), start % len(ring) + len(ring))


def _cut(one: Points, other: Points) -> tuple[float, float]:
    """A place on each of two rings where they are well cut open."""
    here, there = _round(one), _round(other)
    a, b = points_along(one, here), points_along(other, there)
    gain = np.fft.ifft(np.conj(np.fft.fft(a)) * np.fft.fft(b)).real
    peaks = np.flatnonzero((gain >= np.roll(gain, 1)) & (gain >= np.roll(gain, -1)))
    peaks = peaks[np.argsort(-gain[peaks], kind="stable")][:TURNS]
    size = size_of(a, b)
    works = []
    for turn in peaks:
        turned = np.roll(b, -turn)
        ends = np.append(a, a[0]), np.append(turned, turned[0])
        path = align(*ends, ATTEMPTS[0], size)
        works.append(path_work(*ends, path, ATTEMPTS[0], size))
    return float(here[0]), float(there[peaks[int(np.argmin(works))]])


def _round(ring: Points) -> Places:
    """Places in equal steps along a ring, from the one that is farthest from its middle."""
    off = np.abs(ring - _middle(ring))
    far = np.flatnonzero(off >= off.max() * (1 - TIE))
    start = int(far[np.lexsort((ring[far].imag, ring[far].real))[0]])
    _, points = _opened(ring, start)
    along = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(points)))])
    steps = np.interp(np.arange(ROUND) / ROUND * along[-1], along, np.arange(len(points)))
    return np.asarray((start + steps) % len(ring))


def _best(a: Points, b: Points, attempts: Sequence[tuple[Points, Work]]) -> tuple[Places, Places]:
    """The first of some alignments that does not cross itself, or the one that does so least.

    ``attempts`` are the second curve as it is to be laid, and the work.
    """
    if len(a) + len(b) > LONG:
        attempts = attempts[:ATTEMPTS_IF_LONG]
    found: list[tuple[int, tuple[Places, Places]]] = []
    for laid, work in attempts:
        places = matched(a, laid, work)
        found.append((_crossed(points_along(a, places[0]), points_along(b, places[1])), places))
        if not found[-1][0]:
            break
    return min(found, key=lambda one: one[0])[1]


def _crossed(a: Points, b: Points) -> int:
    """How many of the frames looked at cross themselves."""
    frames = (1 - MOMENTS) * a + MOMENTS * b
    lines: Any = shapely.linestrings(np.stack([frames.real, frames.imag], axis=-1))
    return int((~shapely.is_simple(lines)).sum())
