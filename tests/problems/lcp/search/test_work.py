"""The budget of a search that was given none: work, so that the same call gives the same answer on every machine."""

import math

import numpy as np
import pytest
from scipy.sparse import eye_array

from continuation import Budget
from problems import lcp
from problems.lcp.search.work import default_budget


def dense(n):
    return lcp.LCP(np.eye(n), -np.ones(n))


def sparse(n):
    return lcp.LCP(eye_array(n, format="csc"), -np.ones(n))


def test_the_budget_is_work_that_falls_with_the_order_and_is_enough_for_two_paths():
    budgets = [default_budget(problem) for problem in (dense(1), dense(10), dense(300), sparse(100_000))]
    assert all((budget.steps, budget.seconds) == (budget.factorizations, math.inf) for budget in budgets)
    counts = [budget.factorizations for budget in budgets]
    assert counts == sorted(counts, reverse=True)
    assert counts[0] > 1000.0 * counts[-1] >= 100_000.0


@pytest.mark.parametrize("budget", [None, Budget(steps=math.inf, seconds=1800.0, factorizations=3000)])
def test_no_clock_decides_the_answer(budget, monkeypatch):
    """Ten minutes pass between any two looks at the clock, and the search goes on as if none had.

    Seconds of a budget are the processor's, which a busy machine gives later, but no fewer.
    """
    # Larger than what groups of faces decide.
    A = np.eye(61)
    A[:2, :2] = [[0.0, 1.0], [0.0, 0.0]]
    problem = lcp.LCP(A, np.append([-1.0, 1.0], -np.ones(59)))
    usual = lcp.solve(problem, restarts=4, budget=budget)
    now = iter(range(0, 10**9, 600))
    monkeypatch.setattr("problems.lcp.search.search.time.perf_counter", lambda: float(next(now)))
    slow = lcp.solve(problem, restarts=4, budget=budget)
    assert usual.outcome is slow.outcome
    assert usual.counts == slow.counts
    assert len(usual.paths) > 1
    assert slow.seconds > 60.0
