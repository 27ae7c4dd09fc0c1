"""`trace_many`: many paths, one after another or over any executor, kept whatever happens to some of them.

A worker, or this process itself, traces one homotopy and gives back its path, as a share of columns where there is an
archive. This process alone writes: what is lost with a worker is one path, and a kill of this process leaves those that
came, in files that are put in order at the end.
"""

from __future__ import annotations

import secrets
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, ProcessPoolExecutor, wait
from contextlib import ExitStack, suppress
from functools import partial
from multiprocessing.process import BaseProcess
from os import PathLike
from pathlib import Path as File
from typing import Any, Unpack

from attrs import define, field, frozen

from continuation.archive.atomic import new_file
from continuation.archive.codec import problem_data
from continuation.archive.copies import Share, append
from continuation.archive.growing import share_of_path
from continuation.archive.provenance import root_attributes
from continuation.archive.reader import open_archive
from continuation.archive.schema import Layout
from continuation.archive.store import Store, put
from continuation.archive.transfer import gather
from continuation.arguments.checks import complain, instance_with, is_number
from continuation.path import LocatedEvent, Path, Step
from continuation.path.interrupted import Interrupted
from continuation.status import Status
from continuation.step.options import Options, check_names
from continuation.step.tracer import Tracer
from continuation.step.verdict import sentence

Progress = Callable[[int, int], None]
Result = Path | Share | BaseException | None
"""What came of a homotopy; None where Ctrl-C ended it."""

_LOOK = 0.2
"""Seconds between two looks at the stop sign."""

_GRACE = 0.5
"""Seconds that workers get to end their paths after Ctrl-C: they look for it each 0.2 s; the rest is for the answer."""

_ITS_OWN = (Exception, SystemExit, GeneratorExit)
"""What a homotopy raises costs its own path; Ctrl-C alone ends the sweep."""


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
    worker costs its own path only: that one is RAISED, with the exception's text as its message. The order is that of
    the homotopies. Ctrl-C keeps the paths that are finished, and ends within about a second.

    Parameters
    ----------
    homotopies : iterable of Homotopy
        To be picklable where the executor needs it. Where there is an archive those of another number of unknowns than
        the first have the status RAISED.
    executor : concurrent.futures.Executor, optional
        A process pool, dask's ``Client.get_executor()``, ...; without one, the calling process does it all.
    archive : path, optional
        One file with all paths. They are kept in ``name.sweep-xxxxxxxx.1.h5`` as they come (each number of unknowns
        has a file), and are put in order at the end. If this process is killed they stay there, and the sweep can be
        run again.
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
    TypeError, ValueError
        For an option that `continuation.Tracer` does not have, for what is no homotopy, or for none and an archive.
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
    target = None if archive is None else new_file("archive", archive)
    if target is not None and not tasks:
        raise ValueError("homotopies: expected at least one where there is an archive, found none to trace")
    paths = _swept(executor, tasks, target, progress or (lambda done, total: None), timeout, options)
    return paths if target is None else open_archive(target)


def _swept(
    executor: Executor | None, tasks: list[Any], target: File | None, report: Progress, timeout: Any, options: Options
) -> list[Path]:
    token = secrets.token_hex(4)
    # A worker may run in another directory, on another machine.
    folder = File(tempfile.gettempdir()) if target is None else target.absolute().parent
    stop = folder / f"{'continuation' if target is None else target.stem}.sweep-{token}.stop"
    work_of = [Task(homotopy, k, stop, target is not None, options) for k, homotopy in enumerate(tasks)]
    with ExitStack() as stack:
        run = _Run(executor, work_of, timeout, None if target is None else target.absolute(), token, stack)
        stopped = False
        try:
            for done, (number, found) in enumerate(run.results(), 1):
                run.keep(number, found)
                report(done, len(tasks))
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
        raise Interrupted(paths[-1] if paths else Path(status=Status.INTERRUPTED), paths)
    return paths


@define(eq=False)
class _Run:
    """A sweep on its way: what is awaited, and the paths that came, in memory or in a file for each layout."""

    executor: Executor | None
    tasks: Sequence[Task]
    timeout: float | None
    target: File | None
    token: str
    stack: ExitStack
    paths: dict[int, Path] = field(factory=dict)
    parts: dict[Layout, Store] = field(factory=dict)
    futures: dict[Future[Result], int] = field(factory=dict)

    def results(self) -> Iterator[tuple[int, Result]]:
        """What came of each homotopy, when it comes."""
        if self.executor is not None:
            yield from self._spread(self.executor)
            return
        for task in self.tasks:
            found, stopped = traced(task)
            if stopped:
                self.keep(task.number, found)
            yield task.number, None if stopped else found

    def _spread(self, executor: Executor) -> Iterator[tuple[int, Result]]:
        """Submit all of it and wait; workers that hang past the timeout are ended with their processes.

        What was lost with a worker is done again, each in a process of its own: one that ends its process takes no
        other with it.
        """
        lost: dict[int, BaseException] = {}
        for task in self.tasks:
            try:
                self.futures[executor.submit(work, task)] = task.number
            except BrokenExecutor as error:
                lost[task.number] = error
        waiting = set(self.futures)
        while waiting:
            ended, waiting = wait(waiting, timeout=self.timeout, return_when=FIRST_COMPLETED)
            if not ended:
                # All that run have run for that long, since a worker that ends one begins the next.
                if not _end_processes(executor):
                    waiting = {future for future in waiting if not future.cancel() and not future.running()}
                    continue
                ended, waiting = wait(waiting)
            for future in ended:
                # Dask does again what is lost with a worker while somebody holds its future.
                number, found = self.futures.pop(future), _outcome(future)
                if isinstance(found, BrokenExecutor):
                    lost[number] = found
                else:
                    yield number, found
            del ended
        late = TimeoutError(f"took longer than {self.timeout or 0:g} s")
        lost |= dict.fromkeys(self.futures.values(), late)
        for number in sorted(lost):
            alone = isinstance(lost[number], BrokenExecutor) and isinstance(executor, ProcessPoolExecutor)
            found = self._alone(executor, self.tasks[number], late) if alone else lost[number]
            yield number, found

    def _alone(self, executor: Executor, task: Task, late: TimeoutError) -> Result:
        """What comes of a homotopy in a process of its own."""
        alone = ProcessPoolExecutor(1, mp_context=getattr(executor, "_mp_context", None))
        try:
            future = alone.submit(work, task)
            return _outcome(future) if wait([future], timeout=self.timeout).done else late
        finally:
            _end_processes(alone)
            alone.shutdown()

    def keep(self, number: int, found: Result) -> None:
        """Put a path where it stays; `KeyboardInterrupt` where Ctrl-C reached it or its worker."""
        task = self.tasks[number]
        if found is None:
            raise KeyboardInterrupt
        if isinstance(found, BaseException):
            found = sent(Path(status=Status.RAISED, message=sentence(found)), task)
        if isinstance(found, Path):
            self.paths[number] = found
        else:
            append(self.parts.get(found.layout) or self._part(found, task), found)

    def _part(self, share: Share, task: Task) -> Store:
        """The file for all paths of a layout."""
        assert self.target is not None
        # A homotopy that has points was harmless to make a tracer of.
        tracer = Tracer(task.homotopy, **task.options) if share.size else None
        name = f"{self.target.stem}.sweep-{self.token}.{len(self.parts) + 1}{self.target.suffix}"
        problem = problem_data(task.homotopy) if share.size else None
        make = partial(Store, layout=share.layout, attributes=root_attributes(tracer, "", {}), problem=problem)
        store = put(self.target.with_name(name), make, grows=True)
        self.stack.callback(store.close)
        self.parts[share.layout] = store
        return store

    def stop(self) -> None:
        """Let the workers end their paths, and those that do not do so soon, with their processes; keep what is done.

        Threads, which cannot be ended, end by themselves.
        """
        if self.executor is None:
            return
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
    pool = isinstance(executor, ProcessPoolExecutor)
    processes: list[BaseProcess] = list((getattr(executor, "_processes", None) or {}).values()) if pool else []
    for process in processes:
        process.kill()
        process.join()
    return bool(processes)


# -- what a worker does ----------------------------------------------------------------------------------------


@frozen(eq=False)
class Task:
    """A homotopy for a worker, and its number in the sweep. A file `stop` ends the worker by its existence."""

    homotopy: Any
    number: int
    stop: File
    archived: bool
    options: Options


@define(eq=False)
class _Watch:
    """Ends a path as Ctrl-C does once the stop sign, a file, is there."""

    stop: File
    next_look: float = 0.0

    def step(self, tracer: Tracer, step: Step) -> None:
        """See `continuation.Observer`."""
        if time.monotonic() >= self.next_look:
            self.next_look = time.monotonic() + _LOOK
            if self.stop.exists():
                raise KeyboardInterrupt

    def event(self, tracer: Tracer, event: LocatedEvent) -> None:
        """Steps are enough."""

    def end(self, tracer: Tracer) -> None:
        """So it has ended."""


def work(task: Task) -> Result:
    """Trace a homotopy; None where Ctrl-C ended it."""
    found, stopped = (None, True) if task.stop.exists() else traced(task)
    return None if stopped else found


def traced(task: Task) -> tuple[Path | Share, bool]:
    """The path of a homotopy, whatever that raises, and whether Ctrl-C ended it."""
    path, controller, stopped = Path(), tuple[float, ...](), False
    try:
        tracer = Tracer(task.homotopy, observers=(_Watch(task.stop),), **task.options)
        path = tracer.path
        try:
            tracer.run()
        finally:
            controller = () if tracer.state is None else tracer.state.controller
    except Interrupted:
        stopped = True
    except _ITS_OWN as error:
        if path.status in (Status.TRACING, Status.ABANDONED):
            path.status = Status.RAISED
        path.message = sentence(error)
    return sent(path, task, controller), stopped


def sent(path: Path, task: Task, controller: Sequence[float] = ()) -> Path | Share:
    """A path as it is sent back."""
    return share_of_path(path, task.homotopy, controller, task.number) if task.archived else path
