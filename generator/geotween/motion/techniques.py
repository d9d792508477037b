"""The technique of each stage of a motion, by name; what the methods stand for."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from geotween.data.polygons import Identity
from geotween.motion import divide, match, paths
from geotween.motion.correspond import check_technique
from geotween.motion.front.changes import ANNEXATIONS

MORPH, FRONT = "morph", "front"  # the two motions; a front matches nothing


@dataclass(frozen=True)
class Techniques:
    """The name of each stage's technique, and the method that chooses between the two motions.

    ``radius`` is that of correspondence ``within``. ``annexation`` is what becomes of a region
    that a neighbour takes over as a whole.
    ``births`` says which point a polygon without a partner grows from, or shrinks to. ``retries``
    are what is tried, in turn, for pieces that the first matching does not prove: other matchings,
    or ``front``.
    """

    method: str
    correspondence: str
    division: str
    matching: str
    path: str = "straight"
    births: str = "innermost"
    retries: tuple[str, ...] = ()
    radius: float | None = None
    annexation: str = "sweep"
    exceptions: Mapping[tuple[str, str], str] = field(default_factory=dict)

    def named(self, identity: Identity) -> str:
        """The method that an exception names for an identity, the most particular first; or none.

        Exceptions are by ``("key", key)``, ``("class", class)`` and ``("layer", layer)``.
        """
        places = [("class", identity.class_ or ""), ("layer", identity.layer)]
        if identity.keyed:
            places.insert(0, ("key", str(identity.key)))
        return next((self.exceptions[p] for p in places if p in self.exceptions), "")


_PAPER = Techniques("paper", "intersects", "voronoi", "rotation", births="centroid")
_MORPH = Techniques(
    MORPH, "auto", "territory", "trajectory", retries=("rotation", "intrinsic", FRONT)
)

METHODS: Mapping[str, Techniques] = {
    "paper": _PAPER,
    MORPH: _MORPH,
    FRONT: replace(_MORPH, method=FRONT),
    "auto": replace(_MORPH, method="auto"),
}


def resolve(
    method: str,
    correspondence: str | None = None,
    division: str | None = None,
    matching: str | None = None,
    path: str | None = None,
    radius: float | None = None,
    annexation: str | None = None,
    exceptions: Mapping[tuple[str, str], str] | None = None,
) -> Techniques:
    """The technique of each stage: the one named, else the method's.

    Where a matching is named there are no retries.

    Raises
    ------
    ValueError
        For an unknown name, and for a radius where it does not belong.
    """
    default = METHODS[_known(method, METHODS, "method")]
    named: dict[str, Any] = {
        "correspondence": correspondence,
        "division": division,
        "matching": matching,
        "path": path,
        "retries": () if matching else None,
        "radius": radius,
        "annexation": annexation,
        "exceptions": exceptions,
    }
    found = replace(default, **{k: v for k, v in named.items() if v is not None})
    check_technique(found.correspondence, found.radius)
    _known(found.division, divide.TECHNIQUES, "division")
    _known(found.matching, match.TECHNIQUES, "matching")
    _known(found.path, paths.TECHNIQUES, "path")
    _known(found.annexation, ANNEXATIONS, "annexation")
    return found


def _known(name: str, table: Collection[str], what: str) -> str:
    if name not in table:
        raise ValueError(f"unknown {what} {name!r}; expected one of {', '.join(sorted(table))}")
    return name
