"""The legend: what the colours of regions and static layers mean."""

from __future__ import annotations

from dataclasses import dataclass, replace

from geotween.data.load import Scene
from geotween.data.polygons import Identity
from geotween.export.paint import Painter


@dataclass(frozen=True)
class Entry:
    """A colour and what it means; colours are as they are seen on the map's ground.

    ``class_`` is the class that it stands for, if it does.
    """

    label: str
    fill: str
    stroke: str
    class_: str | None = None


def legend(scene: Scene, painter: Painter, *, labelled: bool) -> tuple[Entry, ...]:
    """The entries of a map's legend; none where there is nothing to tell apart.

    Unless the scene says what to list: classes, in the order they are drawn in, where two of them
    differ in colour, and static layers that have a name. Where the map is ``labelled`` and no class
    has two features at a step, the labels say it all.
    """
    wanted = scene.model.map.legend
    if wanted == "none":
        return ()
    of_class, of_key, of_layer = _classes(scene, painter), _keys(scene, painter), _layers(scene)
    if isinstance(wanted, dict):
        known = of_layer | of_key | of_class
        named = [(words, known[name]) for name, words in wanted.items() if name in known]
        return tuple(replace(entry, label=words) for words, entry in named)
    differ = len({(entry.fill, entry.stroke) for entry in of_class.values()}) > 1
    differ &= not (labelled and _each_its_own(scene))
    listed = [*(of_class.values() if differ else ()), *of_layer.values()]
    return tuple(listed) if len(listed) > 1 else ()


def _identities(scene: Scene) -> list[Identity]:
    return list(dict.fromkeys(i for step in scene.steps for i in step.regions.identities))


def _classes(scene: Scene, painter: Painter) -> dict[str, Entry]:
    """An entry for each class; one whose features have a single name, and alone, is called so."""
    names: dict[str, dict[str, None]] = {}
    for identity in _identities(scene):
        if identity.class_ is not None:
            names.setdefault(identity.class_, {}).setdefault(identity.name)
    ordered = [layer for layer in scene.layer_order if layer in names]
    called = {}
    for class_ in [*ordered, *(c for c in names if c not in ordered)]:
        first, *others = names[class_]
        words = first if first and not others and _alone(first, names) else class_
        called[class_] = _entry(scene, painter, Identity(0, class_), words)
    return called


def _each_its_own(scene: Scene) -> bool:
    """Whether no step has two features of one class."""
    steps = [dict.fromkeys(step.regions.identities) for step in scene.steps]
    return all(len({i.class_ for i in of_step}) == len(of_step) for of_step in steps)


def _alone(name: str, names: dict[str, dict[str, None]]) -> bool:
    return sum(name in of_one for of_one in names.values()) == 1


def _keys(scene: Scene, painter: Painter) -> dict[str, Entry]:
    return {
        str(i.key): _entry(scene, painter, i, i.name or str(i.key))
        for i in reversed(_identities(scene))
        if i.keyed
    }


def _entry(scene: Scene, painter: Painter, identity: Identity, words: str) -> Entry:
    paint, opacity = painter.paint(identity), painter.opacity(identity)
    ground = scene.model.map.background
    stroke = paint.stroke if paint.stroked else "none"
    fill, stroke = seen(paint.fill, opacity, ground), seen(stroke, opacity, ground)
    return Entry(words, fill, stroke, None if identity.keyed else identity.class_)


def _layers(scene: Scene) -> dict[str, Entry]:
    layers = [layer for layer, held in scene.layers if layer.name and len(held)]
    ground = scene.model.map.background
    return {
        layer.name: Entry(
            layer.name,
            seen(layer.fill, layer.opacity, ground),
            seen(layer.stroke if layer.width else "none", layer.opacity, ground),
        )
        for layer in layers
    }


def seen(colour: str, opacity: float, ground: str) -> str:
    """A colour as it is seen through its opacity; on white where the ground is ``none``."""
    if colour == "none" or opacity == 1:
        return colour
    under = "#ffffff" if ground == "none" else ground
    pairs = [[int(c[i : i + 2], 16) for c in (colour, under)] for i in (1, 3, 5)]
    return "#" + "".join(f"{round(opacity * a + (1 - opacity) * b):02x}" for a, b in pairs)
