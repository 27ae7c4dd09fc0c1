"""`trace`: the loop that most people call."""

from __future__ import annotations

from os import PathLike
from typing import Any

from continuation.path import Path
from continuation.step.tracer import Observer, Tracer


def trace(
    homotopy: Any,
    *,
    archive: str | PathLike[str] | Observer | None = None,
    progress: bool = False,
    observers: tuple[Observer, ...] = (),
    **options: Any,
) -> Path:
    """Trace the path of a homotopy from its start to its target.

    Parameters
    ----------
    homotopy : Homotopy
        An object with `start` and `residual`, and whatever other capability it has (`continuation.homotopy`).
    archive : path or PathLog, optional
        An HDF5 file to write the path to; must not exist.
    progress : bool
        Show a progress bar (needs tqdm).
    observers : tuple of Observer
    **options
        As for `continuation.Tracer`: predictor, corrector, controller, preset, metric, events, tolerance, budget,
        target, direction, start, finish, check_jacobian, examine.

    Returns
    -------
    Path
        With `status`, a `message`, the points, the events and the counts. A path that fails is returned too.

    Raises
    ------
    TypeError, ValueError
        For bad input: a homotopy without the methods needed, a start that is not finite, an unknown option.
    """
    watching = list(observers)
    if archive is not None:
        watching.append(_log(archive))
    if progress:
        from continuation.progress import Progress

        watching.append(Progress())
    tracer = Tracer(homotopy, observers=tuple(watching), **options)
    for _ in tracer:
        pass
    return tracer.path


def _log(archive: str | PathLike[str] | Observer) -> Observer:
    if isinstance(archive, (str, PathLike)):
        from continuation.archive import PathLog

        return PathLog(archive)
    return archive
