"""The one place that decides outcomes."""

from __future__ import annotations

import math
import time

import numpy as np
from attrs import evolve

from continuation.arrays import Array
from continuation.counts import Counts
from problems.lcp.data.fixed import WithoutFixed
from problems.lcp.data.problem import MixedLCP
from problems.lcp.data.program import Program
from problems.lcp.data.scaling import Scaled, balanced, without_far_factor
from problems.lcp.data.spread import extreme
from problems.lcp.proof.certificate import Certificate, certify
from problems.lcp.proof.farkas import Farkas, FloatFarkas, infeasibility
from problems.lcp.proof.verdict import LARGEST_DECIDED, NEARLY, confirmed, to_precision
from problems.lcp.reference.enumeration import Exhaustion, decidable, exhaust
from problems.lcp.search.exclusion import TRIED, decide
from problems.lcp.search.outcome import Outcome, Solution
from problems.lcp.search.search import Candidate, Search


def answer(search: Search, message: str) -> Solution:
    """The answer; `message` says what was done."""
    end, proof = search.best(), search.proof
    outcome = _outcome(search, end)
    found = Solution(
        search.problem, outcome, "",
        certificate=None if end is None else end.certificate,
        paths=tuple(search.paths),
        best=-1 if end is None else end.path,
        counts=search.counts,
        seconds=search.seconds,
        farkas=proof if isinstance(proof, Farkas) else None,
        exhaustion=search.exhaustion,
        float_farkas=proof if isinstance(proof, FloatFarkas) else None,
    )  # fmt: skip
    return evolve(found, message=" ".join(part for part in (str(outcome), found.proof, message) if part))


def _outcome(search: Search, end: Candidate | None) -> Outcome:
    """The most certain outcome; NOT_FOUND if exact arithmetic finds a solution, but `end` is not `confirmed`."""
    proof, exhaustion = search.proof, search.exhaustion
    if end is not None and search.confirmed(end.certificate):
        undecided = search.problem.n <= LARGEST_DECIDED and (exhaustion is None or not exhaustion.solvable)
        exact = not undecided or end.certificate.exact
        return Outcome.SOLVED if exact else Outcome.SOLVED_TO_PRECISION
    if isinstance(proof, Farkas) or (exhaustion is not None and not exhaustion.solvable):
        return Outcome.UNSOLVABLE
    if proof is not None:
        return Outcome.INFEASIBLE_TO_PRECISION
    if exhaustion is None and end is not None and to_precision(search.problem, end.certificate):
        return Outcome.SOLVED_TO_PRECISION
    if exhaustion is None and end is not None and end.stationary and not end.certificate.solves(NEARLY):
        return Outcome.STATIONARY
    return Outcome.NOT_FOUND


def exactly(search: Search, found: Solution) -> Solution:
    """Another face of a small problem may hold an exact solution: try all."""
    if not decidable(search.problem, LARGEST_DECIDED) or not (search.scaled is None or search.scaled.exact):
        return found
    search.ends = []
    return answer(search, TRIED) if decide(search) else found


def units_of_its_own(problem: MixedLCP, roughly: bool) -> Scaled | None:
    """Scaling for the search, or None.

    `roughly`: keep the units, but for a common factor, if largest entries are similar.
    """
    if roughly and problem.standard:
        scaled, alike = without_far_factor(problem)
        # Balancing may round: then exact arithmetic decides.
        plain = problem if scaled is None else scaled.problem
        if alike and (problem.n > LARGEST_DECIDED or not extreme(plain)):
            return scaled
    return balanced(problem)


def unscaled(problem: MixedLCP, scaled: Scaled, tolerance: float, found: Solution) -> Solution:
    """The answer in the given units."""
    said = "" if scaled.common else "In scaled units."
    if found.paths:
        said = "Rows and columns were scaled by powers of two; the paths are in scaled units."
    exact, nearly, tried = found.farkas if found.exhaustion is None else None, found.float_farkas, found.exhaustion
    if exact is not None:
        exact = exact.in_units(problem, scaled.rows)
    if tried is not None and tried.groups is not None:
        tried = evolve(tried, groups=tried.groups.in_units(scaled.rows))
    if nearly is not None:
        nearly = nearly.in_units(scaled.rows)
    x = None if found.x is None else scaled.x(found.x)
    return _moved(found, problem, x, tolerance, said, exact, nearly, tried)


def with_fixed(small: WithoutFixed, tolerance: float, rest: Solution) -> Solution:
    """The answer with fixed unknowns put back."""
    problem = small.whole
    fixed = [f"x[{i}]" for i in np.flatnonzero(problem.fixed)]
    more = f" and {len(fixed) - 5} more" if len(fixed) > 5 else ""
    said = f"Fixed, and eliminated: {', '.join(fixed[:5])}{more}."
    proof = infeasibility(problem) if rest.farkas is not None or rest.float_farkas is not None else None
    found = _moved(
        rest, problem, None if rest.x is None else small.x(rest.x), tolerance, said,
        proof if isinstance(proof, Farkas) else None,
        proof if isinstance(proof, FloatFarkas) else None,
        None if rest.exhaustion is None else exhaust(problem),
    )  # fmt: skip
    # Elimination rounded q.
    if found.outcome is Outcome.SOLVED and found.certificate is not None and problem.n <= LARGEST_DECIDED:
        found = found if found.certificate.exact else evolve(found, outcome=Outcome.SOLVED_TO_PRECISION)
    return found


def _moved(
    found: Solution, problem: MixedLCP, x: Array | None, tolerance: float, said: str,
    farkas: Farkas | None, float_farkas: FloatFarkas | None, exhaustion: Exhaustion | None,
) -> Solution:  # fmt: skip
    """The answer to another form of the problem, with its proofs; its outcome is judged again."""
    end = found.certificate
    rounded = found.solved and end is not None and not confirmed(found.problem, end, tolerance)
    proved = (farkas is not None and farkas.gap < 0) or (exhaustion is not None and not exhaustion.solvable)
    found = evolve(
        found, problem=problem, message=f"{found.message} {said}".rstrip(),
        farkas=farkas, float_farkas=float_farkas, exhaustion=exhaustion,
    )  # fmt: skip
    if found.outcome is Outcome.UNSOLVABLE and not proved:
        return _not_found(found, "Its proof fails for the digits that were rounded.", None)
    return found if x is None else _at(found, x, tolerance, rounded)


def stored_as(problem: MixedLCP, found: Solution) -> Solution:
    """The answer to a problem whose dense twin was solved."""
    end = found.certificate
    return evolve(found, problem=problem, certificate=None if end is None else evolve(end, problem=problem))


def of_program(program: Program, found: Solution) -> Solution:
    """The answer to a program."""
    parts = [found.message]
    if found.success and not program.convex:
        parts.append("P is not positive semidefinite: this is a KKT point, and need not be a minimum.")
    if found.farkas is not None:
        parts.append(program.reading(np.array([value != 0 for value in found.farkas.y])))
    elif found.float_farkas is not None:
        parts.append(program.reading(found.float_farkas.y))
    return evolve(found, program=program, message=" ".join(part for part in parts if part))


def beyond_floats(problem: MixedLCP, tolerance: float) -> Solution:
    """The answer by exact arithmetic alone."""
    began = time.perf_counter()
    decided = exhaust(problem)
    outcome = Outcome.SOLVED if decided.solvable else Outcome.UNSOLVABLE
    message = "Its entries are too far apart for floats; all complementary faces were tried in exact arithmetic."
    found = Solution(
        problem, outcome, f"{outcome} {message}", None, (), -1, Counts(), time.perf_counter() - began, None, decided
    )
    return found if decided.point is None else _at(found, decided.point, tolerance)


def _at(found: Solution, x: Array, tolerance: float, rounded: bool = False) -> Solution:
    bad = ~np.isfinite(x)
    certificate = None if bad.any() else certify(found.problem, x)
    right = certificate is not None and (rounded or confirmed(found.problem, certificate, tolerance))
    if not found.solved or right:
        return evolve(found, certificate=certificate)
    small = x[x > 0.0].min(initial=math.inf)
    if certificate is not None and small > np.finfo(float).tiny:
        off = certificate.relative_residual
        why = "q drowns in the rounding of x" if off <= tolerance else f"the point misses the tolerance, by {off:.1e}"
        return _not_found(found, f"In the units given {why}.", certificate)
    i = int(np.argmax(bad if bad.any() else x == small))
    why = f"There is a solution, but no float holds it: x[{i}] is {_size(x[i])}."
    return _not_found(found, why, certificate)


def _not_found(found: Solution, why: str, certificate: Certificate | None) -> Solution:
    message = f"{Outcome.NOT_FOUND} {why} Before x was rounded: {found.message}"
    return evolve(found, outcome=Outcome.NOT_FOUND, certificate=certificate, message=message, farkas=None)


def _size(value: float) -> str:
    return "beyond 1e308" if not np.isfinite(value) else f"too small, near {value:.0e}"
