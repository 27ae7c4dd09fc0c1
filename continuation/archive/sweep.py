"""`trace_many`: many paths, over any executor.

Only this process writes; if it is killed, part files keep finished paths.
"""

from __future__ import annotations

import secrets
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    wait,
)
from contextlib import ExitStack
from functools import partial
from os import PathLike
from pathlib import Path as File
from threading import Event
from typing import Any, Unpack

from attrs import define, field, frozen

from continuation.archive.atomic import new_file
from continuation.archive.codec import problem_data
from continuation.archive.growing import Share, grow, share_of_path
from continuation.archive.provenance import root_attributes
from continuation.archive.reader import open_archive
from continuation.archive.schema import Layout
from continuation.archive.store import Store, put
from continuation.archive.transfer import gather
from continuation.arguments.checks import expect, instance_with, is_number
from continuation.linear.threads import one_thread
from continuation.path import Path
from continuation.path.interrupted import Interrupted
from continuation.status import Status
from continuation.step.options import Options, check_names
from continuation.step.tracer import Tracer
from continuation.step.verdict import sentence

Progress = Callable[[int, int], None]
Result = Path | Share
"""A path, or its rows for an archive."""

_ITS_OWN = (Exception, SystemExit, GeneratorExit)
"""Exceptions that end one path only; Ctrl-C ends the sweep."""


@frozen(eq=False)
class Task:
    """A homotopy and its number in the sweep."""

    homotopy: Any
    number: int
    archived: bool
    options: Options
    stop: Event | None = None


def trace_many(
    homotopies: Iterable[Any],
    executor: Executor | None = None,
    archive: str | PathLike[str] | None = None,
    *,
    progress: Progress | None = None,
    timeout: float | None = None,
    **options: Unpack[Options],
) -> Sequence[Path]:
    """Trace many homotopies, in order.

    A homotopy that raises, kills its worker, exceeds the timeout or cannot be pickled gives a RAISED path with a
    message.

    Parameters
    ----------
    homotopies : iterable of Homotopy
        With an archive, those of another number of unknowns than the first become RAISED.
    executor : concurrent.futures.Executor, optional
        A process pool, dask's ``Client.get_executor()``, ...; default: this process.
    archive : path, optional
        One file for all paths; until they are finished, ``name.sweep-xxxxxxxx.1.h5`` (by number of unknowns).
    progress : callable, optional
        ``progress(done, total)``, called after each path.
    timeout : float, optional
        Seconds for each homotopy, enforced in process pools. (`Budget.seconds` acts only between steps.)
    **options
        As for `continuation.trace`, except `start`.

    Returns
    -------
    sequence of Path
        The open `Archive`, or a list.

    Raises
    ------
    TypeError, ValueError
        For unknown options, objects that are no homotopy, or an archive without homotopies.
    ArchiveError
        If a file to be written exists, or the disk is full.
    KeyboardInterrupt
        After Ctrl-C, with finished paths archived.
    """
    check_names(options, owned={"start": "where every homotopy has its own"})
    positive = timeout is None or (is_number(timeout) and timeout > 0)
    expect(positive, "timeout", "a positive number of seconds", timeout)
    expect(isinstance(homotopies, Iterable), "homotopies", "several, as in a list", homotopies, TypeError)
    if executor is not None:
        instance_with("executor", executor, ("submit",), "a concurrent.futures.Executor")
    called = progress is None or callable(progress)
    expect(called, "progress", "a function of (done, total)", progress, TypeError)
    many = list(homotopies)
    for homotopy in many:
        instance_with("homotopies", homotopy, ("start", "residual"), "homotopies only")
    target = None if archive is None else new_file("archive", archive)
    if target is not None and not many:
        raise ValueError("homotopies: expected at least one where there is an archive, found none to trace")
    stop = Event() if isinstance(executor, ThreadPoolExecutor) else None
    tasks = [Task(homotopy, k, target is not None, options, stop) for k, homotopy in enumerate(many)]
    paths = _swept(executor, tasks, target, progress or (lambda done, total: None), timeout)
    return paths if target is None else open_archive(target)


def _swept(
    executor: Executor | None, tasks: Sequence[Task], target: File | None, report: Progress, timeout: float | None
) -> list[Path]:
    futures: dict[Future[Result], int] = {}
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
            for stop in {task.stop for task in tasks if task.stop is not None}:
                stop.set()
            for future in futures:
                future.cancel()
            _end_processes(executor)
            for future, number in futures.items():
                ended = future.done() and not future.cancelled() and future.exception() is None
                # Ctrl-C reaches workers in a terminal, and stops threads: their paths have not ended.
                if ended and future.result().status is not Status.INTERRUPTED:
                    kept.add(number, future.result())
        kept.finish()
    paths = [kept.paths[number] for number in sorted(kept.paths)]
    if stopped:
        raise Interrupted(paths[-1] if paths else Path(status=Status.INTERRUPTED), paths)
    return paths


@define(eq=False)
class _Kept:
    tasks: Sequence[Task]
    target: File | None
    stack: ExitStack
    token: str = field(factory=partial(secrets.token_hex, 4))
    paths: dict[int, Path] = field(factory=dict)
    parts: dict[Layout, Store] = field(factory=dict)

    def add(self, number: int, found: Result) -> None:
        if isinstance(found, Path):
            self.paths[number] = found
        else:
            assert self.target is not None
            store = self.parts.get(found.layout) or self._part(found, self.tasks[number])
            grow(store, [found], file=self.target.name)
        if found.status is Status.INTERRUPTED:
            raise KeyboardInterrupt

    def finish(self) -> None:
        self.stack.close()
        files = [store.file for store in self.parts.values()]
        if self.target is not None and files:
            gather(files, self.target)
        for file in files:
            file.unlink()

    def _part(self, share: Share, task: Task) -> Store:
        assert self.target is not None
        # A path with points had a tracer, so making one succeeds.
        tracer = Tracer(task.homotopy, **task.options) if share.size else None
        name = f"{self.target.stem}.sweep-{self.token}.{len(self.parts) + 1}{self.target.suffix}"
        problem = problem_data(task.homotopy) if share.size else None
        store = put(self.target.with_name(name), share.layout, root_attributes(tracer, "", {}), problem, grows=True)
        self.stack.callback(store.close)
        self.parts[share.layout] = store
        return store


def _spread(
    executor: Executor, tasks: Sequence[Task], timeout: float | None, futures: dict[Future[Result], int]
) -> Iterator[tuple[int, Result]]:
    """Submit all tasks, and once more those lost with a worker."""
    lost = list[int]()
    for task in tasks:
        try:
            futures[executor.submit(traced, task)] = task.number
        except BrokenExecutor:
            lost.append(task.number)
    while futures:
        limit = timeout if isinstance(executor, ProcessPoolExecutor) else None
        ended = wait(futures, timeout=limit, return_when=FIRST_COMPLETED).done
        if not ended:
            # Idle workers start the next task, so all running ones have timed out.
            _end_processes(executor)
            ended = wait(futures).done
        while ended:
            # Dask repeats lost tasks while their future is held.
            future = ended.pop()
            number = futures.pop(future)
            try:
                found = future.result()
            except Exception:
                # `traced` catches the homotopy's exceptions: this is the executor's.
                lost.append(number)
            else:
                yield number, found
            del future
    for number in sorted(lost):
        yield number, _again(executor, tasks[number], timeout)


def _again(executor: Executor, task: Task, timeout: float | None) -> Result:
    """Trace once more, in a new process if `executor` is a process pool."""
    pool = isinstance(executor, ProcessPoolExecutor)
    own = ProcessPoolExecutor(1, mp_context=getattr(executor, "_mp_context", None)) if pool else executor
    try:
        future = own.submit(traced, task)
        if not wait([future], timeout=timeout if pool else None).done:
            raise TimeoutError(f"took longer than {timeout or 0:g} s")
        return future.result()
    except Exception as error:
        return _sent(Path(status=Status.RAISED, message=sentence(error)), task)
    finally:
        if pool:
            _end_processes(own)
            own.shutdown()


def _end_processes(executor: Executor | None) -> None:
    if isinstance(executor, ProcessPoolExecutor):
        for process in list((executor._processes or {}).values()):
            process.kill()
            process.join()


@one_thread
def traced(task: Task) -> Path | Share:
    """Trace a homotopy, whatever it raises."""
    path, tracer = Path(), None
    try:
        tracer = Tracer(task.homotopy, **task.options)
        path = tracer.path
        for _ in tracer:
            # Ctrl-C does not reach threads.
            if task.stop is not None and task.stop.is_set():
                raise KeyboardInterrupt
    except KeyboardInterrupt:
        path.status = Status.INTERRUPTED
    except _ITS_OWN as error:
        if path.status in (Status.TRACING, Status.ABANDONED):
            path.status = Status.RAISED
        path.message = sentence(error)
    return _sent(path, task, () if tracer is None or tracer.state is None else tracer.state.controller)


def _sent(path: Path, task: Task, controller: Sequence[float] = ()) -> Path | Share:
    return share_of_path(path, task.homotopy, controller, task.number) if task.archived else path
