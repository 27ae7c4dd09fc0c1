"""The quickest answers: where the first active set, where q < 0, is right, and where no face of a few is."""

from __future__ import annotations

import time

import numpy as np
from attrs import evolve

from continuation.counts import Counts
from problems.lcp.active_set.finish import Finish
from problems.lcp.data.problem import MixedLCP, active_state
from problems.lcp.proof.pieces import all_faces, doubtful
from problems.lcp.proof.verdict import LARGEST_DECIDED, exact_nearby
from problems.lcp.reference.enumeration import Exhaustion
from problems.lcp.search.outcome import LARGEST_SOUGHT, Outcome, Solution

LARGEST_IN_ONE = 100
"""Up to this order making what a search consists of takes as long as this answer, and the face is made once."""

LARGEST_EXCLUDED = LARGEST_SOUGHT
"""Up to this order all faces are excluded together, where that can be, before anything else is tried: floats with error
bounds do it in 0.1 ms, where a proof by pivots takes 0.6."""

MESSAGE = f"{Outcome.SOLVED} The first active set, where q < 0, is right."


def at_once(finish: Finish) -> tuple[Solution | None, bool]:
    """The solution on the face where q < 0, certified and judged as any other, or None; and whether that is regular.

    `finish`: Of a dense LCP; where its faces are kept this one is made once.
    """
    problem, began = finish.problem, time.perf_counter()
    # Where a symmetric A has a singular face the proximal method comes next, which does not need its solution.
    face = finish.faces.face(active_state(problem.q < 0.0), regular=finish.faces.structure.symmetric)
    point = None if face is None else face.point(np.zeros(problem.n))
    if face is None or point is None or not finish.judged(face, *point)[2]:
        return None, face is not None and face.exact
    certificate = finish.certificate
    assert certificate is not None
    if problem.n <= LARGEST_DECIDED and not exact_nearby(problem, certificate.x, certificate.w):
        return None, face.exact
    counts = Counts(factorizations=1)
    return Solution(problem, Outcome.SOLVED, MESSAGE, certificate, (), -1, counts, time.perf_counter() - began), True


def none_at_once(problem: MixedLCP, plain: MixedLCP) -> Solution | None:
    """That no face holds a solution, proved in floats of all of them together; None where one is in doubt.

    It comes after `at_once`, the factorisation of which is counted. `plain` is the LCP over a common factor.
    """
    began, every = time.perf_counter(), all_faces(problem.n)
    if np.count_nonzero(doubtful(plain, every.astype(np.int8) - 1)):
        return None
    tried, seconds = Exhaustion(None, len(every)), time.perf_counter() - began
    found = Solution(problem, Outcome.UNSOLVABLE, "", None, (), -1, Counts(factorizations=1), seconds, exhaustion=tried)
    return evolve(found, message=f"{Outcome.UNSOLVABLE} {found.proof}")
