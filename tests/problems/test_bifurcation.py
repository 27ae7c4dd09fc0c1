"""The bifurcation problems: what they do with wild iterates, and truths that satisfy the equations to round-off.

That they keep the promises of the protocol, their derivatives among them, is shown in test_conformance; that the
limit points of the aircraft are those published, in the acceptance tests.
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
from tests import truth

PROBLEMS = [
    Circle(), Cusp(), Cusp(splitting=-0.7), Pitchfork(), Pitchfork(imperfection=0.1), Pitchfork(imperfection=-2.0),
    FreudensteinRoth(), Bratu1D(1), Bratu1D(7), Bratu2D(1), Bratu2D(4), ExponentialCosine(1), ExponentialCosine(6),
    Aircraft(), Aircraft(elevator=-0.05),
]  # fmt: skip
every_problem = pytest.mark.parametrize("problem", PROBLEMS, ids=repr)


def residual_at(problem, row):
    return problem.residual(row[:-1], float(row[-1]))


@every_problem
@pytest.mark.parametrize("size", [1e3, 1e300, np.inf, np.nan])
def test_wild_iterates_make_no_noise(problem, size):
    # Warnings are errors in this suite: that nothing is raised is the claim.
    y = np.full(problem.start()[0].shape, size)
    for lam in (0.0, 1.0, size):
        assert problem.residual(y, lam).shape == y.shape
        problem.jacobian(y, lam)


@pytest.mark.parametrize(
    ("problem", "rows"),
    [
        (Circle(), truth.circle.curve(np.linspace(0, 7, 50))),
        (Cusp(), truth.cusp.curve(np.linspace(-2, 2, 50))),
        (Cusp(2.5), truth.cusp.curve(np.linspace(-2, 2, 50), 2.5)),
        (Pitchfork(), truth.pitchfork.bifurcated_branch(np.linspace(-1, 1, 50))),
        (Pitchfork(0.2), truth.pitchfork.curve(np.linspace(-2, 2, 50), 0.2)),
        (FreudensteinRoth(), truth.freudenstein_roth.curve(np.linspace(-2, 4, 50))),
        (ExponentialCosine(4), truth.exponential_cosine.curve(4, np.linspace(0, 3.6, 50))),
    ],
    ids=lambda value: repr(value) if not isinstance(value, np.ndarray) else "",
)
def test_exact_curve_satisfies_the_equations(problem, rows):
    worst = max(np.abs(residual_at(problem, row)).max() for row in rows)
    assert worst <= 1e-13 * (1 + np.abs(rows).max())


@pytest.mark.parametrize(
    ("found", "published"),
    [
        (truth.cusp.turning_points(1.0)[:, 1], [0.3849001794597505, -0.3849001794597505]),
        (truth.freudenstein_roth.limit_points("x1")[0], [14.28309125009385, -1.741376892197492, 0.258577871376728]),
        (truth.freudenstein_roth.turning_points()[1], [61.02031501158272, 2.230138586607810, -0.686352757506886]),
        (truth.bratu.continuum_fold_1d()[1:], [3.513830719125161, 1.186842168634389]),
        ([truth.exponential_cosine.end(2), truth.exponential_cosine.end(8)], [1.475020783911128, 9.021601893584298]),
    ],
)
def test_truths_are_those_that_were_published(found, published):
    np.testing.assert_allclose(found, published, rtol=3e-15)


def test_aircraft_without_an_equilibrium_near_level_flight_says_so(monkeypatch):
    monkeypatch.setattr("problems.bifurcation.aircraft._NEWTON_STEPS", 1)
    with pytest.raises(ArithmeticError, match=r"elevator = 0\.1: no equilibrium at aileron 0"):
        Aircraft(elevator=0.1).start()
