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
    near = linearize(evaluator, np.array([1.0, 0.0]), np.ones(2), np.array([0.0, 1.0]))
    border = np.array([0.0, 1.0])
    found, anchor = PathSolver(evaluator, Tolerance()).project(near, np.array([3.0, 0.0]), border)
    assert found == pytest.approx([1.0, 0.0], abs=1e-15)
    assert 1.0 < anchor.u[0] < 2.0
