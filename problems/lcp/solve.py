"""`solve`: a solution with its certificate, or an honest account of what was found instead."""

from __future__ import annotations

import math
from concurrent.futures import Executor
from contextlib import nullcontext
from os import PathLike
from typing import Any

from continuation.archive import PathLog
from continuation.budget import Budget
from problems.lcp.faces import Faces
from problems.lcp.feasible import NoStrictlyFeasiblePoint
from problems.lcp.finish import Finish
from problems.lcp.homotopies import Structure
from problems.lcp.homotopies.starts import positive_vector
from problems.lcp.infeasible import Farkas, farkas
from problems.lcp.outcome import Outcome, Solution
from problems.lcp.portfolio import MAKERS, Search, another
from problems.lcp.problem import LCP

HOMOTOPIES = ("auto", "kkt", "wang", "yu", "zhao", "xu")

FIRST_STEPS = 30
"""Corrections of the active set before any path."""

LARGEST_PROOF = 300
"""The largest order at which a proof that there is no solution is looked for unasked."""

NEARLY = 1e-5
"""An end that solves the problem to this, and not to the tolerance, is an inaccurate solution, not a stationary point."""


def solve(
    problem: LCP,
    homotopy: str = "auto",
    *,
    x0: Any = None,
    finish: bool = True,
    restarts: int | None = None,
    seed: int = 0,
    budget: Budget | None = None,
    tolerance: float = 1e-10,
    archive: str | PathLike[str] | None = None,
    progress: bool = False,
    executor: Executor | None = None,
    **options: Any,
) -> Solution:
    """Solve LCP(q, A).

    Parameters
    ----------
    problem : LCP
    homotopy : str
        "auto": what is cheap and cannot mislead first, then Wang's path, then the KKT path, then restarts. Or one of
        "kkt", "wang", "yu", "zhao", "xu".
    x0 : array_like, shape (n,), optional
        A positive start; for "kkt" need not be feasible, and if it is, z1 = z2 = e, which is the paper's start.
    finish : bool
        Whether active sets are tried, before the path and along it. Without it `path` is the pure homotopy.
    restarts : int, optional
        Paths from random starts after the first has failed. Default: 0 for a named homotopy, min(10 n, 1000) for
        "auto".
    seed : int
        Of the random starts; the k-th one depends on `seed` and k alone.
    budget : continuation.Budget, optional
        Of everything together; 60 seconds by default.
    tolerance : float
        What `Certificate.solves` is asked before anything is called a solution.
    archive : path, optional
        A new HDF5 file for every path traced. With it the path is traced even where the finish alone would do.
    progress : bool
        A progress bar a path (needs tqdm).
    executor : concurrent.futures.Executor, optional
        For the restarts.
    **options
        As for `continuation.trace`: preset, predictor, corrector, controller, ...

    Returns
    -------
    Solution

    Raises
    ------
    TypeError, ValueError
        For bad input, naming the argument.

    References
    ----------
    Dutta, Das and Jana, "Bounded Homotopy Path Approach to Find the Solution of Linear Complementarity Problems".
    """
    if not isinstance(problem, LCP):
        raise TypeError(f"problem: expected an LCP, found {type(problem).__name__}")
    if homotopy not in HOMOTOPIES:
        raise ValueError(f"homotopy: expected one of {', '.join(HOMOTOPIES)}, found {homotopy!r}")
    structure = Structure(problem)
    attempt = Finish(Faces(structure), tolerance) if finish else None
    if restarts is None:
        restarts = min(10 * problem.n, 1000) if homotopy == "auto" else 0
    budget = budget if budget is not None else Budget(steps=math.inf, seconds=60.0)
    log = None if archive is None else PathLog(archive)
    with log if log is not None else nullcontext():
        search = Search(structure, attempt, tolerance, budget, log, progress, options)
        return _search(search, homotopy, x0, restarts, seed)


def _search(search: Search, homotopy: str, x0: Any, restarts: int, seed: int) -> Solution:
    problem = search.problem
    start = None if x0 is None else positive_vector("x0", x0, problem.n)
    names = ("wang", "kkt") if homotopy == "auto" else (homotopy,)
    if search.log is None:
        if search.finish_from(problem.q < 0.0, FIRST_STEPS):
            return _answer(search, "Solved before any path: by the active-set method from x = 0.")
        if start is not None and search.finish_from(start > problem.w(start), FIRST_STEPS):
            return _answer(search, "Solved before any path: by the active-set method from x0.")
    for name in names:
        try:
            path = MAKERS[name](problem, start, structure=search.structure)
        except NoStrictlyFeasiblePoint as error:
            return _infeasible(search, error)
        if search.follow(path):
            return _answer(search, f"Solved by the path of the {name} homotopy.")
        if search.exhausted:
            return _failure(search, f"The budget is used up: {search.exhausted}.")
    if problem.n <= LARGEST_PROOF and homotopy == "auto":
        proof = farkas(problem)
        if proof is not None:
            return _answer(search, str(Outcome.UNSOLVABLE), proof)
    tried = 0
    while tried < restarts and not search.exhausted:
        name = "kkt" if homotopy == "auto" else homotopy
        solved = search.follow(another(name, search, tried, seed))
        tried += 1
        if solved:
            return _answer(search, f"Solved by a path of the {name} homotopy from random start {tried} (seed {seed}).")
    return _failure(search, f"Restarts from random starts: {tried} (seed {seed}).")


def _answer(search: Search, message: str, proof: Farkas | None = None) -> Solution:
    end = search.best()
    outcome = Outcome.NOT_FOUND
    if end is not None and end.certificate.solves(search.tolerance):
        outcome = Outcome.SOLVED
    elif proof is not None:
        outcome = Outcome.UNSOLVABLE
    elif end is not None and end.arrived and not end.certificate.solves(NEARLY):
        outcome = Outcome.STATIONARY
    return Solution(
        search.problem,
        outcome,
        f"{outcome} {message}",
        None if end is None else end.certificate,
        tuple(search.paths),
        -1 if end is None else end.path,
        search.counts,
        search.seconds,
        proof,
    )


def _failure(search: Search, message: str) -> Solution:
    last = f"The last path: {search.paths[-1].message}" if search.paths else ""
    return _answer(search, f"{message} {last}".strip())


def _infeasible(search: Search, error: NoStrictlyFeasiblePoint) -> Solution:
    proof = error.certificate
    return _answer(search, str(error), proof if proof is not None and proof.no_feasible_point else None)
