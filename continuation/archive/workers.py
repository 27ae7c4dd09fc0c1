"""What a worker of a sweep does: some homotopies, one after another, into a file of its own if there is an archive."""

from __future__ import annotations

import secrets
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path as File
from typing import Any

from attrs import define, field, frozen

from continuation.archive.errors import ArchiveError, ArchiveExistsError
from continuation.archive.writer import PathLog
from continuation.path import LocatedEvent, Path, Step
from continuation.path.interrupted import Interrupted
from continuation.status import Kind, Status
from continuation.step.options import Options
from continuation.step.tracer import Tracer
from continuation.step.verdict import sentence

_ITS_OWN = (Exception, SystemExit, GeneratorExit)
"""What a homotopy raises costs its own path; Ctrl-C alone ends the sweep."""

_LOOK = 0.2
"""Seconds between two looks at the stop sign."""


@frozen(eq=False)
class Batch:
    """Homotopies for one worker, the number of the first in the sweep, and the file for their paths.

    A file `stop` ends the worker, wherever it is, by its existence.
    """

    homotopies: Sequence[Any]
    first: int
    file: File | None
    stop: File | None
    options: Options

    def single(self, k: int) -> Batch:
        """The k-th homotopy alone."""
        return Batch(self.homotopies[k : k + 1], self.first + k, self.file, self.stop, self.options)


@frozen(eq=False)
class Result:
    """The paths of a batch (none where they are in a file), and whether Ctrl-C ended it."""

    paths: list[Path]
    stopped: bool = False


def work(batch: Batch, report: Callable[[int], None] | None = None) -> Result:
    """Trace a batch."""
    if batch.file is None:
        return _trace_all(batch, None, report)
    with ExitStack() as files:
        return _trace_all(batch, _Logs(batch.file, batch.stop is None, files), report)


@define(eq=False)
class _Logs:
    """The logs of a worker, which end a path when the sweep says so: it knows of an exception, the tracer does not.

    With one file the first size of the homotopies is that of all. Else each size has a file of its own, since which is
    the sweep's is known when all of its workers are done.
    """

    file: File
    one: bool
    files: ExitStack
    logs: dict[int, PathLog] = field(factory=dict)
    log: PathLog = field(init=False)
    member: int = 0

    def __attrs_post_init__(self) -> None:
        self.log = self.logs[0] = self.files.enter_context(self._new())

    def _new(self) -> PathLog:
        """A log in the worker's file; under another name where that is taken, as by a lost worker's attempt."""
        try:
            return PathLog(self.file)
        except ArchiveExistsError:
            return PathLog(self.file.with_name(f"{self.file.stem}-{secrets.token_hex(4)}{self.file.suffix}"))

    def begin(self, member: int) -> None:
        """The next path; it has no size before its first step."""
        self.log, self.member = self.logs[0], member
        self.log.member = member

    def step(self, tracer: Tracer, step: Step) -> None:
        """See `continuation.Observer`."""
        if step.kind == Kind.START and not self.one:
            self._choose(step.u.size)
        self.log.step(tracer, step)

    def _choose(self, size: int) -> None:
        if size not in self.logs:
            # The first size takes the file that is there, with the failures in it.
            self.logs[size] = self.logs[0] if len(self.logs) == 1 else self.files.enter_context(self._new())
        self.log = self.logs[size]
        self.log.member = self.member

    def event(self, tracer: Tracer, event: LocatedEvent) -> None:
        """See `continuation.Observer`."""
        self.log.event(tracer, event)

    def end(self, tracer: Tracer) -> None:
        """Not yet."""


@define(eq=False)
class _Watch:
    """Ends a path as Ctrl-C does, once the stop sign is there."""

    stop: File
    next_look: float = 0.0

    def step(self, tracer: Tracer, step: Step) -> None:
        if time.monotonic() >= self.next_look:
            self.next_look = time.monotonic() + _LOOK
            if self.stop.exists():
                raise KeyboardInterrupt

    def event(self, tracer: Tracer, event: LocatedEvent) -> None:
        """Nothing to do."""

    def end(self, tracer: Tracer) -> None:
        """Nothing to do."""


def _trace_all(batch: Batch, logs: _Logs | None, report: Callable[[int], None] | None) -> Result:
    paths: list[Path] = []
    for i, homotopy in enumerate(batch.homotopies):
        if batch.stop is not None and batch.stop.exists():
            return Result(paths, stopped=True)
        if logs is not None:
            logs.begin(batch.first + i)
        path, stopped = _one(homotopy, logs, batch.stop, batch.options)
        if logs is None:
            paths.append(path)
        if stopped:
            return Result(paths, stopped=True)
        if report is not None:
            report(i + 1)
    return Result(paths)


def _one(homotopy: Any, logs: _Logs | None, stop: File | None, options: Options) -> tuple[Path, bool]:
    """One path, and whether Ctrl-C ended it."""
    observers: list[Any] = [] if logs is None else [logs]
    if stop is not None:
        observers.append(_Watch(stop))
    try:
        tracer = Tracer(homotopy, observers=tuple(observers), **options)
    except _ITS_OWN as error:
        if logs is not None:
            logs.log.failure(homotopy, error)
        return failed(error), False
    stopped = True
    try:
        tracer.run()
        stopped = False
    except Interrupted:
        pass
    except ArchiveError:
        # The disk's, not the path's.
        raise
    except _ITS_OWN as error:
        if tracer.path.status in (Status.TRACING, Status.ABANDONED):
            tracer.path.status = Status.RAISED
        tracer.path.message, stopped = sentence(error), False
    # A path that the sweep's stop cut short is left without an end: it is not among those that are kept.
    if logs is not None and not (stopped and stop is not None and stop.exists()):
        logs.log.end(tracer)
    return tracer.path, stopped


def failed(error: BaseException) -> Path:
    """The path of a homotopy that could not be traced."""
    return Path(status=Status.RAISED, message=sentence(error))
