"""Labels: names of regions that lie inside them, go with them, and keep clear of each other.

1. At each step a label stands where its text has most room in the largest part of its region, or
   where it stood before if that has room enough.
2. In a transition it goes straight from place to place. Where it would leave its region on the way
   a moment is added, at which it is where it has most room then; a label that still leaves it is
   not shown in that transition.
3. In each span the more important labels, those of larger regions, keep the others away.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TypeAlias

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon

from geotween.data.polygons import Identity
from geotween.export.bundle import Member
from geotween.export.furniture.names import naming
from geotween.export.furniture.room import Box, boxes, clash, drawn_at, fits, roomiest
from geotween.export.furniture.text import text_width
from geotween.export.page_grid import GridTrack
from geotween.export.timeline import Span
from geotween.scene.model import SceneFile

SIZE = 13.0  # px, of a label's text
LINE = 1.1  # its height in sizes
BOLD = 1.05  # the width of its letters to that of others

# Of the room of a text's ellipse (1: it just fits) at a step, and on the way between two.
AT_STEP, ON_THE_WAY = 1.0, 0.75

# A label stays where it stood as long as it has this share of the most room there is.
STAY = 0.7

# Moments of a transition at which a label's place is looked at, and how many may be added.
LOOKS = 33
MOMENTS = np.linspace(0, 1, LOOKS)
ADDED = 10

# The farthest (px) that a label goes from one of these moments to the next: faster is a leap.
FARTHEST = 30.0

Way: TypeAlias = tuple[tuple[float, float, float], ...]  # t, x and y in px


@dataclass(frozen=True)
class Label:
    """A text that goes with a region: in each span that shows it where it is, and when.

    ``key`` is the region's, empty where it has none. The text may be drawn as many times larger
    than its size as ``room`` says, for a map that is seen from afar: it still lies inside, and
    clear of the labels before it.
    """

    text: str
    key: str
    spans: Mapping[int, Way]
    room: float = 1.0


@dataclass(frozen=True)
class Who:
    """What a label goes with: regions of one layer and text, and of one key if they have any."""

    layer: str
    key: str
    text: str

    @cached_property
    def half(self) -> NDArray[np.float64]:
        """Half the size (2,) of the text in px."""
        return np.array([BOLD * text_width(self.text, SIZE), SIZE * LINE]) / 2


@dataclass(eq=False)
class Moving:
    """The tracks of one label in a span, and their largest part at each moment, in px."""

    tracks: list[GridTrack] = field(default_factory=list)
    seen: dict[float, Polygon | None] = field(default_factory=dict)

    def at(self, t: float) -> Polygon | None:
        if t not in self.seen:
            self.seen[t] = _largest(self.tracks, t)
        return self.seen[t]


def labels(
    model: SceneFile,
    spans: Sequence[Span],
    members: Sequence[Sequence[Member]],
    layers: Sequence[str],
    taken: Callable[[int], Sequence[Box]],
) -> tuple[Label, ...]:
    """The labels of a map, the most important first.

    ``members`` are the tracks of each span with who they are; ``taken`` tells which places of a
    span other words take.
    """
    named = naming(model, [m.identity for of_span in members for m in of_span], layers)
    if named is None:
        return ()
    regions = [_regions(of_span, named) for of_span in members]
    ways = _at_rest(spans, regions)
    ways |= _on_the_way(spans, regions, ways)
    order = _by_importance(spans, regions)
    shown: dict[Who, dict[int, Way]] = {who: {} for who in order}
    room = dict.fromkeys(order, np.inf)
    for span in range(len(spans)):
        candidates = [who for who in order if (span, who) in ways]
        for who, clear in _clear(candidates, ways, span, taken(span)):
            shown[who][span] = ways[span, who]
            room[who] = min(room[who], clear, _room(regions[span][who], who, ways[span, who]))
    found = [Label(who.text, who.key, shown[who], max(1.0, room[who])) for who in order]
    return tuple(label for label in found if label.spans)


def _regions(members: Sequence[Member], named: Callable[[Identity], str]) -> dict[Who, Moving]:
    found: dict[Who, Moving] = {}
    for member in members:
        i, track = member.identity, member.track
        text = named(i).strip()
        if text and track.vertices.shape[1]:
            who = Who(i.layer, str(i.key) if i.keyed else "", text)
            found.setdefault(who, Moving()).tracks.append(track)
    return found


def _at_rest(
    spans: Sequence[Span], regions: Sequence[Mapping[Who, Moving]]
) -> dict[tuple[int, Who], Way]:
    """Where labels stand at the steps, as far as their regions have room for them."""
    ways: dict[tuple[int, Who], Way] = {}
    stood: dict[Who, NDArray[np.float64]] = {}
    for span in (number for number, one in enumerate(spans) if one.rest):
        parts = {who: region.at(0.0) for who, region in regions[span].items()}
        large = [(who, part) for who, part in parts.items() if part and _may_fit(part, who)]
        if not large:
            continue
        halves = np.array([who.half for who, _ in large])
        polygons = np.array([part for _, part in large], dtype=object)
        places = roomiest(polygons, halves)
        room = fits(polygons, places, halves)
        for number, (who, _) in enumerate(large):
            if room[number] < AT_STEP:
                continue
            place = places[number]
            if who in stood:
                one, half = polygons[number : number + 1], halves[number : number + 1]
                still = fits(one, stood[who][None], half)[0]
                if still >= max(AT_STEP, STAY * room[number]):
                    place = stood[who]
            stood[who] = place
            ways[span, who] = ((0.0, float(place[0]), float(place[1])),)
    return ways


def _may_fit(polygon: Polygon, who: Who) -> bool:
    west, south, east, north = polygon.bounds
    return bool(np.all(2 * who.half <= (east - west, north - south)))


def _on_the_way(
    spans: Sequence[Span],
    regions: Sequence[Mapping[Who, Moving]],
    rests: Mapping[tuple[int, Who], Way],
) -> dict[tuple[int, Who], Way]:
    """The ways of labels in transitions, of those that both steps show."""
    ways: dict[tuple[int, Who], Way] = {}
    for span in (number for number, one in enumerate(spans) if not one.rest):
        for who, region in regions[span].items():
            start, end = rests.get((span - 1, who)), rests.get((span + 1, who))
            if start is None or end is None:
                continue
            way = _led(region, who, start[0][1:], end[0][1:])
            if way is not None:
                ways[span, who] = way
    return ways


def _led(
    region: Moving, who: Who, start: tuple[float, float], end: tuple[float, float]
) -> Way | None:
    """A way through a moving region that stays inside it; None if none is found."""
    seen = [region.at(float(t)) for t in MOMENTS]
    if any(part is None for part in seen[1:-1]):
        return None
    inner = np.array(seen[1:-1], dtype=object)
    halves = np.tile(who.half, (len(inner), 1))
    known = {0.0: start, 1.0: end}
    for _ in range(ADDED + 1):
        times = sorted(known)
        places = np.array([known[t] for t in times])
        along = np.column_stack([np.interp(MOMENTS[1:-1], times, axis) for axis in places.T])
        room = fits(inner, along, halves)
        worst = int(room.argmin())
        if room[worst] >= ON_THE_WAY:
            if not _leads_through(inner, along):
                return None
            if (places == places[0]).all():
                times = times[:1]
            return tuple((t, float(known[t][0]), float(known[t][1])) for t in times)
        t = float(MOMENTS[1 + worst])
        if t in known:
            return None
        place = roomiest(inner[worst : worst + 1], halves[:1])[0]
        known[t] = (float(place[0]), float(place[1]))
    return None


def _leads_through(parts: NDArray[np.object_], places: NDArray[np.float64]) -> bool:
    """Whether a label does not leave its region, nor leap, from each moment to the next."""
    lines = shapely.linestrings(np.stack([places[:-1], places[1:]], axis=1))
    near = np.hypot(*np.diff(places, axis=0).T) <= FARTHEST
    still = (places[:-1] == places[1:]).all(axis=1)
    inside = shapely.contains(parts[:-1], lines) & shapely.contains(parts[1:], lines)
    return bool((near & (inside | still)).all())


def _by_importance(spans: Sequence[Span], regions: Sequence[Mapping[Who, Moving]]) -> list[Who]:
    """Labels by the largest area that their region has at a step."""
    area: dict[Who, float] = {}
    for of_span, span in zip(regions, spans, strict=True):
        if span.rest:
            for who, region in of_span.items():
                part = region.at(0.0)
                area[who] = max(area.get(who, 0.0), part.area if part else 0.0)
    return sorted(area, key=lambda who: -area[who])


def _clear(
    order: Sequence[Who],
    ways: Mapping[tuple[int, Who], Way],
    span: int,
    taken: Sequence[Box],
) -> Iterable[tuple[Who, float]]:
    """Those of some labels that keep clear, in a span, of what comes before them.

    With each comes how many times larger all of them can be until it meets another label.
    """
    there = [np.tile(box, (LOOKS, 1)) for box in taken]
    labelled: list[tuple[Who, NDArray[np.float64]]] = []
    for who in order:
        places = places_on(ways[span, who], MOMENTS)
        own = boxes(places, who.half)
        if any(clash(own, other).any() for other in there):
            continue
        there.append(own)
        apart = [np.abs(places - p) / (who.half + other.half) for other, p in labelled]
        labelled.append((who, places))
        yield who, min((float(ratio.max(axis=1).min()) for ratio in apart), default=np.inf)


def _room(region: Moving, who: Who, way: Way) -> float:
    """How many times larger a text on a way may be, and still lie inside its region."""
    seen = [(t, region.at(float(t))) for t in (MOMENTS if len(way) > 1 else MOMENTS[:1])]
    there = [(t, part) for t, part in seen if part is not None]
    parts = np.array([part for _, part in there], dtype=object)
    places = places_on(way, np.array([t for t, _ in there]))
    return float(fits(parts, places, np.tile(who.half, (len(parts), 1))).min())


def places_on(way: Way, moments: NDArray[np.float64]) -> NDArray[np.float64]:
    """The places (k, 2) on a way at some moments."""
    times, x, y = np.transpose(way)
    return np.column_stack([np.interp(moments, times, axis) for axis in (x, y)])


def _largest(tracks: Sequence[GridTrack], t: float) -> Polygon | None:
    """The largest part of what some tracks cover at t, in px."""
    drawn, _ = drawn_at([track for track in tracks if track.life[0] <= t <= track.life[1]], t)
    if not len(drawn):
        return None
    solid = shapely.make_valid(drawn)
    whole = solid[0] if len(solid) == 1 else shapely.union_all(solid)
    parts = shapely.get_parts(shapely.get_parts(whole))
    parts = parts[shapely.get_type_id(parts) == shapely.GeometryType.POLYGON]
    return parts[int(np.argmax(shapely.area(parts)))] if len(parts) else None
