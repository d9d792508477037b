"""The floor of a build: the same geometry read, projected and written, and nothing moved."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pyogrio
import shapely
from pyproj import Transformer

from geotween.data.load import Scene


def sources(scene: Scene, files: Sequence[Path], folder: Path) -> list[Path]:
    """The files of a scene's steps; those that it has written in itself, as GeoJSON."""
    if files:
        return list(files)
    made = []
    for number, step in enumerate(scene.steps):
        made.append(folder / f"step-{number:02}.geojson")
        _write(made[-1], step.exact.polygons)
    return made


def floor(files: Sequence[Path], scene: Scene, folder: Path, *, own: bool) -> float:
    """The seconds of a processor for a read, a projection and a write of all files.

    ``own`` says that they are in the scene's plane already.
    """
    start = time.process_time()
    for number, file in enumerate(files):
        _, _, binary, _ = pyogrio.raw.read(file)
        shapes = shapely.from_wkb(binary)
        if scene.crs is not None and not own:
            way = Transformer.from_crs("EPSG:4326", scene.crs, always_xy=True)
            shapes = shapely.transform(
                shapes, lambda p, way=way: np.column_stack(way.transform(*p.T))
            )
        _write(folder / f"floor-{number:02}.geojson", shapes)
    return time.process_time() - start


def _write(path: Path, shapes: np.ndarray) -> None:
    path.unlink(missing_ok=True)
    pyogrio.raw.write(
        path,
        geometry=np.array(shapely.to_wkb(shapes), dtype=object),
        field_data=[],
        fields=[],
        geometry_type="Unknown",
        crs="EPSG:4326",
        driver="GeoJSON",
    )
