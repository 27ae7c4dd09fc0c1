"""Hypothesis strategies: what they draw is what they promise, exactly, and counterexamples shrink to small integers."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import HealthCheck, find, given, settings
from hypothesis import strategies as st

from problems import hypothesis_hook
from problems.lcp import classes
from problems.lcp import strategies as mine
from problems.lcp.data.problem import LCP
from problems.lcp.reference.enumeration import solve_by_enumeration

from ...exact import exact_w, solves

TESTS = {
    "P": classes.is_p, "P0": classes.is_p0, "PSD": classes.is_psd, "K": classes.is_k, "Z": classes.is_z,
    "N": classes.is_n, "nondegenerate": classes.is_nondegenerate, "row_sufficient": classes.is_row_sufficient,
    "copositive": classes.is_copositive,
}  # fmt: skip

HUNT = settings(max_examples=5000, database=None, suppress_health_check=list(HealthCheck))


@pytest.mark.parametrize("cls", TESTS)
@given(data=st.data())
def test_matrices_belong_to_their_class(cls, data):
    A = data.draw(mine.matrices(cls))
    assert A.dtype == np.float64
    assert A.shape == (len(A), len(A))
    membership = TESTS[cls](A)
    assert membership.holds, str(membership)


HUNTED = {
    "P but not PSD": ("P", lambda A: not classes.is_psd(A).holds),
    "P0 but not P": ("P0", lambda A: not classes.is_p(A).holds and A.any()),
    "P0 but not row sufficient": ("P0", lambda A: not classes.is_row_sufficient(A).holds),
    "PSD but not symmetric": ("PSD", lambda A: (A != A.T).any()),
    "row but not column sufficient": ("row_sufficient", lambda A: not classes.is_column_sufficient(A).holds),
    "row sufficient, neither PSD nor P": (
        "row_sufficient",
        lambda A: classes.is_sufficient(A).holds and not classes.is_psd(A).holds and not classes.is_p(A).holds,
    ),
    "N of the first kind": ("N", lambda A: (A > 0).any()),
    "copositive but not PSD": ("copositive", lambda A: not classes.is_psd(A).holds),
    "Z but not K": ("Z", lambda A: not classes.is_k(A).holds),
    "nondegenerate but not Q0": ("nondegenerate", lambda A: not classes.is_q0(A).holds),
    "nondegenerate and not P": ("nondegenerate", lambda A: not classes.is_p(A).holds),
}


@pytest.mark.parametrize(("cls", "condition"), HUNTED.values(), ids=HUNTED)
def test_the_classes_are_reached_beyond_their_subclasses_and_shrink(cls, condition):
    A = find(mine.matrices(cls, 2), condition, settings=HUNT)
    assert np.abs(A).max() <= 4


@pytest.mark.parametrize("cls", ["any", "P0", "copositive"])
@given(data=st.data())
def test_the_start_of_feasible_problems_is_strictly_feasible(cls, data):
    problem, x0 = data.draw(mine.feasible_lcps(cls))
    assert min(x0) > 0
    assert min(exact_w(problem, x0)) > 0


@given(st.sampled_from([("strict", "P0"), ("degenerate", "PSD"), ("many", "any")]), st.data())
def test_a_planted_solution_solves_and_is_of_its_kind(kind, data):
    problem, x = data.draw(mine.planted_lcps(*kind))
    assert solves(problem, x)
    sums = [a + b for a, b in zip(x, exact_w(problem, x), strict=True)]
    truth = solve_by_enumeration(problem)
    assert tuple(map(Fraction, x)) in {s.x for s in truth.solutions} or not truth.complete
    if kind[0] == "many":
        assert len(truth.solutions) >= 2 or not truth.complete
    else:
        assert (min(sums) > 0) == (kind[0] == "strict")


@given(mine.near_singular_lcps(st.integers(2, 4)))
def test_near_singular_problems_are_a_power_of_two_from_singular_and_strictly_feasible(pair):
    problem, x0 = pair
    assert min(*x0, *exact_w(problem, x0)) > 0
    whole = np.round(problem.A)
    (moved,) = np.abs(problem.A - whole)[whole != problem.A]
    assert 2.0**-40 <= moved <= 2.0**-10
    assert classes.ExactMatrix.of(whole).minors[-1] == 0


def test_the_hook_registers_the_problem_type_for_from_type():
    hypothesis_hook.register()
    assert find(st.from_type(LCP), lambda p: p.n == 2 and p.q.any(), settings=HUNT).n == 2


@pytest.mark.parametrize("cls", mine.CLASSES)
@given(data=st.data())
@settings(max_examples=4, database=None)
def test_thirty_rows_pass_the_health_checks(cls, data):
    problem = data.draw(mine.lcps(cls, 30))
    assert problem.n == 30
    # Of a leading part all minors can be looked at.
    if cls in ("P", "P0", "nondegenerate"):
        assert TESTS[cls](problem.A[:6, :6]).holds


@given(data=st.data())
@settings(max_examples=20, database=None)
def test_entries_of_ones_own(data):
    A = data.draw(mine.matrices("any", 3, entries=st.floats(-1.0, 1.0)))
    assert np.abs(A).max() <= 1.0
    Z = data.draw(mine.matrices("Z", 4, entries=st.floats(-1.0, 1.0)))
    assert classes.is_z(Z).holds
