"""What cannot go well ends with the status that says why, and without a warning."""

import math

import numpy as np
import pytest
from scipy.sparse.linalg import LinearOperator

from continuation import Budget, Kind, Status, TargetValue, Tracer, from_functions, trace
from continuation.controllers import Fixed
from continuation.evaluation.evaluator import EvaluationError
from continuation.evaluation.jacobian_check import check_jacobian
from continuation.predictors import Tangent
from continuation.rejection import Rejection
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


def scalar(residual, slope=None, start=(0.0, 0.0), target=1.0):
    """One equation, with (H_y, H_lam) by `slope`, or by the library."""
    jacobian = None
    if slope is not None:

        def jacobian(y, lam):
            by_y, by_lam = slope(y[0], lam)
            return np.array([[by_y]]), np.array([by_lam])

    return from_functions(residual, jacobian, start=([start[0]], start[1]), target=target)


# -- the start --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "homotopy",
    [
        scalar(lambda y, lam: y * y - lam * lam, lambda y, lam: (2.0 * y, -2.0 * lam)),
        scalar(lambda y, lam: y * y + lam * lam, lambda y, lam: (2.0 * y, 2.0 * lam)),
        scalar(lambda y, lam: 0.0 * y, lambda y, lam: (0.0, 0.0)),
        from_functions(
            lambda y, lam: np.array([y[0] + y[1] - lam, 2.0 * (y[0] + y[1] - lam)]), start=([0.0, 0.0], 0.0), target=1.0
        ),
    ],
    ids=["crossing", "isolated", "nothing", "dependent rows"],
)
def test_a_singular_start(homotopy):
    path = trace(homotopy)
    assert path.status is Status.SINGULAR_START
    assert "start" in path.message
    assert len(path) == 0


def test_a_start_in_a_fold_is_regular():
    path = trace(scalar(lambda y, lam: y * y - lam, lambda y, lam: (2.0 * y, -1.0)))
    assert path.status is Status.REACHED_TARGET
    assert abs(path.endpoint.y[0]) == pytest.approx(1.0, abs=1e-10)


def test_a_start_near_the_path_is_brought_on_it():
    path = trace(scalar(lambda y, lam: y * y - 1.0 - lam, lambda y, lam: (2.0 * y, -1.0), start=(1.2, 0.0)))
    assert path.status is Status.REACHED_TARGET
    np.testing.assert_allclose(path.steps[0].u, (1.0, 0.0), rtol=0, atol=1e-8)


def test_a_start_far_from_any_path():
    path = trace(scalar(lambda y, lam: y * y + 1.0, lambda y, lam: (2.0 * y, 0.0), start=(1.0, 0.0)))
    assert path.status is Status.START_NOT_ON_PATH
    assert len(path) == 0


def test_a_start_without_a_value():
    path = trace(scalar(lambda y, lam: y * np.nan, lambda y, lam: (1.0, 0.0)))
    assert path.status is Status.START_NOT_ON_PATH
    assert "not finite" in path.message


def test_a_start_on_the_target_is_the_end():
    path = trace(scalar(lambda y, lam: y - lam, lambda y, lam: (1.0, -1.0), target=0.0))
    assert path.status is Status.REACHED_TARGET
    assert path.endpoint.u == pytest.approx([0.0, 0.0], abs=1e-12)


# -- the end ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("start", [(1.0, 1.0), (3.0, 9.0), (-1.0, 1.0)])
def test_a_fold_at_the_target(start):
    path = trace(scalar(lambda y, lam: y * y - lam, lambda y, lam: (2.0 * y, -1.0), start=start, target=0.0))
    assert path.status is Status.REACHED_TARGET
    np.testing.assert_allclose(path.endpoint.u, 0.0, rtol=0, atol=1e-7)


def test_a_fold_just_before_the_target_is_no_end():
    homotopy = scalar(lambda y, lam: y * y - lam, lambda y, lam: (2.0 * y, -1.0), start=(1.0, 1.0), target=-1e-3)
    path = trace(homotopy, budget=Budget(steps=50))
    # It turns in the fold, a thousandth before the target, and runs off on the other side.
    assert path.status is Status.DIVERGED
    (fold,) = path.turning_points
    np.testing.assert_allclose(fold.u, 0.0, rtol=0, atol=1e-12)
    assert path.lam.min() >= 0.0
    assert path.endpoint.y[0] < -1.0


@pytest.mark.parametrize("target", [1e-3, 1e-6, 1e-10])
def test_a_fold_just_behind_the_target(target):
    homotopy = scalar(lambda y, lam: y * y - lam, lambda y, lam: (2.0 * y, -1.0), start=(1.0, 1.0), target=target)
    path = trace(homotopy)
    assert path.status is Status.REACHED_TARGET
    assert path.endpoint.lam == target
    assert path.endpoint.y[0] == pytest.approx(np.sqrt(target), rel=1e-6)


@pytest.mark.parametrize("power", [3, 5])
def test_an_inflection_at_the_target(power):
    homotopy = scalar(
        lambda y, lam: y**power - lam, lambda y, lam: (power * y ** (power - 1), -1.0), start=(1.0, 1.0), target=0.0
    )
    path = trace(homotopy)
    assert path.status is Status.REACHED_TARGET
    assert path.endpoint.lam == 0.0
    # Of multiplicity p: an error of round-off in lam is one of its p-th root in y.
    assert abs(path.endpoint.y[0]) <= 10.0 * np.finfo(float).eps ** (1.0 / power)
    assert path.turning_points == []


def test_through_an_inflection():
    homotopy = scalar(lambda y, lam: y**3 - lam, lambda y, lam: (3.0 * y * y, -1.0), start=(1.0, 1.0), target=-1.0)
    path = trace(homotopy)
    assert path.status is Status.REACHED_TARGET
    assert path.endpoint.y[0] == pytest.approx(-1.0, abs=1e-9)
    assert path.events == []


# -- on the way -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("homotopy", "kink"),
    [
        (scalar(lambda y, lam: np.abs(y) - lam, start=(1.0, 1.0), target=-0.5), (0.0, 0.0)),
        (
            scalar(lambda y, lam: np.abs(y) - lam, lambda y, lam: (np.sign(y), -1.0), start=(1.0, 1.0), target=-0.5),
            (0.0, 0.0),
        ),
        (scalar(lambda y, lam: y - 5.0 * np.maximum(0.0, lam - 0.3), start=(0.0, 0.0)), (0.0, 0.3)),
    ],
    ids=["abs", "abs with derivative", "kink"],
)
def test_a_path_ends_at_a_kink_and_says_so(homotopy, kink):
    path = trace(homotopy)
    assert path.status is Status.STEP_TOO_SMALL
    np.testing.assert_allclose(path.endpoint.u, kink, rtol=0, atol=1e-8)
    assert path.events == []
    # The attempts that failed there, the last of which the message names.
    assert path.rejected
    assert str(path.rejected[-1]) in path.message
    # What was accepted lies on the path.
    for step in path.steps:
        assert np.abs(homotopy.residual(step.y, step.lam)).max() <= 1e-8


def test_a_residual_that_turns_nan():
    homotopy = from_functions(
        lambda y, lam: y - lam if lam < 0.5 else y * np.nan,
        lambda y, lam: (np.eye(1), -np.ones(1)),
        start=([0.0], 0.0),
        target=1.0,
    )
    path = trace(homotopy)
    assert path.status is Status.LEFT_DOMAIN
    assert path.endpoint.lam == pytest.approx(0.5, abs=1e-8)
    assert "not finite" in path.message


def test_a_jacobian_that_turns_nan():
    homotopy = from_functions(
        lambda y, lam: y - lam,
        lambda y, lam: (np.eye(1) if lam < 0.5 else np.full((1, 1), np.nan), -np.ones(1)),
        start=([0.0], 0.0),
        target=1.0,
    )
    path = trace(homotopy)
    assert path.status is Status.LEFT_DOMAIN
    assert path.endpoint.lam <= 0.5


@pytest.mark.parametrize("target", [-1.0, 0.0])
def test_the_edge_of_the_domain(target):
    # Beyond lam = 0 there is no square root; H_lam is infinite on the edge itself.
    def slope(y, lam):
        with np.errstate(all="ignore"):
            return 1.0, -0.5 / np.sqrt(lam)

    def residual(y, lam):
        with np.errstate(all="ignore"):
            return y - np.sqrt(lam)

    path = trace(scalar(residual, slope, start=(1.0, 1.0), target=target))
    if target == 0.0 and path.status is Status.REACHED_TARGET:
        np.testing.assert_allclose(path.endpoint.u, 0.0, rtol=0, atol=1e-6)
    else:
        assert path.status is Status.LEFT_DOMAIN
        assert 0.0 <= path.endpoint.lam <= 1e-8


@pytest.mark.parametrize(
    ("residual", "status"),
    [
        (lambda y, lam: y - np.sqrt(1.0 - lam), Status.LEFT_DOMAIN),
        (lambda y, lam: y + np.log(1.0 - lam), Status.LEFT_DOMAIN),
        (lambda y, lam: np.array([y[0] - math.sqrt(1.0 - float(np.real(lam)))]), Status.LEFT_DOMAIN),
    ],
    ids=["sqrt", "log", "math.sqrt"],
)
def test_the_edge_of_the_domain_without_a_derivative_and_without_a_warning(residual, status):
    y0 = -residual(np.zeros(1), 0.0)
    path = trace(from_functions(residual, start=(y0, 0.0), target=2.0), budget=Budget(steps=300))
    assert path.status is status
    assert 1.0 - 1e-4 <= path.endpoint.lam <= 1.0 + 1e-12
    assert any(attempt.reason is Rejection.NO_VALUE for attempt in path.rejected)


def test_overflow_in_a_residual_makes_no_noise():
    homotopy = from_functions(lambda y, lam: np.sinh(y) - lam, start=([0.0], 0.0), target=1e6)
    path = trace(homotopy)
    assert path.status is Status.REACHED_TARGET
    assert path.endpoint.y[0] == pytest.approx(np.arcsinh(1e6), abs=1e-5)


def test_an_exception_of_the_plug_in_is_its_own_and_the_path_is_kept():
    def residual(y, lam):
        if lam > 0.5:
            raise KeyError("a table ends here")
        return y - lam

    homotopy = from_functions(residual, lambda y, lam: (np.eye(1), -np.ones(1)), start=([0.0], 0.0), target=1.0)
    tracer = Tracer(homotopy)
    with pytest.raises(KeyError, match="a table ends here"):
        for _ in tracer:
            pass
    assert tracer.path.status is Status.INTERRUPTED
    assert len(tracer.path) > 1


class CurveUntil(Tangent):
    """Tangents up to a parameter value, and nothing beyond."""

    def prepare(self, evaluator, point, history):
        if point.lam > 0.2:
            raise EvaluationError("there is no curve")
        return super().prepare(evaluator, point, history)


def test_a_predictor_that_fails_is_named_and_no_step_is_blamed():
    path = trace(scalar(lambda y, lam: y - lam, lambda y, lam: (1.0, -1.0)), predictor=CurveUntil())
    assert path.status is Status.PREDICTOR_FAILED
    assert path.message.endswith("It says: there is no curve.")
    assert path.endpoint.lam > 0.2
    assert path.rejected == ()


# -- runs away, turns back, closes ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "homotopy",
    [
        scalar(lambda y, lam: lam * y - 1.0, lambda y, lam: (lam, y), start=(1.0, 1.0), target=0.0),
        scalar(
            lambda y, lam: y * np.cos(lam) - np.sin(lam),
            lambda y, lam: (np.cos(lam), -y * np.sin(lam) - np.cos(lam)),
            target=2.0,
        ),
        scalar(lambda y, lam: np.arctan(y) - lam, lambda y, lam: (1.0 / (1.0 + y * y), -1.0), target=2.0),
    ],
    ids=["1/lam", "tan", "arctan"],
)
def test_divergence(homotopy):
    path = trace(homotopy)
    assert path.status is Status.DIVERGED
    assert abs(path.endpoint.y[0]) > 1e3
    assert len(path) < 200


@pytest.mark.parametrize("n", [1, 3])
def test_growth_with_the_parameter_is_not_divergence(n):
    homotopy = from_functions(lambda y, lam: y - lam**2 * np.arange(1.0, n + 1), start=(np.zeros(n), 0.0), target=1e5)
    assert trace(homotopy).status is Status.REACHED_TARGET


def test_a_closed_curve_that_starts_anywhere():
    for angle in (0.3, 2.0, 4.0):
        start = (math.cos(angle), math.sin(angle))
        path = trace(scalar(Circle().residual, lambda y, lam: (2.0 * y, 2.0 * lam), start=start, target=None))
        assert path.status is Status.CLOSED
        np.testing.assert_allclose(path.endpoint.u, start, rtol=0, atol=1e-9)


def test_a_figure_of_eight_closes_after_both_loops():
    # Gerono's lemniscate lam^4 = lam^2 - y^2 crosses itself in the origin: not closed before the second passage.
    homotopy = scalar(
        lambda y, lam: lam**4 - lam**2 + y * y,
        lambda y, lam: (2.0 * y, 4.0 * lam**3 - 2.0 * lam),
        start=(0.0, 1.0),
        target=None,
    )
    path = trace(homotopy)
    assert path.status is Status.CLOSED
    np.testing.assert_allclose(path.endpoint.u, (0.0, 1.0), rtol=0, atol=1e-9)
    crossings = [event for event in path.events if event.kind == Kind.BRANCH_POINT]
    assert len(crossings) == 2
    assert path.lam.min() < -0.9


class Inside(Circle):
    """The circle as an interior path: |y| <= 2 always holds, the target is never reached."""

    target = 2.0

    def max_step(self, u, v):
        return np.inf if v[0] == 0.0 else float((2.0 - np.sign(v[0]) * u[0]) / abs(v[0]))


def test_an_interior_path_that_comes_back_to_its_start_value():
    path = trace(Inside())
    assert path.status is Status.TURNED_BACK
    np.testing.assert_allclose(path.endpoint.u, (-1.0, 0.0), rtol=0, atol=1e-9)


# -- budgets and interruption -----------------------------------------------------------------------------------


def test_a_budget_of_steps():
    path = trace(Circle(), budget=Budget(steps=5))
    assert path.status is Status.BUDGET_EXHAUSTED
    assert path.counts.accepted == 5
    assert "5 steps" in path.message


def test_a_budget_of_factorisations():
    path = trace(FreudensteinRoth(), budget=Budget(factorizations=20))
    assert path.status is Status.BUDGET_EXHAUSTED
    # It is looked at between attempts.
    assert 20 <= path.counts.factorizations < 35


def test_a_budget_of_seconds():
    path = trace(Circle(), budget=Budget(seconds=1e-9))
    assert path.status is Status.BUDGET_EXHAUSTED
    assert "seconds" in path.message


def test_a_budget_also_ends_a_step_that_keeps_failing():
    homotopy = from_functions(
        lambda y, lam: y - lam if lam < 0.5 else y * np.nan,
        lambda y, lam: (np.eye(1), -np.ones(1)),
        start=([0.0], 0.0),
        target=1.0,
    )
    path = trace(homotopy, controller=Fixed(), budget=Budget(factorizations=15))
    assert path.status in (Status.BUDGET_EXHAUSTED, Status.LEFT_DOMAIN)


class Interrupted(Cusp):
    """Ctrl-C is pressed at the k-th residual."""

    def __init__(self, k):
        super().__init__()
        object.__setattr__(self, "left", [k])

    def residual(self, y, lam):
        self.left[0] -= 1
        if self.left[0] == 0:
            raise KeyboardInterrupt
        return super().residual(y, lam)


@pytest.mark.parametrize("k", range(2, 100))
def test_ctrl_c_loses_nothing(k):
    whole = trace(Cusp())
    tracer = Tracer(Interrupted(k))
    for _ in tracer:
        pass
    path = tracer.path
    assert path.status is Status.INTERRUPTED
    np.testing.assert_array_equal(path.u, whole.u[: len(path)] if len(path) else path.u)
    if tracer.state is not None:
        rest = trace(Cusp(), state=tracer.state)
        assert rest.status is Status.REACHED_TARGET
        np.testing.assert_array_equal(rest.u, whole.u[len(path) :])
        assert len(path.events) + len(rest.events) == len(whole.events)


# -- derivatives ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "slope",
    [
        lambda y, lam: (3.0 * y * y + 5.0, -1.0),
        lambda y, lam: (-3.0 * y * y - 1.0, -1.0),
        lambda y, lam: (3.0 * y * y + 1.0, 1.0),
    ],
    ids=["too large", "sign of H_y", "sign of H_lam"],
)
def test_a_wrong_jacobian_gives_no_wrong_point(slope):
    homotopy = scalar(lambda y, lam: y**3 + y - lam, slope)
    path = trace(homotopy)
    for step in path.steps:
        assert np.abs(homotopy.residual(step.y, step.lam)).max() <= 1e-6
    assert not check_jacobian(homotopy).correct


def test_a_homotopy_that_does_not_depend_on_the_parameter():
    for slope in (None, lambda y, lam: (1.0, 0.0)):
        path = trace(scalar(lambda y, lam: y - 1.0, slope, start=(1.0, 0.0)))
        assert path.status is Status.REACHED_TARGET
        np.testing.assert_allclose(path.endpoint.u, (1.0, 1.0), rtol=0, atol=1e-12)
        assert path.events == []


def filled(y, lam):
    """A residual that fills an array of floats, on which complex numbers and jets fail."""
    r = np.empty(2)
    r[0] = y[0] - lam
    r[1] = y[1] - math.exp(y[0])
    return r


@pytest.mark.parametrize(
    "residual",
    [
        filled,
        lambda y, lam: np.array([y[0] - lam, y[1] - np.exp(np.real(y[0]))]),
        lambda y, lam: np.array([y[0] - lam, y[1] - np.exp(y[0])]),
    ],
    ids=["filled", "real part", "plain"],
)
def test_derivatives_from_any_residual(residual):
    path = trace(from_functions(residual, start=([0.0, 1.0], 0.0), target=1.0))
    assert path.status is Status.REACHED_TARGET
    np.testing.assert_allclose(path.endpoint.u, (1.0, np.e, 1.0), rtol=0, atol=1e-9)


def test_derivatives_from_residuals_are_paid_for_in_residuals():
    calls = 0

    def residual(y, lam):
        nonlocal calls
        calls += 1
        return filled(y, lam)

    path = trace(from_functions(residual, start=([0.0, 1.0], 0.0), target=1.0))
    # Choosing the way costs a few residuals more, once.
    assert path.counts.residuals <= calls <= path.counts.residuals + 20
    assert path.counts.residuals >= 6 * path.counts.factorizations


def test_an_operator_without_a_determinant():
    n = 30

    def jacobian(y, lam):
        return LinearOperator((n, n), matvec=lambda v: (1.0 + 0.3 * np.cos(y)) * v, dtype=float), -np.ones(n)

    homotopy = from_functions(lambda y, lam: y + 0.3 * np.sin(y) - lam, jacobian, start=(np.zeros(n), 0.0), target=1.0)
    path = trace(homotopy)
    assert path.status is Status.REACHED_TARGET
    y = path.endpoint.y
    np.testing.assert_allclose(y + 0.3 * np.sin(y), 1.0, rtol=0, atol=1e-9)
    assert {step.orientation for step in path.steps} == {0}


# -- the check of the Jacobian ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "homotopy",
    [Circle(), Cusp(), Pitchfork(0.1), FreudensteinRoth(), Bratu1D(300), Bratu2D(20), ExponentialCosine(6), Aircraft()],
    ids=lambda homotopy: type(homotopy).__name__,
)
def test_right_jacobians_pass(homotopy):
    report = check_jacobian(homotopy)
    assert report.correct
    assert report.source == "jets"


class Spoiled(ExponentialCosine):
    """One entry of [H_y, H_lam] is wrong."""

    def __init__(self, row, column, by):
        super().__init__(6)
        object.__setattr__(self, "spoil", (row, column, by))

    def jacobian(self, y, lam):
        row, column, by = self.spoil
        whole = np.column_stack(super().jacobian(y, lam))
        whole[row, column] += by
        return whole[:, :-1], whole[:, -1]


@pytest.mark.parametrize("by", [1.0, -1e-4])
@pytest.mark.parametrize("row", [0, 3, 5])
@pytest.mark.parametrize("column", range(7))
def test_a_wrong_entry_is_found(row, column, by):
    report = check_jacobian(Spoiled(row, column, by))
    assert not report.correct
    assert (report.row, report.column) == (row, column)
    assert report.found - report.expected == pytest.approx(by, abs=1e-7)
    assert ("H_lam[" if column == 6 else f"H_y[{row}, {column}]") in str(report)


def test_a_wrong_entry_that_the_start_hides():
    # At the start y = 0, so the missing 2 in the derivative of y^2 is not to be seen.
    homotopy = scalar(lambda y, lam: y + y * y - lam, lambda y, lam: (1.0 + y, -1.0))
    assert not check_jacobian(homotopy).correct
    assert check_jacobian(homotopy, np.zeros(2)).correct
    assert check_jacobian(homotopy, np.array([0.5, 0.0])).found == pytest.approx(1.5)


def test_a_nan_in_the_jacobian_is_found():
    report = check_jacobian(Spoiled(2, 1, np.nan))
    assert not report.correct
    assert report.row == 2


def test_a_sparse_jacobian_of_many_unknowns_is_checked():
    class Wrong(Bratu2D):
        def jacobian(self, y, lam):
            H_y, H_lam = super().jacobian(y, lam)
            H_y[1234, 1235] = 1.5
            return H_y, H_lam

    report = check_jacobian(Wrong(70))
    assert (report.row, report.column) == (1234, 1235)
    assert (report.found, report.expected) == pytest.approx((1.5, 1.0))


def test_differences_serve_where_nothing_better_does():
    def jacobian(y, lam):
        return np.array([[1.0, 0.0], [-np.exp(y[0]), 1.0]]), np.array([-1.0, 0.0])

    report = check_jacobian(from_functions(filled, jacobian, start=([0.0, 1.0], 0.0)))
    assert report.correct
    assert report.source == "differences"


def test_what_cannot_be_checked_is_refused():
    with pytest.raises(TypeError, match="jacobian"):
        check_jacobian(from_functions(lambda y, lam: y - lam, start=([0.0], 0.0)))
    with pytest.raises(ValueError, match="u: expected shape"):
        check_jacobian(Circle(), np.zeros(5))
    with pytest.raises(ValueError, match="u: "):
        check_jacobian(scalar(lambda y, lam: y * np.nan, lambda y, lam: (1.0, 0.0)), np.zeros(2))


def test_the_check_on_request_refuses_a_wrong_jacobian():
    assert trace(ExponentialCosine(3), check_jacobian=True).status is Status.REACHED_TARGET
    with pytest.raises(ValueError, match=r"H_y\[0, 1\]"):
        trace(Spoiled(0, 1, 1.0), check_jacobian=True)


def test_an_end_at_once_when_the_event_is_reached():
    path = trace(Cusp(), events=[TargetValue(-1.0, component=0)])
    assert path.endpoint.y[0] == -1.0


def test_a_path_without_points_says_why():
    path = trace(scalar(lambda y, lam: np.array([1.0 + lam * lam])))
    assert not path.steps
    with pytest.raises(IndexError, match="no point"):
        _ = path.endpoint
