"""The reduction from 3n to n unknowns, one theorem a test: one determinant, one sign, one step."""

from fractions import Fraction
from types import SimpleNamespace

import numpy as np
from hypothesis import assume, example, given
from hypothesis import strategies as st

from continuation import Kind, trace
from problems.lcp import KKTHomotopy
from problems.lcp.strategies import feasible_lcps
from problems.paper import EXAMPLES

from ...exact import determinant, fractions
from ...util import share

TWO_TURNS = (EXAMPLES[9].problem, EXAMPLES[9].x0)


def reduced_matrix(A, x, z1, z2, w, lam):
    """G = (1 - lam) [A + A' + diag(z1/x) + A' diag(z2/w) A] + lam I, in rational arithmetic."""
    n = len(A)
    A, x, z1, z2, w = map(fractions, (A, x, z1, z2, w))
    inner = A + A.T + np.diag(z1 / x) + A.T @ ((z2 / w)[:, None] * A)
    lam = Fraction(lam)
    return (1 - lam) * inner + lam * np.array([[Fraction(i == j) for j in range(n)] for i in range(n)])


def regular_path(problem, x0):
    """The path of the paper's start, which is regular for almost every start: one with a branch point is set aside."""
    path = trace(KKTHomotopy(problem, x0))
    assume(all(event.kind != Kind.BRANCH_POINT for event in path.events))
    return path


def reduced_at(problem, step):
    n = problem.n
    y = step.y
    return reduced_matrix(problem.A, y[:n], y[n : 2 * n], y[2 * n :], problem.w(y[:n]), step.lam)


@share(60)
@given(feasible_lcps(), st.integers(0, 7), st.lists(st.integers(1, 5), min_size=8, max_size=8))
def test_the_determinant_factors(pair, eighths, multipliers):
    """det H_y = det G prod x_i prod w_i for every lambda and all x, z1, z2, w > 0: exactly, on small dyadic numbers."""
    problem, x = pair
    n, lam, w = problem.n, eighths / 8, problem.w(x)
    z1, z2 = np.array(multipliers[:n], dtype=float), np.array(multipliers[-n:], dtype=float)
    H_y, _ = KKTHomotopy(problem, x).jacobian(np.concatenate([x, z1, z2]), lam)
    G = reduced_matrix(problem.A, x, z1, z2, w, lam)
    assert (G == G.T).all()
    assert determinant(H_y) == determinant(G) * int(np.prod(x) * np.prod(w))


@share(40)
@given(feasible_lcps())
@example(TWO_TURNS)
def test_lambda_falls_where_the_reduced_determinant_is_positive(pair):
    """The orientation det [[H'], [tangent']] < 0 of the start is that of every step, so sign(dlam/ds) = -sign det G.

    det [[H'], [v']] = det H_y |v|^2 / v_lam for H' v = 0, and det H_y has the sign of det G.
    """
    problem, x0 = pair
    homotopy = KKTHomotopy(problem, x0)
    steps = regular_path(problem, x0).steps[1:-1]
    for step in steps:
        assert step.orientation == -1
        if step.share > 1e-6:
            assert np.sign(float(determinant(reduced_at(problem, step)))) == -np.sign(step.tangent[-1])
    # The sign of det [[H'], [tangent']] as the reduced factorisation has it, against all 3n + 1 rows exactly.
    for step in steps[::3]:
        full = np.vstack([np.column_stack(homotopy.jacobian(step.y, step.lam)), step.tangent])
        assert homotopy.bordered(step.y, step.lam, step.tangent).sign == (1 if determinant(full) > 0 else -1) == -1


@share(25)
@given(feasible_lcps())
@example(TWO_TURNS)
def test_reduced_and_full_steps_agree(pair):
    """The path with n + 1 unknowns a solve is that with 3n + 1, factored whole and differentiated by jets."""
    one = KKTHomotopy(*pair)
    names = ("target", "metric", "start", "residual", "jacobian", "max_step")
    full = trace(SimpleNamespace(**{name: getattr(one, name) for name in names}))
    reduced = trace(one)
    assert full.status is reduced.status
    np.testing.assert_allclose(full.u, reduced.u, rtol=1e-8, atol=1e-8)
    assert [turn.step for turn in full.turning_points] == [turn.step for turn in reduced.turning_points]
