"""Write all figures, or those named, to docs/figures."""

from __future__ import annotations

import sys
from pathlib import Path

from docs.draw import FIGURES

folder = Path(__file__).parents[1] / "figures"
folder.mkdir(exist_ok=True)
for name in sys.argv[1:] or FIGURES:
    (folder / f"{name}.svg").write_text(FIGURES[name](), encoding="utf-8")
