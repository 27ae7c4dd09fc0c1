"""Groups of faces that multipliers exclude: against enumeration in exact arithmetic, and what is forged is refused."""

import numpy as np
import pytest
from attrs import evolve
from hypothesis import given
from hypothesis import strategies as st

from continuation import Budget
from problems import lcp
from problems.lcp import Outcome
from problems.lcp.proof.groups import Group, Groups
from problems.lcp.reference.branching import Branching
from problems.lcp.reference.enumeration import exhaust
from problems.lcp.strategies import lcps

from ..util import solution_of


def feasible_without_solution(n, seed):
    """Normal entries; q such that x = 1 is feasible, and no face holds a solution."""
    r = np.random.default_rng([78, n])
    A = r.standard_normal((n, n))
    A[:2] = 0.0
    A[0, 1], x = 1.0, np.ones(n)
    order = np.random.default_rng(seed).permutation(n)
    q = np.append([-1.0, 1.0], r.random(n - 2) + 1e-3 - A[2:] @ x)
    return lcp.LCP(A[np.ix_(order, order)], q[order])


@given(st.sampled_from(["any", "PSD", "Z"]).flatmap(lambda cls: lcps(cls, st.integers(1, 7))))
def test_they_agree_with_enumeration_and_hold_exactly(problem):
    # No face is accepted in floats, so that every claim is one of exact arithmetic.
    found = Branching(problem, lambda active: False).run(1000)
    assert found.solvable is exhaust(problem).solvable
    if found.solvable:
        assert problem.natural_residual(found.point) <= 1e-9
    else:
        assert found.groups.holds(problem)


@pytest.mark.parametrize("n", [13, 20])
def test_feasible_problems_without_a_solution_are_decided(n):
    problem = feasible_without_solution(n, n)
    found = solution_of(problem, outcome=Outcome.UNSOLVABLE)
    assert (found.farkas, found.paths) == (None, ())
    assert "in groups" in found.proof
    assert found.exhaustion.faces == 2**n > len(found.exhaustion.groups) > 1
    assert found.exhaustion.groups.holds(problem)


def test_in_other_units_they_hold_for_the_data_as_given():
    problem = feasible_without_solution(14, 3)
    rows, columns = 2.0 ** np.random.default_rng(5).integers(-30, 31, (2, 14))
    scaled = lcp.LCP(rows[:, None] * problem.A * columns, rows * problem.q)
    found = solution_of(scaled, outcome=Outcome.UNSOLVABLE)
    assert found.exhaustion.groups.holds(scaled)
    assert not found.exhaustion.groups.holds(lcp.LCP(np.eye(14), -np.ones(14)))


def test_what_is_forged_does_not_hold():
    problem = feasible_without_solution(13, 1)
    groups = lcp.solve(problem).exhaustion.groups.groups
    one = next(group for group in groups if group.y is not None)
    rest = tuple(group for group in groups if group is not one)
    assert Groups((*rest, one)).holds(problem)
    for other in (
        evolve(one, y=-np.asarray(one.y, dtype=float)),
        evolve(one, y=None),
        Group(np.zeros(26, bool), one.y),
    ):
        assert not Groups((*rest, other)).holds(problem)
    for incomplete in (rest, ()):
        assert not Groups(incomplete).holds(problem)


def test_nodes_end_it_and_it_goes_on():
    problem = feasible_without_solution(20, 2)
    tree = Branching(problem, lambda active: False)
    assert tree.run(1) is None
    assert tree.nodes == 1
    assert tree.run(1000).groups.holds(problem)
    assert lcp.solve(problem, finish=False, restarts=0, budget=Budget(steps=5)).outcome is not Outcome.UNSOLVABLE


def test_a_tree_that_was_given_up_proves_nothing():
    """Entries from 1e-282 to 1: no group of some faces is found to hold none, and the rest is not all."""
    A = np.zeros((4, 4))
    A[0, 2:], A[1, 2:] = [1.66463445e-175, 0.979055238], [1.27498055, 2.46082704e-175]
    A[2, :2], A[3, :2] = [1.07903001, 1.63501523e-45], [1.78075078e-45, 1.01617793]
    problem = lcp.LCP(A, [-1.0692575, -2.57651505e-158, -0.758187060, -1.32468759e-282])
    tree = Branching(problem, lambda active: False)
    for _ in range(3):
        found = tree.run(1000)
        assert found is None or found.solvable is lcp.solve_by_enumeration(problem).solvable
    assert tree.run(1000) is None or not lcp.solve_by_enumeration(problem).solvable
