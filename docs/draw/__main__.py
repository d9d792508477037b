"""Write all figures, or those named, to docs/figures; of real sets if they are present."""

from __future__ import annotations

import sys
from pathlib import Path

from docs.draw import FIGURES
from docs.draw.scenes import REAL, SETS

folder = Path(__file__).parents[1] / "figures"
folder.mkdir(exist_ok=True)
for name in sys.argv[1:] or [f for f in FIGURES if f not in REAL or SETS.is_dir()]:
    (folder / f"{name}.svg").write_text(FIGURES[name](), encoding="utf-8")
