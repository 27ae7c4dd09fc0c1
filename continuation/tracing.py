"""`trace`: the loop that most people call."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from typing import Any, Unpack

from continuation.checks import instance_with
from continuation.path import Path
from continuation.step.options import OBSERVER, Options, documented, each
from continuation.step.state import State
from continuation.step.tracer import Observer, Tracer


@documented
def trace(
    homotopy: Any,
    *,
    archive: str | PathLike[str] | Observer | None = None,
    progress: bool = False,
    observers: Sequence[Observer] = (),
    state: State | None = None,
    **options: Unpack[Options],
) -> Path:
    """Trace the path of a homotopy from its start to its target.

    Parameters
    ----------
    homotopy : Homotopy
        An object with `start` and `residual`, and whatever other capability it has (`continuation.homotopy`).
    archive : path or PathLog, default None
        An HDF5 file to write the path to; must not exist.
    progress : bool, default False
        Show a progress bar (needs tqdm).
    observers : sequence of Observer, default ()
        Watch the trace: a plot, a log.
    state : State, default None
        Resume from here; `continuation.archive.resume` takes it from a file.
    {options}

    Returns
    -------
    Path
        With `success`, a `status`, a `message`, the points, the events and the counts. A path that fails is returned
        too.

    Raises
    ------
    TypeError, ValueError
        For bad input: a homotopy without the methods needed, a start that is not finite, an unknown option.
    Interrupted
        After Ctrl-C: a KeyboardInterrupt with the path so far, ``interrupt.path``; the archive has it too.
    """
    each("observers", observers, OBSERVER)
    watching = list(observers)
    if archive is not None:
        watching.append(_log(archive))
    if progress:
        from continuation.progress import Progress

        watching.append(Progress())
    return Tracer(homotopy, observers=watching, state=state, **options).run()


def _log(archive: str | PathLike[str] | Observer) -> Observer:
    if isinstance(archive, (str, PathLike)):
        from continuation.archive import PathLog

        return PathLog(archive)
    instance_with("archive", archive, OBSERVER.attributes, "a path or a PathLog")
    return archive
