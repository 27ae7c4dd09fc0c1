"""`solve`: `table` orders the methods, `judge` decides the outcome."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import nullcontext
from functools import partial
from numbers import Integral
from os import PathLike
from typing import Any, Unpack

import numpy as np
from attrs import evolve

from continuation.archive import PathLog
from continuation.archive.atomic import as_file
from continuation.arguments.checks import check_flag
from continuation.arrays import Array
from continuation.budget import Budget
from continuation.counts import Counts
from continuation.linear.factoring import check_method
from continuation.linear.silence import Silence
from continuation.linear.threads import one_thread
from continuation.step.options import PART_OPTIONS, PartOptions, check_names, checked, documented
from problems.lcp.active_set.face import Faces, exchanging
from problems.lcp.active_set.finish import Finish
from problems.lcp.data.fixed import without_fixed
from problems.lcp.data.problem import LCP, MixedLCP, require_problem
from problems.lcp.data.program import Program
from problems.lcp.data.spread import extreme
from problems.lcp.homotopies import Structure
from problems.lcp.homotopies.registry import HOMOTOPIES
from problems.lcp.homotopies.starts import inside_vector, positive_vector
from problems.lcp.proof.certificate import certify
from problems.lcp.proof.verdict import LARGEST_DECIDED
from problems.lcp.reference.enumeration import decidable
from problems.lcp.search.at_once import LARGEST, at_once
from problems.lcp.search.judge import (
    answer,
    beyond_floats,
    exactly,
    of_program,
    stored_as,
    units_of_its_own,
    unscaled,
    with_fixed,
)
from problems.lcp.search.outcome import Outcome, Solution
from problems.lcp.search.search import Asked, Nearby, Search
from problems.lcp.search.table import AUTOMATIC, NAMED, PATHS, settled_by
from problems.lcp.search.work import default_budget
from problems.options import check_budget, check_seed, check_tolerance, finite_vector

OWNED = ("target", "direction", "start", "state", "observers")
"""Path options that `solve` sets itself."""


MOST_RESTARTS = 1000
"""Ends a search without a budget."""


@documented
def solve(
    problem: MixedLCP | Program,
    homotopy: str = "auto",
    *,
    x0: Any = None,
    guess: Solution | Nearby | None = None,
    finish: bool = True,
    path: bool = False,
    restarts: int | None = None,
    seed: int = 0,
    budget: Budget | None = None,
    tolerance: float = 1e-10,
    archive: str | PathLike[str] | None = None,
    progress: bool = False,
    sparse: str = "auto",
    **options: Unpack[PartOptions],
) -> Solution:
    """Solve an LCP(q, A), a problem with bounds, or a quadratic program.

    Parameters
    ----------
    problem : LCP, MixedLCP or Program
    homotopy : str
        "auto" tries active sets, pivots, exclusion of faces and reflections, then paths. Or "kkt", "wang", "yu", "xu",
        "zhao", "kmm"; with bounds "kkt", "wang", "yu" or "kmm".
    x0 : array_like, shape (n,), optional
        A positive start, for "kkt" perhaps infeasible; at a feasible one z1 = z2 = e, the paper's start. "auto" tries
        the set x0 > A x0 + q alone, and accepts zeros.
    guess : Solution, optional
        Solution of a nearby problem: its active set is tried, then without bounds pivots from its data.
    finish : bool
        Whether active sets are tried, before and along paths.
    path : bool
        Trace a path even if "auto" needs none; locate its turning and branch points.
    restarts : int, optional
        Paths from random starts after the first. Default: 0 for a named homotopy, 1000 for "auto".
    seed : int
        For random starts and reflections; a call repeats its answer on one machine.
    budget : continuation.Budget, optional
        Default: the factorisations of about a minute, from n alone (`default_budget`); reflections add at most half a
        minute. ``Budget(seconds=60)`` counts CPU seconds.
    tolerance : float
        For `Certificate.solves`, which every solution passes.
    archive : path, optional
        A new HDF5 file for all traced paths; implies `path`.
    progress : bool
        One progress bar per path (needs tqdm).
    sparse : str
        Factorisation of sparse active sets: "superlu", "cholmod" (cvxopt), "pardiso" (pypardiso), or "auto". The
        message names it.
    {parts}

    Raises
    ------
    TypeError, ValueError
        For bad input, naming the argument.
    ImportError
        If the package for `sparse` is missing.

    References
    ----------
    Dutta, Das and Jana (see `KKTHomotopy`).
    """
    back: list[Callable[[Solution], Solution]] = []
    if isinstance(problem, Program):
        back.append(partial(of_program, problem))
        problem = problem.problem
    require_problem(problem)
    automatic = homotopy == "auto"
    _check_homotopy(homotopy, problem)
    check_method("sparse", sparse)
    _check_arguments(tolerance, restarts, seed, budget, options, finish=finish, path=path, progress=progress)
    path = path or archive is not None
    start = None if x0 is None else _start(x0, problem, automatic)
    near = _near(guess, problem)
    if not problem.standard and problem.fixed.any():
        small = without_fixed(problem)
        back.append(partial(with_fixed, small, tolerance))
        start = None if start is None else start[small.kept]
        near = None if near is None else Nearby(near.x[small.kept], near.w[small.kept])
        problem = small.problem
    if problem.standard and not isinstance(problem, LCP):
        problem = LCP(problem.A, problem.q, primal=problem.primal)
    if problem.sparse and problem.n <= LARGEST and sparse == "auto":
        back.append(partial(stored_as, problem))
        problem = evolve(problem, A=problem.A.toarray())
    if restarts is None:
        restarts = MOST_RESTARTS if automatic else 0
    scaled = None
    if problem.n and (automatic or extreme(problem)):
        scaled = units_of_its_own(problem, automatic and finish and not path)
    found = _nothing(problem, archive) if problem.n == 0 else None
    if scaled is not None and not scaled.exact and decidable(problem, LARGEST_DECIDED):
        found = beyond_floats(problem, tolerance)
    elif scaled is not None:
        start = None if start is None else scaled.u(start)
        near = None if near is None else Nearby(scaled.u(near.x), np.ldexp(near.w, scaled.rows))
        back.append(partial(unscaled, problem, scaled, tolerance))
        problem = scaled.problem
    title = f"Paths of a linear complementarity problem, n = {problem.n}"
    log = None if archive is None else PathLog(as_file("archive", archive), title=title)
    with Silence(), one_thread, nullcontext() if log is None else log:
        if found is None and automatic and finish and not path and start is None and near is None:
            found = at_once(problem, tolerance)
        if found is None:
            structure = Structure(problem)
            tried = Finish(Faces(structure, factoring=exchanging(sparse)), tolerance) if finish else None
            asked = Asked(homotopy, start, near, restarts, seed, path, log, progress, dict(options))
            budget = default_budget(problem) if budget is None else budget
            search = Search(structure, tried, tolerance, budget, asked, scaled)
            settled = settled_by(search, NAMED if not automatic else PATHS if path else AUTOMATIC)
            found = answer(search, _account(search, settled))
            if automatic and found.outcome is Outcome.SOLVED_TO_PRECISION:
                found = exactly(search, found)
        for step in reversed(back):
            found = step(found)
    return found


def _check_homotopy(homotopy: Any, problem: MixedLCP) -> None:
    if not isinstance(homotopy, str) or (homotopy != "auto" and homotopy not in HOMOTOPIES):
        given = repr(homotopy) if isinstance(homotopy, str) else type(homotopy).__name__
        raise ValueError(f"homotopy: expected auto or one of {', '.join(HOMOTOPIES)}, found {given}")
    if homotopy != "auto" and not problem.standard and not HOMOTOPIES[homotopy].bounds:
        known = ", ".join(name for name, one in HOMOTOPIES.items() if one.bounds)
        raise ValueError(f"homotopy: expected auto or one of {known} for a problem with bounds, found {homotopy!r}")


def _unfixed(problem: MixedLCP) -> MixedLCP:
    if not problem.fixed.any():
        return problem
    none = np.where(problem.fixed, np.inf, 0.0)
    return MixedLCP(problem.A, problem.q, problem.lower - none, problem.upper + none)


def _check_arguments(
    tolerance: Any, restarts: Any, seed: Any, budget: Any, options: Mapping[str, Any], **flags: Any
) -> None:
    check_tolerance(tolerance)
    if restarts is not None and (not isinstance(restarts, Integral) or restarts < 0):
        raise ValueError(f"restarts: expected an integer, at least 0, found {restarts!r}")
    check_seed(seed)
    for name, flag in flags.items():
        check_flag(name, flag)
    check_budget(budget)
    if options:
        known = (*PART_OPTIONS, *(solve.__kwdefaults__ or ()))
        check_names(options, known, dict.fromkeys(OWNED, "solve says where its paths go"))
        checked(options)


def _start(x0: Any, problem: MixedLCP, automatic: bool) -> Array:
    """A start: positive for a path; "auto" accepts zeros, which paths replace."""
    if not problem.standard:
        return inside_vector("x0", x0, _unfixed(problem))
    if not automatic:
        return positive_vector("x0", x0, problem.n)
    start = finite_vector("x0", x0, problem.n)
    if (start < 0.0).any():
        i = int(np.argmax(start < 0.0))
        raise ValueError(f"x0: expected nonnegative numbers, found {start[i]} at index {i}")
    return start


def _near(guess: Any, problem: MixedLCP) -> Nearby | None:
    if guess is None:
        return None
    if not isinstance(guess, (Solution, Nearby)):
        raise TypeError(f"guess: expected a Solution, found {type(guess).__name__}")
    if guess.x is None or guess.w is None:
        return None
    if guess.x.size != problem.n:
        raise ValueError(f"guess: expected a solution of {problem.n} unknowns, found one of {guess.x.size}")
    return Nearby(guess.x, guess.w)


def _nothing(problem: MixedLCP, archive: Any) -> Solution:
    if archive is not None:
        raise ValueError("archive: expected None for a problem without unknowns, of which there is no path")
    message = f"{Outcome.SOLVED} There are no unknowns."
    return Solution(problem, Outcome.SOLVED, message, certify(problem, np.zeros(0)), (), -1, Counts(), 0.0)


def _account(search: Search, settled: str) -> str:
    factored = "" if search.finish is None else str(search.finish.faces.factoring)
    if settled:
        return f"{settled} {factored}".rstrip()
    parts = []
    if search.paths:
        parts.append(f"The first path: {search.paths[0].message}")
    tried = f"Restarts from random starts: {search.tried} (seed {search.asked.seed})."
    parts.append(tried if search.tried else "No restarts were tried.")
    if search.exhausted:
        parts.append(f"The budget is used up: {search.exhausted}.")
    if (best := search.best()) is not None:
        parts.append(f"The relative residual of the best point is {best.certificate.relative_residual:.1e}.")
    return " ".join([*parts, factored]).rstrip()
