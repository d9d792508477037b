"""The page that the data are put on: how large a unit of theirs is drawn."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geotween.data.polygons import extent, too_far
from geotween.scene.document import Document, Location
from geotween.scene.errors import SceneError
from geotween.scene.model import Map

HIGHEST = 20  # times its width, a page whose height follows from the data


def pixels_per_unit(frame: Map, box: NDArray[np.float64]) -> float:
    """Pixels that a unit of the data takes where ``box`` (bounds, (4,)) fills the map."""
    size = box[2:] - box[:2]
    scale = (frame.width - 2 * frame.padding) / size[0]
    if frame.height is not None:
        scale = min(scale, (frame.height - 2 * frame.padding) / size[1])
    return float(scale)


def check_size(document: Document, at: Location, frame: Map, box: NDArray[np.float64]) -> None:
    """Raise where double precision cannot tell the data's places apart, or they make no page."""
    if too_far(box):
        size, reach = extent(box), np.abs(box).max()
        message = f"the data span {size:.3g} units at {reach:.3g} from the origin: too fine to draw"
        hint = "shift the coordinates nearer to 0"
        raise SceneError([document.fault(at, message, hint, at_key=True)])
    if frame.height is None and box[3] - box[1] > HIGHEST * (box[2] - box[0]):
        message = f"the data are more than {HIGHEST} times as high as wide"
        hint = "name the page's size: map: {width: 300, height: 900}"
        raise SceneError([document.fault(at, message, hint, at_key=True)])
