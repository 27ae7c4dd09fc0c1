"""Points are brought onto the path, from far away too."""

import numpy as np
import pytest

from continuation import Counts, from_functions
from continuation.evaluation.evaluator import Evaluator
from continuation.point.linearization import linearize
from continuation.point.projection import PathSolver
from continuation.tolerance import Tolerance


def test_newton_steps_lead_to_where_increments_halve():
    """At y = 3 the slope of y^3 is 27, at its root 3: with one factorisation increments hardly shrink near the root."""
    evaluator = Evaluator(from_functions(lambda y, lam: y**3 - 1.0 - lam, start=([1.0], 0.0)), Counts())
    border, start = np.array([0.0, 1.0]), np.array([1.0, 0.0])
    near = linearize(evaluator, start, np.ones(2), border)
    found, anchor = PathSolver(evaluator, Tolerance()).project(near, 3.0 * start, border)
    assert found == pytest.approx(start, abs=1e-15)
    assert 1.0 < anchor.u[0] < 2.0
