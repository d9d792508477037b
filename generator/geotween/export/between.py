"""The frames in between as GeoJSON, in longitude and latitude and with times, for a GIS."""

from __future__ import annotations

import datetime
import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import shapely
from shapely.geometry import MultiPolygon, Polygon

from geotween.data.load import Scene, Step
from geotween.data.polygons import Identity
from geotween.export.timeline import timeline
from geotween.motion.tracks import Track, drawn
from geotween.scene.errors import Fault, SceneError

BETWEEN = 9  # frames between two steps: tenths of the way
PRECISION = 1e-7  # degrees: a hundredth of a metre, as RFC 7946 advises
EPOCH = datetime.datetime(2000, 1, 1)  # where the map's own clock begins, if steps have no dates


@dataclass(frozen=True, eq=False)
class Moment:
    """What is there at one time: the last step before it, the share t of the way to the next."""

    step: int
    t: float
    found: list[tuple[Identity, Polygon | MultiPolygon]]


def frames_geojson(scene: Scene, tracks: Sequence[Sequence[Track]], between: int = BETWEEN) -> str:
    """The steps of a scene and frames between them as a GeoJSON FeatureCollection (RFC 7946).

    A feature is a region at one time. ``start`` and ``end`` are the times between which it is to
    be shown, read by QGIS's temporal controller: those of the steps where all have dates that
    rise, else the seconds of the map's clock from the year 2000 on. No easing: t is the share of
    the time.

    Parameters
    ----------
    tracks
        Those of each transition.
    between
        Frames between two steps.

    Raises
    ------
    SceneError
        Where nothing tells where on Earth the coordinates are.
    """
    if scene.crs is None or scene.model.map.fit == "each":
        raise SceneError([_nowhere(scene)])
    moments = list(_moments(scene.steps, tracks, between))
    lines = [
        _feature(identity, shape, scene.steps[moment.step].label, moment.t, said)
        for moment, said, placed in zip(
            moments, _times(scene, between), _on_globe(scene, moments), strict=True
        )
        for (identity, _), shape in zip(moment.found, placed, strict=True)
        if not shape.is_empty
    ]
    return '{"type":"FeatureCollection","features":[\n' + ",\n".join(lines) + "\n]}\n"


def _nowhere(scene: Scene) -> Fault:
    message = "GeoJSON is in longitude and latitude, and nothing tells those of this map"
    hint = "say what its coordinates are: map: {crs: EPSG:25832}"
    if scene.model.map.fit == "each":
        message = 'GeoJSON needs steps in one plane: "fit: each" puts each into one of its own'
        hint = "say fit: shared"
    return Fault(str(scene.path), 1, 1, message, hint)


def _moments(
    steps: Sequence[Step], tracks: Sequence[Sequence[Track]], between: int
) -> Iterator[Moment]:
    for number, step in enumerate(steps):
        resting = zip(step.regions.identities, step.regions.polygons, strict=True)
        yield Moment(number, 0.0, _by_identity(resting))
        if number == len(tracks):
            return
        for k in range(1, between + 1):
            t = k / (between + 1)
            pairs = ((track.identity, shape) for shape, track in drawn(tracks[number], t))
            yield Moment(number, t, _by_identity(pairs))


def _by_identity(
    pairs: Iterable[tuple[Identity, Polygon]],
) -> list[tuple[Identity, Polygon | MultiPolygon]]:
    """The pieces of each feature as one."""
    pieces: dict[tuple[object, ...], tuple[Identity, list[Polygon]]] = {}
    for identity, polygon in pairs:
        who = (identity.layer, identity.keyed, identity.key, identity.class_)
        pieces.setdefault(who, (identity, []))[1].append(polygon)
    return [(identity, _as_one(polygons)) for identity, polygons in pieces.values()]


def _as_one(polygons: list[Polygon]) -> Polygon | MultiPolygon:
    if len(polygons) == 1:
        return polygons[0]
    union = shapely.union_all(polygons)
    assert isinstance(union, Polygon | MultiPolygon)
    return union


def _on_globe(scene: Scene, moments: Sequence[Moment]) -> list[list[Polygon | MultiPolygon]]:
    """The shapes of all moments in longitude and latitude, cut at the 180th meridian."""
    from geotween.data.globe.projection import Projection, read_crs
    from geotween.data.globe.reproject import project
    from geotween.data.read.held import GEOGRAPHIC

    assert scene.crs is not None
    globe = Projection(read_crs(GEOGRAPHIC), "", 180.0)
    shapes = np.array([shape for m in moments for _, shape in m.found], dtype=object)
    placed, _ = project(shapes, scene.crs, globe)
    rounded = shapely.set_precision(placed, PRECISION)
    oriented = iter(shapely.orient_polygons(rounded, exterior_cw=False))
    return [[next(oriented) for _ in moment.found] for moment in moments]


def _times(scene: Scene, between: int) -> list[dict[str, Any]]:
    """When each moment begins and ends, as properties."""
    written = [step.time for step in scene.steps]
    dates = [_as_moment(time) for time in written if isinstance(time, datetime.date)]
    numbers = [time for time in written if isinstance(time, float)]
    shares = np.arange(between + 1) / (between + 1)
    if len(dates) == len(written) and all(a < b for a, b in pairwise(dates)):
        starts = [a + (b - a) * share for a, b in pairwise(dates) for share in shares.tolist()]
        ends = [*starts[1:], dates[-1], dates[-1] + (dates[-1] - starts[-1])]
        starts.append(dates[-1])
    else:
        starts, ends = _on_the_clock(scene, shares)
    told: list[dict[str, Any]] = [
        {"start": _written(start), "end": _written(end)}
        for start, end in zip(starts, ends, strict=True)
    ]
    if len(numbers) == len(written):
        values = np.interp(
            np.arange(len(told)), np.arange(len(numbers)) * (between + 1), numbers
        ).tolist()
        told = [{**said, "time": value} for said, value in zip(told, values, strict=True)]
    return told


def _on_the_clock(
    scene: Scene, shares: np.typing.NDArray[np.float64]
) -> tuple[list[datetime.datetime], list[datetime.datetime]]:
    """When moments begin and end while the map plays; a rest lasts to the first frame after it."""
    spans = timeline(scene)
    seconds: list[float] = []
    for rest, move in zip(spans[::2], [*spans[1::2], None], strict=True):
        later = [] if move is None else (move.start + shares[1:] * move.length).tolist()
        seconds += [rest.start, *later]
    last = max(spans[-1].end, seconds[-1] + 1)
    clock = [EPOCH + datetime.timedelta(milliseconds=s) for s in [*seconds, last]]
    return clock[:-1], clock[1:]


def _as_moment(time: datetime.date) -> datetime.datetime:
    if isinstance(time, datetime.datetime):
        return time if time.tzinfo is None else time.astimezone(datetime.UTC)
    return datetime.datetime.combine(time, datetime.time())


def _written(moment: datetime.datetime) -> str:
    return moment.isoformat(timespec="milliseconds").replace("+00:00", "Z")


def _feature(
    identity: Identity, shape: Polygon | MultiPolygon, step: str, t: float, said: dict[str, Any]
) -> str:
    properties = {
        "key": str(identity.key) if identity.keyed else None,
        "class": identity.class_,
        "name": identity.name or None,
        "layer": identity.layer,
        "step": step,
        "t": round(t, 6),
        **said,
    }
    told = json.dumps(properties, ensure_ascii=False)
    return f'{{"type":"Feature","properties":{told},"geometry":{shapely.to_geojson(shape)}}}'
