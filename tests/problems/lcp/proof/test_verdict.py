"""What may be called a solution, and what only solves a problem whose last digits differ."""

import numpy as np
import pytest
import scipy.sparse as sp

from problems import lcp
from problems.lcp import LCP
from problems.lcp.proof.certificate import certify
from problems.lcp.proof.verdict import stationary
from problems.lcp.reference.enumeration import solve_by_enumeration

Outcome = lcp.Outcome
LAST = float(np.finfo(float).eps)


def test_what_the_last_digit_decides_is_solved_to_precision_alone():
    A = np.array([[1.0, -1.0], [-1.0, 1.0]])
    assert lcp.solve(LCP(A, [-1.0, 1.0])).outcome is Outcome.SOLVED
    # w_1 + w_2 = q_1 + q_2 < 0: nothing is feasible, by the last digit of q_2.
    off = lcp.solve(LCP(A, [-1.0, 1.0 - LAST]))
    assert not solve_by_enumeration(off.problem).solvable
    assert off.outcome is Outcome.SOLVED_TO_PRECISION
    assert off.success
    assert off.relative_residual <= LAST
    assert "in exact arithmetic" in off.message
    # Beyond order 12 exact arithmetic is not asked.
    for n, digits, outcome in (
        (12, 1, Outcome.SOLVED_TO_PRECISION), (12, 8, Outcome.UNSOLVABLE), (13, 1, Outcome.SOLVED),
        (13, 8, Outcome.SOLVED),
    ):  # fmt: skip
        wide = np.eye(n)
        wide[:2, :2] = A
        assert lcp.solve(LCP(wide, [-1.0, 1.0 - digits * LAST, *[-1.0] * (n - 2)])).outcome is outcome


@pytest.mark.parametrize(
    ("q", "y", "expected"),
    [
        (-1.0, [1.0 - 1e-9, -1e-9, 1.0], True),
        (1.0, [-1.0, 0.0, -1.0], False),  # all but x >= 0 and z2 >= 0
        (-1.0, [0.0, -1.0, 0.0], False),  # all but w >= 0 and z1 >= 0
        (-1.0, [1.0, 1.0, 0.0], False),  # all but x z1 = 0
        (-1.0, [1.0 + 1e-3, 0.0, 1.0], False),  # all but the first equation
    ],
)
@pytest.mark.parametrize(("of_x", "of_w"), [(1.0, 1.0), (2.0**-40, 2.0**30), (2.0**40, 2.0**-30)])
def test_what_is_stationary_is_so_in_any_units(q, y, expected, of_x, of_w):
    assert stationary(LCP([[of_w / of_x]], [of_w * q]), np.array(y) * [of_x, of_w, of_x]) is expected


@pytest.mark.parametrize(
    ("A", "q", "x", "exact"),
    [
        ([[2.0, 1.0], [1.0, 3.0]], [-1.0, -0.5], [0.5, 0.0], True),  # degenerate
        ([[1.0, -1.0], [-1.0, 1.0]], [-1.0, 1.0], [2.0, 1.0], True),  # singular
        ([[1.0, -1.0], [-1.0, 1.0]], [-1.0, 1.0 - LAST], [2.0, 1.0], False),  # inconsistent
        # Its equations have a solution, with an x that is negative, to far less than the tolerance.
        ([[-1.0, 1.0], [0.0, 1.0]], [-1.0 - 2.0**-40, -1.0], [-(2.0**-40), 1.0], False),
    ],
)
def test_rationals_decide_what_floats_do_not_prove(A, q, x, exact):
    certificate = certify(LCP(A, q), np.array(x))
    assert not certificate.clearly_exact
    assert certificate.exact is exact


@pytest.mark.parametrize("make", [np.asarray, sp.csr_array])
def test_what_floats_prove_is_true(make):
    r = np.random.default_rng(3)
    proved = 0
    for _ in range(200):
        n = int(r.integers(1, 4))
        A = r.integers(-3, 4, (n, n)) * 2.0 ** r.integers(-30, 30, n)
        x = np.where(r.random(n) < 0.6, r.integers(1, 5, n) * 2.0 ** r.integers(-20, 20, n), 0.0)
        q = np.where(x > 0.0, 0.0, r.integers(-1, 3, n)) - A @ x + r.choice([0.0, 1e-14, -1e-9], n)
        problem = LCP(make(A), q)
        if certify(problem, x).clearly_exact:
            proved += 1
            assert any(np.allclose(x, s.point, rtol=0.6) for s in solve_by_enumeration(problem).solutions)
    assert proved > 20


def test_what_floats_prove_with_bounds_is_true():
    """Pieces of boxes, planted from integers, some of them off by a little: rationals agree."""
    r = np.random.default_rng(5)
    proved = 0
    for _ in range(200):
        n = int(r.integers(1, 4))
        A, lower = r.integers(-3, 4, (n, n)) * 2.0 ** r.integers(-20, 20, n), r.integers(-2, 1, n).astype(float)
        upper = lower + r.integers(0, 3, n)
        x = lower + (upper - lower) * r.choice([0.0, 0.5, 1.0], n)
        w = np.where(x == lower, 1.0, np.where(x == upper, -1.0, 0.0)) * r.integers(0, 3, n)
        problem = lcp.MixedLCP(A, w - A @ x + r.choice([0.0, 1e-14, -1e-9], n), lower, upper)
        certificate = certify(problem, x)
        if certificate.clearly_exact:
            proved += 1
            assert lcp.certify_exactly(problem, x).solves
    assert proved > 20
