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


@pytest.mark.parametrize(
    ("problem", "expected"),
    [(dense(1), 169966), (dense(10), 166667), (dense(100), 56667), (dense(300), 8947), (sparse(1000), 8095)],
)
def test_the_budget_is_work_that_depends_on_the_order_alone(problem, expected):
    budget = default_budget(problem)
    assert budget.factorizations == budget.steps == expected
    assert budget.seconds == math.inf


def test_large_problems_have_two_paths_at_least():
    assert default_budget(sparse(100_000)).factorizations == 100


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
