"""What a worker of a sweep does: one homotopy, whose path it returns, as a share where there is an archive."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path as File
from typing import Any

from attrs import define, frozen

from continuation.archive.atomic import ArchiveError
from continuation.archive.copies import Share
from continuation.archive.growing import share_of_path
from continuation.archive.writer import PathLog
from continuation.path import LocatedEvent, Path, Step
from continuation.path.interrupted import Interrupted
from continuation.status import Status
from continuation.step.options import Options
from continuation.step.tracer import Observer, Tracer
from continuation.step.verdict import sentence

Result = Path | Share | BaseException | None
"""What came of a homotopy; None where Ctrl-C ended it."""

_LOOK = 0.2
"""Seconds between two looks at the stop sign."""

_ITS_OWN = (Exception, SystemExit, GeneratorExit)
"""What a homotopy raises costs its own path; Ctrl-C alone ends the sweep."""


@define(eq=False)
class Watch:
    """Ends a path as Ctrl-C does once the stop sign, a file, is there; else tells a log of all but the path's end."""

    stop: File | None = None
    log: PathLog | None = None
    next_look: float = 0.0

    def step(self, tracer: Tracer, step: Step) -> None:
        """See `continuation.Observer`."""
        if self.log is not None:
            self.log.step(tracer, step)
        if self.stop is not None and time.monotonic() >= self.next_look:
            self.next_look = time.monotonic() + _LOOK
            if self.stop.exists():
                raise KeyboardInterrupt

    def event(self, tracer: Tracer, event: LocatedEvent) -> None:
        """See `continuation.Observer`."""
        if self.log is not None:
            self.log.event(tracer, event)

    def end(self, tracer: Tracer) -> None:
        """Not yet: the exception that ended a path is known to who called the tracer."""


def begun(homotopy: Any, observer: Observer, options: Options) -> Tracer | BaseException:
    """The tracer of a homotopy, or why there is none."""
    try:
        return Tracer(homotopy, observers=(observer,), **options)
    except _ITS_OWN as error:
        return error


def interrupts(tracer: Tracer) -> bool:
    """Trace the path to its end; whether Ctrl-C is that."""
    try:
        tracer.run()
    except Interrupted:
        return True
    except ArchiveError:
        # The disk's, not the path's.
        raise
    except _ITS_OWN as error:
        if tracer.path.status in (Status.TRACING, Status.ABANDONED):
            tracer.path.status = Status.RAISED
        tracer.path.message = sentence(error)
    return False


def failed(error: BaseException) -> Path:
    """The path of a homotopy that could not be traced."""
    return Path(status=Status.RAISED, message=sentence(error))


@frozen(eq=False)
class Task:
    """A homotopy for a worker, and its number in the sweep. A file `stop` ends the worker by its existence."""

    homotopy: Any
    number: int
    stop: File
    archived: bool
    options: Options


def work(task: Task) -> Result:
    """Trace a homotopy."""
    if task.stop.exists():
        return None
    tracer = begun(task.homotopy, Watch(task.stop), task.options)
    if not isinstance(tracer, Tracer):
        return kept(failed(tracer), task)
    if interrupts(tracer):
        return None
    return kept(tracer.path, task, tracer.state.controller if tracer.state is not None else ())


def kept(path: Path, task: Task, controller: Sequence[float] = ()) -> Path | Share:
    """A path as it is sent back."""
    return share_of_path(path, task.homotopy, controller, task.number) if task.archived else path
