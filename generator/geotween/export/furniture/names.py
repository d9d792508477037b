"""What regions are labelled: names, keys or a column, as the scene says."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from geotween.data.polygons import Identity
from geotween.data.read.columns import as_text
from geotween.scene.model import SceneFile

# `auto` labels a map whose regions have names, and not more than this: more would be an atlas.
MANY = 12


def naming(
    model: SceneFile, identities: Iterable[Identity], layers: Sequence[str]
) -> Callable[[Identity], str] | None:
    """What a region is labelled, as the scene says; None where regions have no labels.

    `auto` leaves hotspots and classes that lie on each other to the legend.
    """
    wanted = model.map.labels
    if wanted == "none":
        return None
    if wanted == "keys":
        return lambda identity: str(identity.key) if identity.keyed else ""
    if wanted == "names":
        return lambda identity: identity.name
    if wanted == "auto":
        names = {identity.name for identity in identities} - {""}
        few = 1 <= len(names) <= MANY and model.hotspots is None and len(layers) < 2
        return (lambda identity: identity.name) if few else None
    return lambda identity: _column(identity, wanted)


def _column(identity: Identity, column: str) -> str:
    value = identity.attributes.get(column)
    try:
        return "" if value is None else as_text(value)
    except ValueError:
        return ""
