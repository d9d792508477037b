"""What tests see in pictures."""

from __future__ import annotations

from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

NEAR = 6  # levels of a channel by which one colour may differ in two drawings


def pixels(content: bytes) -> NDArray[np.int16]:
    """A picture's pixels (h, w, 3)."""
    return np.asarray(Image.open(BytesIO(content)).convert("RGB"), dtype=np.int16)


def where(picture: NDArray[Any], colour: str, near: int = NEAR) -> NDArray[np.bool_]:
    """Which pixels (h, w) have a colour."""
    wanted = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)])
    return np.asarray((np.abs(picture[..., :3].astype(np.int16) - wanted) <= near).all(axis=-1))


def box(mask: NDArray[np.bool_]) -> tuple[int, int, int, int]:
    """Left, top, right and bottom of what is marked."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    return int(columns[0]), int(rows[0]), int(columns[-1]) + 1, int(rows[-1]) + 1


def overlap(one: NDArray[np.bool_], other: NDArray[np.bool_]) -> float:
    """Intersection over union."""
    return float((one & other).sum() / max((one | other).sum(), 1))
