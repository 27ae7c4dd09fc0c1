"""`trace`, `trace_both` and `solve_at`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import nullcontext
from os import PathLike
from typing import Any, Unpack

import numpy as np

from continuation.arguments.checks import check_flag, complain, instance_with, is_number, real_vector
from continuation.arrays import Array
from continuation.counts import Counts
from continuation.evaluation.evaluator import Evaluator
from continuation.linear.threads import one_thread
from continuation.path import Path
from continuation.point.projection import PathSolver
from continuation.status import Status
from continuation.step.options import OBSERVER, Options, check_run, checked, documented
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
        New HDF5 file for the path.
    save_every : int, default 1
        Write every n-th step, and ends and events.
    progress : bool, default False
        Show progress, by tqdm if installed.
    certified : bool, default False
        Prove the path (`continuation.certify`), with shorter steps if needed; see `path.proof`. The residual must
        accept interval arrays.
    observers : sequence of Observer, default ()
        They watch the trace.
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
        from continuation.certificate.shortened import provable

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
    log = nullcontext() if archive is None else _many(archive)
    with log as kept:
        forward = trace(homotopy, archive=kept, progress=progress, **ahead)
        if forward.status is Status.CLOSED or not len(forward):
            return forward
        backward = trace(homotopy, archive=kept, progress=progress, **behind)
    path = backward.reversed().join(forward)
    path.message = f"{forward.message} The other way: {backward.message}"
    return path


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
    if not is_number(lam) or not math.isfinite(lam):
        raise complain(TypeError if not is_number(lam) else ValueError, "lam", "a finite number", lam)
    y = start[:-1] if guess is None else np.atleast_1d(real_vector("guess", guess))
    if y.ndim != 1 or not np.isfinite(y).all():
        raise complain(ValueError, "guess", "a vector of finite numbers", guess)
    u = np.append(y, lam)
    if u.size != start.size:
        raise ValueError(f"guess: expected {start.size - 1} numbers, found {u.size - 1}")
    with np.errstate(all="ignore"):
        return at_parameter(PathSolver(evaluator, as_tolerance(tolerance)), u)[:-1]


def _many(archive: str | PathLike[str]) -> Any:
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
