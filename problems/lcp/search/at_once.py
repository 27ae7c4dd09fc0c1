"""The quickest answer: a small problem whose first active set, where q < 0, is right."""

from __future__ import annotations

import time

import numpy as np

from continuation.counts import Counts
from problems.lcp.active_set.finish import Finish
from problems.lcp.data.problem import active_state
from problems.lcp.proof.verdict import LARGEST_DECIDED, exact_nearby
from problems.lcp.search.outcome import Outcome, Solution

LARGEST = 100
"""Up to this order making what a search consists of takes as long as this answer, and the face is made once."""

MESSAGE = f"{Outcome.SOLVED} The first active set, where q < 0, is right."


def at_once(finish: Finish) -> Solution | None:
    """The solution on the face where q < 0, certified and judged as any other; None if that is not one.

    Parameters
    ----------
    finish : Finish
        Of a dense LCP; where its faces are kept this one is made once.
    """
    problem, began = finish.problem, time.perf_counter()
    face = finish.faces.face(active_state(problem.q < 0.0))
    point = None if face is None else face.point(np.zeros(problem.n))
    if face is None or point is None or not finish.judged(face, *point)[2]:
        return None
    certificate = finish.certificate
    assert certificate is not None
    if problem.n <= LARGEST_DECIDED and not exact_nearby(problem, certificate.x):
        return None
    counts = Counts(factorizations=1)
    return Solution(problem, Outcome.SOLVED, MESSAGE, certificate, (), -1, counts, time.perf_counter() - began)
