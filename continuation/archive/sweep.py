"""`trace_many`: many paths, one after another or over any executor, kept whatever happens to some of them.

A worker, or this process itself, traces one homotopy and gives back its path, as a share of columns where there is an
archive. This process alone writes: what is lost with a worker is one path, and a kill of this process leaves those that
came, in files that are put in order at the end.
"""

from __future__ import annotations

import secrets
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, ProcessPoolExecutor, wait
from contextlib import ExitStack, suppress
from functools import partial
from os import PathLike
from pathlib import Path as File
from typing import Any, Unpack

from attrs import define, field, frozen

from continuation.archive.atomic import new_file
from continuation.archive.codec import problem_data
from continuation.archive.copies import Share, append, share_of_path
from continuation.archive.provenance import root_attributes
from continuation.archive.reader import open_archive
from continuation.archive.schema import Layout
from continuation.archive.store import Store, put
from continuation.archive.transfer import gather
from continuation.arguments.checks import complain, instance_with, is_number
from continuation.path import Path
from continuation.path.interrupted import Interrupted
from continuation.status import Status
from continuation.step.options import Options, check_names
from continuation.step.tracer import Tracer
from continuation.step.verdict import sentence

Progress = Callable[[int, int], None]
Result = Path | Share | BaseException
"""What came of a homotopy."""

_ITS_OWN = (Exception, SystemExit, GeneratorExit)
"""What a homotopy raises costs its own path; Ctrl-C alone ends the sweep."""


@frozen(eq=False)
class Task:
    """A homotopy for a worker, and its number in the sweep."""

    homotopy: Any
    number: int
    archived: bool
    options: Options


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
    many = list(homotopies)
    for homotopy in many:
        instance_with("homotopies", homotopy, ("start", "residual"), "homotopies only")
    target = None if archive is None else new_file("archive", archive)
    if target is not None and not many:
        raise ValueError("homotopies: expected at least one where there is an archive, found none to trace")
    tasks = [Task(homotopy, k, target is not None, options) for k, homotopy in enumerate(many)]
    paths = _swept(executor, tasks, target, progress or (lambda done, total: None), timeout)
    return paths if target is None else open_archive(target)


def _swept(
    executor: Executor | None, tasks: Sequence[Task], target: File | None, report: Progress, timeout: float | None
) -> list[Path]:
    futures: dict[Future[Path | Share], int] = {}
    results: Iterator[tuple[int, Result]] = (
        ((task.number, traced(task)) for task in tasks)
        if executor is None
        else _spread(executor, tasks, timeout, futures)
    )
    stopped = False
    with ExitStack() as stack:
        kept = _Kept(tasks, None if target is None else target.absolute(), stack)
        try:
            for done, (number, found) in enumerate(results, 1):
                kept.add(number, found)
                report(done, len(tasks))
        except KeyboardInterrupt:
            stopped = True
            for future in futures:
                future.cancel()
            _end_processes(executor)
            for future, number in futures.items():
                if future.done() and not future.cancelled() and future.exception() is None:
                    # Ctrl-C reaches the workers too, in a terminal.
                    with suppress(KeyboardInterrupt):
                        kept.add(number, future.result())
    if target is not None and kept.parts:
        files = [store.file for store in kept.parts.values()]
        gather(files, target)
        for file in files:
            file.unlink()
    paths = [kept.paths[number] for number in sorted(kept.paths)]
    if stopped:
        raise Interrupted(paths[-1] if paths else Path(status=Status.INTERRUPTED), paths)
    return paths


@define(eq=False)
class _Kept:
    """The paths that came, in memory or in a file for each layout."""

    tasks: Sequence[Task]
    target: File | None
    stack: ExitStack
    token: str = field(factory=partial(secrets.token_hex, 4))
    paths: dict[int, Path] = field(factory=dict)
    parts: dict[Layout, Store] = field(factory=dict)

    def add(self, number: int, found: Result) -> None:
        """Put a path where it stays; `KeyboardInterrupt` where Ctrl-C reached it or its worker."""
        task = self.tasks[number]
        if isinstance(found, KeyboardInterrupt):
            raise found
        if isinstance(found, BaseException):
            found = _sent(Path(status=Status.RAISED, message=sentence(found)), task)
        if isinstance(found, Path):
            self.paths[number], status = found, found.status
        else:
            append(self.parts.get(found.layout) or self._part(found, task), found)
            status = Status(int(found.paths["status"][0]))
        if status is Status.INTERRUPTED:
            raise KeyboardInterrupt

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


def _spread(
    executor: Executor, tasks: Sequence[Task], timeout: float | None, futures: dict[Future[Path | Share], int]
) -> Iterator[tuple[int, Result]]:
    """Submit all of it and wait; `futures` are those on their way. A pool's workers that hang are ended.

    What was lost with a worker is done again, each in a process of its own: one that ends its process takes no other
    with it.
    """
    lost: dict[int, BaseException] = {}
    for task in tasks:
        try:
            futures[executor.submit(traced, task)] = task.number
        except BrokenExecutor as error:
            lost[task.number] = error
    pool = isinstance(executor, ProcessPoolExecutor)
    while futures:
        ended = wait(futures, timeout=timeout if pool else None, return_when=FIRST_COMPLETED).done
        if not ended:
            # All that run have run for that long, since a worker that ends one begins the next.
            _end_processes(executor)
            ended = wait(futures).done
        while ended:
            # Dask does again what is lost with a worker while somebody holds its future.
            future = ended.pop()
            number, raised = futures.pop(future), future.exception()
            if isinstance(raised, BrokenExecutor):
                lost[number] = raised
            else:
                yield number, future.result() if raised is None else raised
            del future
    for number in sorted(lost):
        yield number, _alone(executor, tasks[number], timeout) if pool else lost[number]


def _alone(executor: Executor, task: Task, timeout: float | None) -> Result:
    """What comes of a homotopy in a process of its own."""
    alone = ProcessPoolExecutor(1, mp_context=getattr(executor, "_mp_context", None))
    try:
        future = alone.submit(traced, task)
        if not wait([future], timeout=timeout).done:
            return TimeoutError(f"took longer than {timeout or 0:g} s")
        return future.exception() or future.result()
    finally:
        _end_processes(alone)
        alone.shutdown()


def _end_processes(executor: Executor | None) -> None:
    """End the processes of a pool, whose homotopies do not come back; threads end by themselves."""
    if isinstance(executor, ProcessPoolExecutor):
        for process in list((executor._processes or {}).values()):
            process.kill()
            process.join()


def traced(task: Task) -> Path | Share:
    """The path of a homotopy, whatever that raises: what a worker does."""
    path, controller = Path(), tuple[float, ...]()
    try:
        tracer = Tracer(task.homotopy, **task.options)
        path = tracer.path
        try:
            tracer.run()
        finally:
            controller = () if tracer.state is None else tracer.state.controller
    except Interrupted:
        path.status = Status.INTERRUPTED
    except _ITS_OWN as error:
        if path.status in (Status.TRACING, Status.ABANDONED):
            path.status = Status.RAISED
        path.message = sentence(error)
    return _sent(path, task, controller)


def _sent(path: Path, task: Task, controller: Sequence[float] = ()) -> Path | Share:
    """A path as it is sent back: as columns where there is an archive."""
    return share_of_path(path, task.homotopy, controller, task.number) if task.archived else path
