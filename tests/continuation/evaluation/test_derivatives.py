"""Derivatives: from any residual, by jets, complex steps or differences; and the check of those that are given."""

import math

import numpy as np
import pytest

from continuation import Budget, Status, from_functions, trace
from continuation.evaluation.derivatives import from_residual
from continuation.evaluation.jacobian_check import check_jacobian
from continuation.evaluation.products import BY_JETS, by_differences, exact
from problems.bifurcation import Bratu1D, Bratu2D, Circle, ExponentialCosine, FreudensteinRoth

from ...util import path_of
from ..util import scalar


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
    path = trace(homotopy, budget=Budget(steps=20))
    assert max(step.residual_norm for step in path.steps) <= 1e-6
    assert not check_jacobian(homotopy).correct


def filled(y, lam):
    """A residual that fills an array of floats, on which complex numbers and jets fail."""
    r = np.empty(2)
    r[:] = y[0] - lam, y[1] - math.exp(y[0])
    return r


@pytest.mark.parametrize(
    "function",
    [
        filled,
        lambda y, lam: np.array([y[0] - lam, y[1] - np.exp(np.real(y[0]))]),
        lambda y, lam: np.array([y[0] - lam, y[1] - np.exp(y[0])]),
    ],
    ids=["filled", "real part", "plain"],
)
def test_derivatives_from_any_residual_are_paid_for_in_residuals(function):
    calls = []

    def residual(y, lam):
        calls.append(lam)
        return function(y, lam)

    path = path_of(from_functions(residual, start=([0.0, 1.0], 0.0), target=1.0))
    np.testing.assert_allclose(path.endpoint.u, (1.0, np.e, 1.0), rtol=0, atol=1e-9)
    # Choosing the way costs a few residuals more, once.
    assert path.counts.residuals <= len(calls) <= path.counts.residuals + 20
    assert path.counts.residuals >= (6 if function is filled else 1) * path.counts.factorizations


def test_no_row_in_large_units_hides_that_complex_steps_are_wrong_in_another():
    def residual(y, lam):
        return np.array([1e5 * (y[0] - lam), abs(np.real_if_close(y)[1]) - 1.0 - lam])

    H_y, _ = from_residual(residual, (np.array([0.3, 0.7]), 0.2))(np.array([0.3, 0.7]), 0.2)
    np.testing.assert_allclose(H_y, np.diag([1e5, 1.0]), rtol=1e-6, atol=1e-6)


def test_rows_that_stand_still_do_not_choose_the_step_at_which_exact_products_are_compared():
    # The first row settles where steps are 1e-12; there the second has round-off.
    def residual(y, lam):
        return np.stack([1e-28 * np.sin(1e11 * y[1]), 1.0 + y[0] - 3.0 * y[1], y[1] + 2.0 - lam])

    assert exact(residual, np.array([1.0, 0.0, 1.0]), np.array([1e-3, 1.0, 0.3])) is BY_JETS


@pytest.mark.parametrize("small", [1e-7, 1e-12, 1e-17, 1e-43])
def test_a_component_that_is_almost_zero_says_nothing_of_its_step(small):
    def residual(y, lam):
        a, b = (float(part) for part in y)
        return np.array([a * a + lam * lam - 1.0 + b, b * (lam - 1.5)])

    differences = by_differences(residual, np.array([1.0, small, 0.0]))
    found = differences.whole(residual, np.array([0.7, 0.1, 0.3]))
    np.testing.assert_allclose(found, [[1.4, 1.0, 0.6], [0.0, -1.2, 0.1]], atol=1e-8)


@pytest.mark.parametrize("small", [1e-8, 1e-12, 1e-310])
def test_a_component_that_begins_at_almost_zero_is_followed_far_from_it(small):
    """Its step is not relative to the first value where it has grown to one."""

    def residual(y, lam):
        a, b = (float(part) for part in y)
        return np.array([a - lam, b - 1.0 - np.sin(3.0 * a)])

    path_of(from_functions(residual, start=([small, 1.0], 0.0), target=1.0), budget=Budget(steps=40))


def spoiled(homotopy, row, column, by):
    """The same with one entry of [H_y, H_lam] wrong."""

    def jacobian(y, lam):
        parts = homotopy.jacobian(y, lam)
        place = (row,) if column == y.size else (row, column)
        parts[column == y.size][place] += by
        return parts

    return from_functions(homotopy.residual, jacobian, start=homotopy.start(), target=homotopy.target)


@pytest.mark.parametrize("by", [1.0, -1e-4, np.nan])
@pytest.mark.parametrize("row", [0, 3, 5])
@pytest.mark.parametrize("column", [0, 4, 6])
def test_a_wrong_entry_is_found(row, column, by):
    report = check_jacobian(spoiled(ExponentialCosine(6), row, column, by))
    assert not report.correct
    assert report.row == row
    # A NaN leaves no entry of its row.
    assert np.isnan(by) or report.column == column
    assert np.isnan(by) or report.found - report.expected == pytest.approx(by, abs=1e-7)
    assert np.isnan(by) or ("H_lam[" if column == 6 else f"H_y[{row}, {column}]") in str(report)


def test_a_wrong_entry_of_a_sparse_jacobian_is_found():
    report = check_jacobian(spoiled(Bratu2D(70), 1234, 1235, 0.5))
    assert (report.row, report.column) == (1234, 1235)
    assert (report.found, report.expected) == pytest.approx((1.5, 1.0))


def test_a_wrong_entry_that_the_start_hides():
    # At the start y = 0, so the missing 2 in the derivative of y^2 is not to be seen.
    homotopy = scalar(lambda y, lam: y + y * y - lam, lambda y, lam: (1.0 + y, -1.0))
    assert not check_jacobian(homotopy).correct
    assert check_jacobian(homotopy, np.zeros(2)).correct
    assert check_jacobian(homotopy, np.array([0.5, 0.0])).found == pytest.approx(1.5)


@pytest.mark.parametrize(
    ("homotopy", "source"),
    [
        *((homotopy, "jets") for homotopy in (FreudensteinRoth(), Bratu1D(300), Bratu2D(20))),
        (
            from_functions(
                filled,
                lambda y, lam: (np.array([[1.0, 0.0], [-np.exp(y[0]), 1.0]]), np.array([-1.0, 0.0])),
                start=([0.0, 1.0], 0.0),
            ),
            "differences",
        ),
    ],
)
def test_right_jacobians_pass_by_differences_where_nothing_better_serves(homotopy, source):
    report = check_jacobian(homotopy)
    assert (report.correct, report.source) == (True, source)


@pytest.mark.parametrize(
    ("homotopy", "u", "words"),
    [
        (from_functions(lambda y, lam: y - lam, start=([0.0], 0.0)), None, "jacobian"),
        (Circle(), np.zeros(5), "u: expected shape"),
        (scalar(lambda y, lam: y * np.nan, lambda y, lam: (1.0, 0.0)), np.zeros(2), "u: "),
    ],
)
def test_what_cannot_be_checked_is_refused(homotopy, u, words):
    with pytest.raises((TypeError, ValueError), match=words):
        check_jacobian(homotopy, u)


def test_the_check_on_request_refuses_a_wrong_jacobian():
    assert trace(ExponentialCosine(3), check_jacobian=True).status is Status.REACHED_TARGET
    with pytest.raises(ValueError, match=r"H_y\[0, 1\]"):
        trace(spoiled(ExponentialCosine(6), 0, 1, 1.0), check_jacobian=True)
