"""A map as one HTML page: the first step as SVG, keyframes as JSON, and the player."""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Sequence
from functools import cache
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from geotween.export.coded import coded, differences
from geotween.export.furniture.language import direction, words_in
from geotween.export.furniture.multiples import multiples
from geotween.export.keyframes import Keyframes
from geotween.export.page_grid import GRID
from geotween.export.paint import Paint
from geotween.export.resources import resource
from geotween.export.shapes import Shape
from geotween.export.svg import still_svg
from geotween.scene.model import SceneFile

FORMAT_VERSION = 3


def page(
    frames: Keyframes,
    model: SceneFile,
    *,
    svg_href: str,
    index_href: str,
    alternative: Sequence[str] = (),
    alts: Sequence[str] = (),
) -> str:
    """The page of a scene; it asks the network for nothing.

    ``alternative`` says in sentences what happens, ``alts`` what does so at each step.
    """
    stills = zip(frames.labels, frames.captions, multiples(frames, model.title), strict=True)
    return render(
        "page.html.j2",
        lang=model.lang,
        dir=direction(model.lang),
        title=model.title,
        subtitle=model.subtitle,
        description=model.description,
        source=model.source,
        credit=model.credit,
        figure=Markup(still_svg(frames, model.title)),
        legend=frames.furniture.legend,
        keyframes=Markup(_island(keyframes_json(frames, alts))),
        small_multiples=[
            {"label": label, "caption": caption, "figure": Markup(figure)}
            for label, caption, figure in stills
        ],
        alternative=alternative,
        svg_href=svg_href,
        index_href=index_href,
    )


def render(template: str, **context: Any) -> str:
    """A template with the player's style and script, and the hashes a policy admits them by."""
    style, script = _text("player.css"), _text("player.js")
    return (
        _environment()
        .get_template(template)
        .render(
            **context,
            style=Markup(style),
            script=Markup(script),
            style_hash=_hash(style),
            script_hash=_hash(script),
        )
    )


def keyframes_json(frames: Keyframes, alts: Sequence[str] = ()) -> dict[str, Any]:
    """Keyframes as plain values; each track and paint once, vertices as differences."""
    slots = {slot: place for place, slot in enumerate(frames.slots())}
    found = dict.fromkeys(slot.group for slot in slots)
    groups = {group: place for place, group in enumerate(found)}
    paints: dict[Paint, int] = {}
    told = coded(t for _, shapes in frames.spans for shape in shapes for t in shape.tracks)

    def shape(value: Shape) -> dict[str, Any]:
        found: dict[str, Any] = {
            "slot": slots[value.slot],
            "tracks": differences([told.numbers[track] for track in value.tracks]),
            "paint": [paints.setdefault(p, len(paints)) for p in value.paints],
        }
        if value.slot.code:
            found["code"] = value.slot.code
        if value.show:
            found["show"] = [round(v, 6) for v in value.show]
        return found

    spans = [
        {
            "start": span.start / 1000,
            "end": span.end / 1000,
            "step": span.step if span.rest else None,
            "shapes": [shape(s) for s in shapes],
        }
        for span, shapes in frames.spans
    ]
    return {
        "version": FORMAT_VERSION,
        "grid": GRID,
        "duration": frames.duration / 1000,
        "loop": frames.loop,
        "easing": frames.easing,
        "steps": [
            {
                "label": label,
                "caption": caption,
                "start": rest.start / 1000,
                "end": rest.end / 1000,
                "time": time,
                "alt": alt,
            }
            for label, caption, rest, time, alt in zip(
                frames.labels,
                frames.captions,
                frames.rests,
                frames.times,
                alts or [""] * len(frames.labels),
                strict=True,
            )
        ],
        "labels": [
            {
                "text": label.text,
                "key": label.key,
                "room": round(label.room, 2),
                "spans": {
                    str(span): [[round(t, 5), round(x, 1), round(y, 1)] for t, x, y in way]
                    for span, way in label.spans.items()
                },
            }
            for label in frames.furniture.labels
        ],
        "tips": [
            {key: {"name": tip.name, "rows": tip.rows} for key, tip in of_step.items()}
            for of_step in frames.furniture.tips
        ],
        "words": words_in(frames.lang),
        "paints": [
            {"fill": p.fill, "stroke": p.stroke, "width": p.width, "dash": p.dash} for p in paints
        ],
        "groups": [{"layer": g.layer, "opacity": g.opacity} for g in groups],
        "slots": [{"group": groups[s.group], "kind": s.kind, "key": s.key} for s in slots],
        **told.shared,
        "tracks": told.tracks,
        "spans": spans,
    }


def _island(value: object) -> str:
    """JSON that no text in it can end: inside a script element ``<`` is written as an escape."""
    text = json.dumps(value, separators=(",", ":"), ensure_ascii=False)
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")


@cache
def _environment() -> Environment:
    return Environment(
        loader=FileSystemLoader(resource("templates")),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )


@cache
def _text(name: str) -> str:
    return (resource("templates") / name).read_text(encoding="utf-8")


def _hash(text: str) -> str:
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
