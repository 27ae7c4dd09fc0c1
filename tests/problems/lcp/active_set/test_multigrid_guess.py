"""The cascade of coarser problems: how many factorisations it takes, with bounds, and in any units."""

import numpy as np
import pytest
import scipy.sparse as sp

from continuation.linear.factoring import Factoring
from problems import lcp
from problems.lcp import LCP, MixedLCP

from ....util import benchmark

ROWS = vars(benchmark("large.py"))["ROWS"]
OBSTACLE = ROWS["obstacle"]


@pytest.fixture
def orders(monkeypatch):
    """Of the matrices that are factored."""
    found, real = [], Factoring.factor
    monkeypatch.setattr(Factoring, "factor", lambda self, A: found.append(A.shape[0]) or real(self, A))
    return found


def solved(problem, **options):
    """The solution, by active sets alone, to round-off."""
    found = lcp.solve(problem, **options)
    assert (found.solved, "before any path" in found.message) == (True, True)
    assert found.certificate.relative_residual < 1e-14
    return found


@pytest.mark.parametrize("m", [31, 63])
def test_a_membrane_takes_one_factorisation_of_the_finest_level(m, orders):
    found = solved(OBSTACLE(m), sparse="superlu")
    assert found.counts.factorizations == len(orders) <= 7
    assert sum(order > 200 for order in orders) == 1
    assert f"Sparse factorisations: {len(orders)} by SuperLU" in found.message


def convected(m):
    # Upwind differences: not symmetric.
    T = sp.diags_array([-1.0, 1.0], offsets=[-1, 0], shape=(m, m))
    wind = 1000.0 * (m + 1) * (sp.kron(T, sp.eye_array(m)) + 0.7 * sp.kron(sp.eye_array(m), T.T))
    return LCP(sp.csr_array(OBSTACLE(m).A + wind), OBSTACLE(m).q)


def perforated(m):
    # Each bound is there for two thirds of the points.
    r, t = np.random.default_rng(m), np.arange(1, m + 1) / (m + 1)
    low, high = (np.where(r.random(m * m) < 0.3, np.inf, 0.01 * r.random(m * m)) for _ in range(2))
    return MixedLCP(OBSTACLE(m).A, 8.0 * np.outer(np.sin(2 * np.pi * t), np.sin(3 * np.pi * t)).ravel(), -low, high)


@pytest.mark.parametrize(
    ("make", "m"),
    [(ROWS["torsion"], 60), (ROWS["put"], 100), (convected, 60), (perforated, 100)],
)
def test_bounds_above_and_weighted_rows_have_a_cascade_too(make, m, orders):
    solved(make(m))
    assert sum(order > 200 for order in orders) == 1


def test_the_cascade_does_not_depend_on_which_side_the_obstacle_is(orders):
    """x >= l, x <= -l with signs changed, and x - l >= 0 have the same faces."""
    problem, l = OBSTACLE(31), np.sin(np.arange(31**2))
    below = MixedLCP(problem.A, problem.q - problem.A @ l, l, np.full(problem.n, np.inf))
    above = MixedLCP(problem.A, problem.A @ l - problem.q, np.full(problem.n, -np.inf), -l)
    x = solved(problem).x
    np.testing.assert_allclose(solved(below).x - l, x, atol=1e-9)
    np.testing.assert_allclose(-solved(above).x - l, x, atol=1e-9)
    assert orders == 3 * orders[: len(orders) // 3]


def test_units_of_the_unknowns_cost_the_cascade_nothing(orders):
    """Powers of two that differ from one unknown to the next, on a line."""
    problem, unit = OBSTACLE(63), np.where(np.arange(63**2) // 63 == 30, 4.0, 1.0)
    moved = LCP(unit[:, None] * problem.A * unit, unit * problem.q)
    np.testing.assert_allclose(unit * solved(moved).x, solved(problem).x, atol=1e-9)
    assert sum(order > 200 for order in orders) == 2


@pytest.mark.parametrize(("name", "package"), [("cholmod", "cvxopt"), ("pardiso", "pypardiso")])
@pytest.mark.parametrize("row", ["obstacle", "torsion"])
def test_packages_end_at_the_same_solution(row, name, package):
    pytest.importorskip(package)
    problem = ROWS[row](40)
    one, other = solved(problem, sparse="superlu"), solved(problem, sparse=name)
    np.testing.assert_allclose(one.x, other.x, atol=1e-12 * np.abs(one.x).max())
    assert name.upper() in other.message
