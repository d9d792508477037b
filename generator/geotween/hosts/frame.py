"""A map's page within another page: a frame of its own, which nothing gets into or out of."""

from __future__ import annotations

from base64 import b64encode
from functools import cache

from markupsafe import Markup

from geotween.export.build import Rendered
from geotween.export.embed import WIDTH
from geotween.export.resources import resource

SPARE = 48  # px of room in a notebook, where no script corrects what was reckoned


def on_site(rendered: Rendered, title: str) -> Markup:
    """HTML of a frame with a whole page, and a script that makes it as high as that.

    The frame has an origin of its own and may run its own script, so that no two maps, and no map
    and its host, disturb each other. All is in ASCII.
    """
    width, height = rendered.size
    room = f"calc({height / width:.2%} + {_around(rendered)}px)"  # where the script may not run
    script = Markup("<script>{}</script>").format(Markup(_script()))
    return _framed(rendered, title, room, after=script, lazy=True)


def in_notebook(rendered: Rendered, title: str, still: str) -> Markup:
    """The same frame without a script, over a still (SVG): what is left where frames are stripped.

    The still takes the height of the map, in the flow of the page: hosts that strip frames strip
    some styles, too, and leave others.
    """
    address = "data:image/svg+xml;base64," + b64encode(still.encode()).decode()
    picture = '<img src="{}" alt="{}" style="display:block;width:100%;height:auto">'
    room = f"{_around(rendered) + SPARE}px"
    return _framed(rendered, title, room, before=Markup(picture).format(address, title))


def _around(rendered: Rendered) -> int:
    """What a page takes beside its map, px."""
    width, height = rendered.size
    return rendered.height - round(height * min(1.0, WIDTH / width))


def _framed(
    rendered: Rendered,
    title: str,
    room: str,
    *,
    before: str = "",
    after: str = "",
    lazy: bool = False,
) -> Markup:
    """A frame that fills a box as high as ``room`` (CSS) and what comes before it."""
    (page,) = rendered.files.values()
    box = f"position:relative;max-width:{rendered.size[0]:g}px;padding-bottom:{room}"
    html = Markup(
        '<div class="geotween-frame" style="{}">{}<iframe title="{}" srcdoc="{}"'
        ' sandbox="allow-scripts"{} width="100%" height="{}" style="position:absolute;'
        'inset:0;width:100%;height:100%;border:0"></iframe>{}</div>'
    ).format(
        box,
        before,
        title,
        page.decode(),
        Markup(' loading="lazy"') if lazy else "",
        rendered.height,
        after,
    )
    # The hashes in the page's policy hold whatever encoding the host is taken for.
    return Markup(html.encode("ascii", "xmlcharrefreplace").decode())


@cache
def _script() -> str:
    return (resource("templates") / "fit.js").read_text(encoding="ascii")
