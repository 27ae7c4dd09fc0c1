"""`open_archive`: an archive as tables and paths, read on demand."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cached_property, partial
from numbers import Integral
from os import PathLike
from pathlib import Path as File
from types import TracebackType
from typing import Any

import numpy as np

from continuation.archive.contents import Contents
from continuation.archive.provenance import Checkpoint, unpack
from continuation.archive.rows import (
    ROWS_AT_ONCE,
    Table,
    dataset,
    flat,
    from_columns,
    kept_whole,
    record_of,
    row_columns,
)
from continuation.archive.schema import ACCEPTED, COUNT_NAMES, OBSERVED
from continuation.arguments.checks import expect
from continuation.arguments.labels import Labels
from continuation.citation import entries
from continuation.counts import Counts
from continuation.path import LocatedEvent, Path, Step
from continuation.plot.html import archive_page
from continuation.status import Status

_STEP_BYTES, _COPIES = 1400, 6
"""Bytes of a step's objects; copies of its vectors."""


class Archive(Sequence[Path]):
    """An archive open for reading: a sequence of paths, and two tables.

    It shows committed rows; the file may still grow. An unfinished path comes last, with the status TRACING.

    Attributes
    ----------
    file : pathlib.Path
    points : Table
        Columns by name: ``archive.points["arclength"]``.
    closed_by_writer : bool
        False if the file is growing or its writer was killed.
    """

    def __init__(self, contents: Contents) -> None:
        self.contents = contents
        self.file, self.layout, self.closed_by_writer = contents.file, contents.layout, contents.closed_by_writer
        self.points, self._ended = contents.table("point"), contents.table("path")

    @property
    def attributes(self) -> dict[str, Any]:
        """Root attributes: the file's origin."""
        return self.contents.attributes

    @property
    def event_names(self) -> tuple[str, ...]:
        """Names that ``event_index`` numbers."""
        return self.contents.event_names

    @cached_property
    def paths(self) -> Table:
        """The path table, unfinished path included."""
        if len(self) == self._ended.size:
            return self._ended
        number, rows = self._ended.size, self.rows(self._ended.size)
        row = {**record_of(Path(), None, ()), **dict.fromkeys(COUNT_NAMES.values(), -1), "wall_time": math.nan}
        row = row_columns({**row, "path": number, "member": number, "n_points": rows.stop - rows.start}, self.layout)
        columns = {name: np.concatenate((self._ended[name], row[name])) for name in self._ended}
        return Table.of(self.layout, "path", columns)

    @cached_property
    def _first_rows(self) -> Any:
        lengths = self._ended["n_points"]
        first = np.concatenate(([0], np.cumsum(lengths))).astype(int)
        if self.points.size < first[-1] or np.any(lengths < 0):
            raise self.contents.damaged(ValueError("its paths have other lengths than its points"))
        return first if self.points.size == first[-1] else np.append(first, self.points.size)

    def __len__(self) -> int:
        return len(self._first_rows) - 1

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self.path(i) for i in range(*index.indices(len(self)))]
        return self.path(index)

    def path(self, index: int, *, keep: str = "all") -> Path:
        """One path as it was traced.

        Without stored tangents, they are NaN and `Path.__call__` interpolates linearly.

        Parameters
        ----------
        index : int
            May be negative.
        keep : str
            Keep "all" steps in memory, or the "ends".

        Raises
        ------
        IndexError
            If there is no such path.
        ValueError
            For another `keep`.
        """
        whole = kept_whole(keep)
        expect(isinstance(index, Integral), "index", "an integer or a slice", index, TypeError)
        if not -len(self) <= index < len(self):
            raise IndexError(f"index: expected a path number below {len(self)}, found {index}")
        return self.contents.guarded(partial(self._path, int(index) % len(self), whole))

    def _path(self, index: int, whole: bool) -> Path:
        steps: Any
        rows, row = self.rows(index), {name: self.paths.some(name, slice(index, index + 1))[0] for name in self.paths}
        if whole:
            size = (rows.stop - rows.start) * (_STEP_BYTES + _COPIES * 8 * (self.layout.unknowns + 1))
            self.contents.allowance.take("the steps of the path", size)
            steps, events = from_columns(self.points.block(rows), self.event_names, self.layout.own(OBSERVED))
        else:
            steps, events = _stored(self, index)
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

    def __repr__(self) -> str:
        if self.contents.closed:
            return f"<Archive {self.file}, closed>"
        state = "" if self.closed_by_writer else ", not closed by its writer"
        size = f"{len(self)} paths, {self.points.size} points of {self.layout.unknowns} unknowns"
        return f"<Archive {self.file}: {size}{state}>"

    def _repr_html_(self) -> str:
        return archive_page(self)

    def rows(self, index: int) -> slice:
        """The path's rows in the point table.

        Parameters
        ----------
        index : int
        """
        return slice(int(self._first_rows[index]), int(self._first_rows[index + 1]))

    def status(self, index: int) -> Status:
        """The path's status.

        Parameters
        ----------
        index : int

        Raises
        ------
        IndexError
            If there is no such path.
        ArchiveError
            If the stored number is no status.
        """
        index = range(len(self))[index]
        return self.contents.guarded(lambda: Status(int(self.paths.some("status", slice(index, index + 1))[0])))

    def to_xarray(self) -> Any:
        """Committed rows as an `xarray.Dataset`, equal to ``xarray.open_dataset(file)``."""
        return dataset(self.points, self.paths, self.event_names, self.layout.unknowns, self.attributes)

    def to_dataframe(self) -> Any:
        """The points as a `pandas.DataFrame`, with unknowns ``y_0``, ``y_1``, ..."""
        import pandas

        return pandas.DataFrame(flat(self.points))

    def checkpoint(self) -> Checkpoint | None:
        """Latest point to resume the last path from, or None."""
        valid = []
        for found in filter(None, map(unpack, self.contents.slots())):
            # A checkpoint precedes the commit of its rows.
            rows = self.rows(found.path) if found.path < len(self) else slice(0, 0)
            valid += [found] if rows.start + found.rows <= rows.stop else []
        return max(valid, key=lambda checkpoint: checkpoint.sequence, default=None)

    def close(self) -> None:
        """Close the file: what was not read by then raises `ArchiveError`."""
        self.contents.close()

    def __enter__(self) -> Archive:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def open_archive(file: str | PathLike[str], *, limit: int | None = None) -> Archive:
    """Open an archive, even while it grows or after a kill.

    Nothing in the file is executed; each block of rows is checked.

    Parameters
    ----------
    file : path
    limit : int, optional
        Bytes of memory; default: 32 times the file's size, at least 128 MiB.

    Raises
    ------
    ArchiveError
        If the file is missing, unreadable, foreign, truncated, damaged or of a newer schema.
    """
    return Archive(Contents(file, limit=limit))


class StoredSteps(Sequence[Step]):
    """Steps of a path: ends and uncommitted ones in memory, the others in the file.

    Segments need stored tangents.
    """

    def __init__(self, file: File, path: int, held: Mapping[int, Step], count: int) -> None:
        self._file, self._path, self._held, self._count = file, path, dict(held), count
        self._window = dict[int, Step]()

    def append(self, step: Step) -> None:
        """Add the next step."""
        self._held[self._count] = step
        self._count += 1

    def committed(self) -> None:
        """Keep only the ends in memory."""
        self._held = {at: self._held[at] for at in (0, self._count - 1)}

    def __len__(self) -> int:
        return self._count

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(self._count))]
        at = range(self._count)[index]
        if at not in self._held and at not in self._window:
            with open_archive(self._file) as archive:
                size = archive.points.at_once
                first = at // size * size
                steps = _window(archive, self._path, first, first + size)[0]
            self._window = dict(enumerate(steps, first))
        return self._held.get(at) or self._window[at]

    def __repr__(self) -> str:
        return f"<{self._count} steps in {self._file}>"

    def column(self, name: str) -> Any:
        """All steps' ``u``, ``tangent`` or ``arclength`` as an array."""
        fields = {"u": ("y", "parameter"), "arclength": ("arclength",)}.get(name)
        if fields is None or len(self._held) == self._count:
            return np.array([getattr(step, name) for step in self])
        begin = self._count - len(self._held) + 1
        with open_archive(self._file) as archive:
            # Making steps takes 14 times as long.
            rows = archive.rows(self._path)
            steps = np.flatnonzero(archive.points.some("role", rows) == ACCEPTED)[:begin]
            found = [archive.points.some(field, rows)[steps] for field in fields]
        stored = found[0] if len(found) == 1 else np.column_stack(found)
        return np.concatenate((stored, [getattr(self._held[at], name) for at in range(begin, self._count)]))


def _window(archive: Archive, path: int, first: int, stop: int) -> tuple[list[Step], list[LocatedEvent]]:
    """Steps from `first` to `stop` - 1 with their events, read with the step before, where the first segment begins."""
    rows, before = archive.rows(path), max(first - 1, 0)
    accepted = np.append(np.flatnonzero(archive.points.some("role", rows) == ACCEPTED), rows.stop - rows.start)
    start, begin, end = (rows.start + int(accepted[min(k, len(accepted) - 1)]) for k in (before, first, stop))
    block = archive.points.block(slice(start, end))
    steps, events = from_columns(block, archive.event_names, archive.layout.own(OBSERVED), before)
    return steps[first - before :], events[np.count_nonzero(block["event_index"][: begin - start] >= 0) :]


def _stored(archive: Archive, path: int) -> tuple[StoredSteps, list[LocatedEvent]]:
    rows = archive.rows(path)
    accepted, numbers = archive.points.some("role", rows) == ACCEPTED, archive.points.some("event_index", rows)
    count = int(np.count_nonzero(accepted))
    # A kink's rows follow its step's.
    eventful = np.unique((np.cumsum(accepted) - 1)[numbers >= 0] // ROWS_AT_ONCE).tolist() if count else []
    events = [event for k in eventful for event in _window(archive, path, k * ROWS_AT_ONCE, (k + 1) * ROWS_AT_ONCE)[1]]
    ends = {at: _window(archive, path, at, at + 1)[0][0] for at in (0, count - 1) if count}
    return StoredSteps(archive.file, path, ends, count), events
