"""What a worker of a sweep does: some homotopies, one after another, into a file of its own if there is an archive."""

from __future__ import annotations

import secrets
import time
from collections.abc import Callable, Sequence
from pathlib import Path as File
from typing import Any

from attrs import define, frozen

from continuation.archive.errors import ArchiveError, ArchiveExistsError
from continuation.archive.writer import PathLog
from continuation.path import LocatedEvent, Path, Step
from continuation.path.interrupted import Interrupted
from continuation.status import Status
from continuation.step.options import Options
from continuation.step.tracer import Tracer
from continuation.step.verdict import sentence

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
    with _log(batch.file) as log:
        return _trace_all(batch, log, report)


def _log(file: File) -> PathLog:
    """A log in the worker's file; under another name where a lost worker's attempt at the same batch lies."""
    try:
        return PathLog(file)
    except ArchiveExistsError:
        return PathLog(file.with_name(f"{file.stem}-{secrets.token_hex(4)}{file.suffix}"))


@frozen(eq=False)
class _Held:
    """A log whose path is not ended by the tracer but by the sweep, which knows of an exception."""

    log: PathLog

    def step(self, tracer: Tracer, step: Step) -> None:
        self.log.step(tracer, step)

    def event(self, tracer: Tracer, event: LocatedEvent) -> None:
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


def _trace_all(batch: Batch, log: PathLog | None, report: Callable[[int], None] | None) -> Result:
    paths: list[Path] = []
    for i, homotopy in enumerate(batch.homotopies):
        if batch.stop is not None and batch.stop.exists():
            return Result(paths, stopped=True)
        if log is not None:
            log.member = batch.first + i
        path, stopped = _one(homotopy, log, batch.stop, batch.options)
        if log is None:
            paths.append(path)
        if stopped:
            return Result(paths, stopped=True)
        if report is not None:
            report(i + 1)
    return Result(paths)


def _one(homotopy: Any, log: PathLog | None, stop: File | None, options: Options) -> tuple[Path, bool]:
    """One path, and whether Ctrl-C ended it."""
    observers: list[Any] = [] if log is None else [_Held(log)]
    if stop is not None:
        observers.append(_Watch(stop))
    try:
        tracer = Tracer(homotopy, observers=tuple(observers), **options)
    except (Exception, SystemExit) as error:
        if log is not None:
            log.failure(homotopy, error)
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
    except (Exception, SystemExit) as error:
        tracer.path.message, stopped = sentence(error), False
    # A path that the sweep's stop cut short is left without an end: it is not among those that are kept.
    if log is not None and not (stopped and stop is not None and stop.exists()):
        log.end(tracer)
    return tracer.path, stopped


def failed(error: BaseException) -> Path:
    """The path of a homotopy that could not be traced."""
    return Path(status=Status.RAISED, message=sentence(error))
