"""The KKT path, its theorems: its start, its course, its end.

Numbers are those of Dutta, Das and Jana, "Bounded Homotopy Path Approach to Find the Solution of Linear Complementarity
Problems". Where their statement is wrong (3.7, 3.9) or unproven (3.4) the test is of what is true in its place.
"""

from types import SimpleNamespace

import numpy as np
from hypothesis import example, given
from hypothesis import strategies as st

from continuation import Status, trace
from problems.lcp import KKTHomotopy, certify, random_start
from problems.lcp.strategies import feasible_lcps, lcps
from problems.paper import COUNTEREXAMPLES, EXAMPLES

from ...util import share

SMALL = 1e-7
"""Relative size below which a number at the end of a path counts as zero; most ends are good to 1e-12."""


def kkt_path(pair, **options):
    """The path of the paper's start z1 = z2 = e."""
    problem, x0 = pair
    return trace(KKTHomotopy(problem, x0), **options)


def with_the_counterexamples(test):
    """Of feasible problems, and the two whose path ends where no solution is."""
    for pair in ((item.problem, item.x0) for item in COUNTEREXAMPLES):
        test = example(pair)(test)
    return given(feasible_lcps())(test)


def small(value, *sizes):
    return np.abs(value) <= SMALL * (1.0 + max(float(np.abs(size).max()) for size in sizes))


@share(40)
@given(feasible_lcps())
def test_the_path_of_a_feasible_start_is_feasible_throughout_and_ends_at_lambda_zero(pair):
    """Theorem 3.1: the curve lies in F x R++ x R++: x, z1, z2 and A x + q are positive at every step.

    Theorem 3.5: not a circle, and never back at lambda = 1, where y0 is the only zero. That it is bounded (Theorem 3.4)
    is not proved in the paper, nor here; no counterexample is known.
    """
    problem, _ = pair
    path = kkt_path(pair)
    assert path.status is Status.REACHED_TARGET
    assert path.endpoint.lam == 0.0
    assert (path.lam[1:] < 1.0).all()
    for step in path.steps[:-1]:
        assert step.lam > 0
        assert step.y.min() > 0
        assert problem.w(step.y[: problem.n]).min() > 0


@share(25)
@given(lcps(), st.integers(0, 2**32 - 1))
def test_the_path_of_any_positive_start_is_positive_throughout(problem, seed):
    """The same off the feasible set, with w = A x + q + lambda (w0 - A x0 - q) in the place of A x + q."""
    start = random_start(problem, np.random.default_rng(seed))
    homotopy = KKTHomotopy(problem, start.x0, start.z1, start.z2, start.w0)
    for step in trace(homotopy).steps[:-1]:
        assert step.y.min() > 0
        assert (problem.w(step.y[: problem.n]) + step.lam * homotopy.rho).min() > 0


@share(60)
@with_the_counterexamples
def test_the_end(pair):
    """With dx = x - z2, dw = w - z1: A' dx = -dw and x_i w_i + z1_i z2_i = dx_i dw_i >= 0 (from Remark 2).

    Theorem 3.6, read index by index: x_i w_i = 0 exactly where dx_i dw_i = 0 or z1_i + z2_i > 0; the end is known to a
    few digits more than the gap that is asked for here between zero and positive. Theorem 3.8: if diag(w) + diag(x) A'
    is nonsingular at the end, then x solves the LCP.
    """
    problem, _ = pair
    n = problem.n
    y = kkt_path(pair).endpoint.y
    x, z1, z2 = y[:n], y[n : 2 * n], y[2 * n :]
    w = problem.w(x)
    assert small(np.minimum(y, 0.0), y).all()
    assert small(np.minimum(w, 0.0), y, w).all()
    dx, dw = x - z2, w - z1
    assert small(problem.A.T @ dx + dw, problem.A, y, w).all()
    products = dx * dw
    assert small(x * w + z1 * z2 - products, np.outer(y, y), np.outer(w, w)).all()
    assert small(np.minimum(products, 0.0), np.outer(y, y), np.outer(w, w)).all()
    gap = 1e-3 * (1.0 + float(np.abs(np.append(y, w)).max()))
    for i in range(n):
        if min(x[i], w[i]) > gap:
            assert small(z1[i], y)
            assert small(z2[i], y)
            assert products[i] > gap * gap / 2
        if max(z1[i], z2[i]) > gap or products[i] <= 0:
            assert small(min(x[i], w[i]), y, w)
    if not certify(problem, x, 1e-4).solves(1e-4):
        values = np.linalg.svd(np.diag(w) + np.diag(x) @ problem.A.T, compute_uv=False)
        assert values[-1] <= SMALL * max(1.0, values[0])


@share(60)
@given(feasible_lcps("row_sufficient"))
def test_row_sufficient_matrices_are_solved(pair):
    """What is true in the place of Theorems 3.7 and 3.9: where A is row sufficient every KKT point solves the LCP.

    Cottle, Pang and Venkateswaran 1989; Cottle, Pang and Stone, Theorem 3.5.4. PSD, P and P_* matrices are such.
    """
    problem, _ = pair
    path = kkt_path(pair)
    assert path.status is Status.REACHED_TARGET
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
