"""Correctors: where they land, what they cost, and how they fail."""

import numpy as np
import pytest

from continuation import Tolerance, from_functions
from continuation.correctors import BorderedNewton, MoorePenrose, NaturalParameter
from continuation.counts import Counts
from continuation.evaluation.evaluator import Evaluator
from continuation.point.linearization import linearize
from continuation.rejection import Rejection
from problems.bifurcation import Circle, ExponentialCosine
from tests.truth import exponential_cosine

CHORD = BorderedNewton(reuse=1.0, max_iterations=20)
CORRECTORS = [BorderedNewton(), BorderedNewton(reuse=0.0), CHORD, MoorePenrose(), NaturalParameter()]
every_corrector = pytest.mark.parametrize("corrector", CORRECTORS, ids=repr)
TOLERANCE = Tolerance(1e-10)


class Setting:
    """A point of the exponential-cosine path for n = 4 and a tangential prediction from it."""

    def __init__(self, h=0.05, homotopy=None, u=None):
        homotopy = homotopy if homotopy is not None else ExponentialCosine(4)
        self.evaluator = Evaluator(homotopy, Counts())
        u = u if u is not None else exponential_cosine.curve(4, 0.5)
        unit = np.zeros(u.size)
        unit[-1] = 1.0
        self.point = linearize(self.evaluator, u, np.ones(u.size), unit)
        self.predicted = self.point.u + h * self.point.tangent
        self.before = self.evaluator.counts.copy()

    def correct(self, corrector, tolerance=TOLERANCE):
        return corrector.correct(self.evaluator, self.point, self.predicted, self.point.border, tolerance)

    @property
    def factorizations(self):
        return self.evaluator.counts.factorizations - self.before.factorizations


@every_corrector
def test_it_lands_on_the_path(corrector):
    setting = Setting()
    correction = setting.correct(corrector)
    assert correction.converged
    S = correction.u[:-1].sum()
    np.testing.assert_allclose(correction.u, exponential_cosine.curve(4, S), rtol=0, atol=1e-9)
    assert correction.distance == pytest.approx(np.linalg.norm(correction.u - setting.predicted), rel=1e-12)
    actual = np.abs(setting.evaluator.residual(correction.u)).max()
    assert correction.residual_norm == actual


@every_corrector
def test_the_prediction_is_left_alone(corrector):
    setting = Setting()
    before = setting.predicted.copy()
    setting.correct(corrector)
    np.testing.assert_array_equal(setting.predicted, before)


@pytest.mark.parametrize("corrector", [BorderedNewton(), BorderedNewton(reuse=0.0), CHORD], ids=repr)
def test_kellers_kind_stays_in_the_plane(corrector):
    setting = Setting()
    moved = setting.correct(corrector).u - setting.predicted
    assert abs(np.dot(setting.point.border, moved)) <= 1e-13


def test_moore_penrose_lands_at_the_foot_of_the_perpendicular():
    setting = Setting()
    correction = setting.correct(MoorePenrose())
    end = linearize(setting.evaluator, correction.u, np.ones(5), setting.point.border)
    back = correction.u - setting.predicted
    # The angle between the way back and the path is a right one up to terms of the second order in the distance.
    cosine = np.dot(back, end.tangent) / np.linalg.norm(back)
    plane = np.dot(setting.correct(BorderedNewton()).u - setting.predicted, end.tangent) / np.linalg.norm(back)
    assert abs(cosine) < 0.2 * abs(plane)


def test_the_natural_parameter_is_kept():
    setting = Setting()
    assert setting.correct(NaturalParameter()).u[-1] == setting.predicted[-1]


def test_newton_factors_at_every_iterate():
    setting = Setting()
    correction = setting.correct(BorderedNewton(reuse=0.0))
    assert setting.factorizations == correction.iterations


def test_reuse_saves_factorisations():
    fresh, reused = Setting(), Setting()
    fresh.correct(BorderedNewton(reuse=0.0))
    reused.correct(BorderedNewton(reuse=0.5))
    assert reused.factorizations < fresh.factorizations


def test_a_reused_factorisation_may_serve_the_tangent():
    setting = Setting()
    assert setting.correct(BorderedNewton(reuse=0.5)).anchor is not None
    assert setting.correct(BorderedNewton(reuse=0.0)).anchor is None


def test_newton_is_quadratic_and_reuse_is_slower():
    tight = Tolerance(1e-13)
    assert Setting().correct(BorderedNewton(reuse=0.0), tight).iterations < Setting().correct(CHORD, tight).iterations


def test_the_contraction_is_the_largest_ratio_of_increments():
    # The derivative at hand is half of the true one, so each increment is minus the one before.
    homotopy = from_functions(
        lambda y, lam: 2.0 * y - lam**2, lambda y, lam: (np.eye(1), np.array([-2.0 * lam])), start=([0.0], 0.0)
    )
    setting = Setting(0.1, homotopy, np.zeros(2))
    correction = setting.correct(BorderedNewton(reuse=0.0, max_contraction=2.0))
    assert not correction.converged
    assert correction.contraction == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize("corrector", [c for c in CORRECTORS if not isinstance(c, MoorePenrose)], ids=repr)
def test_a_hopeless_prediction_is_given_up(corrector):
    setting = Setting(homotopy=Circle(), u=np.array([1.0, 0.0]))
    # No point of the circle lies in the plane through this, nor at its parameter.
    setting.predicted = np.array([1.0, 5.0])
    correction = setting.correct(corrector)
    assert correction.rejection in (Rejection.NOT_CONTRACTING, Rejection.NOT_CONVERGED)
    assert correction.rejected(0.1).h == 0.1


def test_the_normal_flow_needs_no_plane():
    setting = Setting(homotopy=Circle(), u=np.array([1.0, 0.0]))
    setting.predicted = np.array([1.0, 3.0])
    correction = setting.correct(MoorePenrose(max_contraction=1.0))
    assert correction.converged
    np.testing.assert_allclose(correction.u, np.array([1.0, 3.0]) / np.sqrt(10.0), rtol=0, atol=1e-9)


@every_corrector
def test_values_that_are_not_finite_end_the_attempt(corrector):
    homotopy = from_functions(
        lambda y, lam: y - lam**2 if lam < 0.5 else y * np.nan,
        lambda y, lam: (np.eye(1), np.array([-2.0 * lam])),
        start=([0.0], 0.0),
    )
    setting = Setting(0.6, homotopy, np.zeros(2))
    correction = setting.correct(corrector)
    assert correction.rejection is Rejection.NO_VALUE
    assert "finite" in correction.detail


@every_corrector
def test_the_residual_is_judged_where_a_bound_is_given(corrector):
    loose, strict = Tolerance(1e-2), Tolerance(1e-2, residual=1e-9)
    early, late = Setting().correct(corrector, loose), Setting().correct(corrector, strict)
    assert early.converged
    assert late.converged
    assert early.residual_norm > 1e-9 >= late.residual_norm
