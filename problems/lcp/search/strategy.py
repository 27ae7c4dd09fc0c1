"""`solve`: a solution with its certificate, or an honest account of what was found instead."""

from __future__ import annotations

import inspect
import math
from concurrent.futures import Executor
from contextlib import nullcontext
from numbers import Integral, Real
from os import PathLike
from typing import Any

import numpy as np
from attrs import evolve

from continuation.archive import PathLog
from continuation.arrays import Array
from continuation.budget import Budget
from continuation.presets import FAST
from continuation.step.tracer import Tracer
from problems.lcp.active_set.face import Faces
from problems.lcp.active_set.finish import PATIENCE, Finish
from problems.lcp.active_set.multigrid_guess import guess, suitable
from problems.lcp.data.matrix_facts import MatrixFacts, entry_facts, matrix_facts
from problems.lcp.data.problem import LCP
from problems.lcp.data.scaling import Scaled, balanced, extreme
from problems.lcp.homotopies import Structure
from problems.lcp.homotopies.starts import positive_vector
from problems.lcp.proof.certificate import certify
from problems.lcp.proof.farkas import Farkas, FloatFarkas, infeasibility
from problems.lcp.proof.phase1 import NoStrictlyFeasiblePoint
from problems.lcp.proof.verdict import LARGEST_DECIDED, NEARLY, beyond_floats, confirmed, in_units, judged, rounded
from problems.lcp.reference.enumeration import Exhaustion, exhaust
from problems.lcp.search.outcome import Solution
from problems.lcp.search.restarts import FAR, NEAR
from problems.lcp.search.search import MAKERS, Search

HOMOTOPIES = ("auto", "kkt", "wang", "yu", "zhao", "xu")

FIRST_STEPS = 30
"""Corrections of the active set before any path."""

LEAST_STEPS = 1000
"""The same for a Z-matrix, where every correction makes the active set larger until it is right."""

LARGEST_EARLY_PROOF = 40
"""Up to this order the linear program costs less than a path, so it comes first."""

PROOF_SHARE = 0.2
"""Of the time left, the most that the linear program of a proof takes. It is mostly far quicker than a path."""


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
        Of the random starts; the k-th one depends on `seed` and k alone, the weights of its objective on where the
        restarts before it ended (over an executor: every 64th before it). The same call gives the same answer.
    budget : continuation.Budget, optional
        Of everything together; 60 seconds by default.
    tolerance : float
        What `Certificate.solves` is asked before anything is called a solution.
    archive : path, optional
        A new HDF5 file for every path traced. With it paths are traced even where the finish alone would do.
    progress : bool
        A progress bar a path (needs tqdm).
    executor : concurrent.futures.Executor, optional
        For the restarts; not together with an archive.
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
    _check_options(tolerance, restarts, options)
    if restarts is None:
        restarts = min(10 * problem.n, 1000) if homotopy == "auto" else 0
    if archive is not None and executor is not None:
        raise ValueError("executor: expected None with an archive, which one process writes")
    start = None if x0 is None else positive_vector("x0", x0, problem.n)
    # A homotopy by name is traced in the units given, while floats can hold what it is made of.
    scaled = balanced(problem) if homotopy == "auto" or extreme(problem) else None
    if scaled is not None and not scaled.exact and problem.n <= LARGEST_DECIDED:
        return beyond_floats(problem, tolerance)
    structure = Structure(problem if scaled is None else scaled.problem)
    search = Search(
        structure,
        Finish(Faces(structure), tolerance) if finish else None,
        tolerance,
        budget if budget is not None else Budget(steps=math.inf, seconds=60.0),
        None if archive is None else PathLog(archive),
        progress,
        options,
    )
    # What overflows comes out as an infinity or a NaN, which is never taken for an answer: every end is certified.
    with np.errstate(all="ignore"), search.log if search.log is not None else nullcontext():
        start = start if start is None or scaled is None else scaled.u(start)
        if homotopy == "auto":
            answer = _automatic(search, start, restarts, seed, executor)
        else:
            answer = _named(search, homotopy, start, restarts, seed, executor)
        return answer if scaled is None else _unscaled(problem, scaled, answer, tolerance)


def _check_options(tolerance: Any, restarts: Any, options: dict[str, Any]) -> None:
    """Refuse what would otherwise show late, or, where no path is traced, never."""
    if not isinstance(tolerance, Real) or not 0.0 < float(tolerance) < 1.0:
        raise ValueError(f"tolerance: expected a number between 0 and 1, found {tolerance!r}")
    if restarts is not None and (not isinstance(restarts, Integral) or restarts < 0):
        raise ValueError(f"restarts: expected an integer, at least 0, found {restarts!r}")
    known = set(inspect.signature(Tracer).parameters) - {"homotopy", "observers", "state", "start"}
    unknown = set(options) - known
    if unknown:
        raise TypeError(f"options: expected some of {', '.join(sorted(known))}, found {', '.join(sorted(unknown))}")


def _unscaled(problem: LCP, scaled: Scaled, answer: Solution, tolerance: float) -> Solution:
    """The answer for the problem as given: the scaling is exact, and what was judged does not depend on units."""
    message = f"{answer.message} Rows and columns were scaled by powers of two; the paths are in scaled units."
    return in_units(evolve(answer, problem=problem, message=message), scaled, tolerance)


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
        if first and early and (proof := _proof(search)) is not None:
            return _answer(search, f"{said} A linear program gave the proof.", proof)
        if search.follow(MAKERS[name](problem, x0, structure=search.structure), preset=FAST):
            return _answer(search, f"{said} Solved by the path of the {name} homotopy.")
        if search.exhausted:
            return _failure(search, said, 0, seed)
        if first and not early and (proof := _proof(search)) is not None:
            return _answer(search, f"{said} A linear program gave the proof.", proof)
    if problem.n <= LARGEST_DECIDED and (decided := exhaust(problem, max(search.budget.seconds - search.seconds, 0.0))):
        if decided.x is not None:
            search.accept(certify(problem, rounded(decided.x)))
        return _answer(search, f"{said} All complementary faces were tried in exact arithmetic.", exhaustion=decided)
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
    proved = _proof(search)
    if proved is not None:
        return _answer(search, "A linear program gave the proof.", proved)
    tried = search.restart(name, seed, restarts, executor)
    if search.solved:
        return _answer(search, f"By a path of the {name} homotopy from random start {tried} (seed {seed}).")
    return _failure(search, "", tried, seed)


def _proof(search: Search) -> Farkas | FloatFarkas | None:
    """A proof that there is no feasible point, exact or to working precision."""
    return infeasibility(search.problem, PROOF_SHARE * max(search.budget.seconds - search.seconds, 0.0))


def _answer(
    search: Search, message: str, proof: Farkas | FloatFarkas | None = None, exhaustion: Exhaustion | None = None
) -> Solution:
    end = search.best()
    solved = end is not None and confirmed(search.problem, end.certificate, search.tolerance)
    at_stationary = end is not None and end.stationary and not end.certificate.solves(NEARLY)
    outcome = judged(solved, proof, exhaustion, at_stationary)
    answer = Solution(
        search.problem,
        outcome,
        message,
        None if end is None else end.certificate,
        tuple(search.paths),
        -1 if end is None else end.path,
        search.counts,
        search.seconds,
        proof if isinstance(proof, Farkas) else None,
        exhaustion,
        proof if isinstance(proof, FloatFarkas) else None,
    )
    return evolve(answer, message=" ".join(part for part in (str(outcome), answer.proof, message) if part))


def _failure(search: Search, said: str, tried: int, seed: int) -> Solution:
    """Nothing solved: what the paths came to, and how many there were."""
    first = f"The first path: {search.paths[0].message}" if search.paths else ""
    restarts = f"Restarts from random starts: {tried} (seed {seed})." if tried else "No restarts were tried."
    spent = f"The budget is used up: {search.exhausted}." if search.exhausted else ""
    return _answer(search, " ".join(part for part in (said, first, restarts, spent) if part))
