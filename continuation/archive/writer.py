"""`PathLog`: the observer that writes paths to a file while they are traced."""

from __future__ import annotations

import json
import time
from collections.abc import Mapping
from numbers import Integral
from os import PathLike
from pathlib import Path as File
from types import TracebackType
from typing import Any

from continuation.archive.atomic import ArchiveError, as_file, check_new
from continuation.archive.checkpoint import Checkpoint, describe_run, pack
from continuation.archive.codec import problem_data
from continuation.archive.provenance import root_attributes
from continuation.archive.reader import open_archive
from continuation.archive.rows import (
    Buffer,
    Limits,
    Mark,
    OpenPath,
    Record,
    Row,
    counted,
    layout_of,
    record_of,
    row_columns,
    rows_at,
    to_columns,
)
from continuation.archive.schema import ACCEPTED, COUNT_NAMES, KINK_PART, LOCATED, SLOTS, check_names
from continuation.archive.store import Store, create
from continuation.archive.tables import StoredSteps, kept_whole
from continuation.arguments.checks import complain
from continuation.path import LocatedEvent, Path, Step
from continuation.status import Kind, Status
from continuation.step.tracer import Tracer
from continuation.step.verdict import sentence


class PathLog:
    """An observer that writes what it sees to an HDF5 file.

    Rows are buffered, and committed at 256 rows, 4 MiB or one second, and at the end of a path; a kill loses at most
    what was not committed. As a context manager one log holds many paths, traced one after another; else the file is
    closed at the end of the first.

    Parameters
    ----------
    file : path
        Must not exist. The file is made at the first point, so a trace that is refused leaves none.
    durable : bool
        Wait for the disk at each commit: survives a power cut, not only a kill.
    tangents : bool
        Store the unit tangents as well, so that a path that is read is a curve; without them a file is half as large.
        Always done, with the rays of its kinks, where the homotopy has pieces.
    title : str
    parameters : mapping, optional
        What the homotopies were made with, where their attributes do not say it: for `continuation resume`.
    limits : Limits
        When to commit.
    keep : str
        Which steps stay in memory: ``"all"``, or the ``"ends"``; the others are read when asked for.
    save_every : int
        Only every so many steps are written, with the first, the last and all events: for long paths.

    Attributes
    ----------
    member : int or None
        Index in a sweep of the path to come.

    Raises
    ------
    ArchiveError
        If the file exists, or its directory cannot be written; later, if the disk is full.
    ValueError
        Later, if a path has another number of unknowns than the first one.
    """

    file: File
    member: int | None = None
    _buffer: Buffer
    _early: list[Record]
    _limits: Limits
    _whole: bool
    _tangents, _durable, _title = True, False, ""
    _parameters: Mapping[str, Any]
    _many = _closed = False
    _store: Store | None = None
    _open: OpenPath | None = None
    _paths = _sequence = 0
    _save_every = 1
    _identifier = ""
    _known: tuple[Any, Any] = (None, None)
    """The file's first homotopy, and what says in a checkpoint how to make it."""
    _commit_at = 0.0

    def __init__(
        self,
        file: str | PathLike[str],
        *,
        durable: bool = False,
        tangents: bool = True,
        title: str = "",
        parameters: Mapping[str, Any] | None = None,
        limits: Limits | None = None,
        keep: str = "all",
        save_every: int = 1,
    ) -> None:
        limits = Limits() if limits is None else limits
        if not isinstance(limits, Limits):
            raise complain(TypeError, "limits", "Limits(...)", limits)
        if not isinstance(save_every, Integral) or save_every < 1 or (save_every > 1 and keep != "all"):
            raise complain(ValueError, "save_every", 'an integer, at least 1 (and 1 unless keep="all")', save_every)
        self.file, self._limits, self._whole = as_file("file", file), limits, kept_whole(keep)
        check_new(self.file)
        self._durable, self._tangents, self._title = durable, tangents, title
        self._parameters, self._save_every = dict(parameters or {}), int(save_every)
        self._buffer, self._early = Buffer(0), list[Record]()

    @classmethod
    def continued(
        cls, store: Store, points: int, checkpoint: Checkpoint, tracer: Tracer, whole: bool, identifier: str
    ) -> PathLog:
        """A log that goes on with a path of which the file holds the beginning; for `resume`.

        Parameters
        ----------
        store : Store
        points : int
            Rows that the file holds.
        checkpoint : Checkpoint
        tracer : Tracer
        whole : bool
            Whether all steps stay in memory.
        identifier : str
            Of the file in which the path began.
        """
        log = cls.__new__(cls)
        log.file, log._store, log._buffer, log._early = store.file, store, Buffer(points), []
        log._limits, log._whole, log._identifier = Limits(), whole, str(identifier)
        log._paths, log._sequence = checkpoint.path, checkpoint.sequence
        log._known, log.member = (tracer.homotopy, checkpoint.run["homotopy"]), checkpoint.run["member"]
        mark = Mark(checkpoint.state, tuple(checkpoint.counts[name] for name in COUNT_NAMES), checkpoint.rows)
        log._open = OpenPath(tracer, checkpoint.path, checkpoint.rows, checkpoint.seconds, None, mark, mark)
        log._commit_at = time.monotonic() + log._limits.seconds
        return log

    # -- the observer -----------------------------------------------------------------------------------------

    def step(self, tracer: Tracer, step: Step) -> None:
        """See `continuation.Observer`."""
        path = self._path(tracer)
        if self._store is None:
            self._make(tracer, step.u.size - 1, tuple(step.observed))
        if not self._whole and not isinstance(tracer.path.steps, StoredSteps):
            stored: Any = StoredSteps(open_archive, self.file, path.number)
            for earlier in tracer.path.steps:
                stored.append(earlier)
            tracer.path.steps = stored
        path.skipped = step if step.kind == Kind.REGULAR and step.index % self._save_every else None
        if path.skipped is not None:
            # Not a point to resume from either: that is one whose row is there.
            return
        events = tracer.path.events
        first = len(events)
        while first and events[first - 1].ends_step and events[first - 1].step == step.index:
            first -= 1
        for row in rows_at(step, events[first:], self._store is not None and self._store.layout.pieces):
            self._add(path, row)
        state = tracer.state
        if state is not None and state.index == step.index:
            # Whether the path ends at this point is decided after it is written. So a resumed trace begins one point
            # earlier; only at the start there is nothing left to be decided.
            mark = Mark(state, counted(tracer.counts), path.rows)
            path.resume = path.last if path.last is not None else mark
            path.last = mark
        buffer, limits = self._buffer, self._limits
        if len(buffer.rows) >= limits.rows or buffer.nbytes >= limits.nbytes or time.monotonic() >= self._commit_at:
            self._commit()

    def event(self, tracer: Tracer, event: LocatedEvent) -> None:
        """See `continuation.Observer`."""
        self._add(self._path(tracer), Row(event, event, LOCATED, event.tangent))

    def end(self, tracer: Tracer) -> None:
        """See `continuation.Observer`; commits the path, and closes the file unless the log is a context manager."""
        if self._open is not None and (self._closed or (self._store is not None and not self._store.ours)):
            # The disk is full, and has been told of; or a child was forked, whose copy of a path ends when it does.
            return
        path, found, state = self._path(tracer), tracer.path, tracer.state
        if path.skipped is not None:
            self._add(path, Row(path.skipped, None, ACCEPTED, path.skipped.tangent))
        row = record_of(found, tracer.homotopy, state.controller if state is not None else ())
        row["wall_time"] += path.seconds
        refused = self._store is None and found.status in (Status.INTERRUPTED, Status.RAISED)
        if self._many or not refused:
            self._finish(row, path.number, path.rows)
        self._open = None
        if not self._many:
            self.close()

    def failure(self, homotopy: Any, error: BaseException) -> None:
        """A path that could not even begin, as a row with the exception's text.

        Parameters
        ----------
        homotopy : Homotopy
        error : BaseException
        """
        self._check_open()
        path = Path(status=Status.RAISED, message=sentence(error))
        self._finish(record_of(path, homotopy, ()), self._paths, 0)

    def close(self) -> None:
        """Commit what is there and close the file; a second call does nothing."""
        if self._closed:
            return
        if self._store is None and self._early:
            self._make(None, 1, ())
        if self._store is not None:
            if self._buffer.rows and self._store.ours:
                self._commit()
            self._store.close()
        self._closed = True

    def __enter__(self) -> PathLog:
        self._many = True
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    # -- within -----------------------------------------------------------------------------------------------

    def _path(self, tracer: Tracer) -> OpenPath:
        path = self._open
        if path is not None:
            if path.tracer is tracer:
                return path
            raise ArchiveError(f"{self.file}: a path is being written already; a log writes one path after another")
        self._check_open()
        self._open = path = OpenPath(tracer, self._paths)
        self._commit_at = time.monotonic() + self._limits.seconds
        return path

    def _check_open(self) -> None:
        if self._closed:
            raise ArchiveError(f"{self.file}: the log is closed; for many paths use it in a `with` statement")

    def _add(self, path: OpenPath, row: Row) -> None:
        u = row.point.u
        if self._store is not None and u.size - 1 != self._store.layout.unknowns:
            held = self._store.layout.unknowns
            raise ValueError(f"homotopy: expected {held} unknowns, as in {self.file} so far, found {u.size - 1}")
        self._buffer.rows.append(row)
        steps: Any = path.tracer.path.steps
        if row.role != ACCEPTED and isinstance(steps, StoredSteps):
            steps.locate(row.role == KINK_PART)
        self._buffer.nbytes += u.nbytes
        path.rows += 1

    def _finish(self, row: Record, number: int, rows: int) -> None:
        """Write the path's own row; where there is no file yet, with the file."""
        row |= {"path": number, "member": number if self.member is None else self.member, "n_points": rows}
        self._paths = number + 1
        if self._store is None:
            self._early.append(row)
        else:
            self._commit(row)

    def _make(self, tracer: Tracer | None, unknowns: int, observed: tuple[str, ...]) -> None:
        """Make the file, and write the rows of paths that ended before there was one."""
        check_names("observe", observed)
        homotopy = tracer.homotopy if tracer is not None else None
        state = tracer.state.controller if tracer is not None and tracer.state is not None else ()
        layout = layout_of(homotopy, unknowns, observed, state, self._tangents, self._early)
        problem = problem_data(homotopy)
        self._known = (homotopy, {"problem": True} if problem[1] else json.loads(problem[0]))
        attributes = root_attributes(tracer, self._title, self._parameters)
        self._identifier = attributes["identifier"]
        self._store = create(self.file, layout, attributes, problem, durable=self._durable)
        for event in tracer.settings.events if tracer is not None else ():
            self._store.name_event(event.name)
        self._store.commit()
        for row in self._early:
            self._commit(row)
        self._early = []

    def _commit(self, row: Record | None = None) -> None:
        store, buffer, path = self._store, self._buffer, self._open
        assert store is not None
        points, checkpoints = None, {}
        # A commit that Ctrl-C interrupted may have been complete.
        start = max(buffer.start, store.committed.points)
        rows = buffer.rows[start - buffer.start :]
        if path is not None and rows:
            points = to_columns(rows, path.number, store.layout, store.name_event)
        if path is not None and path.resume is not None:
            checkpoints = {(self._sequence + 1) % SLOTS: self._checkpoint(path, path.resume)}
        paths = None
        if row is not None and row["path"] >= store.committed.paths:
            row["source"] = f"{self._identifier} {row['path']} {self.file.name}"
            paths = row_columns(row, store.layout)
        try:
            store.commit(points, start, paths, row["path"] if row is not None else 0, checkpoints)
        except ArchiveError:
            self._closed = True
            store.close()
            raise
        self._buffer = Buffer(start + len(rows))
        if path is not None and isinstance(path.tracer.path.steps, StoredSteps):
            path.tracer.path.steps.committed()
        self._sequence += 1
        self._commit_at = time.monotonic() + self._limits.seconds

    def _checkpoint(self, path: OpenPath, mark: Mark) -> bytes:
        if path.run is None:
            homotopy, described = self._known
            known = described if homotopy is path.tracer.homotopy else None
            path.run = json.dumps(describe_run(path.tracer, self.member, known)).encode()
        counts = dict(zip(COUNT_NAMES, mark.counts))
        seconds = path.seconds + path.tracer.seconds
        return pack(Checkpoint(self._sequence + 1, path.number, mark.rows, mark.state, counts, seconds, {}), path.run)
