"""`trace_many`: many paths, one after another or over any executor, kept whatever happens to some of them."""

from __future__ import annotations

import os
import secrets
import tempfile
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, ProcessPoolExecutor, wait
from contextlib import suppress
from itertools import pairwise
from multiprocessing.process import BaseProcess
from os import PathLike
from pathlib import Path as File
from typing import Any, Unpack

from attrs import define, field

from continuation.archive.atomic import as_file, check_new
from continuation.archive.merge import THREAD_SECONDS, collect, end_repeats, finished
from continuation.archive.reader import open_archive
from continuation.archive.workers import Batch, Result, failed, work
from continuation.arguments.checks import complain, instance_with, is_number
from continuation.path import Path
from continuation.path.interrupted import Interrupted
from continuation.status import Status
from continuation.step.options import Options, check_names

Progress = Callable[[int, int], None]
_PARTS_PER_WORKER = 4
_GRACE = 0.5
"""Seconds that workers get to end their paths after Ctrl-C: they look for it each 0.2 s; the rest is for the files."""


def trace_many(
    homotopies: Iterable[Any],
    executor: Executor | None = None,
    archive: str | PathLike[str] | None = None,
    *,
    progress: Progress | None = None,
    timeout: float | None = None,
    **options: Unpack[Options],
) -> Sequence[Path]:
    """Trace many homotopies.

    A homotopy that raises, exits, ends its worker's process, takes longer than the timeout or cannot be sent to a
    worker costs its own path only: that one has the status RAISED and the exception's text as its message. The
    order is that of the homotopies, whatever the order in which workers finish. Ctrl-C keeps the paths that are
    finished, and ends within about a second.

    Parameters
    ----------
    homotopies : iterable of Homotopy
        To be picklable where the executor needs it. Where there is an archive those of another number of unknowns than
        the first have the status RAISED.
    executor : concurrent.futures.Executor, optional
        A process pool, dask's ``Client.get_executor()``, ...; without one, the calling process does it all.
    archive : path, optional
        One file with all paths. Workers write files of their own, ``name.sweep-xxxxxxxx.0001.h5``, ..., which are
        merged into it and removed. If this process is killed they stay, to be merged, and the sweep can be run again.
    progress : callable, optional
        ``progress(done, total)``, called in this process; `continuation.step.progress.SweepProgress` shows it.
    timeout : float, optional
        Seconds that one homotopy may take with a process pool, whose processes are ended then. (`Budget.seconds` is
        looked at between steps, and so never where a homotopy does not come back.)
    **options
        As for `continuation.trace`, the same for all; `start` is every homotopy's own.

    Returns
    -------
    sequence of Path
        The open `Archive` where there is one (lazy, and to be closed), else a list.

    Raises
    ------
    TypeError
        For an option that `continuation.Tracer` does not have, or for what is no homotopy.
    ValueError
        If there are no homotopies, and there is an archive.
    ArchiveError
        If a file to be written exists, or the disk is full.
    KeyboardInterrupt
        After Ctrl-C, when everything finished is in the archive.
    """
    check_names(options, owned={"start": "where every homotopy has its own"})
    if timeout is not None and not (is_number(timeout) and timeout > 0):
        raise complain(ValueError, "timeout", "a positive number of seconds", timeout)
    if not isinstance(homotopies, Iterable):
        raise complain(TypeError, "homotopies", "several, as in a list", homotopies)
    if executor is not None:
        instance_with("executor", executor, ("submit",), "a concurrent.futures.Executor")
    if progress is not None and not callable(progress):
        raise complain(TypeError, "progress", "a function of (done, total)", progress)
    tasks = list(homotopies)
    for homotopy in tasks:
        instance_with("homotopies", homotopy, ("start", "residual"), "homotopies only")
    target = None if archive is None else as_file("archive", archive)
    if target is not None:
        check_new(target)
        if not tasks:
            raise ValueError("homotopies: expected at least one where there is an archive, found none to trace")
    report = progress or (lambda done, total: None)
    if executor is None:
        result = work(Batch(tasks, 0, target, None, options), lambda done: report(done, len(tasks)))
        if result.stopped:
            raise _interrupted(result.paths)
    else:
        result = _spread(executor, tasks, target, report, timeout, options)
    return result.paths if target is None else open_archive(target)


def _interrupted(paths: Sequence[Path]) -> Interrupted:
    """Ctrl-C, with what is not in a file."""
    return Interrupted(paths[-1] if paths else Path(status=Status.INTERRUPTED), paths)


# -- over an executor -----------------------------------------------------------------------------------------


def _spread(
    executor: Executor, tasks: list[Any], target: File | None, report: Progress, timeout: float | None, options: Options
) -> Result:
    # A worker may run in another directory, on another machine.
    target = None if target is None else target.absolute()
    token = secrets.token_hex(4)
    sign = f"continuation-{token}.stop" if target is None else f"{target.stem}.sweep-{token}.stop"
    stop = (File(tempfile.gettempdir()) if target is None else target.parent) / sign
    parts = len(tasks) if timeout is not None else _parts(executor, len(tasks))
    batches = _batches(tasks, max(parts, 1), target, token, stop, options)
    run = _Run(executor, batches, report, timeout)
    try:
        run.begin()
        run.mend()
        if target is not None and not run.errors():
            end_repeats(target, token, stop)
    except KeyboardInterrupt:
        run.stop(stop)
    finally:
        with suppress(OSError):
            stop.unlink()
    found = run.results
    stopped = run.stopped or any(result.stopped for result in found.values() if isinstance(result, Result))
    if target is not None:
        collect(batches, run.errors(), target, token, stopped)
    if stopped:
        raise _interrupted([path for k in sorted(found) for path in getattr(found[k], "paths", ())])
    return Result([] if target is not None else run.paths())


@define(eq=False)
class _Run:
    """The batches of a sweep on their way: a result or an exception for each, and for single homotopies done again."""

    executor: Executor
    batches: Sequence[Batch]
    report: Progress
    timeout: float | None
    results: dict[int, Result | BaseException] = field(factory=dict)
    again: dict[int, Result | BaseException] = field(factory=dict)
    futures: dict[Future[Result], int] = field(factory=dict)
    processes: list[BaseProcess] = field(factory=list)
    stopped: bool = False
    done: int = 0

    def begin(self) -> None:
        """Submit all of it and wait; workers that hang past the timeout are ended with their processes."""
        for k, batch in enumerate(self.batches):
            self.futures[self.executor.submit(work, batch)] = k
        self.processes = _processes(self.executor)
        waiting = set(self.futures)
        while waiting:
            ended, waiting = wait(waiting, timeout=self.timeout, return_when=FIRST_COMPLETED)
            if not ended:
                # All that run have run for that long, since a worker that ends one begins the next.
                if not _end_processes(self.executor):
                    waiting = {future for future in waiting if not future.cancel() and not future.running()}
                    continue
                ended, waiting = wait(waiting)
            for future in ended:
                self._take(future)
                # Dask does again what is lost with a worker while somebody holds its future.
                del self.futures[future]
            del ended

    def _take(self, future: Future[Result]) -> None:
        k = self.futures[future]
        self.results[k] = _outcome(future)
        if isinstance(self.results[k], Result):
            self._count(len(self.batches[k].homotopies))

    def _count(self, number: int) -> None:
        self.done += number
        self.report(self.done, sum(len(batch.homotopies) for batch in self.batches))

    def mend(self) -> None:
        """Do again, one by one, what was lost with a worker, or with a batch that could not be sent to one.

        Where the executor is broken each homotopy gets a process of its own, so that one that ends its process takes no
        other with it.
        """
        if any(isinstance(found, BrokenExecutor) for found in self.results.values()):
            self._join()
        lost = f"took longer than {self.timeout:g} s" if self.timeout else "was never begun"
        for k, batch in enumerate(self.batches):
            error = self.results.setdefault(k, TimeoutError(lost))
            if isinstance(error, Result):
                continue
            written = finished(batch)
            for i in range(len(batch.homotopies)):
                if batch.first + i not in written:
                    self.again[batch.first + i] = self._alone(batch.single(i), error)
                self._count(1)

    def _join(self) -> None:
        """Wait for processes that were ended, or are by their pool: their files are at rest after that."""
        for process in self.processes:
            process.join()

    def _alone(self, batch: Batch, error: BaseException) -> Result | BaseException:
        if isinstance(error, TimeoutError):
            return error
        if not isinstance(error, BrokenExecutor):
            return _waited(self.executor.submit(work, batch), self.timeout)
        if not isinstance(self.executor, ProcessPoolExecutor):
            return error
        context = getattr(self.executor, "_mp_context", None)
        alone = ProcessPoolExecutor(1, mp_context=context)
        try:
            found = _waited(alone.submit(work, batch), self.timeout)
        except BaseException:
            _end_processes(alone)
            raise
        if isinstance(found, TimeoutError):
            _end_processes(alone)
        alone.shutdown()
        return found

    def stop(self, sign: File) -> None:
        """Let the workers end their paths, and those that do not do so soon, with their processes."""
        self.stopped = True
        with suppress(OSError):
            sign.touch()
        for future in self.futures:
            future.cancel()
        if wait(self.futures, timeout=_GRACE).not_done:
            ended = _end_processes(self.executor)
            self._join()
            wait(self.futures, timeout=_GRACE / 4 if ended else THREAD_SECONDS)
        for future, k in self.futures.items():
            if future.done():
                self.results[k] = _outcome(future)

    def errors(self) -> dict[int, BaseException]:
        """By the number of the homotopy."""
        return {number: found for number, found in self.again.items() if isinstance(found, BaseException)}

    def paths(self) -> list[Path]:
        """All the paths, in the order of the homotopies."""
        paths: list[Path] = []
        for k, batch in enumerate(self.batches):
            result = self.results[k]
            if isinstance(result, Result):
                paths += result.paths
                continue
            for i in range(len(batch.homotopies)):
                found = self.again[batch.first + i]
                paths += found.paths if isinstance(found, Result) else [failed(found)]
        return paths


def _waited(future: Future[Result], timeout: float | None) -> Result | BaseException:
    if not wait([future], timeout=timeout).done:
        future.cancel()
        return TimeoutError(f"took longer than {timeout:g} s")
    return _outcome(future)


def _outcome(future: Future[Result]) -> Result | BaseException:
    if future.cancelled():
        return Result([], stopped=True)
    error = future.exception()
    return future.result() if error is None else error


def _end_processes(executor: Executor) -> bool:
    """End the processes of a pool, whose homotopies do not come back; False where it has none of its own."""
    processes = _processes(executor)
    for process in processes:
        process.kill()
    return bool(processes)


def _processes(executor: Executor) -> list[BaseProcess]:
    processes = getattr(executor, "_processes", None) if isinstance(executor, ProcessPoolExecutor) else None
    return list((processes or {}).values())


def _parts(executor: Executor, tasks: int) -> int:
    workers = getattr(executor, "_max_workers", None) or os.cpu_count() or 1
    return max(min(_PARTS_PER_WORKER * int(workers), tasks), 1)


def _batches(
    tasks: list[Any], parts: int, target: File | None, token: str, stop: File, options: Options
) -> list[Batch]:
    """Consecutive homotopies of nearly equal number, each with the file that its worker writes."""
    bounds = [len(tasks) * k // parts for k in range(parts + 1)]
    batches = []
    for k, (first, last) in enumerate(pairwise(bounds)):
        name = f"{target.stem}.sweep-{token}.{k + 1:04d}{target.suffix}" if target is not None else ""
        file = target.with_name(name) if target is not None else None
        batches.append(Batch(tasks[first:last], first, file, stop, options))
    return batches
