"""The two tables of an archive, with columns read on demand."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from continuation.archive.atomic import ArchiveError
from continuation.archive.schema import COMPONENT, EVENT_NAME, Column, Layout
from continuation.arguments.checks import expect

Fetch = Callable[[Column, slice], np.ndarray[Any, Any]]
Block = dict[str, Any]
"""Rows of a table, by column."""

ROWS_AT_ONCE, BYTES_AT_ONCE = 4096, 1 << 22
"""Rows and bytes of one read: short reads cost more; 260 rows of 1000 unknowns with tangents take 4 MiB."""


class Table(Mapping[str, "np.ndarray[Any, Any]"]):
    """Columns by name, read on demand and cached.

    Attributes
    ----------
    columns : dict of str to Column
    size : int
        Number of rows.
    at_once : int
        Least number of rows in one read.
    """

    def __init__(self, layout: Layout, table: str, rows: int, fetch: Fetch) -> None:
        self.columns = {column.name: column for column in layout.columns(table)}
        self.size, self._fetch = rows, fetch
        self.at_once = min(max(BYTES_AT_ONCE // layout.row_bytes(table), 1), ROWS_AT_ONCE)
        self._read: dict[str, tuple[int, np.ndarray[Any, Any]]] = {}

    @classmethod
    def of(cls, layout: Layout, table: str, columns: Mapping[str, Any]) -> Table:
        """A table in memory.

        Parameters
        ----------
        layout : Layout
        table : str
            "point" or "path".
        columns : mapping of str to ndarray
        """
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
        """Rows of one column, with further rows read ahead.

        Parameters
        ----------
        name : str
        rows : slice

        Returns
        -------
        ndarray
        """
        start, held = self._read.get(name, (0, None))
        if held is None or not start <= rows.start <= rows.stop <= start + len(held):
            start, stop = rows.start, max(rows.stop, min(rows.start + self.at_once, self.size))
            try:
                held = self._fetch(self.columns[name], slice(start, stop))
            except ArchiveError:
                # Rows beyond the request may be damaged.
                held = self._fetch(self.columns[name], rows)
            self._read[name] = start, held
        return held[rows.start - start : rows.stop - start]


def kept_whole(keep: str) -> bool:
    """Whether `keep` is ``"all"``, not ``"ends"``."""
    expect(keep in ("all", "ends"), "keep", '"all" or "ends"', keep)
    return keep == "all"


def joined(blocks: Sequence[Block]) -> Block:
    """Blocks of rows, one after another."""
    return {name: np.concatenate([block[name] for block in blocks]) for name in blocks[0]}


def _part(columns: Mapping[str, Any], column: Column, rows: slice) -> Any:
    """Picklable, as shares of a sweep are sent."""
    return columns[column.name][rows]


def dataset(points: Table, paths: Table, events: Sequence[str], unknowns: int, attributes: Mapping[str, Any]) -> Any:
    """An `xarray.Dataset` like the file."""
    import xarray

    variables: dict[str, Any] = {
        name: (column.dimensions, _text(table[name]), column.attributes)
        for table in (points, paths)
        for name, column in table.columns.items()
    }
    variables["event_name"] = (EVENT_NAME.dimensions, np.array(events), EVENT_NAME.attributes)
    component = np.arange(unknowns, dtype=COMPONENT.storage)
    coordinates = {"path": variables.pop("path"), "component": (COMPONENT.dimensions, component, COMPONENT.attributes)}
    return xarray.Dataset(variables, coordinates, attributes)


def flat(block: Mapping[str, Any]) -> dict[str, Any]:
    """The columns, a matrix as one for each component."""
    columns = {}
    for name, values in block.items():
        parts = {name: _text(values)} if values.ndim == 1 else {f"{name}_{i}": v for i, v in enumerate(values.T)}
        columns.update(parts)
    return columns


def dataframe(points: Table) -> Any:
    """A `pandas.DataFrame`, one row for each point."""
    import pandas

    return pandas.DataFrame(flat(points))


def _text(values: Any) -> Any:
    return np.char.decode(values, "utf-8", "replace") if values.dtype.kind == "S" else values
