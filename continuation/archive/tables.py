"""What an archive is seen as: two tables that are read column by column when asked for, for xarray and pandas too; and
the steps of a path that stay in the file, so that a long path needs no memory.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from pathlib import Path as File
from typing import Any

import numpy as np

from continuation.archive.rows import from_columns
from continuation.archive.schema import ACCEPTED, COMPONENT, EVENT_NAME, Column
from continuation.arguments.checks import complain
from continuation.path import LocatedEvent, Step

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

    def __init__(self, columns: tuple[Column, ...], rows: int, fetch: Fetch) -> None:
        self.columns = {column.name: column for column in columns}
        self.size, self._fetch = rows, fetch
        self._read: dict[str, np.ndarray[Any, Any]] = {}

    def __getitem__(self, name: str) -> np.ndarray[Any, Any]:
        if name not in self.columns:
            raise KeyError(f"column: expected one of {', '.join(self.columns)}, found {name!r}")
        if name not in self._read:
            self._read[name] = self._fetch(name, slice(0, self.size))
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
        return self._read[name][rows] if name in self._read else self._fetch(name, rows)

    def load(self) -> None:
        """Read everything."""
        for name in self.columns:
            self[name]


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


# -- steps that stay in the file -------------------------------------------------------------------------------


ROWS_AT_ONCE = 4096
"""Rows that are read, copied or written as text at once: of 100 unknowns they take 7 MB."""

_COLUMNS = {"u": ("y", "parameter"), "arclength": ("arclength",)}
"""What of a step is a column of the file. A tangent may be in memory alone."""

Opener = Callable[[File], AbstractContextManager[Any]]
"""Opens an archive: `continuation.archive.open_archive`, which this module is too low to know."""


def kept_whole(keep: str) -> bool:
    """Whether ``"all"`` steps stay in memory, or the ``"ends"`` alone; `ValueError` for anything else."""
    if keep not in ("all", "ends"):
        raise complain(ValueError, "keep", '"all" or "ends"', keep)
    return keep == "all"


class StoredSteps(Sequence[Step]):
    """The steps of a path as a sequence: the first and the last ones in memory, the others read from the file.

    While the path is traced, `append` adds to it, and what is not yet committed is in memory: all of `steps` at first.
    A step that is read has the segment to the step before only if the archive holds tangents.
    """

    def __init__(self, opener: Opener, file: File, path: int, steps: Iterable[Step], count: int | None = None) -> None:
        self._opener, self._file, self._path = opener, file, path
        self._last = list(steps)
        self._first, self._count = next(iter(self._last), None), len(self._last) if count is None else count
        self._last = self._last if count is None else self._last[-1:]

    def append(self, step: Step) -> None:
        """The next step."""
        self._first = self._first or step
        self._last.append(step)
        self._count += 1

    def committed(self) -> None:
        """The file holds all of it: only the last step is still held, and the first."""
        self._last = self._last[-1:]

    def __len__(self) -> int:
        return self._count

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            wanted = range(*index.indices(self._count))
            first = min(wanted, default=0)
            between = list(self._between(first, max(wanted, default=-1) + 1))
            return [between[i - first] for i in wanted]
        if not -self._count <= index < self._count:
            raise IndexError(f"index: expected a step below {self._count}, found {index}")
        index %= self._count
        return self._first if not index and self._first else next(self._between(index, index + 1))

    def __iter__(self) -> Iterator[Step]:
        return self._between(0, self._count)

    def __repr__(self) -> str:
        held = {id(step) for step in (self._first, *self._last) if step is not None}
        return f"<{self._count} steps in {self._file}, {len(held)} of them in memory>"

    def column(self, name: str) -> Any:
        """One number or vector of all steps, as an array: ``u``, ``tangent`` or ``arclength``."""
        fields, begin = _COLUMNS.get(name, ()), self._count - len(self._last)
        if not fields or not begin:
            return np.array([getattr(step, name) for step in self])
        with self._opener(self._file) as archive:
            # To make steps of them takes 14 times as long.
            rows = archive.rows(self._path)
            steps = np.flatnonzero(archive.points.some("role", rows) == ACCEPTED)[:begin]
            found = [archive.points.some(field, rows)[steps] for field in fields]
        stored = found[0] if len(found) == 1 else np.column_stack(found)
        return np.concatenate((stored, [getattr(step, name) for step in self._last]))

    def _between(self, start: int, stop: int) -> Iterator[Step]:
        begin = self._count - len(self._last)
        while start < min(stop, begin):
            # One row more, for the segment from the step before.
            before, end = max(start - 1, 0), min(start + ROWS_AT_ONCE, stop, begin)
            with self._opener(self._file) as archive:
                steps, _ = window(archive, self._path, before, end)
            yield from steps[start - before :]
            start = end
        yield from self._last[start - begin : max(stop - begin, 0)]


def window(archive: Any, path: int, start: int, stop: int) -> tuple[list[Step], list[LocatedEvent]]:
    """Some steps of a path of an `Archive`, and the events from the first of them on to before the one after them."""
    rows = archive.rows(path)
    accepted = np.append(np.flatnonzero(archive.points.some("role", rows) == ACCEPTED), rows.stop - rows.start)
    begin, end = (rows.start + int(accepted[min(k, len(accepted) - 1)]) for k in (start, stop))
    return from_columns(archive.points.block(slice(begin, end)), archive.event_names, archive.layout.observed, start)


def stored_path(archive: Any, opener: Opener, file: File, path: int) -> tuple[StoredSteps, list[LocatedEvent]]:
    """The steps of a path of an `Archive`, of which only the ends are in memory, and its events."""
    rows = archive.rows(path)
    accepted, numbers = archive.points.some("role", rows) == ACCEPTED, archive.points.some("event_index", rows)
    count = int(np.count_nonzero(accepted))
    # A kink and its parts stay together: their rows come after the step's.
    eventful = np.unique((np.cumsum(accepted) - 1)[numbers >= 0] // ROWS_AT_ONCE).tolist() if count else []
    events = [event for k in eventful for event in window(archive, path, k * ROWS_AT_ONCE, (k + 1) * ROWS_AT_ONCE)[1]]
    # The last with the one before, for the segment from there.
    last = window(archive, path, max(count - 2, 0), count)[0][-1:] if count else []
    ends = (window(archive, path, 0, 1)[0] if count > 1 else []) + last
    return StoredSteps(opener, file, path, ends, count), events
