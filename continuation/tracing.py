"""Ways to trace: one way, both ways, in renewed unknowns; and to solve at one parameter."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import nullcontext
from os import PathLike
from typing import Any, Protocol, Unpack, runtime_checkable

import numpy as np
from attrs import evolve, field, frozen

from continuation.arguments.checks import check_flag, expect, instance_with, is_number, real_vector
from continuation.arrays import Array
from continuation.budget import Budget
from continuation.counts import Counts
from continuation.evaluation.evaluator import Evaluator
from continuation.linear.threads import one_thread
from continuation.path import LocatedEvent, Path, Step
from continuation.path.parts import shifted
from continuation.point.projection import PathSolver
from continuation.status import Status
from continuation.step.options import OBSERVER, Options, check_names, check_run, checked, documented
from continuation.step.presets import DEFAULT
from continuation.step.start import at_parameter
from continuation.step.state import State
from continuation.step.tracer import Observer, Tracer
from continuation.tolerance import Tolerance, as_tolerance


@documented
@one_thread
def trace(
    homotopy: Any,
    *,
    archive: str | PathLike[str] | Observer | None = None,
    save_every: int = 1,
    progress: bool = False,
    certified: bool = False,
    observers: Sequence[Observer] = (),
    state: State | None = None,
    **options: Unpack[Options],
) -> Path:
    """Trace the path of a homotopy from its start to its target.

    Parameters
    ----------
    homotopy : Homotopy
        Has `start`, `residual` and optional capabilities (`continuation.homotopy`).
    archive : path or PathLog, default None
        New HDF5 file.
    save_every : int, default 1
        Write every n-th step, and ends and events.
    progress : bool, default False
        Show progress, by tqdm if installed.
    certified : bool, default False
        Prove the path (`continuation.certify`), with shorter steps if needed; see `path.proof`. The residual must
        accept interval arrays.
    observers : sequence of Observer, default ()
        Watch the trace.
    state : State, default None
        Resume from here; `continuation.archive.resume` reads it from a file.
    {options}

    Returns
    -------
    Path
        With `success`, `status`, `message`, points, events and counts, also after a failure.

    Raises
    ------
    TypeError, ValueError
        For bad input.
    Interrupted
        After Ctrl-C: a KeyboardInterrupt with ``interrupt.path``.
    """
    check_run(observers, state)
    for name, flag in (("progress", progress), ("certified", certified)):
        check_flag(name, flag)
    proof = None
    if certified:
        from continuation.certificate.certifying import provable

        options, proof = provable(homotopy, options)
    watching = list(observers)
    if archive is not None:
        watching.append(_log(archive, save_every))
    elif save_every != 1:
        raise ValueError(f"save_every: expected none without an archive, found {save_every!r}")
    if progress:
        from continuation.step.progress import Progress

        watching.append(Progress())
    path = Tracer(homotopy, observers=watching, state=state, **options).run()
    if proof is not None:
        path.proof = proof
        path.message = f"{path.message} {proof}"
        if isinstance(archive, (str, PathLike)):
            from continuation.archive import add_proof

            add_proof(archive, proof)
    return path


@documented
def trace_both(
    homotopy: Any,
    *,
    archive: str | PathLike[str] | None = None,
    progress: bool = False,
    **options: Unpack[Options],
) -> Path:
    """Trace the path from its start in both directions, as one path.

    Parameters
    ----------
    homotopy : Homotopy
    archive : path, default None
        New HDF5 file with the halves as two paths.
    progress : bool, default False
    {options}

    Returns
    -------
    Path
        With the status of the half with growing parameter; a closed curve is traced once.

    Raises
    ------
    TypeError, ValueError
        As for `trace`; also if `direction` is given.
    """
    if options.get("direction"):
        raise ValueError(f"direction: expected none, since both are traced, found {options['direction']!r}")
    ahead: dict[str, Any] = {**options, "direction": 1}
    behind: dict[str, Any] = {**options, "direction": -1}
    given: Any = checked(options)["start"]
    if given is not None and np.ndim(given[1]):
        ahead, behind = {**options}, {**options, "start": (given[0], -np.asarray(given[1], dtype=float))}
    with _many(archive) as kept:
        forward = trace(homotopy, archive=kept, progress=progress, **ahead)
        if forward.status is Status.CLOSED or not len(forward):
            return forward
        backward = trace(homotopy, archive=kept, progress=progress, **behind)
    path = backward.reversed().join(forward)
    path.message = f"{forward.message} The other way: {backward.message}"
    return path


@runtime_checkable
class SupportsRenewal(Protocol):
    """Unknowns that suit a part of a path, for `follow`."""

    renewed_at: Sequence[str]
    """Own events that end a trace for renewal."""

    def renewed(self, u: Array, v: Array) -> tuple[Any, Array, Array]:
        """Return another homotopy of equal size, and point and direction in its unknowns.

        Parameters
        ----------
        u, v : ndarray, shape (N + 1,)

        Raises
        ------
        ArithmeticError
            If there is none.
        """
        ...


@frozen(eq=False)
class Followed:
    """A path in the unknowns of several homotopies.

    Attributes
    ----------
    homotopies : tuple
    paths : tuple of Path
        One for each.
    """

    homotopies: tuple[Any, ...]
    paths: tuple[Path, ...]
    path: Path = field(init=False, repr=False)
    """All steps and events as one path."""

    @path.default
    def _path(self) -> Path:
        first, *others = self.paths
        steps, events = list(first.steps), list(first.events)
        for path in others:
            more, met = shifted(steps[-1], path.steps, path.events)
            steps, events = steps + more, events + met
        last = self.paths[-1]
        return evolve(
            last,
            steps=steps,
            events=events,
            counts=sum((path.counts for path in others), first.counts),
            seconds=sum(path.seconds for path in self.paths),
        )

    def homotopy_of(self, event: Any) -> Any:
        """Return the homotopy of an event or step of `path`.

        Parameters
        ----------
        event : LocatedEvent or Step
        """
        number = event.index if isinstance(event, Step) else event.step if isinstance(event, LocatedEvent) else -1
        expect(0 <= number < len(self.path), "event", "an event or a step of this path", event)
        # The last point of a part has the part's unknowns.
        ends = np.cumsum([len(path) - 1 for path in self.paths])
        return self.homotopies[int(np.searchsorted(ends, number))]


@documented
def follow(
    homotopy: Any, *, every: int = 5, archive: str | PathLike[str] | None = None, **options: Unpack[Options]
) -> Followed:
    """Trace a path and renew the homotopy, for example its mesh, every few steps and at its `renewed_at` events.

    Closed curves, event occurrences and budgets other than steps concern one part only.

    Parameters
    ----------
    homotopy : Homotopy
        A `SupportsRenewal`.
    every : int, default 5
        Steps between renewals.
    archive : path, default None
        New HDF5 file, one path a part; `continuation.archive.resume` continues the last part.
    {options}

    Raises
    ------
    TypeError, ValueError
        For bad input, as `trace`.
    ArithmeticError
        If a renewal fails.
    """
    instance_with("homotopy", homotopy, ("renewed", "renewed_at"), "a homotopy that can be renewed")
    check_names(options)
    expect(isinstance(every, int) and not isinstance(every, bool) and every >= 1, "every", "a positive integer", every)
    given = checked(options)["budget"] or Budget()
    homotopies, left, asked = [homotopy], given.steps, dict[str, Any](options)
    paths: list[Path] = []
    with _many(archive) as log:
        while True:
            steps = min(every, left)
            path = trace(homotopies[-1], archive=log, **{**asked, "budget": evolve(given, steps=steps)})
            paths.append(path)
            left -= path.counts.accepted
            due = path.status is Status.BUDGET_EXHAUSTED and path.counts.accepted >= steps
            if path.status is Status.STOPPED_AT_EVENT:
                due = path.events[-1].name in homotopies[-1].renewed_at
            if not due or left <= 0:
                return Followed(tuple(homotopies), tuple(paths))
            last = path.steps[-1]
            renewed, *asked["start"] = homotopies[-1].renewed(last.u, last.tangent)
            homotopies.append(renewed)
            controller: Any = asked.get("controller") or (asked.get("preset") or DEFAULT).controller
            # A new trace would begin with short steps.
            asked["controller"] = evolve(controller, bounds=evolve(controller.bounds, initial=last.step_length))


def solve_at(homotopy: Any, lam: float, guess: Any = None, tolerance: float | Tolerance = 1e-8) -> Array:
    """Solve H(y, lam) = 0 for y by Newton's method.

    Parameters
    ----------
    homotopy : Homotopy
    lam : float
    guess : array_like, shape (N,), optional
        Default: the homotopy's start.
    tolerance : float or Tolerance, default 1e-8

    Returns
    -------
    ndarray, shape (N,)

    Raises
    ------
    ArithmeticError
        If Newton's method does not converge.
    ValueError
        If the guess has the wrong size.
    """
    evaluator = Evaluator(homotopy, Counts())
    start = evaluator.start()
    expect(
        is_number(lam) and math.isfinite(lam),
        "lam",
        "a finite number",
        lam,
        TypeError if not is_number(lam) else ValueError,
    )
    y = start[:-1] if guess is None else np.atleast_1d(real_vector("guess", guess))
    expect(y.ndim == 1 and np.isfinite(y).all(), "guess", "a vector of finite numbers", guess)
    u = np.append(y, lam)
    if u.size != start.size:
        raise ValueError(f"guess: expected {start.size - 1} numbers, found {u.size - 1}")
    with np.errstate(all="ignore"):
        return at_parameter(PathSolver(evaluator, as_tolerance(tolerance)), u)[:-1]


def _many(archive: str | PathLike[str] | None) -> Any:
    if archive is None:
        return nullcontext()
    from continuation.archive import PathLog
    from continuation.archive.atomic import as_file

    return PathLog(as_file("archive", archive))


def _log(archive: str | PathLike[str] | Observer, save_every: int) -> Observer:
    if isinstance(archive, (str, PathLike)):
        from continuation.archive import PathLog

        return PathLog(archive, save_every=save_every)
    if save_every != 1:
        raise ValueError("save_every: expected none with a log of your own; it is an option of PathLog")
    instance_with("archive", archive, OBSERVER.attributes, "a path or a PathLog")
    return archive
