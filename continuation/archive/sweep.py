"""`trace_many`: many paths, one after another or over any executor, kept whatever happens to some of them.

A worker traces one homotopy and sends back its path, as a share of columns where there is an archive. This process
alone writes: what is lost with a worker is one path, and a kill of this process leaves those that came.
"""

from __future__ import annotations

import secrets
import tempfile
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, ProcessPoolExecutor, wait
from contextlib import ExitStack, suppress
from multiprocessing.process import BaseProcess
from os import PathLike
from pathlib import Path as File
from typing import Any, Unpack

from attrs import define, field

from continuation.archive.atomic import as_file, check_new
from continuation.archive.codec import problem_data
from continuation.archive.copies import Share, append, gather
from continuation.archive.provenance import root_attributes
from continuation.archive.reader import open_archive
from continuation.archive.schema import Layout
from continuation.archive.store import Store, create
from continuation.archive.workers import Result, Task, Watch, begun, failed, interrupts, kept, work
from continuation.archive.writer import PathLog
from continuation.arguments.checks import complain, instance_with, is_number
from continuation.path import Path
from continuation.path.interrupted import Interrupted
from continuation.status import Status
from continuation.step.options import Options, check_names
from continuation.step.tracer import Tracer

Progress = Callable[[int, int], None]
_GRACE = 0.5
"""Seconds that workers get to end their paths after Ctrl-C: they look for it each 0.2 s; the rest is for the answer."""


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
        One file with all paths. Those of an executor are kept in ``name.sweep-xxxxxxxx.1.h5`` as they come (each
        number of unknowns has a file), and are put in order at the end. If this process is killed they stay there, and
        the sweep can be run again.
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
    paths = (
        _serial(tasks, target, report, options)
        if executor is None
        else _spread(executor, tasks, target, report, timeout, options)
    )
    return paths if target is None else open_archive(target)


def _interrupted(paths: Sequence[Path]) -> Interrupted:
    """Ctrl-C, with what is not in a file."""
    return Interrupted(paths[-1] if paths else Path(status=Status.INTERRUPTED), paths)


# -- one after another, or over an executor --------------------------------------------------------------------


def _serial(tasks: list[Any], target: File | None, report: Progress, options: Options) -> list[Path]:
    """One after another, into a log of them all."""
    paths: list[Path] = []
    with ExitStack() as stack:
        log = None if target is None else stack.enter_context(PathLog(target))
        for number, homotopy in enumerate(tasks):
            if log is not None:
                log.member = number
            tracer, stopped = begun(homotopy, Watch(log=log), options), False
            if isinstance(tracer, Tracer):
                stopped = interrupts(tracer)
            if log is None:
                paths.append(tracer.path if isinstance(tracer, Tracer) else failed(tracer))
            elif isinstance(tracer, Tracer):
                log.end(tracer)
            else:
                log.failure(homotopy, tracer)
            if stopped:
                raise _interrupted(paths)
            report(number + 1, len(tasks))
    return paths


def _spread(
    executor: Executor, tasks: list[Any], target: File | None, report: Progress, timeout: float | None, options: Options
) -> list[Path]:
    token = secrets.token_hex(4)
    sign = f"continuation-{token}.stop" if target is None else f"{target.stem}.sweep-{token}.stop"
    # A worker may run in another directory, on another machine.
    stop = (File(tempfile.gettempdir()) if target is None else target.absolute().parent) / sign
    work_of = [Task(homotopy, k, stop, target is not None, options) for k, homotopy in enumerate(tasks)]
    with ExitStack() as stack:
        run = _Run(executor, work_of, report, timeout, None if target is None else target.absolute(), token, stack)
        stopped = False
        try:
            run.begin()
        except KeyboardInterrupt:
            stopped = True
            run.stop()
        finally:
            with suppress(OSError):
                stop.unlink()
    if target is not None and run.parts:
        files = [store.file for store in run.parts.values()]
        gather(files, target)
        for file in files:
            file.unlink()
    paths = [run.paths[number] for number in sorted(run.paths)]
    if stopped:
        raise _interrupted(paths)
    return paths


@define(eq=False)
class _Run:
    """A sweep on its way: what is awaited, and the paths that came, in memory or in a file for each layout."""

    executor: Executor
    tasks: Sequence[Task]
    report: Progress
    timeout: float | None
    target: File | None
    token: str
    stack: ExitStack
    paths: dict[int, Path] = field(factory=dict)
    parts: dict[Layout, Store] = field(factory=dict)
    futures: dict[Future[Result], int] = field(factory=dict)
    done: int = 0

    def begin(self) -> None:
        """Submit all of it and wait; workers that hang past the timeout are ended with their processes.

        What was lost with a worker is done again, each in a process of its own: one that ends its process takes no
        other with it.
        """
        lost: dict[int, BaseException] = {}
        for task in self.tasks:
            try:
                self.futures[self.executor.submit(work, task)] = task.number
            except BrokenExecutor as error:
                lost[task.number] = error
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
                # Dask does again what is lost with a worker while somebody holds its future.
                number, found = self.futures.pop(future), _outcome(future)
                if isinstance(found, BrokenExecutor):
                    lost[number] = found
                else:
                    self.add(number, found)
            del ended
        lost |= {number: self._late() for number in self.futures.values()}
        for number in sorted(lost):
            self.add(number, self._alone(self.tasks[number], lost[number]))

    def add(self, number: int, found: Result) -> None:
        """What came of a homotopy; `KeyboardInterrupt` where Ctrl-C reached its worker."""
        if found is None:
            raise KeyboardInterrupt
        self.keep(number, found)
        self.done += 1
        self.report(self.done, len(self.tasks))

    def keep(self, number: int, found: Path | Share | BaseException) -> None:
        """Put a path where it stays."""
        if isinstance(found, BaseException):
            found = kept(failed(found), self.tasks[number])
        if isinstance(found, Path):
            self.paths[number] = found
        else:
            append(self.parts.get(found.layout) or self._part(found, self.tasks[number]), found)

    def _part(self, share: Share, task: Task) -> Store:
        """The file for all paths of a layout."""
        assert self.target is not None
        # A homotopy that has points was harmless to make a tracer of.
        tracer = Tracer(task.homotopy, **task.options) if share.size else None
        name = f"{self.target.stem}.sweep-{self.token}.{len(self.parts) + 1}{self.target.suffix}"
        problem = problem_data(task.homotopy) if share.size else None
        store = create(self.target.with_name(name), share.layout, root_attributes(tracer, "", {}), problem)
        self.stack.callback(store.close)
        self.parts[share.layout] = store
        return store

    def _late(self) -> TimeoutError:
        return TimeoutError(f"took longer than {self.timeout:g} s")

    def _alone(self, task: Task, error: BaseException) -> Result:
        if not (isinstance(error, BrokenExecutor) and isinstance(self.executor, ProcessPoolExecutor)):
            return error
        alone = ProcessPoolExecutor(1, mp_context=getattr(self.executor, "_mp_context", None))
        try:
            future = alone.submit(work, task)
            return _outcome(future) if wait([future], timeout=self.timeout).done else self._late()
        finally:
            _end_processes(alone)
            alone.shutdown()

    def stop(self) -> None:
        """Let the workers end their paths, and those that do not do so soon, with their processes; keep what is done.

        Threads, which cannot be ended, end by themselves.
        """
        with suppress(OSError):
            self.tasks[0].stop.touch()
        for future in self.futures:
            future.cancel()
        if wait(self.futures, timeout=_GRACE).not_done and _end_processes(self.executor):
            wait(self.futures, timeout=_GRACE)
        for future, number in self.futures.items():
            found = _outcome(future) if future.done() else None
            if isinstance(found, (Path, Share)):
                self.keep(number, found)


def _outcome(future: Future[Result]) -> Result:
    error = None if future.cancelled() else future.exception()
    if future.cancelled() or isinstance(error, KeyboardInterrupt):
        return None
    return future.result() if error is None else error


def _end_processes(executor: Executor) -> bool:
    """End the processes of a pool, whose homotopies do not come back; False where it has none of its own."""
    processes: list[BaseProcess] = []
    if isinstance(executor, ProcessPoolExecutor):
        processes = list((getattr(executor, "_processes", None) or {}).values())
    for process in processes:
        process.kill()
        process.join()
    return bool(processes)
