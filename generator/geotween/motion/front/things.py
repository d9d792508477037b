"""Things: what bears one identity from end to end of a transition, by name or by place.

origin  a a b b      a breaks up into c and d, b lives on and loses a part to d:
target  c d d b      labels are a, b, c, d; things are (a, c), (a, d) and (b, b)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from geotween.data.polygons import Identity, PolygonSet
from geotween.motion.correspond import LEAST_SHARE, SHARE
from geotween.motion.front.plane import NOTHING, Floats, Ints, Plane, Thing
from geotween.motion.groups import connected

# Of two tiles without names each is more than this part of the other: they are the same one.
MOST = 0.5

Name = tuple[str, object]


@dataclass(frozen=True, eq=False)
class Labels:
    """Who each polygon is, as a number (n,) for each set; the same number, the same one."""

    of_origin: Ints
    of_target: Ints

    @property
    def count(self) -> int:
        """One more than the largest label."""
        return int(max(self.of_origin.max(initial=-1), self.of_target.max(initial=-1))) + 1

    def of_faces(self, cover: Ints) -> Ints:
        """The labels (2, f) of the polygons that cover each face, NOTHING where none does."""
        ends = zip((self.of_origin, self.of_target), cover, strict=True)
        return np.stack([np.append(labels, NOTHING)[covering] for labels, covering in ends])


def labels_of(origin: PolygonSet, target: PolygonSet, plane: Plane, cover: Ints) -> Labels:
    """Who is who: by key, without a key by class where there are several, else by place.

    Polygons without names that overlap, be it through others, are one: a fire that splits stays
    one fire. Where some of them border on each other, as tiles do, each is one of its own, and
    the same as a tile of the other set if ``MOST`` of both is common.
    """
    identities = (*origin.identities, *target.identities)
    classes = {identity.class_ for identity in identities if not identity.keyed}
    names = [_name(identity, len(classes) > 1) for identity in identities]
    nameless = np.array([name is None for name in names], dtype=bool)
    if nameless.any():
        sets = np.where(cover == NOTHING, NOTHING, cover + np.array([[0], [len(origin)]]))
        sets[~np.append(nameless, False)[sets]] = NOTHING
        by_place = _by_place(sets, len(names), plane)
        names = [by_place[i] if name is None else name for i, name in enumerate(names)]
    numbers: dict[Name | None, int] = {}
    found = np.array([numbers.setdefault(name, len(numbers)) for name in names], dtype=np.intp)
    return Labels(found[: len(origin)], found[len(origin) :])


def lasting(labels: Labels, of_faces: Ints, areas: Floats) -> Ints:
    """The pairs (k, 2) of labels that are one thing from end to end, sorted.

    A label of both ends with itself; one that ends with one that begins, where they share a
    ``SHARE`` of the smaller, or, if that leaves one of them alone, the most and a ``LEAST_SHARE``:
    less is a sliver along borders that were drawn twice. The partner of what has none is NOTHING.
    """
    every = np.arange(labels.count)
    ends, begins = np.isin(every, labels.of_origin), np.isin(every, labels.of_target)
    one, other, shared = _shared(of_faces, areas)
    turning = ~begins[one] & ~ends[other]
    one, other, shared = one[turning], other[turning], shared[turning]
    smaller = np.minimum(
        sums(of_faces[0], areas, len(every))[one], sums(of_faces[1], areas, len(every))[other]
    )
    real = shared >= SHARE * smaller
    kept = real.copy()
    for side in (one, other):
        most = np.zeros(len(every))
        np.maximum.at(most, side, shared)
        alone = ~np.isin(side, side[real])
        kept |= alone & (shared == most[side]) & (shared >= LEAST_SHARE * smaller)
    alive = every[ends & begins]
    gone = np.setdiff1d(every[ends & ~begins], one[kept])
    new = np.setdiff1d(every[begins & ~ends], other[kept])
    pairs = [
        np.column_stack([alive, alive]),
        np.column_stack([one[kept], other[kept]]),
        np.column_stack([gone, np.full_like(gone, NOTHING)]),
        np.column_stack([np.full_like(new, NOTHING), new]),
    ]
    return np.unique(np.concatenate(pairs), axis=0)


def things_of(
    pairs: Ints, labels: Labels, origin: PolygonSet, target: PolygonSet
) -> tuple[Thing, ...]:
    """Things from pairs (k, 2) of labels; each has the identity of its label's largest polygon."""
    before = _identities(origin, labels.of_origin, labels.count)
    after = _identities(target, labels.of_target, labels.count)
    return tuple(Thing(before[one], after[other]) for one, other in pairs.tolist())


def sums(numbers: Ints, weights: Floats, count: int) -> Floats:
    """The sum (count,) of the weights of each number; of NOTHING there is none."""
    found = np.bincount(numbers + 1, weights=weights, minlength=count + 1)
    return found[1:].astype(np.float64)


def _name(identity: Identity, by_class: bool) -> Name | None:
    if identity.keyed:
        return "key", identity.key
    return ("class", identity.class_) if by_class and identity.class_ is not None else None


def _by_place(cover: Ints, count: int, plane: Plane) -> list[Name]:
    """Names for polygons, numbered over both sets, from those that cover each face (2, f)."""
    areas = shapely.area(plane.faces)
    sizes = np.sum([sums(side, areas, count) for side in cover], axis=0)
    one, other, shared = _shared(cover, areas)
    pairs = np.column_stack([one, other])
    smaller, larger = np.sort(sizes[pairs], axis=1).T
    group = connected(pairs[shared >= LEAST_SHARE * smaller], count)
    tile = connected(pairs[shared > MOST * larger], count)
    sides = plane.sides[plane.between]
    tiled = np.zeros(count, dtype=bool)
    for side in cover:
        left, right = side[sides].T
        beside = (left != right) & (left != NOTHING) & (right != NOTHING)
        tiled[group[left[beside & (group[left] == group[right])]]] = True
    return [
        ("tile", tile[polygon]) if tiled[group[polygon]] else ("place", group[polygon])
        for polygon in range(count)
    ]


def _shared(cover: Ints, areas: Floats) -> tuple[Ints, Ints, Floats]:
    """The pairs of numbers at both ends of faces (2, f), without NOTHING, and the area of each."""
    both = (cover != NOTHING).all(axis=0)
    width = int(cover.max(initial=0)) + 1
    pairs, place = np.unique(cover[0, both] * width + cover[1, both], return_inverse=True)
    shared = sums(place.reshape(-1), areas[both], len(pairs))
    return pairs // width, pairs % width, shared


def _identities(polygons: PolygonSet, labels: Ints, count: int) -> list[Identity | None]:
    """For each label the identity of its largest polygon, of equals the first; None at the end."""
    found: list[Identity | None] = [None] * (count + 1)
    for place in np.argsort(-shapely.area(polygons.polygons), kind="stable")[::-1].tolist():
        found[labels[place]] = polygons.identities[place]
    return found
