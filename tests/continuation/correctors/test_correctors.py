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

CHORD, FRESH, NATURAL = BorderedNewton(reuse=1.0, max_iterations=20), BorderedNewton(reuse=0.0), NaturalParameter()
CORRECTORS = [BorderedNewton(), FRESH, CHORD, MoorePenrose(), NATURAL]
TOLERANCE = Tolerance(1e-10)
every_corrector = pytest.mark.parametrize("corrector", CORRECTORS, ids=repr)


class Setting:
    """A point of the exponential-cosine path for n = 4, or another, and a prediction, tangential unless given."""

    def __init__(self, h=0.05, homotopy=None, u=None, predicted=None):
        homotopy = homotopy if homotopy is not None else ExponentialCosine(4)
        self.evaluator = Evaluator(homotopy, Counts())
        u = u if u is not None else exponential_cosine.curve(4, 0.5)
        self.point = linearize(self.evaluator, u, np.ones(u.size), np.eye(u.size)[-1])
        self.predicted = self.point.u + h * self.point.tangent if predicted is None else predicted

    def correct(self, corrector, tolerance=TOLERANCE):
        before = self.evaluator.counts.factorizations
        correction = corrector.correct(self.evaluator, self.point, self.predicted, self.point.border, tolerance)
        self.factorizations = self.evaluator.counts.factorizations - before
        self.moved = correction.u - self.predicted
        return correction


@every_corrector
def test_it_lands_on_the_path_and_measures_the_way(corrector):
    setting = Setting()
    before = setting.predicted.copy()
    correction = setting.correct(corrector)
    assert correction.converged
    np.testing.assert_array_equal(setting.predicted, before)
    np.testing.assert_allclose(correction.u, exponential_cosine.curve(4, correction.u[:-1].sum()), rtol=0, atol=1e-9)
    assert correction.distance == pytest.approx(np.linalg.norm(setting.moved), rel=1e-12)
    assert correction.residual_norm == np.abs(setting.evaluator.residual(correction.u)).max()
    # Keller's kind stays in the plane, and that of the parameter keeps the parameter.
    across = np.eye(5)[-1] if corrector is NATURAL else setting.point.border
    within = {NATURAL: 0.0}.get(corrector, 1e-13)
    assert isinstance(corrector, MoorePenrose) or abs(across @ setting.moved) <= within


def test_moore_penrose_lands_at_the_foot_of_the_perpendicular():
    setting = Setting()
    correction = setting.correct(MoorePenrose())
    end = linearize(setting.evaluator, correction.u, np.ones(5), setting.point.border)
    foot = abs(setting.moved @ end.tangent)
    setting.correct(BorderedNewton())
    # The angle between the way back and the path is a right one up to terms of the second order in the distance.
    assert foot < 0.2 * abs(setting.moved @ end.tangent)
    # It needs no plane.
    far = Setting(homotopy=Circle(), u=np.array([1.0, 0.0]), predicted=np.array([1.0, 3.0]))
    found = far.correct(MoorePenrose(max_contraction=1.0)).u
    np.testing.assert_allclose(found, np.array([1.0, 3.0]) / np.sqrt(10.0), rtol=0, atol=1e-9)


def test_the_contraction_is_the_largest_ratio_of_increments():
    # The derivative at hand is half of the true one, so each increment is minus the one before.
    homotopy = from_functions(
        lambda y, lam: 2.0 * y - lam**2, lambda y, lam: (np.eye(1), np.array([-2.0 * lam])), start=([0.0], 0.0)
    )
    correction = Setting(0.1, homotopy, np.zeros(2)).correct(BorderedNewton(reuse=0.0, max_contraction=2.0))
    assert not correction.converged
    assert correction.contraction == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize("corrector", [c for c in CORRECTORS if not isinstance(c, MoorePenrose)], ids=repr)
def test_a_hopeless_prediction_is_given_up(corrector):
    # No point of the circle lies in the plane through this, nor at its parameter.
    setting = Setting(homotopy=Circle(), u=np.array([1.0, 0.0]), predicted=np.array([1.0, 5.0]))
    correction = setting.correct(corrector)
    assert correction.rejection in (Rejection.NOT_CONTRACTING, Rejection.NOT_CONVERGED)
    assert correction.rejected(0.1).h == 0.1


@every_corrector
def test_values_that_are_not_finite_end_the_attempt(corrector):
    homotopy = from_functions(
        lambda y, lam: y - lam**2 if lam < 0.5 else y * np.nan,
        lambda y, lam: (np.eye(1), np.array([-2.0 * lam])),
        start=([0.0], 0.0),
    )
    correction = Setting(0.6, homotopy, np.zeros(2)).correct(corrector)
    assert correction.rejection is Rejection.NO_VALUE
    assert "finite" in correction.detail


@every_corrector
def test_the_residual_is_judged_where_a_bound_is_given(corrector):
    early, late = (Setting().correct(corrector, Tolerance(1e-2, residual=bound)) for bound in (np.inf, 1e-9))
    assert early.converged
    assert late.converged
    assert early.residual_norm > 1e-9 >= late.residual_norm
