"""Data of `problems.lcp` on the edge of what can be meant; all else is in the table `tests/reliability/hostile.py`."""

import pytest

from problems import lcp
from problems.lcp import LCP


@pytest.mark.parametrize("options", [{}, {"seed": 7486, "restarts": 2}], ids=["alone", "restarts"])
def test_finite_data_always_has_an_answer(options):
    """A solution of one of its faces is beyond what certifies it, and is no point to complain about."""
    small = 1e-13
    A = [[1.0 - small, 0.0, -1.0 - small], [-2.0 + small, 0.0, 2.0], [-2.0 + small, small, 2.0]]
    found = lcp.solve(LCP(A, [1.0 - small, -small, 1.0 - small]), **options)
    assert not found.success
    assert not lcp.solve_by_enumeration(found.problem).solutions
