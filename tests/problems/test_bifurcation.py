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


def dense(matrix):
    return matrix if isinstance(matrix, np.ndarray) else matrix.toarray()


def full_jacobian(problem, u):
    H_y, H_lam = problem.jacobian(u[:-1], u[-1])
    return np.column_stack((dense(H_y), H_lam))


def residual_at(problem, row):
    return problem.residual(row[:-1], float(row[-1]))


def smallest_singular_value(matrix):
    return np.linalg.svd(matrix, compute_uv=False)[-1]


@every_problem
@pytest.mark.parametrize("size", [1e3, 1e300, np.inf, np.nan])
def test_wild_iterates_make_no_noise(problem, size):
    # Warnings are errors in this suite: that nothing is raised is the claim.
    y = np.full(problem.start()[0].shape, size)
    for lam in (0.0, 1.0, size):
        assert problem.residual(y, lam).shape == y.shape
        problem.jacobian(y, lam)


@pytest.mark.parametrize("problem", [Bratu1D(5), Bratu2D(3)], ids=repr)
def test_overflow_is_not_hidden(problem):
    y = np.full(problem.start()[0].shape, 1e3)
    assert not np.isfinite(problem.residual(y, 1.0)).any()


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
    ("problem", "rows"),
    [
        (Circle(), truth.circle.turning_points()),
        (Cusp(), truth.cusp.turning_points()),
        (Cusp(0.3), truth.cusp.turning_points(0.3)),
        (Pitchfork(0.2), truth.pitchfork.turning_points(0.2)),
        (Pitchfork(-0.2), truth.pitchfork.turning_points(-0.2)),
        (FreudensteinRoth(), truth.freudenstein_roth.turning_points()),
        (ExponentialCosine(3), truth.exponential_cosine.turning_points(3)),
        (ExponentialCosine(8), truth.exponential_cosine.turning_points(8)),
        *((Aircraft(e), truth.aircraft.limit_points(e)) for e in truth.aircraft.ELEVATORS),
        *((Aircraft(e), truth.aircraft.limit_points(e, "rising")) for e in truth.aircraft.ELEVATORS),
    ],
    ids=lambda value: repr(value) if not isinstance(value, np.ndarray) else "",
)
def test_turning_points_are_folds(problem, rows):
    # On the path, H_y singular, and (H_y, H_lam) regular: a fold, not a branch point.
    assert len(rows) > 0
    for row in rows:
        whole = full_jacobian(problem, row)
        scale = 1 + np.abs(whole).max()
        assert np.abs(residual_at(problem, row)).max() <= 1e-14 * scale * (1 + np.abs(row).max())
        assert smallest_singular_value(whole[:, :-1]) <= 1e-12 * scale
        assert smallest_singular_value(whole) > 1e-3


def test_cusp_folds_as_published():
    folds = truth.cusp.turning_points(1.0)
    np.testing.assert_allclose(folds[:, 0], [-1 / np.sqrt(3), 1 / np.sqrt(3)], rtol=1e-15)
    np.testing.assert_allclose(folds[:, 1], [0.3849001794597505, -0.3849001794597505], rtol=1e-15)
    assert truth.cusp.turning_points(-1.0).shape == (0, 2)


@pytest.mark.parametrize("splitting", [-2.0, 0.0, 1.0, 9.0])
def test_cusp_starts_before_both_folds_and_ends_after_them(splitting):
    cusp = Cusp(splitting)
    y, mu = cusp.start()
    assert cusp.target == -mu
    assert all(y[0] < x for x, _ in truth.cusp.turning_points(splitting))


def test_pitchfork_meets_its_branch_point_only_when_perfect():
    x, lam = truth.pitchfork.BRANCH_POINT
    row = np.array([x, lam])
    assert not full_jacobian(Pitchfork(), row).any()
    assert residual_at(Pitchfork(), row) == 0.0
    assert residual_at(Pitchfork(1e-3), row) == 1e-3
    assert Pitchfork(1e-3).start()[0][0] > 0 > truth.pitchfork.turning_points(1e-3)[0, 0]


def test_freudenstein_roth_limit_points_as_published():
    in_x1 = [
        [14.28309125009385, -1.741376892197492, 0.258577871376728],
        [61.66936258114785, 1.983801134621735, -0.663879742243337],
    ]
    in_lam = [
        [20.48585782792345, -0.896805253274477, 0.587587325408120],
        [61.02031501158272, 2.230138586607810, -0.686352757506886],
    ]
    np.testing.assert_allclose(truth.freudenstein_roth.limit_points("x1"), in_x1, rtol=3e-15)
    np.testing.assert_allclose(truth.freudenstein_roth.turning_points(), in_lam, rtol=3e-15)
    np.testing.assert_allclose(
        truth.freudenstein_roth.curve(np.array([-2.0, 4.0])), [[15, -2, 0], [5, 4, 1]], atol=1e-14
    )


def test_bratu_fold_of_the_continuum_as_published():
    theta, lam, max_u = truth.bratu.continuum_fold_1d()
    assert lam == pytest.approx(3.513830719125161, rel=1e-15)
    assert max_u == pytest.approx(1.186842168634389, rel=1e-15)
    assert truth.bratu.parameter_1d(theta) == pytest.approx(lam, rel=1e-15)
    assert truth.bratu.solution_1d(np.array(0.5), theta) == pytest.approx(max_u, rel=1e-15)
    # A maximum of lam(theta): one bit lower on both sides of a step of 1e-4.
    assert (truth.bratu.parameter_1d(theta + np.array([-1e-4, 1e-4])) < lam).all()


@pytest.mark.parametrize("theta", [0.5, 3.0, 4.798714561030935, 9.0])
def test_bratu_solution_satisfies_the_differential_equation(theta):
    # Differences of second order: halving h divides their error by 4.
    errors = []
    for n in (49, 99):
        x = np.arange(1, n + 1) / (n + 1)
        problem = Bratu1D(n)
        defect = problem.residual(truth.bratu.solution_1d(x, theta), float(truth.bratu.parameter_1d(theta)))
        errors.append(np.abs(defect).max() * (n + 1) ** 2)
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.02)
    assert truth.bratu.solution_1d(np.array([0.0, 1.0]), theta) == pytest.approx([0.0, 0.0], abs=1e-14)


EXPONENTIAL_COSINE = [
    (2, 1.475020783911128, 1.1003509626909, 0), (3, 3.333951466487999, 0.37472756109156, 4),
    (4, 3.669146409693785, 0.42145547339476, 4), (5, 5.192877706525616, 1.5875828159969, 10),
    (6, 5.474761931954080, 1.9949909313114, 12), (7, 6.810433708600244, 2.3730945655736, 18),
    (8, 9.021601893584298, 0.39859096762391, 24),
]  # fmt: skip


@pytest.mark.parametrize(("n", "S", "x1", "turns"), EXPONENTIAL_COSINE)
def test_exponential_cosine_as_published(n, S, x1, turns):
    exact = truth.exponential_cosine
    end = exact.end(n)
    assert end == pytest.approx(S, rel=1e-15)
    row = exact.curve(n, end)
    assert row[0] == pytest.approx(x1, rel=3e-14)
    assert row[-1] == pytest.approx(1.0, abs=1e-14)
    assert row[:-1].sum() == pytest.approx(end, rel=1e-14)
    assert exact.turning_points(n).shape == (turns, n + 1)


def test_aircraft_without_an_equilibrium_near_level_flight_says_so(monkeypatch):
    monkeypatch.setattr("problems.bifurcation.aircraft._NEWTON_STEPS", 1)
    with pytest.raises(ArithmeticError, match=r"elevator = 0\.1: no equilibrium at aileron 0"):
        Aircraft(elevator=0.1).start()
