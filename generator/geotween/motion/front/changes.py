"""What changes in a transition: which thing gives way to which, where, and from which side."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from geotween.data.polygons import RELATIVE_TOLERANCE, PolygonSet
from geotween.motion.front.plane import (
    INNER,
    NEUTRAL,
    NONE,
    NOTHING,
    SINK,
    SOURCE,
    Change,
    Floats,
    Ints,
    Plane,
    cut,
)
from geotween.motion.front.things import labels_of, lasting, sums, things_of
from geotween.motion.groups import connected

ANNEXATIONS = ("sweep", "in-place")

Flags = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class _Draft:
    """Things, as pairs of labels (k, 2), and the one that covers each face at each end (2, f)."""

    pairs: Ints
    cover: Ints

    @property
    def label_before(self) -> Ints:
        """The label of each thing at the origin; NOTHING also for the thing NOTHING."""
        return np.append(self.pairs[:, 0], NOTHING)

    @property
    def label_after(self) -> Ints:
        """The label of each thing at the target; NOTHING also for the thing NOTHING."""
        return np.append(self.pairs[:, 1], NOTHING)


def changes(origin: PolygonSet, target: PolygonSet, annexation: str = "sweep") -> Change:
    """What becomes of each face into which the borders of two sets part the plane.

    Parameters
    ----------
    origin, target
        The sets of a transition, of one layer.
    annexation
        Where a thing that ends goes over to one that lives on: ``sweep``, it is swept from where
        the other one borders on it, or ``in-place``, it turns where it lies.

    Raises
    ------
    ValueError
        For another annexation.
    ArithmeticError
        Where the borders cannot be cut with each other.

    Notes
    -----
    What splits, merges or gets a new name turns where it lies, and so does what would be swept
    from one thing to another but from no side. All else is a border that moves. O(n log n) for n
    vertices and crossings.
    """
    if annexation not in ANNEXATIONS:
        raise ValueError(f"annexation is one of {', '.join(ANNEXATIONS)}, not {annexation!r}")
    plane, cover = cut(origin, target)
    labels = labels_of(origin, target, plane, cover)
    of_faces = labels.of_faces(cover)
    draft = _draft(plane, of_faces, lasting(labels, of_faces, shapely.area(plane.faces)))
    turning = _from_no_side(plane, draft)
    if annexation == "in-place":
        turning |= _annexed(draft)
    draft = _turned(draft, turning)
    region = _regions(plane, draft)
    things = things_of(draft.pairs, labels, origin, target)
    before, after = draft.cover
    return Change(plane, things, before, after, region, _roles(plane, draft, region))


def _draft(plane: Plane, labels: Ints, pairs: Ints) -> _Draft:
    """A face is the thing of both its labels at both ends, else at each what it borders on."""
    areas = shapely.area(plane.faces)
    whole = _number(pairs, labels.T)
    whole[(labels == NOTHING).any(axis=0)] = NOTHING
    sizes = sums(whole, areas, len(pairs))
    by_size = np.argsort(_told_apart(sizes), kind="stable")
    count = int(max(labels.max(initial=0), pairs.max(initial=0))) + 1
    cover = np.empty_like(labels)
    for end, label in enumerate(labels):
        largest = np.full(count + 1, NOTHING)  # the last one stands for NOTHING
        largest[pairs[by_size, end]] = by_size
        largest[NOTHING] = NOTHING
        found = _spread(plane, label, whole)
        cover[end] = np.where(found == NOTHING, largest[label], found)
    return _Draft(pairs, cover)


def _spread(plane: Plane, label: Ints, thing: Ints) -> Ints:
    """The things (f,) of faces, spread to those of the same label without one: longest side first.

    To begin with to those that border on some, then to those that border on these, and so on.
    """
    left, right = label[plane.sides].T
    alike = plane.between & (left == right) & (left != NOTHING)
    one, other = np.concatenate([plane.sides[alike], plane.sides[alike, ::-1]]).T
    lengths = np.tile(plane.lengths[alike], 2)
    found = np.where(label == NOTHING, NOTHING, thing)
    count = int(thing.max(initial=0)) + 1
    while (open_ := (found[one] == NOTHING) & (found[other] != NOTHING)).any():
        votes, place = np.unique(one[open_] * count + found[other[open_]], return_inverse=True)
        length = sums(place.reshape(-1), lengths[open_], len(votes))
        order = np.argsort(_told_apart(length), kind="stable")
        found[votes[order] // count] = votes[order] % count
    return found


def _regions(plane: Plane, draft: _Draft) -> Ints:
    """The number (f,) of the region of change that each face is in, -1 where nothing changes."""
    before, after = draft.cover
    changing = before != after
    sides = plane.sides[plane.between]
    alike = (draft.cover[:, sides[:, 0]] == draft.cover[:, sides[:, 1]]).all(axis=0)
    alike &= changing[sides[:, 0]]
    component = connected(sides[alike], len(before))
    region = np.full(len(before), NOTHING, dtype=np.intp)
    region[changing] = np.unique(component[changing], return_inverse=True)[1].reshape(-1)
    return region


def _roles(plane: Plane, draft: _Draft, region: Ints) -> NDArray[np.uint8]:
    """The roles of both sides of each edge.

    Territory counts by its label: where c and d turn into s in place, a strip that goes over to s
    is swept from both of them, though it belongs to one.
    """
    still = np.append(np.where(region == NOTHING, draft.cover[0], NOTHING), NOTHING)
    is_still = np.append(region == NOTHING, True)
    regions = np.append(region, NOTHING)
    before, after = (np.append(side, NOTHING) for side in draft.cover)
    roles = np.empty(plane.sides.shape, dtype=np.uint8)
    for column, (mine, other) in enumerate((plane.sides.T, plane.sides.T[::-1])):
        there = still[other]
        same_after = draft.label_after[there] == draft.label_after[after[mine]]
        same_before = draft.label_before[there] == draft.label_before[before[mine]]
        conditions = [
            regions[mine] == NOTHING,
            regions[mine] == regions[other],
            ~is_still[other],
            there == after[mine],
            there == before[mine],
            same_after,
            same_before,
        ]
        found = [NONE, INNER, NEUTRAL, SOURCE, SINK, SOURCE, SINK]
        roles[:, column] = np.select(conditions, found, NEUTRAL)
    return roles


def _from_no_side(plane: Plane, draft: _Draft) -> Flags:
    """The faces (f,) that one thing takes from another, and no front of it can reach.

    Fronts of a thing run on through all that it takes and that hangs together.
    """
    sides = plane.sides[plane.between]
    before, after = draft.cover
    changing = before != after
    onward = (after[sides[:, 0]] == after[sides[:, 1]]) & changing[sides].all(axis=1)
    reach = connected(sides[onward], len(after))
    roles = _roles(plane, draft, _regions(plane, draft))
    reached = np.isin(reach, reach[plane.sides[roles == SOURCE]])
    return np.asarray(changing & ~reached & (draft.cover != NOTHING).all(axis=0))


def _annexed(draft: _Draft) -> Flags:
    """The faces (f,) that go over from a thing that ends to one that lives on."""
    before, after = draft.cover
    ends = draft.label_after[before] == NOTHING
    lives = draft.label_before[after] == draft.label_after[after]
    return np.asarray(ends & lives & (draft.cover != NOTHING).all(axis=0))


def _turned(draft: _Draft, turning: Flags) -> _Draft:
    """Some faces turn where they lie: one thing at both ends. Things without a face are gone."""
    before, after = draft.cover
    pairs = np.stack([draft.pairs[before[turning], 0], draft.pairs[after[turning], 1]], axis=1)
    kept = np.unique(draft.cover[:, ~turning])
    every = np.unique(np.concatenate([draft.pairs[kept[kept != NOTHING]], pairs]), axis=0)
    renumbered = np.append(_number(every, draft.pairs), NOTHING)
    cover = renumbered[draft.cover]
    cover[:, turning] = _number(every, pairs)
    return _Draft(every, cover)


def _told_apart(sizes: Floats) -> Floats:
    """Sizes, equal where they differ by rounding only, so that no choice turns with the map."""
    return np.rint(sizes / (RELATIVE_TOLERANCE * sizes.max(initial=0.0) or 1.0))


def _number(pairs: Ints, wanted: Ints) -> Ints:
    """The places of wanted pairs (m, 2) among sorted ones (k, 2), NOTHING where they are not."""
    if not len(pairs):
        return np.full(len(wanted), NOTHING, dtype=np.intp)
    width = max(int(pairs.max()), int(wanted.max(initial=0))) + 2
    known, sought = ((of[:, 0] + 1) * width + of[:, 1] + 1 for of in (pairs, wanted))
    place = np.searchsorted(known, sought).clip(max=len(known) - 1)
    return np.where(known[place] == sought, place, NOTHING)
