"""A map as one HTML page, or a fragment of one: still SVG, keyframes as JSON, and the player."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from typing import Any

from markupsafe import Markup

from geotween.export.coded import coded, differences
from geotween.export.furniture.labels import SIZE as LABEL_SIZE
from geotween.export.furniture.language import direction, words_in
from geotween.export.furniture.multiples import multiples
from geotween.export.keyframes import Keyframes
from geotween.export.page_grid import GRID
from geotween.export.paint import Paint
from geotween.export.shapes import Shape
from geotween.export.site import Site, render
from geotween.export.svg import still_svg
from geotween.scene.model import SceneFile

FORMAT_VERSION = 3


def page(
    frames: Keyframes,
    model: SceneFile,
    *,
    svg_href: str = "",
    index_href: str = "",
    alternative: Sequence[str] = (),
    alts: Sequence[str] = (),
    social: Mapping[str, str] | None = None,
    oembed_href: str = "",
    site: Site | None = None,
    fragment: bool = False,
) -> str:
    """The page of a scene; it asks the network for nothing.

    Parameters
    ----------
    svg_href, index_href
        What it links to, if anything.
    alternative, alts
        What happens in sentences, and what does so at each step.
    social, oembed_href
        Meta elements for social cards by name, and where the page's oEmbed is.
    site
        The site that the page belongs to.
    fragment
        The map alone, without head and body, for a site's own template.

    Raises
    ------
    jinja2.TemplateError
        Where a site's own template is wrong.
    """
    stills = zip(frames.labels, frames.captions, multiples(frames, model.title), strict=True)
    return render(
        "fragment.html.j2" if fragment else "page.html.j2",
        site or Site(),
        model.layout,
        elsewhere=fragment,
        lang=model.lang,
        dir=direction(model.lang),
        words=words_in(model.lang, "page"),
        layout=model.layout,
        title=model.title,
        subtitle=model.subtitle,
        description=model.description,
        source=model.source,
        credit=model.credit,
        figure=inline(still_svg(frames, model.title)),
        legend=frames.furniture.legend,
        keyframes=Markup(_island(keyframes_json(frames, alts))),
        steps=[
            {"label": label, "caption": caption, "figure": inline(figure)}
            for label, caption, figure in stills
        ],
        alternative=alternative,
        svg_href=svg_href,
        index_href=index_href,
        social=social or {},
        oembed_href=oembed_href,
    )


def inline(svg: str) -> Markup:
    """An SVG as a part of HTML, which knows namespaces without being told."""
    root, end, rest = svg.partition(">")
    return Markup(re.sub(r' (xmlns(:\w+)?|baseProfile|version)="[^"]*"', "", root) + end + rest)


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
                "size": LABEL_SIZE,
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
        "words": words_in(frames.lang, "player"),
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
