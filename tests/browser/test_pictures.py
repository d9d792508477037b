"""A frame beside what a browser shows of the animated SVG at the same time."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from playwright.sync_api import Browser
from scipy import ndimage

from geotween.export.furniture.furniture import NO_FURNITURE
from geotween.export.pictures.moments import at_time
from geotween.export.pictures.picture import frame_svg
from geotween.export.pictures.pixels import png
from geotween.export.svg import animated_svg
from geotween.export.words import words
from tests.export.pictures.conftest import GALLERY, gallery_scene
from tests.export.pictures.seen import overlap, pixels, where

SCALE = 2  # pixels to a px: edges, which are mixed colours, count for less
LEAST = 300 * SCALE**2  # pixels of a colour that fills something; of less many are its edge
LINE = 2 * SCALE  # pixels: half of what is wider than any line
NEAR = 2  # levels: two fills may be nearly of one colour while they turn

STOP = """() => {
    document.documentElement.pauseAnimations();
    const {width, height} = document.documentElement.viewBox.baseVal;
    return [width, height];
}"""


def fills(picture: NDArray[np.int16]) -> set[str]:
    """The colours that fill something, as they are seen through each other."""
    red, green, blue = np.moveaxis(picture.astype(np.int64), -1, 0)
    found, counts = np.unique((red << 16) + (green << 8) + blue, return_counts=True)
    many = [f"#{colour:06x}" for colour in found[counts >= LEAST].tolist()]
    return {
        c for c in many if ndimage.binary_erosion(where(picture, c, NEAR), iterations=LINE).any()
    }


@pytest.mark.parametrize("name", GALLERY)
def test_fills_are_where_the_browser_has_them(browser: Browser, name: str, tmp_path: Path) -> None:
    shown = gallery_scene(name)
    # Letters are the reader's font in one, and ours in the other.
    frames = replace(shown.frames, furniture=NO_FURNITURE)
    bare = replace(shown, frames=frames, title="", source="")
    path = tmp_path / "map.svg"
    path.write_text(animated_svg(frames, "", "", words(frames, "", "")), encoding="utf-8")
    page = browser.new_page(device_scale_factor=SCALE)
    page.goto(path.as_uri())
    width, height = page.evaluate(STOP)
    page.set_viewport_size({"width": round(width), "height": round(height)})
    for share in (0.1, 0.55):
        milliseconds = round(share * frames.duration)
        page.evaluate("t => document.documentElement.setCurrentTime(t)", milliseconds / 1000)
        theirs = pixels(page.screenshot())
        moment = at_time(frames, milliseconds)
        ours = pixels(png(frame_svg(bare, moment), round(width) * SCALE, "white"))
        assert ours.shape == theirs.shape
        both = [
            (colour, where(ours, colour, NEAR), where(theirs, colour, NEAR))
            for colour in sorted(fills(ours) | fills(theirs))
        ]
        # Edges, whose colours are mixed, are of no fill.
        filled = np.any([a for _, a, _ in both], axis=0) & np.any([b for *_, b in both], axis=0)
        assert filled.mean() > 0.9
        for colour, one, other in both:
            assert overlap(one & filled, other & filled) >= 0.99, (share, colour)
        assert np.mean(np.abs(ours - theirs).max(axis=-1) > 40) < 0.002
    page.close()
