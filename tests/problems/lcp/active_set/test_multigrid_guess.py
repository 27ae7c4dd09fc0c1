"""The cascade of coarser problems: how many factorisations it takes, with bounds, and in any units."""

import numpy as np
import pytest
import scipy.sparse as sp

from continuation.linear.factoring import Factoring
from problems import lcp
from problems.lcp import LCP, MixedLCP

from ....util import benchmark

BENCHMARK = vars(benchmark("large.py"))


@pytest.fixture
def orders(monkeypatch):
    """Of the matrices that are factored."""
    found, real = [], Factoring.factor

    def counted(self, matrix):
        found.append(matrix.shape[0])
        return real(self, matrix)

    monkeypatch.setattr(Factoring, "factor", counted)
    return found


def solved(problem, **options):
    """The solution, by active sets alone, to round-off."""
    found = lcp.solve(problem, **options)
    assert found.solved
    assert found.certificate.relative_residual < 1e-14
    assert "before any path" in found.message
    return found


@pytest.mark.parametrize(("m", "every"), [(31, 7), (63, 8)])
def test_a_membrane_takes_one_factorisation_of_the_finest_level(m, every, orders):
    found = solved(BENCHMARK["obstacle_2d"](m), sparse="superlu")
    assert found.counts.factorizations == len(orders) == every
    assert sum(2 * order > m * m for order in orders) == 1
    assert f"Sparse factorisations: {every} by SuperLU" in found.message


@pytest.mark.parametrize(("row", "m", "finest"), [("torsion", 60, 2), ("put", 100, 2)])
def test_bounds_above_and_weighted_rows_have_a_cascade_too(row, m, finest, orders):
    found = solved(BENCHMARK["ROWS"][row](m))
    assert sum(order > 0.4 * found.problem.n for order in orders) == finest


def test_the_cascade_does_not_depend_on_which_side_the_obstacle_is(orders):
    """x >= l, x <= -l with signs changed, and x - l >= 0 have the same faces."""
    problem = BENCHMARK["obstacle_2d"](31)
    l = np.sin(np.arange(problem.n))
    below = MixedLCP(problem.A, problem.q - problem.A @ l, l, np.full(problem.n, np.inf))
    above = MixedLCP(problem.A, problem.A @ l - problem.q, np.full(problem.n, -np.inf), -l)
    x = solved(problem).x
    np.testing.assert_allclose(solved(below).x - l, x, atol=1e-9)
    np.testing.assert_allclose(-solved(above).x - l, x, atol=1e-9)
    assert len(orders) == 3 * 7


def test_units_of_the_unknowns_cost_the_cascade_nothing(orders):
    """Powers of two that differ from one unknown to the next, on a line."""
    problem = BENCHMARK["obstacle_2d"](63)
    unit = np.where(np.arange(problem.n) // 63 == 30, 4.0, 1.0)
    D = sp.diags_array(unit)
    moved = LCP(D @ problem.A @ D, unit * problem.q)
    np.testing.assert_allclose(unit * solved(moved).x, solved(problem).x, atol=1e-9)
    assert sum(2 * order > problem.n for order in orders) <= 2 * 3


@pytest.mark.parametrize("row", ["obstacle", "torsion"])
def test_cholmod_ends_at_the_same_solution(row):
    pytest.importorskip("cvxopt")
    problem = BENCHMARK["ROWS"][row](40)
    one, other = solved(problem, sparse="superlu"), solved(problem, sparse="cholmod")
    np.testing.assert_allclose(one.x, other.x, atol=1e-12 * np.abs(one.x).max())
    assert "CHOLMOD" in other.message
