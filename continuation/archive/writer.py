"""`PathLog`: the observer that writes paths to a file."""

from __future__ import annotations

import time
from collections.abc import Mapping
from itertools import takewhile
from numbers import Integral
from os import PathLike
from pathlib import Path as File
from types import TracebackType
from typing import Any

from attrs import define, field, frozen

from continuation.archive.atomic import ArchiveError, new_file
from continuation.archive.codec import problem_data
from continuation.archive.provenance import Checkpoint, describe_run, pack, root_attributes
from continuation.archive.reader import StoredSteps
from continuation.archive.rows import (
    Record,
    Row,
    counted,
    joined,
    kept_whole,
    layout_of,
    record_of,
    row_columns,
    rows_at,
    to_columns,
)
from continuation.archive.schema import COUNT_NAMES, check_names
from continuation.archive.store import Store, put
from continuation.arguments.checks import expect, integer, number
from continuation.path import LocatedEvent, Step
from continuation.status import Kind, Status
from continuation.step.state import State
from continuation.step.tracer import Tracer

Mark = tuple[State, tuple[int, ...], int]
"""A point to resume from: state, counters, number of earlier rows."""


@frozen
class Limits:
    """Rows, bytes or seconds until a commit."""

    rows: int = field(default=256, validator=integer(1))
    nbytes: int = field(default=4 << 20, validator=integer(1))
    seconds: float = field(default=1.0, validator=number("at least 0", lambda x: x >= 0.0))


@define(eq=False)
class OpenPath:
    """The path being written."""

    tracer: Tracer
    number: int
    first: int
    seconds: float = 0.0
    run: Mapping[str, Any] = field(factory=dict)
    last: Mark | None = None
    resume: Mark | None = None
    skipped: Row | None = None


class PathLog:
    """An observer that writes paths to an HDF5 file.

    Rows are committed at 256 rows, 4 MiB or one second by default, and at a path's end. In a ``with`` statement a log
    holds many paths; otherwise the first one's end closes the file.

    Parameters
    ----------
    file : path
        Must not exist; the first point creates it.
    durable : bool
        Wait for the disk at each commit, to survive power cuts.
    title : str
    parameters : mapping, optional
        Parameters for `continuation resume` that the homotopies' attributes lack.
    limits : Limits
    keep : str
        Steps in memory: ``"all"``, or the ``"ends"``.
    save_every : int
        Write every so many steps, and the first, the last and all events.

    Raises
    ------
    ArchiveError
        If the file exists or cannot be written.
    ValueError
        Later, if a path has another number of unknowns.
    """

    file: File
    _rows: tuple[int, list[Row]]
    """Number of the first uncommitted row, and these rows."""
    _ended: dict[int, Record]
    """Uncommitted rows of the path table."""
    _many = _closed = False
    _store: Store | None = None
    _open: OpenPath | None = None
    _limits, _whole, _save_every, _durable = Limits(), True, 1, False
    _about: tuple[str, Mapping[str, Any]] = ("", {})
    _first: Any = None
    """The homotopy in the problem group."""
    _commit_at = 0.0

    def __init__(
        self,
        file: str | PathLike[str],
        *,
        durable: bool = False,
        title: str = "",
        parameters: Mapping[str, Any] | None = None,
        limits: Limits | None = None,
        keep: str = "all",
        save_every: int = 1,
    ) -> None:
        expect(isinstance(limits, Limits | None), "limits", "Limits(...)", limits, TypeError)
        fine = isinstance(save_every, Integral) and (save_every == 1 or (save_every > 1 and keep == "all"))
        expect(fine, "save_every", 'an integer, at least 1 (and 1 unless keep="all")', save_every)
        self._whole, self.file = kept_whole(keep), new_file("file", file)
        self._limits, self._save_every = limits or Limits(), int(save_every)
        self._durable, self._about = durable, (title, dict(parameters or {}))
        self._rows, self._ended = (0, []), {}

    @classmethod
    def continued(cls, store: Store, checkpoint: Checkpoint, tracer: Tracer, whole: bool) -> PathLog:
        """A log that continues a path in a file, for `resume`.

        Parameters
        ----------
        store : Store
        checkpoint : Checkpoint
        tracer : Tracer
        whole : bool
            Keep all steps in memory.
        """
        log = cls.__new__(cls)
        points = store.committed.points
        log.file, log._store, log._rows, log._ended = store.file, store, (points, []), {}
        log._whole = whole
        mark = checkpoint.state, tuple(checkpoint.counts[name] for name in COUNT_NAMES), checkpoint.rows
        first = points - checkpoint.rows
        log._open = OpenPath(tracer, checkpoint.path, first, checkpoint.seconds, checkpoint.run, mark, mark)
        log._commit_at = time.monotonic() + log._limits.seconds
        return log

    def step(self, tracer: Tracer, step: Step) -> None:
        """See `continuation.Observer`."""
        path = self._path(tracer)
        store = self._store or self._make(tracer, step.u.size - 1, tuple(step.observed))
        if step.u.size - 1 != store.layout.unknowns:
            held, found = store.layout.unknowns, step.u.size - 1
            raise ValueError(f"homotopy: expected {held} unknowns, as in {self.file} so far, found {found}")
        if not self._whole and not isinstance(tracer.path.steps, StoredSteps):
            before = dict(enumerate(tracer.path.steps))
            stored: Any = StoredSteps(self.file, path.number, before, len(before))
            tracer.path.steps = stored
        events = [*takewhile(lambda e: e.step == step.index, reversed(tracer.path.events))]
        found_rows = rows_at(step, events[::-1])
        path.skipped = found_rows.pop() if step.kind == Kind.REGULAR and step.index % self._save_every else None
        self._rows[1].extend(found_rows)
        if path.skipped is not None:
            # A resumed trace needs the row.
            return
        state, (first, rows) = tracer.state, self._rows
        if state is not None and state.index == step.index:
            # The path may still end here: a trace resumes one point earlier.
            mark = state, counted(tracer.counts), first + len(rows) - path.first
            path.resume, path.last = path.last or mark, mark
        limits = self._limits
        full = len(rows) >= limits.rows or len(rows) * step.u.nbytes >= limits.nbytes
        if full or time.monotonic() >= self._commit_at:
            self._commit()

    def event(self, tracer: Tracer, event: LocatedEvent) -> None:
        """Do nothing: rows are written with the step after the event."""

    def end(self, tracer: Tracer) -> None:
        """See `continuation.Observer`; commits, and closes the file without ``with``."""
        if self._open is not None and (self._closed or (self._store is not None and self._store.abandoned)):
            # The disk is full, or this process is a forked child.
            return
        path, found, state = self._path(tracer), tracer.path, tracer.state
        if path.skipped is not None:
            self._rows[1].append(path.skipped)
        row = record_of(found, tracer.homotopy, state.controller if state is not None else ())
        row["wall_time"] += path.seconds
        if self._many or self._store is not None or found.status not in (Status.INTERRUPTED, Status.RAISED):
            row |= {"path": path.number, "member": path.number}
            row["n_points"] = self._rows[0] + len(self._rows[1]) - path.first
            self._ended[path.number] = row
            if self._store is not None:
                self._commit()
        self._open = None
        if not self._many:
            self.close()

    def close(self) -> None:
        """Commit and close the file; idempotent."""
        if self._closed:
            return
        store = self._store or (self._make(None, 1, ()) if self._ended else None)
        if store is not None:
            if (self._rows[1] or self._ended) and not store.abandoned:
                self._commit()
            store.close()
        self._closed = True

    def __enter__(self) -> PathLog:
        self._many = True
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _path(self, tracer: Tracer) -> OpenPath:
        path = self._open
        if path is None:
            if self._closed:
                raise ArchiveError(f"{self.file}: the log is closed; for many paths use it in a `with` statement")
            number = max([*self._ended, (self._store.committed.paths if self._store else 0) - 1]) + 1
            self._open = path = OpenPath(tracer, number, self._rows[0])
            self._commit_at = time.monotonic() + self._limits.seconds
        if path.tracer is not tracer:
            raise ArchiveError(f"{self.file}: a path is being written already; a log writes one path after another")
        return path

    def _make(self, tracer: Tracer | None, unknowns: int, observed: tuple[str, ...]) -> Store:
        check_names("observe", observed)
        self._first = homotopy = tracer.homotopy if tracer is not None else None
        state = tracer.state.controller if tracer is not None and tracer.state is not None else ()
        layout = layout_of(homotopy, unknowns, observed, state, self._ended.values())
        attributes, problem = root_attributes(tracer, *self._about), problem_data(homotopy)
        self._store = put(self.file, layout, attributes, problem, durable=self._durable, grows=True)
        return self._store

    def _commit(self) -> None:
        store, path = self._store, self._open
        assert store is not None
        points = checkpoint = None
        # The commit that Ctrl-C interrupted may be complete.
        start = store.committed.points
        rows = self._rows[1][start - self._rows[0] :]
        if path is not None and rows:
            points = to_columns(rows, path.number, store.layout, store.name_event)
        if path is not None and path.resume is not None:
            first = self._first is path.tracer.homotopy
            path.run = path.run or describe_run(path.tracer, first)
            (state, counts, held), seconds = path.resume, path.seconds + path.tracer.seconds
            named, sequence = dict(zip(COUNT_NAMES, counts)), store.committed.checkpoint + 1
            checkpoint = pack(Checkpoint(sequence, path.number, held, state, named, seconds, path.run))
        ended = [
            row_columns({**row, "source": f"{store.identifier} {number} {self.file.name}"}, store.layout)
            for number, row in self._ended.items()
            if number >= store.committed.paths
        ]
        paths = joined(ended) if ended else None
        try:
            store.commit(points, paths, checkpoint)
        except ArchiveError:
            self._closed = True
            store.close()
            raise
        self._rows, self._ended = (start + len(rows), []), {}
        if path is not None and isinstance(path.tracer.path.steps, StoredSteps):
            path.tracer.path.steps.committed()
        self._commit_at = time.monotonic() + self._limits.seconds
