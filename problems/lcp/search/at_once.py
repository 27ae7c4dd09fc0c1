"""The quickest answer: a small problem whose first active set, where q < 0, is right."""

from __future__ import annotations

import time

import numpy as np

from continuation.counts import Counts
from problems.lcp.active_set.face import Faces
from problems.lcp.data.problem import LCP, active_state
from problems.lcp.proof.certificate import ROUND_OFF, certified
from problems.lcp.proof.verdict import LARGEST_DECIDED, confirmed, exact_nearby
from problems.lcp.search.outcome import Outcome, Solution

LARGEST = 20
"""Up to this order making what a search consists of takes as long as this answer."""

MESSAGE = f"{Outcome.SOLVED} The first active set, where q < 0, is right."


def at_once(faces: Faces, tolerance: float) -> Solution | None:
    """The solution on the face where q < 0, certified and judged as any other; None if that is not one.

    Parameters
    ----------
    faces : Faces
        Of a dense LCP; where it keeps faces this one is made once.
    tolerance : float
    """
    problem, began = faces.problem, time.perf_counter()
    assert isinstance(problem, LCP)
    face = faces.face(active_state(problem.q < 0.0))
    point = None if face is None or not face.exact else face.point(np.zeros(problem.n))
    if point is None or point[0].min() < 0.0 or point[1].min() < 0.0:
        return None
    certificate = certified(problem, point[0])
    if certificate.relative_residual > ROUND_OFF or not confirmed(problem, certificate, tolerance):
        return None
    if problem.n <= LARGEST_DECIDED and not exact_nearby(problem, certificate.x):
        return None
    counts = Counts(factorizations=1)
    return Solution(problem, Outcome.SOLVED, MESSAGE, certificate, (), -1, counts, time.perf_counter() - began)
