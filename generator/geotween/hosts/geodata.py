"""A scene from a table of polygons in memory, such as a GeoDataFrame."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from geotween.data.load import Scene, read
from geotween.data.read.held import GEOGRAPHIC
from geotween.data.read.tables import Table
from geotween.scene.document import Document

NAME = "map"  # what files are called that are made of the scene


def animate(
    data: Any,
    *,
    time: str,
    key: str | None = None,
    class_: str | None = None,
    name: str | None = None,
    where: str | None = None,
    times: Iterable[object] | None = None,
    time_format: str | None = None,
    title: str = "Map",
    **scene: Any,
) -> Scene:
    """A scene whose steps are the distinct times of a column.

    Parameters
    ----------
    data
        Rows with a polygon each: a GeoDataFrame or what is like one (``geometry``, ``columns``),
        or features with properties (``__geo_interface__``, a GeoJSON mapping).
    time
        Column of times: dates, date-times, numbers, or their texts.
    key, class_, name
        Columns: what is the same thing over time, what decides the colour, what it is called.
    where
        SQL expression over the columns that selects rows.
    times, time_format
        Times and periods to keep; how a text column writes times, as ``strptime`` takes it.
    title
        The map's heading.
    **scene
        What else a scene file may say: ``subtitle``, ``source``, ``lang``, ``map``, ``style``,
        ``motion``, ``timing``, ``story``, ``steps``, as mappings and lists.

    Raises
    ------
    TypeError
        Where the data are no table of geometries.
    SceneError
        With everything that is wrong with rows, columns and options.
    """
    table, called = _table(data), type(data).__name__
    source = {
        "file": called,
        "time": time,
        "key": key,
        "class": class_,
        "name": name,
        "where": where,
        "times": None if times is None else [str(one) for one in times],
        "time_format": time_format,
    }
    said = {"title": title, **scene, "data": {k: v for k, v in source.items() if v is not None}}
    text = json.dumps(said, default=str, ensure_ascii=False, indent=2)  # JSON is YAML
    document = Document("animate()", Path(f"{NAME}.yaml"), text)
    return read(document, tables={called: table})


def _table(data: Any) -> Table:
    if hasattr(data, "geometry") and hasattr(data, "columns"):
        geometries = np.array([*data.geometry], dtype=object)
        active = getattr(data.geometry, "name", "geometry")
        columns = [column for column in data.columns if column != active]
        values = [map(_plain, data[column].tolist()) for column in columns]
        names = [str(column) for column in columns]
        rows = [dict(zip(names, row, strict=True)) for row in zip(*values, strict=True)]
        return Table(geometries, rows or [{} for _ in geometries], _system(data))
    features = getattr(data, "__geo_interface__", data)
    if not isinstance(features, Mapping) or "features" not in features:
        what = type(data).__name__
        raise TypeError(f"expected a GeoDataFrame or GeoJSON features, not a {what}")
    rows = [{**(feature.get("properties") or {})} for feature in features["features"]]
    shapes = [feature.get("geometry") for feature in features["features"]]
    read_shapes = [None if shape is None else shapely.geometry.shape(shape) for shape in shapes]
    return Table(np.array(read_shapes, dtype=object), rows, GEOGRAPHIC)


def _system(data: Any) -> str | None:
    """A table's coordinate reference system as text: pyproj's own, or any that has a text."""
    system = getattr(data, "crs", None)
    if system is None:
        return None
    return str(system.to_wkt()) if hasattr(system, "to_wkt") else str(system)


def _plain(value: Any) -> Any:
    """A cell's value; None where it is missing: NaN and NaT do not equal themselves."""
    if hasattr(value, "geom_type"):
        return shapely.to_wkt(value)
    try:
        return value if value is not None and bool(value == value) else None
    except (TypeError, ValueError):  # pandas.NA, and arrays
        return None
