"""Tables as xarray datasets and pandas frames; both packages are imported only here, and only when asked for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from continuation.archive.schema import COMPONENT, EVENT_NAME
from continuation.archive.tables import Table


def dataset(points: Table, paths: Table, events: Sequence[str], unknowns: int, attributes: Mapping[str, Any]) -> Any:
    """An `xarray.Dataset` with the names, dimensions, coordinates and attributes of the file."""
    import xarray

    variables: dict[str, Any] = {}
    for table in (points, paths):
        for name, column in table.columns.items():
            variables[name] = (column.dimensions, _text(table[name]), column.attributes)
    variables["event_name"] = (EVENT_NAME.dimensions, np.array(events), EVENT_NAME.attributes)
    component = np.arange(unknowns, dtype=COMPONENT.dtype)
    coordinates = {"path": variables.pop("path"), "component": (COMPONENT.dimensions, component, COMPONENT.attributes)}
    return xarray.Dataset(variables, coordinates, attributes)


def dataframe(points: Table) -> Any:
    """A `pandas.DataFrame`, one row a point; matrices have one column a component."""
    import pandas

    columns: dict[str, Any] = {}
    for name in points:
        values = points[name]
        if values.ndim == 1:
            columns[name] = values
        else:
            columns |= {f"{name}_{i}": values[:, i] for i in range(values.shape[1])}
    return pandas.DataFrame(columns)


def _text(values: Any) -> Any:
    return np.char.decode(values, "utf-8", "replace") if values.dtype.kind == "S" else values
