"""The Taylor predictor: coefficients, range, order and dense output."""

import numpy as np
import pytest

from continuation import DEFAULT, SERIES, TargetValue, from_functions, trace
from continuation.auditing import refine
from continuation.controllers import SeriesRange
from continuation.counts import Counts
from continuation.evaluation.evaluator import Evaluator
from continuation.metric import Euclidean
from continuation.point.linearization import linearize
from continuation.predictors import Taylor
from continuation.predictors.taylor import coefficients_at
from problems.bifurcation import Bratu1D, Circle, ExponentialCosine, FreudensteinRoth

from ...util import by_preset

LAST = {"events": [TargetValue(1.0, direction=-1)]}


def largest_residual(homotopy, points):
    return max(np.abs(homotopy.residual(u[:-1], u[-1])).max() for u in points)


def test_circle_coefficients_are_those_of_the_square_root():
    # From (1, 0) with the tangent (0, 1) and border = tangent: lam = s, y = sqrt(1 - s^2).
    evaluator = Evaluator(Circle(), Counts())
    c = coefficients_at(evaluator, linearize(evaluator, evaluator.start(), np.ones(2), np.array([0.0, 1.0])), 12)
    ratios = [1.0, *((2 * k - 3) / (2 * k) for k in range(1, 7))]
    np.testing.assert_allclose(c[::2, 0], np.cumprod(ratios), atol=1e-15)
    np.testing.assert_allclose(c[1::2, 0], 0.0, atol=1e-15)
    np.testing.assert_allclose(c[:, 1], np.eye(13)[1], atol=1e-15)
    assert evaluator.counts.factorizations == 1


def test_dense_output_is_on_the_path_everywhere():
    homotopy = ExponentialCosine(3)
    path, tight = (trace(homotopy, preset=SERIES, predictor=part) for part in (None, Taylor(accuracy=1e-9)))
    s = np.linspace(0.0, path.arclength[-1], 400)
    assert largest_residual(homotopy, path(s)) <= 1e-3
    assert largest_residual(homotopy, [refine(homotopy, path, t) for t in s[::21]]) <= 1e-13
    assert largest_residual(homotopy, tight(np.linspace(0.0, tight.arclength[-1], 400))) <= 1e-8
    np.testing.assert_allclose(path(path.arclength[3]), path.u[3], atol=1e-12)


@pytest.mark.parametrize(("order", "safety"), [(8, 1.0), (20, 0.8), (30, 1.0)])
def test_no_choice_of_order_and_safety_loses_the_path(order, safety):
    predictor = Taylor(order=order, safety=safety)
    path = trace(ExponentialCosine(5), predictor=predictor, controller=SeriesRange(), metric=Euclidean())
    assert path.endpoint.y[0] == pytest.approx(1.5875828159969, abs=1e-10)
    assert len(path.turning_points) == 10


@pytest.mark.parametrize("bad", [{"order": 1}, {"accuracy": 2.0}])
def test_settings_are_checked(bad):
    with pytest.raises(ValueError, match=next(iter(bad))):
        Taylor(**bad)


def floats(homotopy):
    """As one that only takes floats: jets do not pass, and series go through points of the path."""
    return from_functions(
        lambda y, lam: homotopy.residual(np.asarray(y, dtype=float), float(lam)),
        start=homotopy.start(),
        target=homotopy.target,
    )


@by_preset(DEFAULT, SERIES)
@pytest.mark.parametrize(
    ("homotopy", "options"), [(FreudensteinRoth(), {}), (ExponentialCosine(3), {}), (Bratu1D(30), LAST)], ids=repr
)
def test_series_through_points_finds_the_same_folds(homotopy, options, preset):
    path, own = (trace(one, preset=preset, **options) for one in (floats(homotopy), homotopy))
    assert path.status is own.status
    found, wanted = ([point.lam for point in one.turning_points] for one in (path, own))
    np.testing.assert_allclose(found, wanted, rtol=1e-9)
    # As long as jets' steps, or a few times shorter: the order is eleven at most.
    assert len(path) <= 4 * len(own)
    assert any("points of the path" in note for note in path.counts.notes) == (preset is SERIES)
