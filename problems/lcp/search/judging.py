"""From what a search found to what may be claimed: the one place where an outcome is decided."""

from __future__ import annotations

from attrs import evolve

from problems.lcp.data.problem import LCP
from problems.lcp.data.scaling import Scaled
from problems.lcp.proof.certificate import certify
from problems.lcp.search.outcome import Outcome, Solution
from problems.lcp.search.search import Search

NEARLY = 1e-5
"""An end that solves the problem to this but not to the tolerance is an inaccurate solution, not a stationary point."""


def answer(search: Search, message: str) -> Solution:
    """What the search came to.

    Parameters
    ----------
    search : Search
    message : str
        What was done; the outcome's own sentence is put before it.
    """
    end = search.best()
    outcome = Outcome.NOT_FOUND
    if end is not None and end.certificate.solves(search.tolerance):
        outcome = Outcome.SOLVED
    elif search.proof is not None:
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
        search.proof,
    )


def unscaled(problem: LCP, scaled: Scaled, found: Solution, tolerance: float) -> Solution:
    """The answer for the problem as given, judged anew there; a proof is of that problem from the beginning.

    Parameters
    ----------
    problem : LCP
        As given.
    scaled : Scaled
        What was solved in its place.
    found : Solution
        Of the scaled problem.
    tolerance : float
        What `Certificate.solves` is asked.
    """
    message = f"{found.message} Rows and columns were scaled by powers of two; the paths are in scaled units."
    certificate = None if found.x is None else certify(problem, scaled.x(found.x))
    outcome = found.outcome
    if outcome is Outcome.SOLVED and certificate is not None and not certificate.solves(tolerance):
        outcome = Outcome.NOT_FOUND
        message += f" Unscaled, the solution misses the tolerance: its residual is {certificate.residual:.1e}."
    return evolve(found, problem=problem, outcome=outcome, certificate=certificate, message=message)
