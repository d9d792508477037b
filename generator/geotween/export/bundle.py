"""Bundles: the tracks of a span that are one path, and the shapes that draw them.

Tracks of one key and one paint make a bundle, drawn as one region path; where a bundle has seams,
its stroke becomes paths of their own, so that a closed seam is not stroked.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from geotween.data.polygons import Identity
from geotween.export.backing import Bundle, backings
from geotween.export.page_grid import GridTrack
from geotween.export.paint import Paint, Painter
from geotween.export.shapes import Group, Kind, Shape, Slot


@dataclass(frozen=True, eq=False)
class Member:
    """A track of a span, the identity it bears, and those that it is painted by at both ends."""

    identity: Identity
    ends: tuple[Identity, Identity]
    track: GridTrack


def shapes_of(members: Iterable[Member], painter: Painter) -> list[Shape]:
    """The paths of a span, its backings first."""
    bundles = _bundles(members, painter)
    shapes = backings(bundles)
    for bundle in bundles:
        codes = np.unique(np.concatenate([track.seams for track in bundle.tracks]))
        tracks, paints = tuple(bundle.tracks), _of_one_width(*bundle.paints)
        if not bundle.stroked or not codes.any():
            shapes.append(Shape(_slot(bundle, "region"), tracks, paints))
            continue
        fill = (paints[0].filled_only(), paints[1].filled_only())
        stroke = (paints[0].stroked_only(), paints[1].stroked_only())
        shapes.append(Shape(_slot(bundle, "region"), tracks, fill))
        if (codes == 0).any():
            shapes.append(Shape(_slot(bundle, "border"), tracks, stroke))
        for code in codes[codes > 0]:
            shapes.append(Shape(_slot(bundle, "seam", int(code)), tracks, stroke))
    return shapes


def _of_one_width(one: Paint, other: Paint) -> tuple[Paint, Paint]:
    """Two paints; a stroke that comes or goes does so in its full width."""
    if one.stroked == other.stroked:
        return one, other
    if other.stroked:
        return replace(one, stroke="none", width=other.width), other
    return one, replace(other, stroke="none", width=one.width)


def _slot(bundle: Bundle, kind: Kind, code: int = 0) -> Slot:
    return Slot(bundle.group, kind, bundle.key, bundle.number, code)


def _bundles(members: Iterable[Member], painter: Painter) -> list[Bundle]:
    found: dict[object, Bundle] = {}
    numbers: dict[object, int] = {}
    for member in members:
        if not member.track.vertices.shape[1]:
            continue
        key = str(member.identity.key) if member.identity.keyed else ""
        one, other = member.ends
        paints = (painter.paint(one), painter.paint(other))
        group = Group(member.identity.layer, (painter.opacity(one), painter.opacity(other)))
        name = (group, key, paints)
        if name not in found:
            number = numbers.setdefault((group, key), 0)
            numbers[group, key] += 1
            found[name] = Bundle(group, key, number, paints)
        found[name].tracks.append(member.track)
    return list(found.values())
