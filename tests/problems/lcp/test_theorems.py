"""The KKT path, its theorems: its course, its end.

Numbers are those of Dutta, Das and Jana, "Bounded Homotopy Path Approach to Find the Solution of Linear Complementarity
Problems". Where their statement is wrong (3.7, 3.9) or unproven (3.4) the test is of what is true in its place.
"""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from continuation import Status, trace
from problems.lcp import KKTHomotopy, certify, random_start
from problems.lcp.strategies import feasible_lcps, lcps
from problems.paper import EXAMPLES

from ...util import path_of, share


def from_anywhere(problem, seed):
    """The homotopy from any positive start."""
    start = random_start(problem, np.random.default_rng(seed))
    return KKTHomotopy(problem, start.x0, start.z1, start.z2, start.w0)


@pytest.mark.parametrize("feasible", [True, False])
@share(40)
@given(data=st.data())
def test_the_path_is_positive_throughout_and_that_of_a_feasible_start_feasible_to_lambda_zero(feasible, data):
    """Theorem 3.1: the curve lies in F x R++ x R++: x, z1, z2 and A x + q are positive at every step.

    Off the feasible set, the same with w = A x + q + lambda (w0 - A x0 - q) in the place of A x + q.

    Theorem 3.5: not a circle, and never back at lambda = 1, where y0 is the only zero. That it is bounded (Theorem 3.4)
    is not proved in the paper, nor here; no counterexample is known.
    """
    starts = feasible_lcps() if feasible else st.tuples(lcps(), st.integers(0, 2**32 - 1))
    homotopy = (KKTHomotopy if feasible else from_anywhere)(*data.draw(starts))
    problem, path = homotopy.problem, trace(homotopy)
    if feasible:
        assert (path.status, path.endpoint.lam) == (Status.REACHED_TARGET, 0.0)
        assert min(path.lam[:-1]) > 0.0
        assert (path.lam[1:] < 1.0).all()
    for step in path.steps[:-1]:
        assert step.y.min() > 0
        assert (problem.w(step.y[: problem.n]) + (not feasible) * step.lam * homotopy.rho).min() > 0


@share(60)
@given(feasible_lcps("row_sufficient"))
def test_row_sufficient_matrices_are_solved(pair):
    """What is true in the place of Theorems 3.7 and 3.9: where A is row sufficient every KKT point solves the LCP.

    Cottle, Pang and Venkateswaran 1989; Cottle, Pang and Stone, Theorem 3.5.4. PSD, P and P_* matrices are such.
    """
    problem, _ = pair
    path = path_of(KKTHomotopy(*pair))
    certificate = certify(problem, np.maximum(path.endpoint.y[: problem.n], 0.0), 1e-8)
    assert certificate.solves(1e-8), (certificate.relative_residual, path.message)


@share(25)
@given(feasible_lcps())
@example((EXAMPLES[9].problem, EXAMPLES[9].x0))
def test_reduced_and_full_steps_agree(pair):
    """The path with n + 1 unknowns a solve is that with 3n + 1, factored whole and differentiated by jets."""
    one = KKTHomotopy(*pair)
    names = ("target", "metric", "start", "residual", "jacobian", "max_step")
    full = trace(SimpleNamespace(**{name: getattr(one, name) for name in names}))
    reduced = trace(one)
    assert full.status is reduced.status
    np.testing.assert_allclose(full.u, reduced.u, rtol=1e-8, atol=1e-8)
    assert [turn.step for turn in full.turning_points] == [turn.step for turn in reduced.turning_points]
