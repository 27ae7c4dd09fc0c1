"""Where the paper's guarantees fail: from the middle of two solutions, and beside it, where they hold again."""

import numpy as np
import pytest

from continuation import Kind, trace
from problems.lcp import LCP, KKTHomotopy, Outcome, solve

from ...util import for_interior_paths, path_of

HILL = LCP([[-1]], [2])
"""min x (2 - x): its solutions are 0 and 2, and between them, at x = 1, a maximum, which is stationary too."""


@for_interior_paths
def test_the_start_in_the_middle_meets_a_branch_point_and_ends_on_the_top(preset):
    """Theorem 3.1 holds for almost every start, not for every: from x0 = 1 the path is x = 1, z1 = z2 = lambda.

    On it G = (1 - lam)(2 lam - 2) + lam, which vanishes where 2 lam^2 - 5 lam + 2 = 0: at lam = 1/2, a pitchfork.
    """
    path = trace(KKTHomotopy(HILL, [1.0]), preset=preset)
    (branch,) = path.events
    assert branch.kind == Kind.BRANCH_POINT
    np.testing.assert_allclose(branch.u, [1, 0.5, 0.5, 0.5], atol=1e-7)
    np.testing.assert_allclose(path.y, np.column_stack([np.ones(len(path)), path.lam, path.lam]), atol=1e-12)
    assert path.endpoint.orientation == -branch.orientation == 1
    assert solve(HILL, "kkt", x0=[1.0], finish=False).outcome is Outcome.STATIONARY


@for_interior_paths
@pytest.mark.parametrize("offset", [1e-2, 1e-4, 1e-6])
@pytest.mark.parametrize("side", [-1, 1])
def test_a_start_beside_the_middle_turns_off_to_a_solution(preset, offset, side):
    """The pitchfork unfolded: a turn of width offset^(1/3) towards the solution on its side, followed, not leapt."""
    path = path_of(KKTHomotopy(HILL, [1.0 + side * offset]), preset=preset)
    assert not path.events
    assert path.endpoint.y[0] == pytest.approx(1.0 + side, abs=1e-8)
    assert (np.sign(path.y[:, 0] - 1.0) == side).all()
