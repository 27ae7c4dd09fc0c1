"""What may be said of a problem: which points solve it, which are stationary, and what proves that none solves it."""

from __future__ import annotations

import math
import time
from fractions import Fraction

import numpy as np
from attrs import evolve

from continuation.arrays import Array
from continuation.counts import Counts
from problems.lcp.data.problem import LCP
from problems.lcp.data.scaling import Scaled
from problems.lcp.homotopies.starts import natural_units
from problems.lcp.proof.certificate import Certificate, certify, certify_exactly
from problems.lcp.proof.farkas import Farkas, FloatFarkas
from problems.lcp.reference.enumeration import Exhaustion, exhaust
from problems.lcp.search.outcome import Outcome, Solution

LARGEST_DECIDED = 12
"""Up to this order all faces are tried in exact arithmetic, within about a second, before the first restart; and what
solves a problem to the tolerance but not to round-off is called a solution only if exact arithmetic agrees."""

ENTRIES = 2 * float(np.finfo(float).eps)
"""A relative residual below this is within rounding: half an eps for x, and half for each factor that gave the entries
their units, of a row and of a column; the last half is for their products."""

STATIONARY = 1e-6
"""Relative to their terms: how well the optimality conditions hold at what is called stationary."""

NEARLY = 1e-5
"""An end that solves the problem to this but not to the tolerance is an inaccurate solution, not a stationary point."""


def confirmed(problem: LCP, certificate: Certificate, tolerance: float) -> bool:
    """Whether the point may be called a solution.

    One that passes `Certificate.solves`; but of a small problem, where that is cheap, exact arithmetic has to agree
    unless its rows are off by no more than the rounding of the entries.

    Parameters
    ----------
    problem : LCP
    certificate : Certificate
        Of the point.
    tolerance : float
        Of its relative residual.
    """
    if not certificate.solves(tolerance):
        return False
    if certificate.relative_residual <= ENTRIES or problem.n > LARGEST_DECIDED:
        return True
    return certify_exactly(problem, certificate.x).solves


def stationary(problem: LCP, y: Array) -> bool:
    """Whether y = (x, z1, z2) satisfies the optimality conditions of min x'(A x + q) over x >= 0, A x + q >= 0.

    That is (A + A') x + q = z1 + A' z2, x, w, z1, z2 >= 0, x_i z1_i = 0 and w_i z2_i = 0: relative to the sizes of x,
    w, z1 and z2, so that a common factor of A and q, and one of q alone, makes no difference.
    """
    if y.size != 3 * problem.n:
        return False
    x, z1, z2 = np.split(y, 3)
    w = problem.w(x)
    unit_x, unit_w = natural_units(problem)
    size_x = unit_x + max(float(np.abs(x).max()), float(np.abs(z2).max()))
    size_w = unit_w + max(float(np.abs(w).max()), float(np.abs(z1).max()), unit_w / unit_x * size_x)
    gradient = w + problem.A.T @ x - z1 - problem.A.T @ z2
    lowest = min(float(min(x.min(), z2.min())) / size_x, float(min(w.min(), z1.min())) / size_w)
    products = max(float(np.abs(x * z1).max()), float(np.abs(w * z2).max())) / (size_x * size_w)
    return max(float(np.abs(gradient).max()) / size_w, products, -lowest) <= STATIONARY


def judged(
    solved: bool, proof: Farkas | FloatFarkas | None, exhaustion: Exhaustion | None, at_stationary: bool
) -> Outcome:
    """The outcome, what is certain first.

    Where all faces were tried and one holds a solution, but its rounding to floats is not `confirmed`, none is found.

    Parameters
    ----------
    solved : bool
        Whether a point was `confirmed`.
    proof : Farkas, FloatFarkas or None
    exhaustion : Exhaustion or None
    at_stationary : bool
        Whether the best point is stationary, and no solution even to `NEARLY`.
    """
    if solved:
        return Outcome.SOLVED
    if isinstance(proof, Farkas) or (exhaustion is not None and not exhaustion.solvable):
        return Outcome.UNSOLVABLE
    if proof is not None:
        return Outcome.INFEASIBLE_TO_PRECISION
    if exhaustion is not None:
        return Outcome.NOT_FOUND
    return Outcome.STATIONARY if at_stationary else Outcome.NOT_FOUND


def rounded(x: tuple[Fraction, ...]) -> Array:
    """The exact point in floats: infinite or zero where it is beyond their range."""
    return np.array([_float(value) for value in x])


def _float(value: Fraction) -> float:
    try:
        return float(value)
    except OverflowError:
        return math.inf


def in_units(found: Solution, scaled: Scaled, tolerance: float) -> Solution:
    """The answer in the units of the problem as given: what was judged does not depend on units.

    Parameters
    ----------
    found : Solution
        Of the problem as given, but for its point and its proofs, which are in those of `scaled`.
    scaled : Scaled
    tolerance : float
        Of the relative residual.
    """
    exact, nearly = found.farkas, found.float_farkas
    if exact is not None:
        moved = exact.in_units(found.problem, scaled.rows)
        if not scaled.exact and not moved.holds(found.problem):
            message = f"{Outcome.NOT_FOUND} A Farkas vector fails for the digits that scaling lost. {found.message}"
            return evolve(found, outcome=Outcome.NOT_FOUND, certificate=None, message=message, farkas=None)
        found = evolve(found, farkas=moved)
    if nearly is not None:
        found = evolve(found, float_farkas=nearly.in_units(scaled.rows))
    return found if found.x is None else _at(found, scaled.x(found.x), tolerance)


def _at(found: Solution, x: Array, tolerance: float) -> Solution:
    """The answer at a point of the problem as given, infinite or zero where that is beyond the range of floats."""
    bad = ~np.isfinite(x)
    certificate = None if bad.any() else certify(found.problem, x)
    if found.outcome is not Outcome.SOLVED or (
        certificate is not None and confirmed(found.problem, certificate, tolerance)
    ):
        return evolve(found, certificate=certificate)
    if not bad.any() and (x > 0.0).any() and float(x[x > 0.0].min()) > np.finfo(float).tiny:
        off = math.nan if certificate is None else certificate.relative_residual
        message = f"{Outcome.NOT_FOUND} In the units given the point misses the tolerance, by {off:.1e}."
        return evolve(found, outcome=Outcome.NOT_FOUND, certificate=certificate, message=f"{message} {found.message}")
    i = int(np.argmax(bad)) if bad.any() else int(np.argmin(np.where(x > 0.0, x, np.inf)))
    message = f"{Outcome.NOT_FOUND} There is a solution, but no float holds it: x[{i}] is {_size(x[i])}."
    return evolve(found, outcome=Outcome.NOT_FOUND, certificate=certificate, message=f"{message} {found.message}")


def _size(value: float) -> str:
    return "beyond 1e308" if not np.isfinite(value) else f"too small, near {value:.0e}"


def beyond_floats(problem: LCP, tolerance: float) -> Solution:
    """The answer to a small problem whose entries are too far apart for floats: by exact arithmetic alone."""
    began = time.perf_counter()
    decided = exhaust(problem)
    assert decided is not None
    outcome = Outcome.SOLVED if decided.solvable else Outcome.UNSOLVABLE
    message = "Its entries are too far apart for floats; all complementary faces were tried in exact arithmetic."
    found = Solution(
        problem, outcome, f"{outcome} {message}", None, (), -1, Counts(), time.perf_counter() - began, None, decided
    )
    return found if decided.x is None else _at(found, rounded(decided.x), tolerance)
