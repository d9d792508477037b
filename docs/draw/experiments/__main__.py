"""Run all experiments and write their pages to docs/experiments, or to the folder named."""

from __future__ import annotations

import sys
import time
from pathlib import Path

from docs.draw.experiments import pages, write

start = time.perf_counter()
folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[2] / "experiments"
write(folder, pages(), start)
