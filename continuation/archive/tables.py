"""What an archive is seen as: two tables, of which columns are read when asked for, for xarray and pandas too."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from continuation.archive.atomic import ArchiveError
from continuation.archive.schema import COMPONENT, EVENT_NAME, Layout
from continuation.arguments.checks import complain

Fetch = Callable[[str, slice], np.ndarray[Any, Any]]
Block = dict[str, Any]
"""Rows of a table: an array a column."""

ROWS_AT_ONCE, BYTES_AT_ONCE = 4096, 1 << 22
"""Rows that are read, copied or written as text at once, and bytes of all columns: many short reads cost much more;
of 1000 unknowns with tangents 260 rows take 4 MiB."""


class Table(Mapping[str, "np.ndarray[Any, Any]"]):
    """Columns by name; each is read when asked for, and remembered.

    Attributes
    ----------
    columns : dict of str to Column
        Names, units, long names, flags.
    size : int
        Rows.
    at_once : int
        Rows that are read in one go where fewer are asked for.
    """

    def __init__(self, layout: Layout, table: str, rows: int, fetch: Fetch) -> None:
        self.columns = {column.name: column for column in layout.columns(table)}
        self.size, self._fetch = rows, fetch
        self.at_once = min(max(BYTES_AT_ONCE // layout.row_bytes(table), 1), ROWS_AT_ONCE)
        self._read: dict[str, tuple[int, np.ndarray[Any, Any]]] = {}

    @classmethod
    def of(cls, layout: Layout, table: str, columns: Mapping[str, Any]) -> Table:
        """A table in memory."""
        return cls(layout, table, len(next(iter(columns.values()))), partial(_part, columns))

    def __getitem__(self, name: str) -> np.ndarray[Any, Any]:
        if name not in self.columns:
            raise KeyError(f"column: expected one of {', '.join(self.columns)}, found {name!r}")
        return self.some(name, slice(0, self.size))

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)

    def __repr__(self) -> str:
        return f"<Table of {self.size} rows: {', '.join(self.columns)}>"

    def block(self, rows: slice) -> dict[str, np.ndarray[Any, Any]]:
        """All columns of some rows.

        Parameters
        ----------
        rows : slice

        Returns
        -------
        dict of str to ndarray
        """
        return {name: self.some(name, rows) for name in self.columns}

    def some(self, name: str, rows: slice) -> np.ndarray[Any, Any]:
        """Some rows of one column; what was read last is remembered, the rows behind those asked for with it.

        Parameters
        ----------
        name : str
            Of the column.
        rows : slice

        Returns
        -------
        ndarray
        """
        start, held = self._read.get(name, (0, None))
        if held is None or not start <= rows.start <= rows.stop <= start + len(held):
            start, stop = rows.start, max(rows.stop, min(rows.start + self.at_once, self.size))
            try:
                held = self._fetch(name, slice(start, stop))
            except ArchiveError:
                # What lies behind may be damaged.
                held = self._fetch(name, rows)
            self._read[name] = start, held
        return held[rows.start - start : rows.stop - start]


def kept_whole(keep: str) -> bool:
    """Whether ``"all"`` steps stay in memory, or the ``"ends"`` alone; `ValueError` for anything else."""
    if keep not in ("all", "ends"):
        raise complain(ValueError, "keep", '"all" or "ends"', keep)
    return keep == "all"


def _part(columns: Mapping[str, Any], name: str, rows: slice) -> Any:
    return columns[name][rows]


def dataset(points: Table, paths: Table, events: Sequence[str], unknowns: int, attributes: Mapping[str, Any]) -> Any:
    """An `xarray.Dataset` with the names, dimensions, coordinates and attributes of the file."""
    import xarray

    variables: dict[str, Any] = {
        name: (column.dimensions, _text(table[name]), column.attributes)
        for table in (points, paths)
        for name, column in table.columns.items()
    }
    variables["event_name"] = (EVENT_NAME.dimensions, np.array(events), EVENT_NAME.attributes)
    component = np.arange(unknowns, dtype=COMPONENT.dtype)
    coordinates = {"path": variables.pop("path"), "component": (COMPONENT.dimensions, component, COMPONENT.attributes)}
    return xarray.Dataset(variables, coordinates, attributes)


def flat(block: Mapping[str, Any]) -> dict[str, Any]:
    """The columns of some rows; of a matrix one a component, and texts as texts."""
    columns = {}
    for name, values in block.items():
        parts = {name: _text(values)} if values.ndim == 1 else {f"{name}_{i}": v for i, v in enumerate(values.T)}
        columns.update(parts)
    return columns


def dataframe(points: Table) -> Any:
    """A `pandas.DataFrame`, one row a point; matrices have one column a component."""
    import pandas

    return pandas.DataFrame(flat(points))


def _text(values: Any) -> Any:
    return np.char.decode(values, "utf-8", "replace") if values.dtype.kind == "S" else values
