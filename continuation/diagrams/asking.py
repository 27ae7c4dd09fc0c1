"""`diagram`: checks arguments and searches."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from contextlib import closing, nullcontext
from numbers import Integral
from os import PathLike
from typing import Any, Unpack

import numpy as np

from continuation.archive.atomic import as_file, check_new
from continuation.archive.growing import Growing
from continuation.arguments.checks import expect, instance_with, is_number
from continuation.counts import Counts
from continuation.diagrams.branches import Diagram
from continuation.diagrams.search import BranchSearch
from continuation.evaluation.evaluator import Evaluator
from continuation.events.box import is_boundless
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
    """Trace all connected branches: from the start both ways, then from every point where others leave.

    A branch is a smooth curve, straight through crossings. Rays at branch points and kinks are followed breadth first,
    each once. The result does not depend on the number of processes.

    Parameters
    ----------
    homotopy : Homotopy
        Picklable if the executor needs it.
    starts : sequence of (y, lam), default ()
        Starts besides the homotopy's own.
    branches : int, default 100
        Largest number of branches.
    generations : int, optional
        Largest number of branch points between a branch and the start.
    deflate : sequence of float, default ()
        Parameter values at which deflation (`Deflated`) seeks disconnected solutions.
    step : float, default 1e-2
        Distance from branch points at which branches start, in the metric, as for `switch_branch`.
    stability : Stability, optional
        Stored with each point; its Hopf points are located.
    executor : concurrent.futures.Executor, optional
        Traces the paths of a generation.
    archive : path, optional
        A new file; branches are written as they finish.
    resume : bool, default False
        Continue the archive, if it exists, with the same arguments.
    keep : str, default "all"
        "ends": points between ends of a branch stay in the archive.
    {options}

    Returns
    -------
    Diagram
        Also if a limit is reached; see `complete` and `message`.

    Raises
    ------
    TypeError, ValueError
        For bad input, no box, or a start outside of it.
    Interrupted
        After Ctrl-C: a KeyboardInterrupt with finished branches, ``interrupt.diagram``, and the unfinished path,
        ``interrupt.path``.
    """
    check_names(options, owned={"start": "there is starts=", "direction": "both are traced"})
    Evaluator(homotopy, Counts())
    for name, count in (("branches", branches), ("generations", 1 if generations is None else generations)):
        whole = isinstance(count, Integral) and is_number(count) and count >= (name == "branches")
        expect(whole, name, "a positive integer", count)
    expect(is_number(step) and 0.0 < step < np.inf, "step", "a positive finite number", step)
    expect(isinstance(stability, Stability | None), "stability", "a Stability or None", stability, TypeError)
    if executor is not None:
        instance_with("executor", executor, ("submit",), "a concurrent.futures.Executor")
    expect(
        isinstance(deflate, Sequence) and all(is_number(lam) and np.isfinite(lam) for lam in deflate),
        "deflate",
        "values of the parameter",
        deflate,
        TypeError,
    )
    expect(all(is_guess(start) for start in starts), "starts", "pairs (y, lam)", starts, TypeError)
    expect(
        isinstance(resume, bool) and (archive is not None or not resume),
        "resume",
        "True with an archive, or False",
        resume,
    )
    expect(keep == "all" or (keep == "ends" and archive is not None), "keep", '"all", or "ends" with an archive', keep)
    file = None if archive is None else as_file("archive", archive)
    if file is not None and not resume:
        check_new(file)
    box = options.get("box", getattr(homotopy, "box", None))
    expect(
        box is not None and not isinstance(box, str) and not is_boundless(box),
        "box",
        'one, as {"lam": (0, 5)}, since branches have no other end',
        box,
    )
    asked: Options = {**options, "box": box, "target": options.get("target")}
    if stability is not None:
        asked["events"] = (*options.get("events", ()), *stability.events)
    log = None if file is None else Growing(file, "A diagram", keep)
    search = BranchSearch(homotopy, asked, executor, float(step), branches, generations, log)
    with nullcontext() if log is None else closing(log):
        try:
            search.run([None, *starts], [float(lam) for lam in deflate])
        except KeyboardInterrupt as interrupt:
            search.missing.append("it was interrupted")
            path = interrupt.path if isinstance(interrupt, Interrupted) else Path(status=Status.INTERRUPTED)
            raise Interrupted(path, [*search.found.paths, path], search.found) from interrupt
    return search.found
