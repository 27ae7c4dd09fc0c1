"""A guess of the active set of a problem with bounds and a symmetric matrix, by a few projected gradients."""

from __future__ import annotations

import numpy as np

from problems.lcp.data.problem import MixedLCP, State

PROJECTED_STEPS = 12
"""Each costs one product with A, a tenth of a correction of the active set at n = 300.

Of random programs in a box (rank n/2, definite, condition 1e6) those corrections are 10, 6 and 12 from x = 0, 5, 5 and
3 after five steps, 3, 3 and 2 after twelve, and hardly fewer after twenty; at n = 1000 11, 8 and 14 become 3, 5 and 3.
"""


def projected_state(problem: MixedLCP) -> State:
    """The state after steps along the projected gradient of 1/2 x'A x + q'x, from the point nearest to zero.

    In units of the diagonal of A, with the step lengths of Barzilai and Borwein, while the state changes.

    `problem`: A is symmetric, and its diagonal not negative.

    References
    ----------
    Barzilai and Borwein, "Two-Point Step Size Gradient Methods", IMA J. Numer. Anal. 8, 1988; More and Toraldo, "On the
    Solution of Large Quadratic Programming Problems with Bound Constraints", SIAM J. Optim. 1, 1991.
    """
    x, diagonal = problem.near_zero, problem.A.diagonal()
    inverse = 1.0 / np.where(diagonal > 0.0, diagonal, 1.0)
    w = problem.w(x)
    down = inverse * w
    length = _ratio(float(down @ w), float(down @ (problem.A @ down)))
    state = problem.states(x, length * down)
    for _ in range(PROJECTED_STEPS):
        following = problem.clipped(x - length * down)
        moved, before = following - x, w
        x, w = following, problem.w(following)
        length = _ratio(float(moved @ (moved / inverse)), float(moved @ (w - before)))
        down = inverse * w
        last, state = state, problem.states(x, length * down)
        if np.array_equal(state, last):
            break
    return state


def _ratio(size: float, curvature: float) -> float:
    """A step to the minimum along a line; one in units of the diagonal where there is none."""
    return size / curvature if curvature > 0.0 and np.isfinite(size / curvature) else 1.0
