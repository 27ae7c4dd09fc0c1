"""The two tables of an archive, read column by column when asked for."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from continuation.archive.schema import Column

Fetch = Callable[[str, slice], np.ndarray[Any, Any]]


class Table(Mapping[str, "np.ndarray[Any, Any]"]):
    """Columns by name; each is read when asked for, and remembered.

    Attributes
    ----------
    columns : dict of str to Column
        Names, units, long names, flags.
    size : int
        Rows.
    """

    def __init__(self, columns: tuple[Column, ...], rows: int, fetch: Fetch, chosen: Any = None) -> None:
        self.columns = {column.name: column for column in columns}
        self.size = rows if chosen is None else len(chosen)
        self._rows, self._fetch, self._chosen = rows, fetch, chosen
        self._read: dict[str, np.ndarray[Any, Any]] = {}
        self._ahead, self._near = slice(-1, -1), dict[str, np.ndarray[Any, Any]]()

    def __getitem__(self, name: str) -> np.ndarray[Any, Any]:
        if name not in self.columns:
            raise KeyError(f"column: expected one of {', '.join(self.columns)}, found {name!r}")
        if name not in self._read:
            values = self._fetch(name, slice(0, self._rows))
            self._read[name] = values if self._chosen is None else values[self._chosen]
        return self._read[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)

    def __repr__(self) -> str:
        return f"<Table of {self.size} rows: {', '.join(self.columns)}>"

    def block(self, rows: slice) -> dict[str, np.ndarray[Any, Any]]:
        """All columns of some rows: from memory where they are remembered, and not remembered where they are not.

        Parameters
        ----------
        rows : slice
            Of all rows, also where this table is a choice of them.

        Returns
        -------
        dict of str to ndarray
        """
        return {name: self.some(name, rows) for name in self.columns}

    def some(self, name: str, rows: slice) -> np.ndarray[Any, Any]:
        """Some rows of one column, not remembered.

        Parameters
        ----------
        name : str
            Of the column.
        rows : slice

        Returns
        -------
        ndarray
        """
        if name in self._read:
            return self._read[name][rows]
        first = self._ahead.start
        if first <= rows.start and rows.stop <= self._ahead.stop:
            return self._near[name][rows.start - first : rows.stop - first]
        return self._fetch(name, rows)

    def look_ahead(self, rows: slice) -> None:
        """Read some rows of all columns, and remember them until others are read ahead.

        Parameters
        ----------
        rows : slice
        """
        self._ahead, self._near = rows, {name: self._fetch(name, rows) for name in self.columns}

    def load(self) -> None:
        """Read everything."""
        for name in self.columns:
            self[name]

    def choose(self, rows: Any) -> Table:
        """The table of these rows only (numbers of all rows, in order).

        Parameters
        ----------
        rows : array_like of int

        Returns
        -------
        Table
        """
        return Table(tuple(self.columns.values()), self._rows, self._fetch, rows)
