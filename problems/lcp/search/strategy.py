"""`solve`: a solution with its certificate, or an honest account of what was found instead."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import Executor
from contextlib import nullcontext
from numbers import Integral, Real
from os import PathLike
from typing import Any, Unpack

import numpy as np
from attrs import evolve

from continuation.archive import PathLog
from continuation.arrays import Array
from continuation.budget import Budget
from continuation.presets import FAST
from continuation.step.options import PART_OPTIONS, PartOptions, check_names, checked, documented
from problems.lcp.active_set.face import Faces
from problems.lcp.active_set.finish import PATIENCE, Finish
from problems.lcp.active_set.multigrid_guess import guess, suitable
from problems.lcp.data.matrix_facts import MatrixFacts, entry_facts, matrix_facts
from problems.lcp.data.problem import LCP
from problems.lcp.data.scaling import Scaled, balanced
from problems.lcp.homotopies import Structure
from problems.lcp.homotopies.starts import positive_vector
from problems.lcp.proof.certificate import certify
from problems.lcp.proof.farkas import Farkas, farkas
from problems.lcp.proof.phase1 import NoStrictlyFeasiblePoint
from problems.lcp.search.outcome import Outcome, Solution
from problems.lcp.search.restarts import FAR, NEAR
from problems.lcp.search.search import MAKERS, Search
from problems.lcp.search.work import default_budget

HOMOTOPIES = ("auto", "kkt", "wang", "yu", "zhao", "xu")

OWNED = ("target", "direction", "start", "state", "observers")
"""What may be said of a path, but not of those that `solve` traces."""

FIRST_STEPS = 30
"""Corrections of the active set before any path."""

LEAST_STEPS = 1000
"""The same for a Z-matrix, where every correction makes the active set larger until it is right."""

LARGEST_PROOF = 300
"""The largest order at which a proof that there is no solution is looked for unasked."""

LARGEST_EARLY_PROOF = 40
"""Up to this order the linear program costs less than a path, so it comes first."""

NEARLY = 1e-5
"""An end that solves the problem to this but not to the tolerance is an inaccurate solution, not a stationary point."""


@documented
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
    **options: Unpack[PartOptions],
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
        Of the random starts; the k-th one depends on `seed` and k alone, the weights of its objective on where the
        restarts before it ended (over an executor: every 64th before it). The same call gives the same answer.
    budget : continuation.Budget, optional
        Of everything together. By default as many factorisations as take about a minute, which depends on n alone
        (`default_budget`), so that the same call gives the same answer on every machine; ``Budget(seconds=60)`` ends
        by the clock.
    tolerance : float
        What `Certificate.solves` is asked before anything is called a solution.
    archive : path, optional
        A new HDF5 file for every path traced. With it paths are traced even where the finish alone would do.
    progress : bool
        A progress bar a path (needs tqdm).
    executor : concurrent.futures.Executor, optional
        For the restarts; not together with an archive.
    {parts}

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
    _check_arguments(tolerance, restarts, seed, finish, budget, options)
    if restarts is None:
        restarts = min(10 * problem.n, 1000) if homotopy == "auto" else 0
    if archive is not None and executor is not None:
        raise ValueError("executor: expected None with an archive, which one process writes")
    start = None if x0 is None else positive_vector("x0", x0, problem.n)
    scaled = balanced(problem) if homotopy == "auto" else None
    structure = Structure(problem if scaled is None else scaled.problem)
    search = Search(
        structure,
        Finish(Faces(structure), tolerance) if finish else None,
        tolerance,
        budget if budget is not None else default_budget(problem),
        None if archive is None else PathLog(archive),
        progress,
        dict(options),
    )
    with search.log if search.log is not None else nullcontext():
        if homotopy != "auto":
            return _named(search, homotopy, start, restarts, seed, executor)
        if scaled is None:
            return _automatic(search, start, restarts, seed, executor)
        start = None if start is None else scaled.u(start)
        return _unscaled(problem, scaled, _automatic(search, start, restarts, seed, executor), tolerance)


def _check_arguments(
    tolerance: Any, restarts: Any, seed: Any, finish: Any, budget: Any, options: Mapping[str, Any]
) -> None:
    """Refuse what would otherwise show late, or, where no path is traced, never."""
    if not isinstance(tolerance, Real) or not 0.0 < float(tolerance) < 1.0:
        raise ValueError(f"tolerance: expected a number between 0 and 1, found {tolerance!r}")
    if restarts is not None and (not isinstance(restarts, Integral) or restarts < 0):
        raise ValueError(f"restarts: expected an integer, at least 0, found {restarts!r}")
    if not isinstance(seed, Integral) or seed < 0:
        raise ValueError(f"seed: expected an integer, at least 0, found {seed!r}")
    if not isinstance(finish, bool):
        raise TypeError(f"finish: expected True or False, found {finish!r}")
    if budget is not None and not isinstance(budget, Budget):
        raise TypeError(f"budget: expected a Budget, found {budget!r}")
    known = (*PART_OPTIONS, *(solve.__kwdefaults__ or ()))
    check_names(options, known, dict.fromkeys(OWNED, "solve says where its paths go"))
    checked(options)


def _unscaled(problem: LCP, scaled: Scaled, answer: Solution, tolerance: float) -> Solution:
    """The answer for the problem as given, judged anew there."""
    message = f"{answer.message} Rows and columns were scaled by powers of two; the paths are in scaled units."
    certificate = None if answer.x is None else certify(problem, scaled.x(answer.x))
    outcome = answer.outcome
    if outcome is Outcome.SOLVED and certificate is not None and not certificate.solves(tolerance):
        outcome = Outcome.NOT_FOUND
        message += f" Unscaled, the solution misses the tolerance: its residual is {certificate.residual:.1e}."
    if outcome is Outcome.UNSOLVABLE:
        proof = farkas(problem)
        if proof is None:
            outcome = Outcome.NOT_FOUND
        return evolve(answer, problem=problem, outcome=outcome, certificate=certificate, message=message, farkas=proof)
    return evolve(answer, problem=problem, outcome=outcome, certificate=certificate, message=message)


def _automatic(search: Search, x0: Array | None, restarts: int, seed: int, executor: Executor | None) -> Solution:
    """The portfolio: what is cheap and cannot mislead first."""
    problem = search.problem
    if (problem.q >= 0.0).all():
        search.accept(certify(problem, np.zeros(problem.n)))
        return _answer(search, "q >= 0, so x = 0 is a solution.")
    known = entry_facts(search.structure)
    if search.log is None and _finished_first(search, known, x0):
        return _answer(search, f"A is {known}. Solved by active sets alone, before any path.")
    known = matrix_facts(search.structure)
    said = f"A is {known}."
    if search.log is None and known.semidefinite and not known.symmetric and search.finish_nearby():
        return _answer(search, f"{said} Solved by active sets of A + shift I, before any path.")
    early = problem.n <= LARGEST_EARLY_PROOF
    for name in known.names:
        first = name == known.names[0]
        if first and early and (proof := farkas(problem)) is not None:
            return _answer(search, f"{said} A linear program gave the proof.", proof)
        if search.follow(MAKERS[name](problem, x0, structure=search.structure), preset=FAST):
            return _answer(search, f"{said} Solved by the path of the {name} homotopy.")
        if search.exhausted:
            return _failure(search, said, 0, seed)
        if first and not early and (proof := _proof(problem)) is not None:
            return _answer(search, f"{said} A linear program gave the proof.", proof)
    tried = search.restart("kkt", seed, restarts, executor, NEAR if known.nonnegative else FAR)
    if search.solved:
        return _answer(search, f"{said} Solved by a path of the kkt homotopy from random start {tried} (seed {seed}).")
    return _failure(search, said, tried, seed)


def _finished_first(search: Search, known: MatrixFacts, x0: Array | None) -> bool:
    """Active sets alone: from coarser problems or of A + shift I where A is of that kind, from x = 0, from x0."""
    problem = search.problem
    if suitable(search.structure) and search.finish_from(guess(problem) > 0.0, FIRST_STEPS):
        return True
    definite_perhaps = known.symmetric and not known.z_matrix and not known.negative_diagonal
    if definite_perhaps and search.finish_nearby(problem.q < 0.0):
        return True
    steps, patience = (min(problem.n, LEAST_STEPS), None) if known.z_matrix else (FIRST_STEPS, PATIENCE)
    if search.finish_from(problem.q < 0.0, steps, patience):
        return True
    return x0 is not None and search.finish_from(x0 > problem.w(x0), FIRST_STEPS)


def _named(
    search: Search, name: str, x0: Array | None, restarts: int, seed: int, executor: Executor | None
) -> Solution:
    """One homotopy, as asked for."""
    try:
        homotopy = MAKERS[name](search.problem, x0, structure=search.structure)
    except NoStrictlyFeasiblePoint as error:
        proof = error.certificate
        return _answer(search, str(error), proof if proof is not None and proof.no_feasible_point else None)
    if search.follow(homotopy):
        return _answer(search, f"By the path of the {name} homotopy.")
    proof = _proof(search.problem)
    if proof is not None:
        return _answer(search, "A linear program gave the proof.", proof)
    tried = search.restart(name, seed, restarts, executor)
    if search.solved:
        return _answer(search, f"By a path of the {name} homotopy from random start {tried} (seed {seed}).")
    return _failure(search, "", tried, seed)


def _proof(problem: LCP) -> Farkas | None:
    """An exact proof that there is no feasible point, where looking for it is cheap."""
    return farkas(problem) if problem.n <= LARGEST_PROOF else None


def _answer(search: Search, message: str, proof: Farkas | None = None) -> Solution:
    end = search.best()
    outcome = Outcome.NOT_FOUND
    if end is not None and end.certificate.solves(search.tolerance):
        outcome = Outcome.SOLVED
    elif proof is not None:
        outcome = Outcome.UNSOLVABLE
    elif end is not None and end.stationary and not end.certificate.solves(NEARLY):
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


def _failure(search: Search, said: str, tried: int, seed: int) -> Solution:
    """Nothing solved: what the paths came to, and how many there were."""
    first = f"The first path: {search.paths[0].message}" if search.paths else ""
    restarts = f"Restarts from random starts: {tried} (seed {seed})." if tried else "No restarts were tried."
    spent = f"The budget is used up: {search.exhausted}." if search.exhausted else ""
    return _answer(search, " ".join(part for part in (said, first, restarts, spent) if part))
