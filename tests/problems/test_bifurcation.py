"""The bifurcation problems: what they do with wild iterates.

That they keep the promises of the protocol, their derivatives among them, is shown in test_conformance; that their
curves and limit points are those in closed form or published, in the acceptance tests.
"""

import numpy as np
import pytest

from problems.bifurcation import (
    Aircraft,
    Bratu1D,
    Bratu2D,
    Circle,
    Cusp,
    ExponentialCosine,
    FreudensteinRoth,
    Pitchfork,
)

PROBLEMS = [
    Circle(), Cusp(), Cusp(splitting=-0.7), Pitchfork(), Pitchfork(imperfection=0.1), Pitchfork(imperfection=-2.0),
    FreudensteinRoth(), Bratu1D(1), Bratu1D(7), Bratu2D(1), Bratu2D(4), ExponentialCosine(1), ExponentialCosine(6),
    Aircraft(), Aircraft(elevator=-0.05),
]  # fmt: skip
every_problem = pytest.mark.parametrize("problem", PROBLEMS, ids=repr)


@every_problem
@pytest.mark.parametrize("size", [1e3, 1e300, np.inf, np.nan])
def test_wild_iterates_make_no_noise(problem, size):
    # Warnings are errors in this suite: that nothing is raised is the claim.
    y = np.full(problem.start()[0].shape, size)
    for lam in (0.0, 1.0, size):
        assert problem.residual(y, lam).shape == y.shape
        problem.jacobian(y, lam)
