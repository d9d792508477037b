"""Descent: the things of each step, and which of them come from which.

origin  A   B       most of B lies in C:              B-C
target  C   D       most of D lies in A, of A in C:   A-C  A-D     C merged from A and B, A split

Correspondence asks what a polygon has to do with; descent asks where most of a thing goes to, and
where most of it comes from. A border that shifts by a third gives a neighbour ground, not a child.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.polygons import RELATIVE_TOLERANCE, Identity, PolygonSet
from geotween.motion.correspond import Correspondence

# A thing that lives on in nothing descends to whatever takes this part of it; a thing that nothing
# became descends from whatever makes up this part. Less is a border drawn anew.
PART = 0.1

# Without a key, a thing that splits lives on in the part that is more than this of all its parts,
# twice as large as the others together; so does one that others merge with.
DOMINANT = 2 / 3

Numbers = NDArray[np.intp]
Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Things:
    """What the polygons of a set are taken for: those of one key and layer together, others alone.

    ``of`` (n,) is the thing of each polygon; ``identities`` are those of the things.
    """

    of: Numbers
    identities: tuple[Identity, ...]

    def __len__(self) -> int:
        return len(self.identities)

    def polygons(self, thing: int) -> tuple[int, ...]:
        """The places of a thing's polygons in the set."""
        return tuple(np.flatnonzero(self.of == thing).tolist())


@dataclass(frozen=True, eq=False)
class Descent:
    """Which things of the origin become which of the target.

    ``pairs`` (m, 2), sorted, are all; ``lives`` (m,) marks those whose two things are the same one,
    at most one pair for each thing.
    """

    origin: Things
    target: Things
    pairs: Numbers
    lives: NDArray[np.bool_]


def things_of(polygons: PolygonSet) -> Things:
    """The things of a set, in the order of their first polygons."""
    numbers: dict[object, int] = {}
    identities: list[Identity] = []
    of = np.empty(len(polygons), dtype=np.intp)
    for index, identity in enumerate(polygons.identities):
        name: object = (identity.layer, identity.key) if identity.keyed else index
        of[index] = numbers.setdefault(name, len(numbers))
        if of[index] == len(identities):
            identities.append(identity)
    return Things(of, tuple(identities))


def descent(related: Correspondence) -> Descent:
    """Who becomes whom among the things of two sets.

    A target thing descends from an origin thing where they correspond and one of these holds: it
    takes the largest part of it, or the largest part of it comes from there; both have one key; it
    takes at least ``PART`` of one that does not live on, or of one that did not live before at
    least ``PART`` comes from there. A thing lives on in that of its key; without keys in one that
    is more than ``DOMINANT`` of all that descends from it, and of whose forebears it is as much.
    Turned round in time it is the same relation. Cost: the intersections of corresponding polygons.
    """
    origin, target = things_of(related.origin), things_of(related.target)
    pairs, shared = _shared(related, origin, target)
    areas = _areas(related.origin, origin), _areas(related.target, target)
    same = _same_key(origin, target, pairs)
    close = same | _largest(pairs, shared, areas)
    lives = same | _dominant(origin, target, pairs, close, same, areas)
    for side in (0, 1):
        alive = np.zeros(len(areas[side]), dtype=bool)
        alive[pairs[lives, side]] = True
        part = shared >= PART * areas[side][pairs[:, side]]
        close = close | (part & ~alive[pairs[:, side]])
    return Descent(origin, target, pairs[close], lives[close])


def _shared(related: Correspondence, origin: Things, target: Things) -> tuple[Numbers, Floats]:
    """Pairs (m, 2) of things whose polygons correspond, and the area that they share (m,)."""
    i, j = related.pairs.T
    ones, others = related.origin.polygons[i], related.target.polygons[j]
    common = shapely.area(shapely.intersection(ones, others))
    codes = origin.of[i] * max(len(target), 1) + target.of[j]
    found, places = np.unique(codes, return_inverse=True)
    pairs = np.column_stack(np.divmod(found, max(len(target), 1)))
    return pairs, np.bincount(places, common, len(found)).astype(float)


def _areas(polygons: PolygonSet, things: Things) -> Floats:
    return np.bincount(things.of, shapely.area(polygons.polygons), len(things)).astype(float)


def _same_key(origin: Things, target: Things, pairs: Numbers) -> NDArray[np.bool_]:
    found = [
        (one := origin.identities[i]).keyed
        and (other := target.identities[j]).keyed
        and one.key == other.key
        for i, j in pairs.tolist()
    ]
    return np.array(found, dtype=bool)


def _largest(pairs: Numbers, shared: Floats, areas: tuple[Floats, Floats]) -> NDArray[np.bool_]:
    """Whether a pair shares the most that one of its two shares with anything, ties included."""
    chosen = np.zeros(len(pairs), dtype=bool)
    for side in (0, 1):
        most = np.zeros(len(areas[side]))
        np.maximum.at(most, pairs[:, side], shared)
        chosen |= shared >= most[pairs[:, side]] * (1 - RELATIVE_TOLERANCE)
    return chosen


def _dominant(
    origin: Things,
    target: Things,
    pairs: Numbers,
    close: NDArray[np.bool_],
    same: NDArray[np.bool_],
    areas: tuple[Floats, Floats],
) -> NDArray[np.bool_]:
    """Pairs of things without a key in common, each ``DOMINANT`` in what the other one meets."""
    chosen = close & ~same
    alone = np.ones(len(pairs), dtype=bool)
    for side, other in ((0, 1), (1, 0)):
        size = np.bincount(pairs[close, side], areas[other][pairs[close, other]], len(areas[side]))
        count = np.bincount(pairs[close, side], minlength=len(areas[side]))
        taken = np.zeros(len(areas[side]), dtype=bool)
        taken[pairs[same, side]] = True
        chosen &= areas[other][pairs[:, other]] > DOMINANT * size[pairs[:, side]]
        chosen &= ~taken[pairs[:, side]]
        alone &= count[pairs[:, side]] == 1
    for k in np.flatnonzero(chosen & ~alone).tolist():
        one, two = origin.identities[pairs[k, 0]], target.identities[pairs[k, 1]]
        chosen[k] = (one.name, one.class_) == (two.name, two.class_) and not (
            one.keyed and two.keyed
        )
    return chosen
