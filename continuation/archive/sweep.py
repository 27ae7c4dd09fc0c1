"""`trace_many`: many paths, one after another or over any executor, kept whatever happens to some of them."""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Executor, Future, as_completed, wait
from itertools import pairwise
from os import PathLike
from pathlib import Path as File
from typing import Any

from attrs import frozen

from continuation.archive.atomic import check_new
from continuation.archive.errors import ArchiveError
from continuation.archive.merge import merge
from continuation.archive.reader import open_archive
from continuation.archive.record import sentence
from continuation.archive.writer import PathLog
from continuation.path import LocatedEvent, Path, Step
from continuation.status import Status
from continuation.step.tracer import Tracer

Progress = Callable[[int, int], None]
_PARTS_PER_WORKER = 4


def trace_many(
    homotopies: Iterable[Any],
    executor: Executor | None = None,
    archive: str | PathLike[str] | None = None,
    *,
    progress: Progress | None = None,
    **options: Any,
) -> Sequence[Path]:
    """Trace many homotopies.

    A homotopy that raises costs its own path only: that one has the status INTERRUPTED and the exception's text as its
    message. The order is that of the homotopies, whatever the order in which workers finish. Ctrl-C keeps the paths
    that are finished.

    Parameters
    ----------
    homotopies : iterable of Homotopy
        To be picklable where the executor needs it; all of one number of unknowns where there is an archive.
    executor : concurrent.futures.Executor, optional
        A process pool, dask's ``Client.get_executor()``, ...; without one, the calling process does it all.
    archive : path, optional
        One file with all paths. Workers write files of their own, ``name.0001.h5``, ..., which are merged into it and
        removed.
    progress : callable, optional
        ``progress(done, total)``, called in this process.
    **options
        As for `continuation.Tracer`, the same for all.

    Returns
    -------
    sequence of Path
        The open `Archive` where there is one (lazy, and to be closed), else a list.

    Raises
    ------
    TypeError
        For an option that `continuation.Tracer` does not have.
    ArchiveError
        If a file to be written exists, or the disk is full.
    KeyboardInterrupt
        After Ctrl-C, when everything finished is in the archive.
    """
    known = set(inspect.signature(Tracer).parameters) - {"homotopy", "observers", "state", "start"}
    unknown = set(options) - known
    if unknown:
        raise TypeError(f"options: expected some of {', '.join(sorted(known))}, found {', '.join(sorted(unknown))}")
    tasks = list(homotopies)
    target = None if archive is None else File(archive)
    if target is not None:
        check_new(target)
    report = progress or _silent
    if executor is None:
        result = _work(_Batch(tasks, 0, target, None, options), lambda done: report(done, len(tasks)))
        if result.stopped:
            raise KeyboardInterrupt
    else:
        result = _spread(executor, tasks, target, report, options)
    return result.paths if target is None else open_archive(target)


@frozen(eq=False)
class _Batch:
    """Homotopies for one worker, the number of the first, and the file for their paths."""

    homotopies: Sequence[Any]
    first: int
    file: File | None
    stop: File | None
    options: dict[str, Any]


@frozen(eq=False)
class _Result:
    """The paths of a batch (none where they are in a file), and whether Ctrl-C ended it."""

    paths: list[Path]
    stopped: bool = False


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


def _work(batch: _Batch, report: Callable[[int], None] | None = None) -> _Result:
    if batch.file is None:
        return _trace_batch(batch, None, report)
    with PathLog(batch.file) as log:
        return _trace_batch(batch, log, report)


def _trace_batch(batch: _Batch, log: PathLog | None, report: Callable[[int], None] | None) -> _Result:
    paths: list[Path] = []
    for i, homotopy in enumerate(batch.homotopies):
        if batch.stop is not None and batch.stop.exists():
            return _Result(paths, stopped=True)
        if log is not None:
            log.member = batch.first + i
        path, stopped = _one(homotopy, log, batch.options)
        if log is None:
            paths.append(path)
        if stopped:
            return _Result(paths, stopped=True)
        if report is not None:
            report(i + 1)
    return _Result(paths)


def _one(homotopy: Any, log: PathLog | None, options: dict[str, Any]) -> tuple[Path, bool]:
    """One path, and whether Ctrl-C ended it."""
    try:
        tracer = Tracer(homotopy, observers=() if log is None else (_Held(log),), **options)
    except Exception as error:
        if log is not None:
            log.failure(homotopy, error)
        return _failed(error), False
    stopped = True
    try:
        for _ in tracer:
            pass
        stopped = tracer.path.status is Status.INTERRUPTED
    except ArchiveError:
        # The disk's, not the path's.
        raise
    except Exception as error:
        tracer.path.message, stopped = sentence(error), False
    if log is not None:
        log.end(tracer)
    return tracer.path, stopped


def _failed(error: BaseException) -> Path:
    return Path(status=Status.INTERRUPTED, message=sentence(error))


def _silent(done: int, total: int) -> None:
    pass


# -- over an executor -----------------------------------------------------------------------------------------


def _spread(
    executor: Executor, tasks: list[Any], target: File | None, report: Progress, options: dict[str, Any]
) -> _Result:
    # A worker may run in another directory, on another machine.
    target = None if target is None else target.absolute()
    batches = _batches(tasks, _parts(executor, len(tasks)), target, options)
    futures: dict[Future[_Result], int] = {}
    stopped, done = False, 0
    try:
        for k, batch in enumerate(batches):
            futures[executor.submit(_work, batch)] = k
        for future in as_completed(futures):
            done += len(batches[futures[future]].homotopies)
            report(done, len(tasks))
    except KeyboardInterrupt:
        stopped = True
        _stop(futures, target)
    results = {futures[future]: _outcome(future) for future in futures}
    stopped = stopped or any(isinstance(r, _Result) and r.stopped for r in results.values())
    if target is not None:
        _collect(batches, results, target)
    if stopped:
        raise KeyboardInterrupt
    paths: list[Path] = []
    for k, batch in enumerate(batches):
        result = results[k]
        paths += result.paths if isinstance(result, _Result) else [_failed(result) for _ in batch.homotopies]
    return _Result(paths)


def _parts(executor: Executor, tasks: int) -> int:
    workers = getattr(executor, "_max_workers", None) or os.cpu_count() or 1
    return max(min(_PARTS_PER_WORKER * int(workers), tasks), 1)


def _batches(tasks: list[Any], parts: int, target: File | None, options: dict[str, Any]) -> list[_Batch]:
    """Consecutive homotopies of nearly equal number, each with the file that its worker writes."""
    bounds = [len(tasks) * k // parts for k in range(parts + 1)]
    batches = []
    for k, (first, last) in enumerate(pairwise(bounds)):
        file = None if target is None else target.with_name(f"{target.stem}.{k + 1:04d}{target.suffix}")
        if file is not None:
            check_new(file)
        batches.append(_Batch(tasks[first:last], first, file, _stop_sign(target), options))
    return batches


def _stop_sign(target: File | None) -> File | None:
    """A file whose existence ends the workers, wherever they are, after the path at hand."""
    return None if target is None else target.with_name(target.name + ".stop")


def _stop(futures: dict[Future[_Result], int], target: File | None) -> None:
    sign = _stop_sign(target)
    if sign is not None:
        sign.touch()
    for future in futures:
        future.cancel()
    wait(futures)
    if sign is not None:
        sign.unlink()


def _outcome(future: Future[_Result]) -> _Result | BaseException:
    if future.cancelled():
        return _Result([], stopped=True)
    error = future.exception()
    return future.result() if error is None else error


def _collect(batches: Sequence[_Batch], results: dict[int, _Result | BaseException], target: File) -> None:
    """Merge the workers' files; what a worker that died did not come to is there as failures."""
    files: list[File] = []
    for k, batch in enumerate(batches):
        assert batch.file is not None
        if batch.file.exists():
            files.append(batch.file)
        result = results.get(k)
        if isinstance(result, BaseException):
            files.append(_lost(batch, result))
    if files:
        merge(files, target)
    for file in files:
        file.unlink()


def _lost(batch: _Batch, error: BaseException) -> File:
    assert batch.file is not None
    written = 0
    if batch.file.exists():
        with open_archive(batch.file) as part:
            written = len(part)
    file = batch.file.with_name(f"{batch.file.stem}.lost{batch.file.suffix}")
    with PathLog(file) as log:
        for i, homotopy in enumerate(batch.homotopies[written:], start=written):
            log.member = batch.first + i
            log.failure(homotopy, error)
    return file
