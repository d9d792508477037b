"""The figures of the documentation, drawn by the code that they explain.

``python -m docs.draw``, from the project's folder, writes them to ``docs/figures``.
"""

from __future__ import annotations

from docs.draw import fronts, morphs, scenes

FIGURES = {**fronts.FIGURES, **morphs.FIGURES, **scenes.FIGURES}
