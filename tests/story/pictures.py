"""Small sets of squares, as the pictures in the tests' names."""

from __future__ import annotations

from collections.abc import Sequence

import shapely

from geotween.data.polygons import Feature, PolygonSet, polygon_set
from geotween.motion.techniques import resolve
from geotween.story.events import Event, events, related_by_layer
from geotween.story.measure import Measure, Plane

Box = tuple[float, float, float, float]  # least x and y, greatest x and y


def boxes(*found: Box) -> PolygonSet:
    """A set without keys."""
    return polygon_set([Feature(shapely.box(*box)) for box in found])


def keyed(**found: Box | Sequence[Box]) -> PolygonSet:
    """A set whose keys are the names; a list of boxes is one feature in parts."""
    return polygon_set(
        [
            Feature(
                shapely.multipolygons([shapely.box(*one) for one in box])
                if isinstance(box, list)
                else shapely.box(*box),
                key,
            )
            for key, box in found.items()
        ]
    )


def events_of(
    origin: PolygonSet,
    target: PolygonSet,
    measure: Measure | None = Plane(),  # noqa: B008  # it is frozen
    **motion: object,
) -> tuple[Event, ...]:
    """The events between two sets that correspond as a scene's would."""
    techniques = resolve("auto", **motion)  # type: ignore[arg-type]
    return events(related_by_layer(origin, target, techniques), measure)


def told(origin: PolygonSet, target: PolygonSet, **motion: object) -> list[str]:
    """The events in short: kind, subject and partners by what they are called."""
    return [
        " ".join([event.kind, event.subject.called, *(p.called for p in event.partners)]).replace(
            "polygon ", ""
        )
        for event in events_of(origin, target, **motion)  # type: ignore[arg-type]
    ]
