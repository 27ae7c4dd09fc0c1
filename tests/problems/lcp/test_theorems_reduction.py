"""The reduction from 3n to n unknowns, one theorem a test: one determinant, one sign, one step."""

from types import SimpleNamespace

import numpy as np
from hypothesis import example, given

from continuation import trace
from problems.lcp import KKTHomotopy
from problems.lcp.strategies import feasible_lcps
from problems.paper import EXAMPLES

from ...util import share

TWO_TURNS = (EXAMPLES[9].problem, EXAMPLES[9].x0)


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
