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


def prediction(predictor, h, s=0.4, evaluator=None):
    """At arclength s after equidistant steps h."""
    evaluator = evaluator if evaluator is not None else Evaluator(PARABOLA, Counts())
    # Steps of unequal length, as a tracer makes them.
    history = [knot(s - back * h) for back in (3.9, 2.7, 1.2, 0.0)[-max(predictor.memory, 1) :]]
    here = history[-1]
    point = linearize(evaluator, here.u, np.ones(2), here.tangent)
    return predictor.prepare(evaluator, point, history)


@every_predictor
def test_the_local_error_has_the_order_that_is_stated(predictor):
    steps = (0.02, 0.01)
    errors = [error(prediction(predictor, h)(h), knot(0.4)) for h in steps]
    measured = np.log2(errors[0] / errors[1])
    assert measured == pytest.approx(predictor.order + 1, abs=0.3)


@every_predictor
def test_it_starts_at_the_point(predictor):
    np.testing.assert_allclose(prediction(predictor, 0.05)(1e-14), knot(0.4).u, rtol=0, atol=1e-13)


@every_predictor
def test_it_runs_ahead_at_unit_speed(predictor):
    ahead = prediction(predictor, 0.01)
    eps = 1e-4
    assert np.linalg.norm(ahead(eps) - knot(0.4).u) == pytest.approx(eps, rel=5e-3)
    assert np.dot(ahead(eps) - knot(0.4).u, knot(0.4).tangent) > 0


@every_predictor
def test_the_first_step_has_no_history_and_is_tangent_at_least(predictor):
    evaluator = Evaluator(PARABOLA, Counts())
    here = knot(0.4)
    point = linearize(evaluator, here.u, np.ones(2), here.tangent)
    ahead = predictor.prepare(evaluator, point, [here])
    errors = [error(ahead(h), here) for h in (0.04, 0.02)]
    assert np.log2(errors[0] / errors[1]) > 1.7
    assert ahead.reach > 0


@every_predictor
def test_straight_lines_are_predicted_exactly(predictor):
    line = from_functions(
        lambda y, lam: y - 2.0 * lam, lambda y, lam: (np.eye(1), np.array([-2.0])), start=([0.0], 0.0)
    )
    v = np.array([2.0, 1.0]) / np.sqrt(5.0)
    history = [Knot(s, s * v, v) for s in (0.1, 0.25, 0.3, 0.5)[-max(predictor.memory, 1) :]]
    evaluator = Evaluator(line, Counts())
    point = linearize(evaluator, history[-1].u, np.ones(2), v)
    np.testing.assert_allclose(predictor.prepare(evaluator, point, history)(0.7), 1.2 * v, rtol=0, atol=1e-13)


@every_predictor
def test_a_prediction_costs_nothing(predictor):
    evaluator = Evaluator(PARABOLA, Counts())
    ahead = prediction(predictor, 0.1, evaluator=evaluator)
    before = evaluator.counts.copy()
    ahead(0.1)
    assert evaluator.counts == before
