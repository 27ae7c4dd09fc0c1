"""`open_archive`: an archive as tables and as paths, read when asked for."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from numbers import Integral
from os import PathLike
from types import TracebackType
from typing import Any, TypeVar, overload

import numpy as np

from continuation.archive.checkpoint import Checkpoint, unpack
from continuation.archive.contents import Contents
from continuation.archive.rows import from_columns, record_of, row_columns
from continuation.archive.schema import COUNT_NAMES
from continuation.archive.tables import Table, dataframe, dataset, kept_whole, stored_path
from continuation.arguments.checks import complain
from continuation.arguments.labels import Labels
from continuation.citation import entries
from continuation.counts import Counts
from continuation.path import Path
from continuation.plot.html import archive_page
from continuation.status import Status

_T = TypeVar("_T")

_AT_ONCE = 1 << 22
"""Numbers (of 8 bytes) that are read in one go when all paths are asked for: many short reads cost much more."""

_STEP_BYTES, _COPIES = 1400, 6
"""Of a step that is made of a row: its own and its segment's objects, and copies of its point and tangent."""


class Archive(Sequence[Path]):
    """An archive open for reading: a sequence of paths, and two tables. Use it in a ``with`` statement.

    Only what was committed is seen, so a file may be read while it grows. A path without an end (still growing, or
    left by a kill) comes last, with the status TRACING.

    Attributes
    ----------
    file : pathlib.Path
    attributes : dict
        Where the file comes from.
    points, paths : Table
        Columns by name: ``archive.points["arclength"]``.
    event_names : tuple of str
        What ``event_index`` counts.
    closed_by_writer : bool
        False for a file that is growing, or was left by a kill: `recover` makes it whole.
    """

    def __init__(self, file: str | PathLike[str], *, limit: int | None = None) -> None:
        self.contents = contents = Contents(file, limit=limit)
        self.file, self.layout, self.event_names = contents.file, contents.layout, contents.event_names
        self.closed_by_writer, self.attributes = contents.closed_by_writer, contents.attributes
        # As they are now: the file may be read anew while it grows.
        self._committed, self._unended = contents.committed, dict[str, Any]()
        try:
            lengths = contents.read("path", "n_points", slice(0, self._committed.paths))
            self._first_rows = np.concatenate(([0], np.cumsum(lengths))).astype(int)
            rest = self._committed.points - int(self._first_rows[-1])
            if rest < 0 or np.any(lengths < 0):
                raise contents.damaged(ValueError("its paths have other lengths than its points"))
            if rest:
                self._first_rows = np.append(self._first_rows, self._committed.points)
                self._read_unended(rest)
        except BaseException:
            self.close()
            raise
        self.points = Table(self.layout.point_columns, self._committed.points, partial(contents.read, "point"))
        self.paths = Table(self.layout.path_columns, len(self), self._fetch_path)

    # -- the sequence -----------------------------------------------------------------------------------------

    def __len__(self) -> int:
        return len(self._first_rows) - 1

    @overload
    def __getitem__(self, index: int) -> Path: ...

    @overload
    def __getitem__(self, index: slice) -> list[Path]: ...

    def __getitem__(self, index: int | slice) -> Path | list[Path]:
        if isinstance(index, slice):
            return [self.path(i) for i in range(*index.indices(len(self)))]
        return self.path(index)

    def path(self, index: int, *, keep: str = "all") -> Path:
        """One path, as it was traced: status, message, steps, events, counts.

        With ``keep="ends"`` its steps are read from the file when they are asked for, also after the archive is closed.

        Tangents are NaN where the file holds none; then `Path.__call__` interpolates linearly between points.

        Parameters
        ----------
        index : int
            0 is the first; from the end where it is negative.
        keep : str
            "all" steps in memory, or its "ends".

        Returns
        -------
        Path

        Raises
        ------
        IndexError
            If there is no such path.
        ValueError
            For another `keep` than ``"all"`` or ``"ends"``.
        """
        whole = kept_whole(keep)
        if not isinstance(index, Integral):
            raise complain(TypeError, "index", "an integer or a slice", index)
        if not -len(self) <= index < len(self):
            raise IndexError(f"index: expected a path number below {len(self)}, found {index}")
        index %= len(self)
        rows, row = self.rows(index), self.paths.block(slice(index, index + 1))
        if whole:
            size = (rows.stop - rows.start) * (_STEP_BYTES + _COPIES * 8 * (self.layout.unknowns + 1))
            self._sensible(lambda: self.contents.allowance.take("the steps of the path", size))
        return self._sensible(lambda: self._path(index, row, self.points.block(rows) if whole else None))

    def _sensible(self, read: Callable[[], _T]) -> _T:
        """What `read` makes of the file; `ArchiveError` if it cannot."""
        try:
            return read()
        except (ValueError, LookupError) as error:
            raise self.contents.damaged(error) from error

    def _path(self, index: int, rows: Mapping[str, Any], points: Mapping[str, Any] | None) -> Path:
        """A path of its row of the one table, and of its rows of the other if they are to be in memory."""
        steps: Any
        row = {name: column[0] for name, column in rows.items()}
        if points is not None:
            steps, events = from_columns(points, self.event_names, self.layout.observed)
        else:
            steps, events = stored_path(self, open_archive, self.file, index)
        end_error = float(row["end_error"])
        return Path(
            steps,
            events,
            Status(int(row["status"])),
            row["message"].decode(errors="replace"),
            Counts(*(int(row[column]) for column in COUNT_NAMES.values())),
            float(row["wall_time"]),
            references=entries(str(self.attributes.get("references", ""))),
            end_error=None if math.isnan(end_error) else end_error,
            winding_number=int(row["winding_number"]) or None,
            labels=Labels.from_attributes(self.attributes),
        )

    def __iter__(self) -> Iterator[Path]:
        # In runs of paths: many short reads cost much more.
        at_once, stop = _AT_ONCE // (2 * self.layout.unknowns + len(self.points)), 0
        while stop < len(self):
            start, begin = stop, int(self._first_rows[stop])
            stop = max(start + 1, int(np.searchsorted(self._first_rows, begin + at_once, "right")) - 1)
            paths = self.paths.block(slice(start, stop))
            points = self.points.block(slice(begin, self.rows(stop - 1).stop))
            for k in range(start, stop):
                rows = slice(self.rows(k).start - begin, self.rows(k).stop - begin)
                row = {name: column[k - start : k - start + 1] for name, column in paths.items()}
                own = {name: column[rows] for name, column in points.items()}
                yield self._sensible(partial(self._path, k, row, own))

    def __repr__(self) -> str:
        state = "" if self.closed_by_writer else ", not closed by its writer"
        size = f"{len(self)} paths, {self.points.size} points of {self.layout.unknowns} unknowns"
        return f"<Archive {self.file}: {size}{state}>"

    def _repr_html_(self) -> str:
        return archive_page(self)

    def rows(self, index: int) -> slice:
        """Where the path's rows are in the point table.

        Parameters
        ----------
        index : int
            Of the path, at least 0.
        """
        return slice(int(self._first_rows[index]), int(self._first_rows[index + 1]))

    def status(self, index: int) -> Status:
        """How a path ended.

        Parameters
        ----------
        index : int
            0 is the first.

        Raises
        ------
        ArchiveError
            If the file says something that is no status.
        """
        return self._sensible(lambda: Status(int(self.paths["status"][index])))

    # -- views ------------------------------------------------------------------------------------------------

    def to_xarray(self) -> Any:
        """The committed rows as an `xarray.Dataset`, as ``xarray.open_dataset(file)`` has them."""
        return dataset(self.points, self.paths, self.event_names, self.layout.unknowns, self.attributes)

    def to_dataframe(self) -> Any:
        """The points as a `pandas.DataFrame`, the unknowns as ``y_0``, ``y_1``, ..."""
        return dataframe(self.points)

    # -- for resuming and copying -----------------------------------------------------------------------------

    def checkpoint(self) -> Checkpoint | None:
        """The latest point from which the last path can be resumed; None where there is none."""
        valid = [c for c in map(unpack, self.contents.slots()) if c is not None and self._covers(c)]
        return max(valid, key=lambda checkpoint: checkpoint.sequence, default=None)

    def _covers(self, checkpoint: Checkpoint) -> bool:
        """Whether the rows before the checkpoint are all committed: it is written before the counters are."""
        rows = self.rows(checkpoint.path) if checkpoint.path < len(self) else slice(0, 0)
        return bool(rows.start + checkpoint.rows <= rows.stop)

    def problem(self) -> tuple[str, Mapping[str, Any]]:
        """The first homotopy's description (JSON), and its arrays."""
        return self.contents.problem()

    def close(self) -> None:
        """Close the file."""
        self.contents.close()

    def __enter__(self) -> Archive:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    # -- within -----------------------------------------------------------------------------------------------

    def _fetch_path(self, name: str, rows: slice) -> np.ndarray[Any, Any]:
        held = self._committed.paths
        values = self.contents.read("path", name, slice(min(rows.start, held), min(rows.stop, held)))
        own = row_columns(self._unended, self.layout)[name] if rows.stop > held else values[:0]
        return np.concatenate((values, own))

    def _read_unended(self, rows: int) -> None:
        """A row for the path that has none, as far as its checkpoint tells."""
        number = self._committed.paths
        member = int(self._fetch_path("member", slice(number - 1, number))[0]) + 1 if number else 0
        # An older checkpoint than the last is good to resume from, and tells the work of then.
        row = {**record_of(Path(), None, ()), **dict.fromkeys(COUNT_NAMES.values(), -1), "wall_time": math.nan}
        self._unended = row = {**row, "path": number, "member": member, "n_points": rows}
        checkpoint = self.checkpoint()
        if checkpoint is not None and checkpoint.path == number:
            told = checkpoint.run.get("member")
            row["member"] = number if told is None else int(told)
            if not self.contents.checked or self._committed.checkpoint == checkpoint.sequence:
                row |= {COUNT_NAMES[name]: value for name, value in checkpoint.counts.items() if name in COUNT_NAMES}
                row |= {"wall_time": checkpoint.seconds, "controller_state": checkpoint.state.controller}


def open_archive(file: str | PathLike[str], *, limit: int | None = None) -> Archive:
    """Open an archive for reading; also one that is still growing, or was left by a kill.

    Nothing in the file is executed, imported or obeyed. Every block of rows is checked when it is read.

    Parameters
    ----------
    file : path
    limit : int, optional
        Bytes of memory that all which is read may take, Python's objects included. By default 128 MiB, or 32 times as
        many as the file has.

    Raises
    ------
    ArchiveError
        One line for a file that is missing, unreadable, not HDF5, foreign, truncated, damaged, or of a newer schema.
    """
    return Archive(file, limit=limit)
