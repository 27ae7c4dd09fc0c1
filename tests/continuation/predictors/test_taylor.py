"""The Taylor predictor: coefficients, range, order, dense output, and how few factorisations it needs."""

import numpy as np
import pytest
from attrs import field, frozen
from hypothesis import given, settings
from hypothesis import strategies as st

import continuation
from continuation.auditing import refine
from continuation.controllers import AllgowerGeorg, Bounds, SeriesRange
from continuation.correctors import BorderedNewton
from continuation.counts import Counts
from continuation.evaluation.evaluator import Evaluator
from continuation.metric import Euclidean
from continuation.point.linearization import linearize, relinearize, with_exact_solves
from continuation.predictors import Taylor
from continuation.predictors.fitted import fitted
from continuation.predictors.taylor import ORDERS, Series, best_order, coefficients_at, series_reach
from problems.bifurcation import Bratu1D, Circle, ExponentialCosine, FreudensteinRoth
from tests.truth import bratu, exponential_cosine, freudenstein_roth


def at_start(homotopy, metric=None):
    evaluator = Evaluator(homotopy, Counts())
    u = evaluator.start()
    border = np.zeros_like(u)
    border[0 if isinstance(homotopy, Circle) else -1] = 1.0
    return evaluator, linearize(evaluator, u, np.ones_like(u), border)


def test_circle_coefficients_are_those_of_the_square_root():
    # From (1, 0) with the tangent (0, 1) and border = tangent: lam = s, y = sqrt(1 - s^2).
    evaluator = Evaluator(Circle(), Counts())
    u = evaluator.start()
    point = linearize(evaluator, u, np.ones(2), np.array([0.0, 1.0]))
    c = coefficients_at(evaluator, point, 12)
    expected = np.zeros(13)
    for k in range(7):
        expected[2 * k] = 1.0 if k == 0 else expected[2 * k - 2] * (2 * k - 3) / (2 * k)
    np.testing.assert_allclose(c[:, 0], expected, atol=1e-15)
    np.testing.assert_allclose(c[:, 1], np.eye(13)[1], atol=1e-15)
    assert evaluator.counts.factorizations == 1


@pytest.mark.parametrize("homotopy", [ExponentialCosine(4), FreudensteinRoth(), Bratu1D(30)])
def test_the_truncated_series_satisfies_the_equation_to_its_order(homotopy):
    evaluator, point = at_start(homotopy)
    order = 9
    series = Series(coefficients_at(evaluator, point, order), np.inf)
    h = 0.5 * series_reach(series.coefficients, 1e-3, np.ones(series.coefficients.shape[1]))
    coarse, fine = (np.abs(evaluator.residual(series(t))).max() for t in (h, h / 2))
    assert coarse / fine > 2.0**order


@given(st.floats(0.1, 3.0), st.integers(5, 25))
@settings(max_examples=40, deadline=None)
def test_series_derivative_is_the_derivative(h, order):
    c = np.random.default_rng(order).standard_normal((order + 1, 4)) * 0.3 ** np.arange(order + 1)[:, None]
    series = Series(c, np.inf)
    k = np.arange(order + 1)
    np.testing.assert_allclose(series(h), (h**k) @ c, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(series.derivative(h), (k[1:] * h ** (k[1:] - 1)) @ c[1:], rtol=1e-11, atol=1e-11)


@pytest.mark.parametrize("accuracy", [1e-2, 1e-4, 1e-8])
def test_reach_keeps_the_error_near_the_accuracy_asked_for(accuracy):
    # The geometric series 1/(1 - s): the first neglected term bounds nothing yet at order 20 within the reach.
    order = 20
    c = np.ones((order + 1, 2))
    reach = series_reach(c, accuracy, np.ones(c.shape[1]))
    assert reach < 1.0
    error = abs(Series(c, reach)(0.95 * reach)[0] - 1.0 / (1.0 - 0.95 * reach))
    assert error <= 10.0 * accuracy * (1.0 + 1.0 / (1.0 - reach))


def test_order_follows_the_cost_model():
    orders = [best_order(n, 1e-4) for n in (3, 30, 300, 3000)]
    assert orders == sorted(orders)
    assert ORDERS[0] <= orders[0] < orders[-1] <= ORDERS[1]
    # The model's own optimum, by brute force over real work per length of path.
    for n in (10, 100, 400):
        f, loss = 4.0 + n / 60.0, -np.log(1e-4)
        work = {k: (f + k) * np.exp(loss / k) for k in range(ORDERS[0], ORDERS[1] + 1)}
        assert best_order(n, 1e-4) in (min(work, key=work.get) + d for d in (-1, 0, 1))


def test_a_refined_factorisation_gives_the_same_coefficients_as_one_of_its_own():
    homotopy = ExponentialCosine(5)
    evaluator, point = at_start(homotopy)
    ahead = BorderedNewton().correct(
        evaluator, point, point.u + 0.01 * point.tangent, point.border, continuation.Tolerance(1e-13)
    )
    near = relinearize(evaluator, ahead.u, point.weights, point.anchor, point.border)
    assert not near.exact
    before = evaluator.counts.factorizations
    refined = coefficients_at(evaluator, with_exact_solves(evaluator, near), 12)
    assert evaluator.counts.factorizations == before
    own = linearize(evaluator, ahead.u, point.weights, near.border)
    np.testing.assert_allclose(refined, coefficients_at(evaluator, own, 12), rtol=1e-9, atol=1e-12)


def test_one_factorisation_a_step():
    path = continuation.trace(ExponentialCosine(2), preset=continuation.SERIES)
    assert path.status is continuation.Status.REACHED_TARGET
    assert path.counts.factorizations == path.counts.accepted + 1


@pytest.mark.parametrize("rational", [False, True])
def test_freudenstein_roth_in_at_most_25_factorisations(rational):
    path = continuation.trace(
        FreudensteinRoth(),
        preset=continuation.SERIES,
        predictor=Taylor(rational=rational),
        events=[continuation.TurningPoint(0)],
    )
    np.testing.assert_allclose(path.endpoint.u, [5, 4, 1], atol=1e-12)
    found = {name: np.array([e.u for e in path.events if e.name.startswith(name)]) for name in ("turning point",)}
    points = np.array(sorted(found["turning point"], key=lambda u: u[1]))
    truth = np.vstack([freudenstein_roth.limit_points("x1"), freudenstein_roth.limit_points("lam")])
    np.testing.assert_allclose(points, truth[np.argsort(truth[:, 1])], atol=1e-10)
    assert path.counts.factorizations <= 25


def test_bratu_in_at_most_15_factorisations():
    path = continuation.trace(
        Bratu1D(1000), preset=continuation.SERIES, events=[continuation.TargetValue(1.0, direction=-1)]
    )
    assert path.status is continuation.Status.STOPPED_AT_EVENT
    assert path.turning_points[0].lam == pytest.approx(bratu.FOLD_1D[1000][0], abs=1e-12)
    assert path.counts.factorizations <= 15


def test_exponential_cosine_8_needs_half_the_factorisations_of_hermite():
    series = continuation.trace(ExponentialCosine(8), preset=continuation.SERIES)
    hermite = continuation.trace(ExponentialCosine(8))
    end = exponential_cosine.curve(8, np.array(exponential_cosine.end(8)))
    for path in (series, hermite):
        np.testing.assert_allclose(path.endpoint.u, end, atol=1e-10)
        assert len(path.turning_points) == 24
    assert 2 * series.counts.factorizations <= 1.2 * hermite.counts.factorizations


def test_a_residual_in_plain_numpy_is_traced_at_order_12_without_a_jacobian():
    def residual(y, lam):
        k = np.arange(1, 4)
        return y - lam * np.exp(np.cos(k * np.sum(y)))

    homotopy = continuation.from_functions(residual, start=(np.zeros(3), 0.0), target=1.0)
    path = continuation.trace(homotopy, preset=continuation.SERIES, predictor=Taylor(order=12))
    assert path.status is continuation.Status.REACHED_TARGET
    assert path.endpoint.y[0] == pytest.approx(0.37472756109156, abs=1e-10)
    assert len(path.turning_points) == 4


def test_dense_output_is_on_the_path_everywhere():
    homotopy = ExponentialCosine(3)
    path = continuation.trace(homotopy, preset=continuation.SERIES)
    s = np.linspace(0.0, path.arclength[-1], 400)
    assert max(np.abs(homotopy.residual(u[:-1], u[-1])).max() for u in path(s)) <= 1e-3
    refined = [refine(homotopy, path, t) for t in s[::7]]
    assert max(np.abs(homotopy.residual(u[:-1], u[-1])).max() for u in refined) <= 1e-13
    tight = continuation.trace(homotopy, preset=continuation.SERIES, predictor=Taylor(accuracy=1e-9))
    s = np.linspace(0.0, tight.arclength[-1], 400)
    assert max(np.abs(homotopy.residual(u[:-1], u[-1])).max() for u in tight(s)) <= 1e-8
    np.testing.assert_allclose(path(path.arclength[3]), path.u[3], atol=1e-12)


@pytest.mark.parametrize("preset", [continuation.DEFAULT, continuation.SERIES], ids=lambda p: p.name)
def test_dense_output_is_parametrised_by_arclength(preset):
    path = continuation.trace(Circle(), preset=preset, metric=Euclidean())
    angle = np.linspace(0.0, 6.28, 50)
    # Counted from the start in the direction of a growing parameter.
    start = np.arctan2(path.u[0, 1], path.u[0, 0])
    np.testing.assert_allclose(path(angle), np.stack([np.cos(start + angle), np.sin(start + angle)], axis=1), atol=3e-3)


@pytest.mark.parametrize("safety", [0.8, 1.0])
@pytest.mark.parametrize("order", [8, 20, 30])
def test_no_choice_of_order_and_safety_loses_the_path(order, safety):
    path = continuation.trace(
        ExponentialCosine(5), predictor=Taylor(order=order, safety=safety), controller=SeriesRange(), metric=Euclidean()
    )
    assert path.endpoint.y[0] == pytest.approx(1.5875828159969, abs=1e-10)
    assert len(path.turning_points) == 10


def test_settings_are_checked():
    with pytest.raises(ValueError, match="order"):
        Taylor(order=1)
    with pytest.raises(ValueError, match="accuracy"):
        Taylor(accuracy=2.0)


@frozen
class Noting:
    """A controller that notes the orders which it is told."""

    orders: list[int]
    rule: AllgowerGeorg = field(factory=AllgowerGeorg)
    bounds: Bounds = field(factory=Bounds)

    def init(self):
        return self.rule.init()

    def update(self, state, attempt):
        self.orders.append(attempt.order)
        return self.rule.update(state, attempt)


@pytest.mark.parametrize(
    ("predictor", "orders"),
    # Of the rational curves the one that reaches farthest is taken, which may be of an order less.
    [(Taylor(), {15}), (Taylor(rational=True), {14, 15}), (Taylor(6), {6})],
)
def test_a_controller_is_told_the_order_that_was_used(predictor, orders):
    noting = Noting([])
    continuation.trace(Circle(), predictor=predictor, controller=noting)
    assert set(noting.orders) == orders
    assert best_order(2, 1e-5) == 15


def compiled(homotopy):
    """As one that only takes floats."""

    def residual(y, lam):
        return homotopy.residual(np.asarray(y, dtype=float), float(lam))

    return continuation.from_functions(residual, start=homotopy.start(), target=homotopy.target)


def powers(y, lam):
    """What jets do not know."""
    return np.asarray(y, dtype=float) ** 3 - 1.0 - float(lam)


@pytest.mark.parametrize("preset", [continuation.DEFAULT, continuation.SERIES], ids=lambda preset: preset.name)
@pytest.mark.parametrize("slope", [None, lambda y, lam: (np.diag(3.0 * y**2), -np.ones(2))], ids=["alone", "jacobian"])
def test_no_preset_refuses_what_another_takes(preset, slope):
    homotopy = continuation.from_functions(powers, slope, start=(np.ones(2), 0.0), target=1.0)
    path = continuation.trace(homotopy, preset=preset)
    assert path.success
    np.testing.assert_allclose(path.endpoint.y, 2.0 ** (1.0 / 3.0), rtol=1e-9)
    assert any("points of the path" in note for note in path.counts.notes) == (preset is continuation.SERIES)


@pytest.mark.parametrize("homotopy", [FreudensteinRoth(), ExponentialCosine(3), Bratu1D(30)], ids=repr)
def test_series_through_points_finds_the_same_folds(homotopy):
    stop = {"events": [continuation.TargetValue(1.0, -1)]} if isinstance(homotopy, Bratu1D) else {}
    path, own = (continuation.trace(one, preset=continuation.SERIES, **stop) for one in (compiled(homotopy), homotopy))
    assert path.status is own.status
    folds, wanted = (np.array([point.lam for point in one.turning_points]) for one in (path, own))
    np.testing.assert_allclose(folds, wanted, rtol=1e-9)
    # As long as jets' steps, or a few times shorter: the order is eleven at most.
    assert len(path) <= 4 * len(own)


def test_coefficients_through_points_are_those_of_jets():
    evaluator, point = at_start(Bratu1D(20))
    exact = coefficients_at(evaluator, point, 9)
    reach = float(series_reach(exact, 1e-5, point.weights))
    for first in (1e-6, 1.0, 1e6):
        found = fitted(evaluator, point, 9, first, lambda c: series_reach(c, 1e-5, point.weights), 1e-5)
        # Beside the path, as far as the series is used.
        for s in (0.3 * reach, -0.3 * reach):
            np.testing.assert_allclose(Series(found, reach)(s), Series(exact, reach)(s), rtol=0, atol=1e-6)
        assert 0.5 * reach <= series_reach(found, 1e-5, point.weights) <= 2.0 * reach


@pytest.mark.parametrize("longest", [1e-2, 0.5, 1000.0])
def test_a_longest_step_is_kept_by_series_too(longest):
    path = continuation.trace(Circle(), preset=continuation.SERIES, max_step=longest)
    assert path.status is continuation.Status.CLOSED
    assert max(step.step_length for step in path.steps if np.isfinite(step.step_length)) <= longest * (1.0 + 1e-12)
