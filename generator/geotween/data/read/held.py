"""What a source holds: its features, and what its format says of them."""

from __future__ import annotations

from dataclasses import dataclass, field

from geotween.data.polygons import Feature
from geotween.data.problems import Problem
from geotween.scene.document import Location

GEOGRAPHIC = "OGC:CRS84"  # longitude, latitude on WGS 84: GeoJSON's own, by RFC 7946


@dataclass(frozen=True, eq=False)
class Held:
    """What a source holds, before it is made valid.

    ``name`` is the file as the scene names it, empty for coordinates in the scene itself; ``at``
    is where the scene does so. ``words`` tell what ``crs`` is. ``skipped`` counts geometries
    without area. ``lonlat`` is for formats whose coordinates are longitude and latitude unless
    they say otherwise, ``wound`` for those that say which way rings run.
    """

    features: list[Feature]
    at: Location = ()
    name: str = ""
    crs: str | None = None
    words: str = ""
    skipped: int = 0
    lonlat: bool = False
    wound: bool = False
    problems: tuple[Problem, ...] = field(default=())
