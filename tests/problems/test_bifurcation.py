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


def test_an_elevator_without_a_table_is_named():
    with pytest.raises(ValueError, match="elevator: expected one of"):
        truth.aircraft.limit_points(0.3)


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


def test_circle_length():
    rows = truth.circle.curve(np.linspace(0, truth.circle.ARCLENGTH, 10001))
    assert np.linalg.norm(np.diff(rows, axis=0), axis=1).sum() == pytest.approx(truth.circle.ARCLENGTH, rel=1e-7)
    np.testing.assert_allclose(rows[0], rows[-1], atol=1e-14)


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


def fold_by_moore_spence(problem, u, lam):
    """(u, lam) at the fold of a Bratu problem: H = 0, H_y v = 0, c.v = 1 (Moore and Spence, 1980)."""
    n = u.size
    H_y, _ = problem.jacobian(u, lam)
    v = np.linalg.eigh(dense(H_y))[1][:, -1]
    c = v.copy()
    for _ in range(8):
        H_y, slope = problem.jacobian(u, lam)
        H_y = dense(H_y)
        # H_lam = h^2 e^u is the nonlinear part, so it also gives the second derivatives.
        system = np.zeros((2 * n + 1, 2 * n + 1))
        system[:n, :n], system[:n, n] = H_y, slope
        system[n : 2 * n, :n], system[n : 2 * n, n] = np.diag(lam * slope * v), slope * v
        system[n : 2 * n, n + 1 :], system[2 * n, n + 1 :] = H_y, c
        defect = np.concatenate((problem.residual(u, lam), H_y @ v, [c @ v - 1.0]))
        step = np.linalg.solve(system, defect)
        u, lam, v = u - step[:n], lam - step[n], v - step[n + 1 :]
    assert np.abs(step).max() < 1e-10
    return u, lam


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


@pytest.mark.parametrize("n", [100, 200])
def test_bratu_1d_fold_table(n):
    theta, lam, _ = truth.bratu.continuum_fold_1d()
    u, lam = fold_by_moore_spence(Bratu1D(n), truth.bratu.solution_1d(np.arange(1, n + 1) / (n + 1), theta), lam)
    expected_lam, expected_max = truth.bratu.FOLD_1D[n]
    assert lam == pytest.approx(expected_lam, abs=1e-12)
    assert u.max() == pytest.approx(expected_max, abs=1e-11)
    assert Bratu1D(n).observe(u, lam) == {"max_u": u.max()}


def test_bratu_1d_fold_converges_at_the_published_rate():
    _, lam, _ = truth.bratu.continuum_fold_1d()
    for n, (fold, _) in truth.bratu.FOLD_1D.items():
        assert (lam - fold) * (n + 1) ** 2 == pytest.approx(truth.bratu.FOLD_ERROR_1D, abs=1e-4)


@pytest.mark.parametrize("m", [10, 20])
def test_bratu_2d_fold_table(m):
    sine = np.sin(np.pi * np.arange(1, m + 1) / (m + 1))
    _, lam = fold_by_moore_spence(Bratu2D(m), 1.39 * np.outer(sine, sine).ravel(), 6.8)
    assert lam == pytest.approx(truth.bratu.FOLD_2D[m], abs=1e-12)


def test_bratu_2d_fold_table_converges_to_the_continuum():
    # lam* - lam*_m = 1.5016 h^2 + 5.57 h^4 + ...: each entry lies on this curve through the finest one.
    square = {m: 1.0 / (m + 1.0) ** 2 for m in truth.bratu.FOLD_2D}
    error = {m: truth.bratu.CONTINUUM_FOLD_2D - fold for m, fold in truth.bratu.FOLD_2D.items()}
    leading = error[100] / square[100]
    for m in (10, 20, 30, 50):
        assert (error[m] / square[m] - leading) / (square[m] - square[100]) == pytest.approx(5.57, abs=0.04)


EXPONENTIAL_COSINE = [
    (2, 1.475020783911128, 1.1003509626909, 1.6199408163807, 0, 1.6),
    (3, 3.333951466487999, 0.37472756109156, 5.1124703543198, 4, 13),
    (4, 3.669146409693785, 0.42145547339476, 6.5195070281339, 4, 33),
    (5, 5.192877706525616, 1.5875828159969, 14.828190064503, 10, 44),
    (6, 5.474761931954080, 1.9949909313114, 17.260258578309, 12, 87),
    (7, 6.810433708600244, 2.3730945655736, 24.433767691728, 18, 271),
    (8, 9.021601893584298, 0.39859096762391, 48.712616148201, 24, 374),
]


@pytest.mark.parametrize(("n", "S", "x1", "arclength", "turns", "curvature"), EXPONENTIAL_COSINE)
def test_exponential_cosine_as_published(n, S, x1, arclength, turns, curvature):
    exact = truth.exponential_cosine
    end = exact.end(n)
    assert end == pytest.approx(S, rel=1e-15)
    row = exact.curve(n, end)
    assert row[0] == pytest.approx(x1, rel=3e-14)
    assert row[-1] == pytest.approx(1.0, abs=1e-14)
    assert row[:-1].sum() == pytest.approx(end, rel=1e-14)
    assert exact.arclength(n) == pytest.approx(arclength, rel=5e-14)
    assert exact.turning_points(n).shape == (turns, n + 1)
    assert exact.curvature(n, np.linspace(0, end, 100001)).max() == pytest.approx(curvature, rel=0.02)


def test_exponential_cosine_curvature_is_that_of_the_curve():
    # By differences of the curve itself, at a point of moderate curvature.
    S, h = 2.0, 1e-4
    behind, here, ahead = truth.exponential_cosine.curve(3, np.array([S - h, S, S + h]))
    u1, u2 = (ahead - behind) / (2 * h), (ahead - 2 * here + behind) / h**2
    area = np.sqrt((u1 @ u1) * (u2 @ u2) - (u1 @ u2) ** 2)
    assert truth.exponential_cosine.curvature(3, S) == pytest.approx(area / np.linalg.norm(u1) ** 3, rel=1e-5)


def test_aircraft_without_an_equilibrium_near_level_flight_says_so(monkeypatch):
    monkeypatch.setattr("problems.bifurcation.aircraft._NEWTON_STEPS", 1)
    with pytest.raises(ArithmeticError, match=r"elevator = 0\.1: no equilibrium at aileron 0"):
        Aircraft(elevator=0.1).start()
