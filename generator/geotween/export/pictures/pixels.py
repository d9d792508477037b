"""Pictures as pixels: an SVG drawn by resvg."""

from __future__ import annotations

from typing import TYPE_CHECKING

from geotween.export.pictures.extras import needed

if TYPE_CHECKING:
    from PIL.Image import Image


def png(svg: str, width: int, ground: str | None = None) -> bytes:
    """An SVG as PNG, so many pixels wide, on a ground of a colour where it leaves it clear.

    Fonts are looked for only where words are left in it: what is outlined needs none.

    Raises
    ------
    MissingExtraError
        Where resvg is not installed.
    """
    resvg = needed("resvg_py", "a picture in pixels")
    drawn: bytes = resvg.svg_to_bytes(
        svg_string=svg, width=width, background=ground, skip_system_fonts="<text" not in svg
    )
    return drawn


def image(svg: str, width: int) -> Image:
    """An SVG as an opaque picture in memory; what it leaves clear is white.

    Raises
    ------
    MissingExtraError
        Where resvg or Pillow is not installed.
    """
    from io import BytesIO

    pillow = needed("PIL.Image", "a picture that moves")
    drawn: Image = pillow.open(BytesIO(png(svg, width, "white"))).convert("RGB")
    return drawn
