"""Predictors: the order of each, measured on a curve whose arclength is known, and what each costs."""

import numpy as np
import pytest
from scipy.optimize import brentq

from continuation import from_functions
from continuation.counts import Counts
from continuation.evaluation.evaluator import Evaluator
from continuation.point.linearization import linearize
from continuation.predictors import Hermite, Knot, Tangent

PREDICTORS = [Tangent(), Hermite()]
every_predictor = pytest.mark.parametrize("predictor", PREDICTORS, ids=repr)

PARABOLA = from_functions(
    lambda y, lam: y - lam**2, lambda y, lam: (np.eye(1), np.array([-2.0 * lam])), start=([0.0], 0.0), target=None
)
LINE = from_functions(lambda y, lam: y - 2.0 * lam, lambda y, lam: (np.eye(1), np.array([-2.0])), start=([0.0], 0.0))


def length(lam):
    """From 0 to lam along y = lam^2."""
    return 0.5 * lam * np.sqrt(1.0 + 4.0 * lam * lam) + 0.25 * np.arcsinh(2.0 * lam)


def knot(s):
    lam = brentq(lambda lam: length(lam) - s, -5.0, 5.0, xtol=1e-15)
    v = np.array([2.0 * lam, 1.0])
    return Knot(s, np.array([lam * lam, lam]), v / np.linalg.norm(v))


def error(predicted, here):
    """From the predicted point to the path, in the plane through it that is orthogonal to the tangent `here`."""
    sigma = here.tangent @ predicted
    lam = brentq(lambda lam: here.tangent @ (lam * lam, lam) - sigma, 0.0, 2.0, xtol=1e-15)
    return np.linalg.norm(predicted - (lam * lam, lam))


def prediction(predictor, history, homotopy=PARABOLA):
    """From the last knot; a prediction costs nothing."""
    evaluator, here = Evaluator(homotopy, Counts()), history[-1]
    point = linearize(evaluator, here.u, np.ones(2), here.tangent)
    ahead = predictor.prepare(evaluator, point, history)
    before = evaluator.counts.copy()
    ahead(0.1)
    assert evaluator.counts == before
    return ahead


def behind(h, make=knot):
    """Knots up to the arclength 0.4, after steps of unequal length, as a tracer makes them."""
    return [make(0.4 - back * h) for back in (3.9, 2.7, 1.2, 0.0)]


def order(predictor, history):
    """By two lengths of the step, and of those before."""
    errors = [error(prediction(predictor, history(h))(h), knot(0.4)) for h in (0.02, 0.01)]
    return np.log2(errors[0] / errors[1]) - 1.0


@every_predictor
def test_the_local_error_has_the_order_that_is_stated_and_the_first_step_is_tangent(predictor):
    assert order(predictor, lambda h: behind(h)[-max(predictor.memory, 1) :]) == pytest.approx(predictor.order, abs=0.3)
    assert order(predictor, lambda h: [knot(0.4)]) > 0.7
    assert prediction(predictor, [knot(0.4)]).reach > 0


@every_predictor
def test_it_starts_at_the_point_and_runs_ahead_at_unit_speed(predictor):
    ahead, here = prediction(predictor, behind(0.01)), knot(0.4)
    np.testing.assert_allclose(ahead(1e-14), here.u, rtol=0, atol=1e-13)
    assert np.linalg.norm(ahead(1e-4) - here.u) == pytest.approx(1e-4, rel=5e-3)
    assert (ahead(1e-4) - here.u) @ here.tangent > 0.99e-4


@every_predictor
def test_straight_lines_are_predicted_exactly(predictor):
    v = np.array([2.0, 1.0]) / np.sqrt(5.0)
    history = behind(0.07, lambda s: Knot(s, s * v, v))
    np.testing.assert_allclose(prediction(predictor, history, LINE)(0.7), 1.1 * v, rtol=0, atol=1e-13)
