"""The two tables of an archive, read column by column when asked for: chosen rows, xarray datasets, pandas frames."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from numbers import Integral
from pathlib import Path as File
from typing import Any, Protocol

import numpy as np

from continuation.archive.schema import COMPONENT, EVENT_NAME, KINK_PART, Column
from continuation.arguments.checks import complain, is_number
from continuation.path import Path
from continuation.status import Status

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


class OpenArchive(Protocol):
    """What is asked of `continuation.archive.Archive` by the modules below it."""

    file: File
    points: Table
    paths: Table
    event_names: tuple[str, ...]
    attributes: dict[str, Any]
    layout: Any

    def __len__(self) -> int: ...

    def path(self, index: int) -> Path:
        """One of its paths."""
        ...

    def rows(self, index: int) -> slice:
        """The path's rows."""
        ...


class Selection:
    """Some points of an archive, and the paths they belong to."""

    def __init__(self, archive: OpenArchive, points: Any, paths: Any) -> None:
        self.archive = archive
        self.numbers: list[int] = paths.tolist()
        self.points = archive.points.choose(points)
        self.paths = archive.paths.choose(paths)

    def __len__(self) -> int:
        return len(self.numbers)

    def __iter__(self) -> Iterator[Path]:
        return (self.archive.path(number) for number in self.numbers)

    def __repr__(self) -> str:
        return f"<Selection of {self.archive.file}: {len(self)} paths, {self.points.size} points>"

    def to_xarray(self) -> Any:
        """The selected points and paths as an `xarray.Dataset`; ``path_index`` keeps the numbers of the file."""
        archive = self.archive
        return dataset(self.points, self.paths, archive.event_names, archive.layout.unknowns, archive.attributes)

    def to_dataframe(self) -> Any:
        """The selected points as a `pandas.DataFrame`."""
        return dataframe(self.points)


def selected(archive: OpenArchive, status: Any, kind: Any, event: Any, parameter: Any) -> Selection:
    """What `Archive.select` returns, with its arguments.

    Raises `TypeError` or `ValueError` if one of them is nothing of its kind, or the event does not occur in the file at
    all.
    """
    paths = np.ones(len(archive), dtype=bool)
    if status is not None:
        wanted = list(status) if isinstance(status, Iterable) else [status]
        if not all(isinstance(one, Status) for one in wanted):
            raise complain(TypeError, "status", "a Status, or several", status)
        paths = np.isin(archive.paths["status"], [int(one) for one in wanted])
    points = paths[archive.points["path_index"]] & (archive.points["role"] != KINK_PART)
    if kind is not None:
        if not isinstance(kind, Integral):
            raise complain(TypeError, "kind", "a Kind", kind)
        points &= archive.points["kind"] == kind
    if event is not None:
        if event not in archive.event_names:
            raise ValueError(f"event: expected one of {', '.join(archive.event_names)}, found {event!r}")
        points &= archive.points["event_index"] == archive.event_names.index(event)
    if parameter is not None:
        if not isinstance(parameter, Sequence) or len(parameter) != 2 or not all(map(is_number, parameter)):
            raise complain(TypeError, "parameter", "two numbers, the ends of an interval", parameter)
        low, high = parameter
        points &= (archive.points["parameter"] >= low) & (archive.points["parameter"] <= high)
    if kind is not None or event is not None or parameter is not None:
        paths = np.zeros(len(archive), dtype=bool)
        paths[archive.points["path_index"][points]] = True
    return Selection(archive, np.flatnonzero(points), np.flatnonzero(paths))
