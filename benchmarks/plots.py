"""Plots of benchmarks: lines in a frame whose axes are logarithmic."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from docs.draw.canvas import FAINT, INK, Canvas

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#333333")
STRETCH = 0.7  # the height of a decade beside its width

Points = Sequence[tuple[float, float]]


def log_log(lines: Mapping[str, Points], titles: tuple[str, str], label: str) -> str:
    """An SVG of lines by name; ``titles`` are what runs along x and what is over the frame."""
    every = np.log10([point for points in lines.values() for point in points])
    low, high = np.floor(every.min(axis=0) + 1e-9), np.ceil(every.max(axis=0) - 1e-9)
    scale = np.array([1.0, STRETCH])
    box = (*((low - 0.75) * scale), *((high + 0.25) * scale))
    legend = [(COLOURS[k % len(COLOURS)], name) for k, name in enumerate(lines)]
    canvas = Canvas(tuple(map(float, box)), [titles[1]], 640, legend, label)
    for x in np.arange(low[0], high[0] + 1):
        ends = np.array([(x, low[1]), (x, high[1])])
        canvas.lines(0, [ends * scale], FAINT, 0.5)
        canvas.words(0, _told(10**x), (x, (low[1] - 0.2) * STRETCH), INK)
    for y in np.arange(low[1], high[1] + 1):
        ends = np.array([(low[0], y), (high[0], y)])
        canvas.lines(0, [ends * scale], FAINT, 0.5)
        canvas.words(0, _told(10**y), (low[0] - 0.3, y * STRETCH), INK)
    canvas.words(0, titles[0], ((low[0] + high[0]) / 2, (low[1] - 0.5) * STRETCH), INK)
    for (colour, _), points in zip(legend, lines.values(), strict=True):
        places = np.log10(points) * scale
        canvas.lines(0, [places], colour, 2)
        canvas.dots(0, places, colour, 3)
    return canvas.svg()


def _told(value: float) -> str:
    return f"{value:,.0f}" if value >= 1 else f"{value:g}"
