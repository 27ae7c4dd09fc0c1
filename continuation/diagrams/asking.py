"""`diagram`: what is asked for, checked, and the search under its archive."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from contextlib import nullcontext
from numbers import Integral
from os import PathLike
from typing import Any, Unpack

import numpy as np

from continuation.archive.atomic import as_file, check_new
from continuation.archive.growing import Growing
from continuation.arguments.checks import complain, instance_with, is_number
from continuation.counts import Counts
from continuation.diagrams.branches import Diagram
from continuation.diagrams.search import BranchSearch
from continuation.evaluation.evaluator import Evaluator
from continuation.events.box import is_boundless
from continuation.homotopy import SupportsPieces
from continuation.path import Path
from continuation.path.interrupted import Interrupted
from continuation.stability import Stability
from continuation.status import Status
from continuation.step.options import Options, check_names, documented
from continuation.step.start import is_guess


@documented
def diagram(
    homotopy: Any,
    *,
    starts: Sequence[Any] = (),
    branches: int = 100,
    generations: int | None = None,
    deflate: Sequence[float] = (),
    step: float = 1e-2,
    stability: Stability | None = None,
    executor: Executor | None = None,
    archive: str | PathLike[str] | None = None,
    resume: bool = False,
    keep: str = "all",
    **options: Unpack[Options],
) -> Diagram:
    """Trace all branches that hang together: from the start both ways, then from every point at which others leave.

    A branch is a smooth curve; it goes straight on where others cross. At simple and multiple branch points, and at
    kinks, those that leave are followed, breadth first; which rays of a point have been followed is kept, so that a
    branch that comes back to a known point is not traced again. With several processes the result is the same: of two
    that meet from both ends, the later one is dropped.

    Parameters
    ----------
    homotopy : Homotopy
        To be picklable where the executor needs it.
    starts : sequence of (y, lam), default ()
        More points to begin at, besides the homotopy's own start.
    branches : int, default 100
        At most so many.
    generations : int, optional
        At most so many branch points between a branch and the start; 0 for the start's own branch.
    deflate : sequence of float, default ()
        Values of the parameter at which more solutions are sought, when nothing is left that hangs together: by
        Newton's method with the known ones divided out (`Deflated`).
    step : float, default 1e-2
        How far beside a branch point branches begin, in the metric, as for `switch_branch`.
    stability : Stability, optional
        Stored with each point, and drawn; its Hopf points are found.
    executor : concurrent.futures.Executor, optional
        Traces the paths of one generation; without one this process does.
    archive : path, optional
        A new file that all branches are written to, each when it is finished.
    resume : bool, default False
        Go on with the archive, if there is one: its branches are not traced again. The same call as before is meant.
    keep : str, default "all"
        With an archive "ends": points between the ends of a branch are read from the file when they are asked for, so
        that a diagram of thousands of branches needs little memory.
    {options}

    Returns
    -------
    Diagram
        What was found, also where a limit was reached: `complete` and `message` say so.

    Raises
    ------
    TypeError, ValueError
        For bad input; if there is no box, and so no end; if the start is not inside of it.
    Interrupted
        After Ctrl-C: a KeyboardInterrupt with the branches that were finished, ``interrupt.diagram``, and the path that
        was under way, ``interrupt.path``.
    """
    check_names(options, owned={"start": "there is starts=", "direction": "both are traced"})
    Evaluator(homotopy, Counts())
    for name, count in (("branches", branches), ("generations", 1 if generations is None else generations)):
        if not isinstance(count, Integral) or isinstance(count, bool) or count < (name == "branches"):
            raise complain(ValueError, name, "a positive integer", count)
    if not is_number(step) or isinstance(step, bool) or not 0.0 < step < np.inf:
        raise complain(ValueError, "step", "a positive finite number", step)
    if stability is not None and not isinstance(stability, Stability):
        raise complain(TypeError, "stability", "a Stability or None", stability)
    if executor is not None:
        instance_with("executor", executor, ("submit",), "a concurrent.futures.Executor")
    if not isinstance(deflate, Sequence) or not all(is_number(lam) and np.isfinite(lam) for lam in deflate):
        raise complain(TypeError, "deflate", "values of the parameter", deflate)
    if not all(is_guess(start) for start in starts):
        raise complain(TypeError, "starts", "pairs (y, lam)", starts)
    if not isinstance(resume, bool) or (resume and archive is None):
        raise complain(ValueError, "resume", "True with an archive, or False", resume)
    if keep not in ("all", "ends") or (keep == "ends" and archive is None):
        raise complain(ValueError, "keep", '"all", or "ends" with an archive', keep)
    file = None if archive is None else as_file("archive", archive)
    if file is not None and not resume:
        check_new(file)
    box = options.get("box", getattr(homotopy, "box", None))
    if box is None or isinstance(box, str) or is_boundless(box):
        raise complain(ValueError, "box", 'one, as {"lam": (0, 5)}, since branches have no other end', box)
    asked: Options = {**options, "box": box, "target": options.get("target")}
    if stability is not None:
        asked["events"] = (*options.get("events", ()), *stability.events)
    log = None if file is None else Growing(file, "A diagram", isinstance(homotopy, SupportsPieces), keep)
    search = BranchSearch(homotopy, asked, executor, float(step), branches, generations, log)
    with nullcontext() if log is None else log:
        try:
            search.run([None, *starts], [float(lam) for lam in deflate])
        except KeyboardInterrupt as interrupt:
            search.missing.append("it was interrupted")
            path = interrupt.path if isinstance(interrupt, Interrupted) else Path(status=Status.INTERRUPTED)
            raise Interrupted(path, [*search.found.paths, path], search.found) from interrupt
    return search.found
